"""All zeros of a smooth function on an interval, also where it only dips through zero.

Used for stability curves along a family. Sign changes between sample points are not enough: a
curve that dips through the resonant value between two samples has none. So the samples are first
made dense enough for cubic interpolation to predict the function (`resolve`), then each local minimum
of |f| that may reach zero is followed down to where f changes sign or turns back (`find_zeros`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import Vector

Scalar = Callable[[float], float]

RESOLUTION = 2e-3
"""Relative error (for magnitudes above 1, else absolute) that `resolve` leaves between samples."""


@dataclass(frozen=True)
class Samples:
    """Values of a vector function at increasing places.

    Attributes:
        places: increasing.
        values: one per place, each of shape (c,).
    """

    places: tuple[float, ...]
    values: tuple[Vector, ...]


@dataclass(frozen=True)
class Touch:
    """A local minimum of |f| so small that f may or may not reach zero there."""

    place: float
    value: float


@dataclass(frozen=True)
class Zeros:
    """What `find_zeros` returns: the zeros in order, and the touches that it could not decide."""

    zeros: tuple[float, ...]
    undecided: tuple[Touch, ...]


def resolve(
    function: Callable[[float], Vector],
    nodes: Sequence[float],
    *,
    depth: int = 6,
    progress: Callable[[float], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Samples:
    """Sample a vector function densely enough for cubic interpolation between the samples.

    Each interval between `nodes` (increasing, at least two) is halved, at most `depth` times, until
    the value at its middle agrees with the one interpolated from nearby samples within `RESOLUTION`.
    The middles become samples too. `progress` is called with each place reached; once `stop` says so, the samples end
    with the place that was reached.
    """
    known = [np.atleast_1d(np.asarray(function(place), dtype=float)) for place in nodes]
    places, values = [float(nodes[0])], [known[0]]

    def halve(low: float, high: float, guess: Samples, left: int) -> list[tuple[float, Vector]]:
        middle = 0.5 * (low + high)
        value = np.atleast_1d(np.asarray(function(middle), dtype=float))
        error = np.abs(value - _interpolate(guess, middle))
        if left <= 1 or bool(np.all(error <= RESOLUTION * (1.0 + np.abs(value)))):
            return [(middle, value)]
        index = int(np.searchsorted(guess.places, middle))
        finer = Samples(
            (*guess.places[:index], middle, *guess.places[index:]),
            (*guess.values[:index], value, *guess.values[index:]),
        )
        return [*halve(low, middle, finer, left - 1), (middle, value), *halve(middle, high, finer, left - 1)]

    for index in range(len(nodes) - 1):
        if stop():
            break
        first = max(0, min(index - 1, len(nodes) - 4))
        nearby = Samples(tuple(nodes[first : first + 4]), tuple(known[first : first + 4]))
        for place, value in [
            *halve(nodes[index], nodes[index + 1], nearby, depth),
            (nodes[index + 1], known[index + 1]),
        ]:
            places.append(float(place))
            values.append(value)
        if progress is not None:
            progress(float(nodes[index + 1]))
    return Samples(tuple(places), tuple(values))


def subdivide(
    function: Callable[[float], Vector],
    samples: Samples,
    close: Callable[[Vector, Vector], bool],
    *,
    depth: int = 12,
    progress: Callable[[float], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Samples:
    """Samples with middles added until neighbouring values are `close`; an interval is halved at most `depth` times.

    `progress` and `stop` as for `resolve`; the interval in which they end is left out.
    """
    places, values = [samples.places[0]], [samples.values[0]]

    def fill(low: float, first: Vector, high: float, last: Vector, left: int) -> None:
        if left > 0 and not close(first, last) and not stop():
            middle = 0.5 * (low + high)
            value = np.atleast_1d(np.asarray(function(middle), dtype=float))
            fill(low, first, middle, value, left - 1)
            fill(middle, value, high, last, left - 1)
            return
        places.append(high)
        values.append(last)

    for index in range(len(samples.places) - 1):
        count = len(places)
        fill(samples.places[index], samples.values[index], samples.places[index + 1], samples.values[index + 1], depth)
        if stop():
            return Samples(tuple(places[:count]), tuple(values[:count]))
        if progress is not None:
            progress(samples.places[index + 1])
    return Samples(tuple(places), tuple(values))


def _interpolate(samples: Samples, place: float) -> Vector:
    """Lagrange interpolation through the (up to) four samples nearest to `place`."""
    order = np.argsort(np.abs(np.asarray(samples.places) - place))[:4]
    total = np.zeros_like(samples.values[0])
    for i in order:
        weight = 1.0
        for j in order:
            if j != i:
                weight *= (place - samples.places[j]) / (samples.places[i] - samples.places[j])
        total = total + weight * samples.values[i]
    return total


def find_zeros(
    function: Scalar,
    places: Sequence[float],
    values: Sequence[float],
    *,
    noise: float = 1e-9,
) -> Zeros:
    """All zeros of a smooth scalar function between the first and the last of its samples.

    Arguments:
        function: the function.
        places, values: samples at increasing places, dense enough (`resolve`).
        noise: accuracy of the function. A minimum of |f| within it of zero is undecided.
    """
    tolerance = 4e-13 * max(1.0, abs(places[0]), abs(places[-1]))
    at, f = _with_dense_ends(function, places, values)
    zeros: list[float] = []
    undecided: list[Touch] = []
    for index in range(len(at) - 1):
        if (f[index] < 0) != (f[index + 1] < 0):
            zeros.append(bracketed_zero(function, (at[index], at[index + 1]), (f[index], f[index + 1]), tolerance))
    for index in range(1, len(at) - 1):
        sign = -1.0 if f[index] < 0 else 1.0
        low, middle, high = (sign * value for value in f[index - 1 : index + 2])
        if not (0.0 <= middle <= low and middle <= high and max(low, high) > middle):
            continue
        if _vertex(at[index - 1 : index + 2], (low, middle, high))[1] > 20 * RESOLUTION * (1.0 + middle):
            continue
        place, value = _minimum(
            lambda x, sign=sign: sign * function(x), at[index - 1 : index + 2], (low, middle, high), noise
        )
        if value < -noise:
            left, right = (at[index - 1], place), (place, at[index + 1])
            zeros.append(bracketed_zero(function, left, (f[index - 1], sign * value), tolerance))
            zeros.append(bracketed_zero(function, right, (sign * value, f[index + 1]), tolerance))
        elif value <= noise:
            undecided.append(Touch(place, sign * value))
    return Zeros(tuple(sorted(float(zero) for zero in zeros)), tuple(undecided))


def _with_dense_ends(
    function: Scalar, places: Sequence[float], values: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Three more samples in the first and in the last interval if the function is small there.

    A dip next to an end has no sample beyond it to show that the curve turns.
    """
    at, f = list(places), list(values)
    for low, high in ((len(at) - 2, len(at) - 1), (0, 1)):
        if min(abs(f[low]), abs(f[high])) < 20 * RESOLUTION:
            inner = [at[low] + fraction * (at[high] - at[low]) for fraction in (0.25, 0.5, 0.75)]
            f[high:high] = [function(place) for place in inner]
            at[high:high] = inner
    return at, f


