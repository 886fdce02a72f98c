"""An orbit written down: times and states in the frame and units of a file, dense enough to be interpolated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.three_body.trajectories.frames import Frame
from orbitproof.explore.three_body.trajectories.interpolation import WINDOW, TooFine, largest_error, times_by_error
from orbitproof.explore.three_body.trajectories.trajectory import Trajectory
from orbitproof.explore.three_body.trajectories.units import Units
from orbitproof.shared.systems import THREE_BODY

ERRORS = {"km": 1e-3, "nondimensional": 1e-9}
"""Errors of the interpolation, if nothing else is said."""

FINEST = 1e-12
"""Nondimensional: what the solution is known to."""

_COUNT = 201
_INTERVALS = 40
"""That a period begins with, before steps are chosen."""

_TICK = 9
"""Digits of a second to which times in seconds are given: what dates in files hold."""


@dataclass(frozen=True)
class SampledOrbit:
    """An orbit at N times, in the units of a file.

    Attributes:
        trajectory: the orbit.
        frame: that the states refer to.
        units: `None`: nondimensional.
        times: shape (N,), 0 at the first point.
        states: shape (N, m).
        error: of the interpolation of places (`trajectories.interpolation`), in the same units; `None` where
            places are not interpolated.
    """

    trajectory: Trajectory
    frame: Frame
    units: Units | None
    times: Vector
    states: Matrix
    error: float | None

    def states_at(self, times: Vector) -> Matrix:
        """The states at other times, likewise."""
        return _states_at(self.trajectory, self.frame, self.units, times)


def sample(
    trajectory: Trajectory,
    *,
    frame: Frame | None = None,
    units: Units | None = None,
    periods: float = 1.0,
    count: int | None = None,
    error: float | None = None,
) -> SampledOrbit:
    """The states of an orbit over some periods, both ends included.

    Arguments:
        frame, units: of the states; turning, barycentric and nondimensional if they are not given.
        count: of states, at equal intervals; `None`: as many as the error needs, dense where the orbit is fast.
        error: largest error of the interpolation, in the unit of length; 1 m, or 1e-9 if nondimensional.

    Systems other than the three-body problem in space are sampled at equal intervals. Raises `TooFine`.
    """
    frame = Frame() if frame is None else frame
    span = periods * trajectory.period * (1.0 if units is None else units.time)
    in_space = trajectory.source.system in THREE_BODY

    def states_at(times: Vector) -> Matrix:
        return _states_at(trajectory, frame, units, times)

    if count is not None or not in_space:
        times = np.linspace(0.0, span, _COUNT if count is None else count)
    else:
        tolerance = ERRORS["nondimensional" if units is None else "km"] if error is None else error
        finest = FINEST * (1.0 if units is None else units.length)
        if tolerance < finest:
            raise TooFine(f"the error stays at {finest:.1e} or so, the states are known no better; give more")
        times = times_by_error(states_at, span, tolerance, int(_INTERVALS * max(periods, 1.0)))
    if units is not None:
        times = np.round(times, _TICK)
    states = states_at(times)
    found = largest_error(states_at, times, states) if in_space and len(times) >= WINDOW else None
    return SampledOrbit(trajectory, frame, units, times, states, found)


def _states_at(trajectory: Trajectory, frame: Frame, units: Units | None, times: Vector) -> Matrix:
    turns = times if units is None else times / units.time
    states = trajectory.states(turns)
    if trajectory.source.system not in THREE_BODY:
        return states
    states = frame.states(turns, states, trajectory.parameters["mu"])
    return states if units is None else states * np.array([units.length] * 3 + [units.velocity] * 3)
