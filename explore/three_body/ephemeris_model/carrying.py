"""A periodic orbit of the restricted problem carried over to bodies that move as kernels say, by multiple shooting.

The first guess is the orbit in axes that turn and stretch with the primaries as they really move. Its time, 2 pi for a
turn of the primaries, is the angle by which they have turned. States at some times, dense where the orbit is fast, are
then moved, by steps of least norm, until each leg ends where the next begins. What comes out follows the orbit for the
time that was asked for. It is not periodic: nothing is, among real bodies. Double precision; nothing is proved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.three_body.ephemeris_model.kernels import AXES, Bodies
from orbitproof.explore.three_body.ephemeris_model.motion import PointMasses
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.explore.three_body.trajectories import Ephemeris, Trajectory, about, largest_error, times_by_error

STEPS = 30
CLOSED = 1e-9
"""The largest gap between legs, relative to the distance and the speed of the primaries, at which an orbit is found."""

_COARSE = 3e-4
"""Error of the interpolation, relative to the distance of the primaries, between the times at which legs begin."""

_SMALLEST = 1 / 64
"""Smallest part of Newton's step that is tried."""

_ANGLES = 4000
"""Angles of the primaries that are looked at for each turn."""

SMALLER = 1
"""Index of the body at the origin: the smaller primary."""


class NotCarried(Exception):
    """No orbit of the real bodies was found near that of the restricted problem; one line says why."""


@dataclass(frozen=True)
class RealOrbit:
    """An orbit among real bodies, relative to the smaller primary, km and km/s in axes that do not turn.

    Attributes:
        trajectory: the periodic orbit that it follows.
        motion: the equations that it solves.
        times: shape (N + 1,), s after the start, where legs begin and end.
        starts: shape (N + 1, 6), states there.
        gaps: largest distance (km) and difference of velocity (km/s) between the end of a leg and the next start.
        moved: largest distance (km) of the starts from the first guess.
    """

    trajectory: Trajectory
    motion: PointMasses
    times: Vector
    starts: Matrix
    gaps: tuple[float, float]
    moved: float
    legs: tuple[Callable[[Vector], Matrix], ...]

    def states_at(self, times: Vector) -> Matrix:
        """The states at times, s after the start, shape (M, 6)."""
        which = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.legs) - 1)
        result = np.empty((len(times), 6))
        for number in np.unique(which):
            here = which == number
            result[here] = self.legs[number](times[here])
        return result


def carry_over(
    trajectory: Trajectory,
    bodies: Bodies,
    start: float,
    *,
    periods: float = 1.0,
    progress: Callable[[str, float], None] | None = None,
) -> RealOrbit:
    """The orbit among the bodies of loaded kernels that follows a periodic one of the restricted problem.

    Arguments:
        trajectory: of the CR3BP.
        bodies: the first two are its primaries.
        start: TDB seconds past J2000, when it is at its first point.
        periods: for how many it is followed.

    Raises `NotCarried`, and `InputError` where the kernels do not reach.
    """
    span = periods * trajectory.period
    seconds, angles = _turns(bodies, start, span)

    def guess(times: Vector) -> Matrix:
        return _guess(trajectory, bodies, start, times, np.interp(times, seconds, angles))

    length, speed = _scales(bodies, start)
    end = float(np.interp(span, angles, seconds))
    times = times_by_error(guess, end, _COARSE * length, int(8 * max(periods, 1.0)))
    first = guess(times)
    motion = PointMasses(bodies, SMALLER, start, length, length / speed)
    sizes = np.array([length] * 3 + [speed] * 3)
    states, legs, gaps = _corrected(motion, times, first / sizes, sizes, progress)
    moved = _longest((states * sizes - first)[:, :3])
    worst = np.abs(gaps) * sizes
    return RealOrbit(
        trajectory, motion, times, states * sizes,
        (_longest(worst[:, :3]), _longest(worst[:, 3:])), moved, legs,
    )  # fmt: skip


def _longest(rows: Matrix) -> float:
    return float(np.linalg.norm(rows, axis=1).max())


def _corrected(
    motion: PointMasses, times: Vector, states: Matrix, sizes: Vector, progress: Callable[[str, float], None] | None
) -> tuple[Matrix, tuple[Any, ...], Matrix]:
    """States, in units of `sizes`, from which the legs join; the legs, and what is left of the gaps."""
    legs, gaps, transitions = _shoot(motion, times, states, sizes)
    for step in range(STEPS):
        worst = float(np.abs(gaps).max())
        if progress is not None:
            progress(f"gaps {worst:.1e}", min(0.99, (step + 1) / STEPS))
        if worst < CLOSED:
            last = states - _least_change(gaps, transitions)
            better = _shoot(motion, times, last, sizes)
            joined = (last, better) if np.abs(better[1]).max() < worst else (states, (legs, gaps, transitions))
            return joined[0], joined[1][0], joined[1][1]
        change, part = _least_change(gaps, transitions), 1.0
        while True:
            tried = states - part * change
            try:
                found = _shoot(motion, times, tried, sizes)
            except FlowFailure:
                found = None
            if found is not None and np.linalg.norm(found[1]) < (1 - 0.1 * part) * np.linalg.norm(gaps):
                break
            part /= 2
            if part < _SMALLEST:
                raise NotCarried(
                    f"the legs do not join: gaps of {worst * sizes[0]:.1e} km are left; give fewer --periods, or "
                    "another --epoch"
                )
        states, (legs, gaps, transitions) = tried, found
    raise NotCarried(f"the legs do not join in {STEPS} steps; give fewer --periods, or another --epoch")


