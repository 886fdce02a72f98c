"""Times at which an orbit is written down: as dense as an interpolation between them needs.

Readers of ephemerides put a polynomial of degree 7 through four neighbouring states, places and velocities (Hermite;
type 13 of SPK, INTERPOLATION in an OEM). Which four they take for a given time differs from reader to reader. An error
here is the largest over all windows of four that contain the time.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from orbitproof.explore.flow import Matrix, Vector

DEGREE = 7
WINDOW = 4
"""States that determine a polynomial of this degree."""

MOST = 1_000_000
"""States in a file."""

_PLACES = np.array([0.2, 0.5, 0.8])
"""Where within an interval errors are measured, for its length 1."""

_ROUNDS = 40
_AIM = 0.4
"""The part of the tolerance that the density of times is chosen for."""

_IN_VAIN = 4
"""So many times in a row the error may stay as it is."""

_FASTEST = 16.0
"""An interval is divided into at most so many at a time."""


class TooFine(Exception):
    """No number of states gives the error that is wanted; one line says why."""


def check_times(times: Vector) -> Matrix:
    """The times at which the error of each interval is measured, shape (intervals, 3)."""
    return np.asarray(times[:-1, None] + np.diff(times)[:, None] * _PLACES)


def interval_errors(times: Vector, states: Matrix, between: Matrix, places: Matrix) -> Vector:
    """The largest distance between the orbit and its interpolation in each interval.

    Arguments:
        times: shape (N,), N at least 4.
        states: shape (N, 6), places and velocities.
        between: shape (N - 1, 3), from `check_times`.
        places: shape (N - 1, 3, 3), where the orbit is then.
    """
    count = len(times) - WINDOW + 1
    windows = np.arange(count)[:, None] + np.arange(WINDOW)
    middle, size = times[windows].mean(axis=1), times[windows[:, -1]] - times[windows[:, 0]]
    nodes = np.repeat((times[windows] - middle[:, None]) / size[:, None], 2, axis=1)
    coefficients = _divided(nodes, states[windows][:, :, :3], states[windows][:, :, 3:] * size[:, None, None])
    result = np.zeros(len(times) - 1)
    for offset in range(WINDOW - 1):
        rows = np.arange(count) + offset
        at = (between[rows] - middle[:, None]) / size[:, None]
        found = np.zeros((count, len(_PLACES), 3))
        for order in range(2 * WINDOW - 1, -1, -1):
            found = found * (at - nodes[:, order, None])[:, :, None] + coefficients[:, order, None, :]
        result[rows] = np.maximum(result[rows], np.linalg.norm(found - places[rows], axis=2).max(axis=1))
    return result


def _divided(nodes: Matrix, places: Matrix, slopes: Matrix) -> Matrix:
    """Newton's divided differences with every node twice, shape (windows, 8, 3)."""
    table = np.repeat(places, 2, axis=1)
    result = [table[:, 0]]
    for order in range(1, 2 * WINDOW):
        gaps = nodes[:, order:] - nodes[:, :-order]
        with np.errstate(divide="ignore", invalid="ignore"):
            quotients = np.diff(table, axis=1) / gaps[:, :, None]
        if order == 1:
            quotients[:, ::2] = slopes
        table = quotients
        result.append(table[:, 0])
    return np.stack(result, axis=1)


def largest_error(states_at: Callable[[Vector], Matrix], times: Vector, states: Matrix) -> float:
    """The error of the interpolation between given states, against the orbit `states_at`."""
    return float(_errors(states_at, times, states).max())


def _errors(states_at: Callable[[Vector], Matrix], times: Vector, states: Matrix) -> Vector:
    between = check_times(times)
    places = states_at(between.ravel())[:, :3].reshape(*between.shape, 3)
    return interval_errors(times, states, between, places)


def times_by_error(states_at: Callable[[Vector], Matrix], span: float, tolerance: float, first: int = 40) -> Vector:
    """Times from 0 to `span` between which the interpolation is off by at most `tolerance`, in the unit of the places.

    Intervals are made as long as they may be: the error of degree 7 grows as the eighth power of their length. Raises
    `TooFine`.
    """
    times, least, in_vain = np.linspace(0.0, span, max(first, WINDOW) + 1), np.inf, 0
    for _ in range(_ROUNDS):
        errors = _errors(states_at, times, states_at(times))
        in_vain = in_vain + 1 if errors.max() > max(0.5 * least, tolerance) else 0
        least = min(least, float(errors.max()))
        if not np.all(np.isfinite(errors)):
            raise TooFine("the orbit cannot be interpolated")
        factors = np.clip((errors / (_AIM * tolerance)) ** (1 / (2 * WINDOW)), 0.25, _FASTEST)
        wanted = float(factors.sum())
        if errors.max() <= tolerance and len(times) - 1 <= 1.1 * wanted + WINDOW:
            return times
        if wanted > MOST or in_vain == _IN_VAIN:
            break
        # A window reaches over its neighbours, so the density changes slowly from one to the next.
        smooth = np.maximum(factors, 0.7 * np.maximum(np.append(factors[1:], 0), np.append(0, factors[:-1])))
        places = np.append(0.0, np.cumsum(smooth))
        count = max(int(np.ceil(places[-1])), WINDOW)
        times = np.interp(np.linspace(0.0, places[-1], count + 1), places, times)
        times[-1] = span
    if errors.max() <= tolerance:
        return times
    raise TooFine(f"the error stays at {least:.1e}, the states are known no better; give more")