def bracketed_zero(function: Scalar, ends: tuple[float, float], values: tuple[float, float], tolerance: float) -> float:
    """A zero between `ends`, where the function has `values` of opposite signs.

    Regula falsi; the Illinois rule halves the weight of an end that stays twice in a row, and a
    bisection is taken when that is not fast enough.
    """
    (low, high), (f_low, f_high) = ends, values
    if f_low == 0 or f_high == 0:
        return low if f_low == 0 else high
    stayed = 0
    for iteration in range(120):
        width = abs(high - low)
        if width <= tolerance:
            break
        place = (low * f_high - high * f_low) / (f_high - f_low)
        if iteration % 8 == 7 or not min(low, high) < place < max(low, high):
            place = 0.5 * (low + high)
        value = function(place)
        if value == 0:
            return place
        if (value < 0) == (f_low < 0):
            if abs(place - low) <= tolerance and iteration > 2:
                return place
            low, f_low = place, value
            f_high *= 0.5 if stayed == 1 else 1.0
            stayed = 1
        else:
            if abs(place - high) <= tolerance and iteration > 2:
                return place
            high, f_high = place, value
            f_low *= 0.5 if stayed == -1 else 1.0
            stayed = -1
    return 0.5 * (low + high)


def _vertex(places: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """Place and value of the minimum of the parabola through three samples around a minimum."""
    (a, m, b), (fa, fm, fb) = places, values
    left, right = (fm - fa) / (m - a), (fb - fm) / (b - m)
    curvature = (right - left) / (b - a)
    if curvature <= 0:
        return m, fm
    slope = left + curvature * (m - a)
    return m - slope / (2 * curvature), fm - slope * slope / (4 * curvature)


def refine_minimum(function: Scalar, places: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """Place and value of a minimum, from three samples of which the middle one is the lowest."""
    return _minimum(function, places, values, np.inf, 1e-4)


def _minimum(
    function: Scalar, places: Sequence[float], values: Sequence[float], noise: float, narrow: float = 1e-6
) -> tuple[float, float]:
    """The minimum in a bracketing triple of samples, or an earlier place where f < -noise.

    Parabolic steps, with golden section steps when they do not shrink the bracket.
    """
    (a, m, b), (fa, fm, fb) = places, values
    width = b - a
    for iteration in range(80):
        if fm < -noise or b - a < narrow * width:
            break
        vertex, _ = _vertex((a, m, b), (fa, fm, fb))
        margin = 0.01 * (b - a)
        if iteration % 3 == 2 or not a + margin < vertex < b - margin or abs(vertex - m) < margin:
            vertex = m + 0.381966 * (b - m if b - m > m - a else a - m)
        value = function(vertex)
        inside, f_inside, outside, f_outside = (vertex, value, m, fm) if value < fm else (m, fm, vertex, value)
        if outside < inside:
            a, fa = outside, f_outside
        else:
            b, fb = outside, f_outside
        m, fm = inside, f_inside
    return m, fm
