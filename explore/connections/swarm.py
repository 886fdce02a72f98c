"""Many orbits at once in float64, each with steps of its own, to their crossings of a coordinate plane."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow.runge_kutta import square_tableau

Array = NDArray[np.float64]
Field = Callable[[Array], Array]

_TOLERANCE = 1e-11
_MOST = 5000
_SHORTEST = 1e-7
"""Of the first step: an orbit whose steps are shorter runs into a singularity."""
_POLISH = 4


def crossings_of(field: Field, start: Array, section: int, most: int, time: float) -> Array:
    """The states at which orbits cross the plane {x_section = 0} after they start, in order.

    Arguments:
        field: of states, shape (m, N), one column for each orbit.
        start: shape (m, N).
        most: how many crossings are wanted.
        time: how long orbits are followed at most.

    Returns shape (most, m, N); NaN where an orbit has not so many.
    """
    size, orbits = start.shape
    found = np.full((most, size, orbits), np.nan)
    state, count, elapsed = start.copy(), np.zeros(orbits, dtype=int), np.zeros(orbits)
    first = time / _MOST
    length, side, active = np.full(orbits, first), np.sign(start[section]), np.arange(orbits)
    with np.errstate(all="ignore"):
        for _ in range(_MOST):
            here, h = state[:, active], length[active]
            end, error = _step(field, here, h)
            good = error <= 1
            y, now = np.sign(end[section]), side[active]
            over = good & (now * y < 0)
            if over.any():
                at = _onto(field, here[:, over], end[:, over], h[over], section)
                which = active[over]
                found[count[which], :, which] = at.T
                count[which] += 1
            moved = active[good]
            state[:, moved] = end[:, good]
            elapsed[moved] += h[good]
            side[moved] = np.where(y[good] == 0, side[moved], y[good])
            length[active] = h * np.where(error > 0, np.clip(0.9 * error ** (-1 / 8), 0.2, 5.0), 5.0)
            lost = ~np.isfinite(error) | (length[active] < _SHORTEST * first)
            active = active[~lost & (count[active] < most) & (elapsed[active] < time)]
            if not len(active):
                break
    return found


def _step(field: Field, state: Array, length: Array) -> tuple[Array, Array]:
    """One step of order 8, and its error in units of the tolerance."""
    lower, weights = square_tableau()
    slopes = [field(state)]
    end = state
    for row in lower[1:]:
        end = state + length * _combined(row, slopes)
        slopes.append(field(end))
    size = _TOLERANCE * (1 + np.maximum(abs(state), abs(end)))
    return end, np.max(abs(length * _combined(weights, slopes)) / size, axis=0)


def _combined(row: Any, slopes: list[Array]) -> Array:
    terms = (factor * slope for factor, slope in zip(row, slopes, strict=False) if factor)
    return sum(terms, np.zeros_like(slopes[0]))


def _onto(field: Field, start: Array, end: Array, length: Array, section: int) -> Array:
    """The states on the section, by Newton's method in the length of a step."""
    part = length * start[section] / (start[section] - end[section])
    for _ in range(_POLISH):
        at, _ = _step(field, start, part)
        part = part - at[section] / field(at)[section]
    return _step(field, start, part)[0]
