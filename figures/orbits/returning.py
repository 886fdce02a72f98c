"""Periodic orbits without symmetry as polylines: from a section back to it, for drawing only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.shared.formats import PeriodicOrbit

_TOLERANCE = 1e-12
_STEPS = 50_000
_ROWS = 24
"""States that are kept of a step."""
_CLOSED = 1e-3
"""Of the size of an orbit: how far its ends may be apart in a picture."""


@dataclass(frozen=True)
class ReturningOrbit:
    """An orbit from a point of a section to one of its crossings in the direction.

    Attributes:
        times: shape (K,), from 0 on.
        states: shape (K, N), at these times.
        crossings: shape (m, N), where it crosses the section in the direction after the start.
    """

    times: Array
    states: Array
    crossings: Array


def returning_orbit(claim: PeriodicOrbit, start: Sequence[float]) -> ReturningOrbit:
    """The orbit of a point of a claim's section up to its last crossing, in double precision.

    Raises `OrbitNotClosed`, also if the orbit is so unstable that it does not close in a picture.
    """
    values = [float(value) for value in claim.values]
    normal, offset = np.array([float(value) for value in claim.normal]), float(claim.offset)

    def field(_time: float, state: Array) -> Array:
        return np.array(claim.system.vector_field(state.tolist(), values), dtype=float)

    def height(state: Array) -> float:
        return claim.direction * float(normal @ state - offset)

    times, states, crossings = [0.0], [np.array(start, dtype=float)], list[Array]()
    try:
        solver = DOP853(field, 0.0, states[0], np.inf, rtol=_TOLERANCE, atol=_TOLERANCE)
        above = True
        for _ in range(_STEPS):
            solver.step()
            if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
                break
            between = solver.dense_output()
            for time in np.linspace(solver.t_old, solver.t, _ROWS + 1)[1:]:
                state = between(time)
                if not above and height(state) >= 0:
                    instant = brentq(lambda t, between=between: height(between(t)), times[-1], time, xtol=1e-15)
                    crossings.append(between(instant))
                    if len(crossings) == claim.crossings:
                        return _closed([*times, instant], [*states, crossings[-1]], crossings)
                above = height(state) >= 0
                times.append(float(time))
                states.append(state)
    except (ArithmeticError, ValueError) as error:
        raise OrbitNotClosed(f"the orbit of {claim.id} cannot be followed: {error}") from None
    raise OrbitNotClosed(f"the orbit of {claim.id} is not back after {_STEPS} steps")


def _closed(times: list[float], states: list[Array], crossings: list[Array]) -> ReturningOrbit:
    rows = np.array(states)
    apart, size = np.abs(rows[-1] - rows[0]).max(), np.ptp(rows, axis=0).max()
    if not apart < _CLOSED * size:
        raise OrbitNotClosed("the orbit does not close in double precision")
    return ReturningOrbit(np.array(times), rows, np.array(crossings))
