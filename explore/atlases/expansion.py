"""A curve of symmetric orbits expanded in a parameter along it.

Near a point of the curve, in a frame whose first column is the direction of the parameter p_0 = half_width * s and
whose other columns are across, the curve is a graph p_j(s). The coefficients of the p_j come from Newton's method at
points of the circle abs(s) = 1: unlike those from real points they are accurate in the sum of their magnitudes, which
is how a verifier with polynomials on the unit disc measures them. The same orbits show how fast the coefficients of
the flow decay, and with them how wide the piece may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyval

from orbitproof.explore.atlases.complex_flow import LANES, ComplexArray, HalfReturns, Returns
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.numerics import NewtonRule

CIRCLE = NewtonRule(tolerance=1e-15, accepted=1e-7, steps=8)
"""For all points of the circle at once, in units of its radius: the least exact of them ends the iteration."""
DIFFERENCE = 1e-7
TIME_STEPS, CORRECTIONS = 3, 3
WILD = 10.0
"""Steps that grow so fast lead away from the curve, and to orbits that take long to follow."""
PLACING = 12
"""Iterations for the points of one chart in another; their axes are nearly parallel."""
NOISE = 1e-14
"""Relative size below which coefficients of the flow say nothing about their decay."""


class ExpansionFailure(Exception):
    """The curve has no expansion of this width at this point; one line says why."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Where a curve is expanded.

    Attributes:
        centre: shape (1 + n,), in the system's `centre_coordinates`.
        frame: shape (1 + n, 1 + n), column 0 along the curve, the others across.
        half_width: p_0 = half_width * s.
        scale: a typical length of the orbits there, across the curve (distance from a primary).
    """

    centre: Vector
    frame: Matrix
    half_width: float
    scale: float

    def points(self, coordinates: ComplexArray) -> ComplexArray:
        """The points with coordinates p of shape (1 + n, N), in extended precision."""
        frame, centre = self.frame.astype(np.longdouble), self.centre.astype(np.longdouble)
        return np.asarray(centre[:, None] + frame @ coordinates.astype(np.clongdouble), dtype=np.clongdouble)

    def local(self, point: Vector) -> Vector:
        """The coordinates p of a real point."""
        return np.asarray(np.linalg.solve(self.frame, (point - self.centre).astype(float)))


@dataclass(frozen=True, eq=False)
class Expansion:
    """The curve in a chart.

    Attributes:
        returns: how the orbits were followed.
        coefficients: shape (n, K), of p_1, .., p_n in s.
        times: shape (K,), of the half return's time in s, in the units of `returns.coordinates`.
        spectrum: shape (K,), largest coefficients of the state coordinates, at equal parts of the half returns, and
            of the half return's time, relative to their magnitudes.
        noise: shape (n,), error of the coefficients.
        steps: Runge-Kutta steps of the half return.
    """

    chart: Chart
    returns: HalfReturns
    coefficients: Matrix
    times: Vector
    spectrum: Vector
    noise: Vector
    steps: int

    def local(self, s: float) -> Vector:
        """The coordinates p at a real s."""
        across = [polyval(s, row) for row in self.trimmed]
        return np.array([self.chart.half_width * s, *across])

    def point(self, s: float) -> Vector:
        """The curve's point at a real s."""
        return np.asarray(self.chart.centre + self.chart.frame @ self.local(s))

    @cached_property
    def trimmed(self) -> tuple[Vector, ...]:
        """For each p_j the coefficients above the noise."""
        return tuple(_trim(row, error) for row, error in zip(self.coefficients, self.noise, strict=True))

    def predicted(self, chart: Chart) -> tuple[ComplexArray, ComplexArray]:
        """Approximate p_j, shape (n, N), and times, shape (N,), of the curve at the circle of another chart."""
        longest = max(max(map(len, self.trimmed)), 2)
        rows, times = self.coefficients[:, :longest], self.times[:longest]
        frame = np.linalg.solve(chart.frame, self.chart.frame)
        offset = np.linalg.solve(chart.frame, self.chart.centre - chart.centre)
        target = chart.half_width * circle(self.coefficients.shape[1] // 2) - offset[0]
        across = np.zeros((len(rows), len(target)), dtype=complex)
        with np.errstate(all="ignore"):
            for _ in range(PLACING):
                s = (target - frame[0, 1:] @ across) / (frame[0, 0] * self.chart.half_width)
                across = np.array([polyval(s, row) for row in rows])
            local = offset[:, None] + frame @ np.vstack([self.chart.half_width * s, across])
            return local[1:], np.asarray(polyval(s, times))

    def reach(self, chart: Chart) -> float:
        """How far from its own centre the curve has to be known for another chart, along the curve."""
        return float(abs(self.chart.local(chart.centre)[0])) + chart.half_width

    def best_half_width(self, degree: int, tolerance: float) -> float:
        """The half-width at which coefficient `degree` of the flow falls to `tolerance`.

        From a straight line through the logarithms of the coefficients, as far as they are above the noise.
        """
        sizes = np.maximum.accumulate(self.spectrum[::-1])[::-1]
        above = int(np.count_nonzero(sizes > max(NOISE, 4 * float(sizes[3 * len(sizes) // 4]))))
        if above < 4:
            return 8.0 * self.chart.half_width
        fitted = np.arange(above // 3, above)
        slope, offset = np.polyfit(fitted, np.log(sizes[fitted]), 1)
        growth = (np.log(tolerance) - offset) / degree - slope
        return self.chart.half_width * float(np.exp(min(growth, np.log(8.0))))


def circle(count: int) -> ComplexArray:
    """`count` points of the upper half of the unit circle; with their conjugates evenly spaced."""
    return np.asarray(np.exp(1j * np.pi * (np.arange(count) + 0.5) / count))


def coefficient_transform(count: int) -> ComplexArray:
    """Shape (count, 2 count): real values @ this, real part, are the Taylor coefficients of a real function."""
    return np.asarray(circle(count)[:, None] ** -np.arange(2 * count) / count)


def expand(
    returns: HalfReturns,
    chart: Chart,
    time: float,
    *,
    guess: tuple[ComplexArray, ComplexArray] | None = None,
    even: bool = False,
) -> Expansion:
    """Expand the curve through (nearly) the centre of a chart.

    Arguments:
        time: of the half return at the centre, in the units of `returns.coordinates`.
        guess: approximate p_j and times on the circle, see `Expansion.predicted`.
        even: whether the p_j are known to be even in s.

    Raises `ExpansionFailure` if Newton's method does not converge on the circle.
    """
    n = len(chart.centre) - 1
    # Each point of the circle comes with its neighbours across the curve, one in each direction.
    count = LANES // (1 + n)
    s, transform = circle(count), coefficient_transform(count)
    across, times = np.zeros((n, count), dtype=complex), np.full(count, time, dtype=complex)
    if guess is not None:
        across, times = guess
    last = np.inf
    for _ in range(CIRCLE.steps):
        result, step = _newton(returns, chart, s, across, times, transform)
        size = float(np.max(np.abs(step[:, :n]))) / chart.scale
        if not size < WILD * last:
            raise ExpansionFailure("Newton's method does not converge at complex points of the curve")
        across, times = across - step[:, :n].T, times - step[:, n]
        if CIRCLE.judge(size, last)[0]:
            break
        last = size
    else:
        if size > CIRCLE.accepted:
            raise ExpansionFailure("Newton's method does not converge at complex points of the curve")
    coefficients = (across @ transform).real
    if even:
        coefficients[:, 1::2] = 0.0
    noise = np.max(np.abs(coefficients[:, -count // 2 :]), axis=1)
    series = (times @ transform).real
    spectrum = np.maximum(result.spectrum, np.abs(series) / float(np.max(np.abs(series))))
    return Expansion(chart, returns, coefficients, series, spectrum, noise, result.steps)


def newton_on_curve(
    returns: HalfReturns, chart: Chart, s: Vector, across: Matrix, times: Vector
) -> tuple[Matrix, float]:
    """The p_j of the curve at N real s, from approximations, and the largest kernel coordinate of these.

    Arguments:
        s, times: shape (N,), N = LANES / (1 + n); the times of the half returns, roughly.
        across: shape (n, N), approximate p_1, .., p_n.

    Raises `ExpansionFailure`.
    """
    n = len(across)
    place, p, t = s.astype(complex), across.astype(complex), times.astype(complex)
    for _ in range(TIME_STEPS):
        result, _ = _newton(returns, chart, place, p, t)
        t = t - result.values[0, : len(s)] / result.rates[0, : len(s)]
    kernel = 0.0
    for number in range(CORRECTIONS):
        result, step = _newton(returns, chart, place, p, t)
        if number == 0:
            kernel = float(np.max(np.abs(result.values[1:, : len(s)])))
        p, t = p - step[:, :n].T, t - step[:, n]
    if not np.all(np.isfinite(p)):
        raise ExpansionFailure("Newton's method does not converge on the curve")
    return p.real, kernel


def _newton(
    returns: HalfReturns,
    chart: Chart,
    s: ComplexArray,
    across: ComplexArray,
    times: ComplexArray,
    transform: ComplexArray | None = None,
) -> tuple[Returns, ComplexArray]:
    """The returns and the Newton step in (p_1, .., p_n, time) for each point, shape (N, n + 1)."""
    n, count = across.shape
    small = DIFFERENCE * chart.scale
    blocks = [np.vstack([chart.half_width * s, across])]
    for j in range(n):
        moved = blocks[0].copy()
        moved[1 + j] += small
        blocks.append(moved)
    try:
        result = returns.evaluate(chart.points(np.hstack(blocks)), np.tile(times, 1 + n), transform)
    except FlowFailure as error:
        raise ExpansionFailure(str(error)) from None
    parts = [result.values[:, b * count : (b + 1) * count] for b in range(1 + n)]
    columns = [(part - parts[0]) / small for part in parts[1:]] + [result.rates[:, :count]]
    jacobian = np.moveaxis(np.array(columns), (0, 1, 2), (2, 1, 0))
    sizes = np.max(np.abs(jacobian), axis=2, keepdims=True)
    try:
        step = np.linalg.solve(jacobian / sizes, (parts[0].T / sizes[:, :, 0])[:, :, None])
    except np.linalg.LinAlgError:
        raise ExpansionFailure("the equations of the curve are singular") from None
    return result, step[:, :, 0]


def _trim(row: Sequence[float] | Vector, error: float) -> Vector:
    """The coefficients up to the last one that stands out of the noise."""
    values = np.asarray(row)
    above = np.flatnonzero(np.abs(values) > 4 * error)
    return values[: int(above[-1]) + 1] if len(above) else values[:1]
