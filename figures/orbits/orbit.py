"""Symmetric periodic orbits as polylines, in double precision, for drawing only.

The vector field is the one of `shared.systems.system`. From a point of Fix(R) an orbit is integrated for half a
period, or to its next crossing of the section; the other half is its image under R.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from orbitproof.figures.orbits.fixed_set import Array, parameter_values, state_on_fixed_set
from orbitproof.shared.systems import ReversibleSystem

# Dormand and Prince, A family of embedded Runge-Kutta formulae (1980), orders 5 and 4.
_STAGES = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)

_TOLERANCE = 1e-9
_STEPS = 20_000
_ROWS = 80
_CLOSED = 1e-3
_CROSSINGS = 8
_ON_FIXED_SET = 1e-2


class OrbitNotClosed(Exception):
    """The orbit did not come back to the section, or ran into a singularity."""


def symmetric_orbit(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[float],
    longest_step: float = 0.03,
) -> Array:
    """The closed orbit through a point of Fix(R), shape (N, m), first row repeated at the end.

    `point` is in the order of `ReversibleSystem.centre_coordinates`; `longest_step` bounds the time
    between rows (nondimensional). Raises `OrbitNotClosed`.
    """
    values = parameter_values(system, parameters, point)
    try:
        half = _to_fixed_set(system, values, state_on_fixed_set(system, parameters, point), longest_step)
    except (ZeroDivisionError, OverflowError):
        raise OrbitNotClosed("the orbit runs into a singularity of the vector field") from None
    mirrored = half[-2::-1] * np.array(system.reversing_symmetry, dtype=float)
    return np.vstack([half, mirrored])


def symmetric_orbits(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    points: Array,
    half_periods: Array,
) -> list[Array]:
    """The closed orbits through N points of Fix(R) whose half periods are known, integrated side by side.

    Arguments:
        points: shape (N, 1 + n), in the order of `ReversibleSystem.centre_coordinates`.
        half_periods: shape (N,), nondimensional time from a point to the other one on Fix(R).

    Returns arrays of shape (rows, m), rows differing from orbit to orbit, the first row repeated at the end.
    Raises `OrbitNotClosed` if one of them does not end on Fix(R).
    """
    values = np.array([parameter_values(system, parameters, point) for point in points]).T
    states = np.array([state_on_fixed_set(system, parameters, point) for point in points]).T
    halves = _side_by_side(system, values, states, np.asarray(half_periods, dtype=float))
    signs = np.array(system.reversing_symmetry, dtype=float)
    orbits = []
    for index, half in enumerate(halves):
        miss = float(np.abs(half[-1][signs == -1]).max() / (1.0 + np.abs(half).max()))
        if not miss < _CLOSED:
            raise OrbitNotClosed(f"orbit {index} ends {miss:.2g} away from Fix(R)")
        orbits.append(np.vstack([half, half[-2::-1] * signs]))
    return orbits


def orbit_through(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[float],
    crossings: Array,
    longest_step: float = 0.03,
) -> Array:
    """The closed orbit that starts at a point of Fix(R) and crosses the section at given states, shape (N, m).

    Every piece between crossings is integrated from its own state: orbits that are so unstable that the start
    alone would not bring them back can be drawn too.

    Arguments:
        point, longest_step: as for `symmetric_orbit`.
        crossings: shape (k - 1, m), the states at which half the orbit crosses the section between its ends.

    Raises `OrbitNotClosed`.
    """
    values = parameter_values(system, parameters, point)
    starts = [state_on_fixed_set(system, parameters, point), *(list(map(float, state)) for state in crossings)]
    try:
        pieces = [_to_section(system, values, start, longest_step) for start in starts]
    except (ZeroDivisionError, OverflowError):
        raise OrbitNotClosed("the orbit runs into a singularity of the vector field") from None
    half = np.vstack([*(piece[:-1] for piece in pieces[:-1]), pieces[-1]])
    return np.vstack([half, half[-2::-1] * np.array(system.reversing_symmetry, dtype=float)])


def loop_through(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[float],
    crossings: Array,
    longest_step: float = 0.03,
) -> Array:
    """The closed orbit that crosses the section at given states and nowhere else, without symmetry, shape (N, m).

    Every piece between crossings is integrated from its own state, as in `orbit_through`.

    Arguments:
        point: that has the family parameter, if there is one.
        crossings: shape (c, m), in order.

    Raises `OrbitNotClosed`.
    """
    values = parameter_values(system, parameters, point)
    try:
        pieces = [_to_section(system, values, list(map(float, state)), longest_step) for state in crossings]
    except (ZeroDivisionError, OverflowError):
        raise OrbitNotClosed("the orbit runs into a singularity of the vector field") from None
    return np.vstack([*(piece[:-1] for piece in pieces), crossings[:1]])


def _to_fixed_set(
    system: ReversibleSystem, values: Sequence[float], start: Sequence[float], longest_step: float
) -> Array:
    """To the first crossing of the section close to Fix(R); to the first of all if none of the next ones is."""
    first = half = _to_section(system, values, start, longest_step)
    for _ in range(_CROSSINGS):
        if np.abs(half[-1][list(system.kernel_coordinates)]).max() < _ON_FIXED_SET * (1.0 + np.abs(half).max()):
            return half
        half = np.vstack([half[:-1], _to_section(system, values, list(half[-1]), longest_step)])
    return first


def _side_by_side(system: ReversibleSystem, values: Array, states: Array, times: Array) -> list[Array]:
    """States along each of N orbits, each with steps of its own; arrays have the orbit as last axis."""

    def field(selection: NDArray[np.intp]) -> Callable[[Array], Array]:
        return lambda x: np.stack(np.broadcast_arrays(*system.program.evaluate([*x, *values[:, selection]])))

    count = len(times)
    rows: list[list[Array]] = [[states[:, i]] for i in range(count)]
    elapsed, steps = np.zeros(count), times / (4 * _ROWS)
    slopes = field(np.arange(count))(states)
    states = states.copy()
    for _ in range(_STEPS):
        active = np.flatnonzero(elapsed < times)
        if not len(active):
            return [np.array(orbit) for orbit in rows]
        remaining = times[active] - elapsed[active]
        step = np.minimum(steps[active], remaining)
        following, next_slopes, error = _step(field(active), states[:, active], slopes[:, active], step)
        size = np.max(np.abs(error) / (1.0 + np.abs(following)), axis=0)
        if not np.all(np.isfinite(size)):
            raise OrbitNotClosed("an orbit is not finite")
        good = size <= _TOLERANCE
        done = active[good]
        states[:, done], slopes[:, done] = following[:, good], next_slopes[:, good]
        elapsed[done] = np.where(step[good] == remaining[good], times[done], elapsed[done] + step[good])
        for i in done:
            rows[i].append(states[:, i].copy())
        factor = np.clip(0.9 * (_TOLERANCE / np.maximum(size, 1e-30)) ** 0.2, 0.2, 4.0)
        steps[active] = np.minimum(step * factor, times[active] / _ROWS)
    raise OrbitNotClosed(f"an orbit takes more than {_STEPS} steps")


def _to_section(
    system: ReversibleSystem, values: Sequence[float], start: Sequence[float], longest_step: float
) -> Array:
    section = system.section_index

    def field(state: Array) -> Array:
        return np.array(system.vector_field([float(v) for v in state], values), dtype=float)

    state = np.array(start, dtype=float)
    rows = [state]
    step = min(1e-3, longest_step)
    slope = field(state)
    for _ in range(_STEPS):
        following, next_slope, error = _step(field, state, slope, step)
        size = float(np.max(np.abs(error) / (1.0 + np.abs(following))))
        if not np.isfinite(size):
            raise OrbitNotClosed("the orbit is not finite")
        if size > _TOLERANCE:
            step *= max(0.2, 0.9 * (_TOLERANCE / size) ** 0.2)
            continue
        crossed = len(rows) > 1 and following[section] * state[section] <= 0
        if crossed and abs(following[section]) > 1e-10:
            # Secant in time: the crossing is transversal and the step is short.
            step *= float(state[section] / (state[section] - following[section]))
            continue
        state, slope = following, next_slope
        rows.append(state)
        if abs(state[section]) <= 1e-10:
            return np.array(rows)
        step = min(longest_step, step * min(4.0, 0.9 * (_TOLERANCE / max(size, 1e-30)) ** 0.2))
    raise OrbitNotClosed("the orbit did not come back to the section")


def _step(
    field: Callable[[Array], Array], state: Array, slope: Array, step: Array | float
) -> tuple[Array, Array, Array]:
    slopes = [slope]
    following = state
    for row in _STAGES:
        following = state + step * sum(c * k for c, k in zip(row, slopes, strict=True))
        slopes.append(field(following))
    error = np.asarray(step * sum(c * k for c, k in zip(_ERROR, slopes, strict=True)))
    return following, slopes[-1], error