def _shoot(
    motion: PointMasses, times: Vector, states: Matrix, sizes: Vector
) -> tuple[tuple[Any, ...], Matrix, list[Matrix]]:
    legs, gaps, transitions = [], [], []
    for index in range(len(times) - 1):
        leg, end, transition = motion.leg(states[index] * sizes, times[index], times[index + 1])
        legs.append(leg)
        gaps.append(end / sizes - states[index + 1])
        transitions.append(transition * np.outer(1 / sizes, sizes))
    return tuple(legs), np.array(gaps), transitions


def _least_change(gaps: Matrix, transitions: list[Matrix]) -> Matrix:
    """The shortest change of all states that closes the gaps to first order."""
    from scipy.sparse import block_array, csr_array, eye_array
    from scipy.sparse.linalg import spsolve

    count = len(transitions)
    blocks: list[list[Any]] = [[None] * (count + 1) for _ in range(count)]
    for index, transition in enumerate(transitions):
        blocks[index][index], blocks[index][index + 1] = csr_array(transition), -eye_array(6)
    matrix = block_array(blocks, format="csc")
    return np.asarray(matrix.T @ spsolve((matrix @ matrix.T).tocsc(), gaps.ravel())).reshape(count + 1, 6)


def _scales(bodies: Bodies, start: float) -> tuple[float, float]:
    """Distance and relative speed of the primaries."""
    state = bodies.state(SMALLER, 0, start)
    return float(np.linalg.norm(state[:3])), float(np.linalg.norm(state[3:]))


def _turns(bodies: Bodies, start: float, span: float) -> tuple[Vector, Vector]:
    """Times after the start, s, and the angles by which the primaries have turned then, from 0 to `span` or beyond."""
    seconds, angles = [0.0], [0.0]
    rate = _rate(bodies, start)
    step = 2 * np.pi / _ANGLES
    while angles[-1] < span:
        middle = _rate(bodies, start + seconds[-1] + step / 2 / rate)
        seconds.append(seconds[-1] + step / rate)
        after = _rate(bodies, start + seconds[-1])
        angles.append(angles[-1] + step / rate * (rate + 4 * middle + after) / 6)
        rate = after
    return np.array(seconds), np.array(angles)


def _rate(bodies: Bodies, seconds: float) -> float:
    """Angular velocity of the primaries about each other, 1/s."""
    state = bodies.state(SMALLER, 0, seconds)
    return float(np.linalg.norm(np.cross(state[:3], state[3:])) / (state[:3] @ state[:3]))


def _guess(trajectory: Trajectory, bodies: Bodies, start: float, times: Vector, angles: Vector) -> Matrix:
    """The orbit in axes that turn and stretch with the primaries, relative to the smaller one, km and km/s."""
    turning = trajectory.states(angles)
    turning[:, :3] -= primaries(trajectory.parameters["mu"])[1]
    result = np.empty_like(turning)
    for row, time in enumerate(times):
        state = bodies.state(SMALLER, 0, start + time)
        place, velocity = state[:3], state[3:]
        distance, moment = np.linalg.norm(place), np.cross(place, velocity)
        rate, growth = np.linalg.norm(moment) / distance**2, place @ velocity / distance
        x, z = place / distance, moment / np.linalg.norm(moment)
        axes = np.column_stack([x, np.cross(z, x), z])
        where, moving = turning[row, :3], turning[row, 3:]
        result[row, :3] = distance * axes @ where
        swept = np.array([-where[1], where[0], 0.0])
        result[row, 3:] = axes @ (growth * where + distance * rate * (swept + moving))
    return result


def real_ephemeris(orbit: RealOrbit, epoch: np.datetime64, *, origin: int = SMALLER, error: float = 1e-3) -> Ephemeris:
    """The orbit with dates, states as dense as an interpolation to `error` (km) needs.

    Arguments:
        epoch: TDB, of time 0.
        origin: index of the body that the states are relative to.

    Raises `TooFine`.
    """
    bodies, start = orbit.motion.bodies, orbit.motion.start

    def states_at(times: Vector) -> Matrix:
        states = orbit.states_at(times)
        if origin != SMALLER:
            states = states + np.array([bodies.state(SMALLER, origin, start + time) for time in times])
        return states

    times = np.round(times_by_error(states_at, float(orbit.times[-1]), error), 9)
    times[-1] = min(times[-1], orbit.times[-1])
    states = states_at(times)
    found = largest_error(states_at, times, states)
    said = " ".join(f"{name} (GM {value:.12g})" for name, value in zip(bodies.names, bodies.gravity, strict=True))
    head = (
        f"{orbit.trajectory.source.title}, carried over to bodies as kernels have them by multiple shooting",
        "NUMERICAL: computed in double precision; nothing about these states is proved",
        f"point masses: {said}, km^3/s^2; no other forces",
        f"{len(orbit.legs)} legs join to {orbit.gaps[0]:.1e} km and {orbit.gaps[1]:.1e} km/s; the orbit of the "
        f"restricted problem, stretched with the primaries, is up to {orbit.moved:.6g} km away",
        f"{len(times)} states; interpolated with degree 7 (Hermite, any four neighbouring states) the places are off "
        f"by at most {found:.1e} km",
        *(f"of the restricted problem: {line}" for line in about(orbit.trajectory)),
    )
    remarks = (f"REF_FRAME: the axes that SPICE calls {AXES}", "START_TIME: TDB, the epoch of the computation")
    return Ephemeris(
        orbit.trajectory.source.title, epoch, times, states, found, bodies.names[origin].upper(), "EME2000", head,
        remarks, states_at,
    )  # fmt: skip
