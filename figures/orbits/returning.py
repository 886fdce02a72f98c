"""Periodic orbits without symmetry as polylines: from a section back to it, for drawing only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq

from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.shared.formats import InSection

_TOLERANCE = 1e-12
_COARSE = 1e-9
_STEPS = 50_000
_ROWS = 24
"""States that are kept of a step."""
_CLOSED = 1e-3
"""How far the ends of an orbit may be apart in a picture, relative to its size."""


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


def returning_orbit(
    claim: InSection, start: Sequence[float], crossings: int | None = None, values: Sequence[float] | None = None
) -> ReturningOrbit:
    """The orbit of a point of a claim's section up to its last crossing, in double precision.

    Arguments:
        crossings: how many; by default as claimed.
        values: the parameters in the vector field's order; by default those of the claim.

    Raises `OrbitNotClosed`, also if the orbit is so unstable that it does not close in a picture.
    """
    last = claim.crossings if crossings is None else crossings
    values = [float(value) for value in (claim.values if values is None else values)]
    normal, offset = np.array([float(value) for value in claim.normal]), float(claim.offset)

    def field(_time: float, state: Array) -> Array:
        return np.array(claim.system.program.evaluate([*state.tolist(), *values]), dtype=float)

    def height(state: Array) -> float:
        return claim.direction * float(normal @ state - offset)

    times, states, found = [0.0], [np.array(start, dtype=float)], list[Array]()
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
                    found.append(between(instant))
                    if len(found) == last:
                        return _closed([*times, instant], [*states, found[-1]], found)
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


def orbit_over(
    claim: InSection, start: Sequence[float] | Array, values: Sequence[float], time: float, rows: int
) -> tuple[Array, Array]:
    """An orbit over a time, which may be negative: so many times, and the states there, shape (rows, N).

    Raises `OrbitNotClosed` if it cannot be followed.
    """

    def field(_time: float, state: Array) -> Array:
        return np.array(claim.system.program.evaluate([*state.tolist(), *values]), dtype=float)

    times = np.linspace(0.0, time, rows)
    try:
        found = solve_ivp(field, (0.0, time), np.asarray(start), "DOP853", times, rtol=_COARSE, atol=_COARSE)
    except (ArithmeticError, ValueError) as error:
        raise OrbitNotClosed(f"an orbit of {claim.id} cannot be followed: {error}") from None
    if not (found.success and np.all(np.isfinite(found.y))):
        raise OrbitNotClosed(f"an orbit of {claim.id} cannot be followed")
    return times, found.y.T
