"""Symmetry-breaking points in the mass parameter to high precision, and extrema of the Jacobi constant along them.

The half return is expanded in jets in (x, vy, mu) and, to first order, z: one integration gives the two equations
of a symmetry breaking (Remark in Appendix B of the paper),

    F_1 = pi_vx P = 0,      F_2 = d(pi_vz P)/dz = 0,

with all their derivatives in (x, vy, mu), mu being a variable of the jets like the others. The curve F = 0 has the
tangent t = grad F_1 x grad F_2, and along it dC/dmu = grad C . t / t_mu, C the Jacobi constant. An extremum of C solves
F_1 = F_2 = 0 and D = grad C . t = 0, again by Newton's method, for which second derivatives suffice.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import ceil, log2
from typing import Any

import mpmath

from explore.crossing import section_crossings
from explore.jets import Jet, JetBasis
from explore.mass_charts import Chart
from explore.resonance import working_context
from explore.taylor import IntegrationFailure
from shared.systems import CR3BP

Progress = Callable[[str, float], None]

MAXIMAL_ITERATIONS = 12
FIRST_BITS = 128
MARGIN_DIGITS = 3
GUARD_BITS = 40

_VARIABLES = 3
_X, _VY, _MU = range(_VARIABLES)


class PrecisionFailure(Exception):
    """Newton's method found no point to the precision asked for; one line says why."""


@dataclass(frozen=True)
class Settings:
    """How the orbits are integrated.

    Attributes:
        bits: of the mantissas.
        order: of the Taylor expansion in time, `None`: what suits the precision.
        tolerance: what a step may leave out, relative to the largest coordinate; `None`: below the last bit.
    """

    bits: int
    order: int | None = None
    tolerance: float | None = None

    @property
    def tolerance_bits(self) -> int | None:
        """The tolerance as a number of bits."""
        return None if self.tolerance is None else ceil(-log2(self.tolerance))

    def coarser(self, bits: int) -> Settings:
        """For an iteration that needs fewer bits."""
        return self if bits >= self.bits else Settings(bits)

    def finer(self) -> Settings:
        """More of everything: what the result is checked against."""
        order = None if self.order is None else ceil(1.25 * self.order)
        tolerance = None if self.tolerance is None else max(self.tolerance * 1e-20, 1e-300)
        return Settings(self.bits + 80, order, tolerance)


@dataclass(frozen=True)
class PrecisePoint:
    """A symmetry-breaking point to high precision.

    Attributes:
        mu: mass parameter, exact for a point at a given mass.
        x, vy: the point on Fix(R), dyadic.
        half_period: nondimensional, to double precision.
        jacobi_constant, jacobi_derivative: C and dC/dmu along the curve, from the finer settings.
        jacobi_curvature: the second derivative of C in mu along the curve, at an extremum; otherwise `None`.
        residual: the largest Newton correction of (x, vy), at an extremum also of mu, relative to the chart's unit (mu:
            relative to mu), from an evaluation with finer settings than those that led here.
        derivative_change: by how much dC/dmu (at an extremum: C) changes from the one settings to the other.
        digits: decimal digits asked for.
        settings: those of the last Newton step.
    """

    mu: Fraction
    x: Fraction
    vy: Fraction
    half_period: float
    jacobi_constant: Fraction
    jacobi_derivative: Fraction
    jacobi_curvature: Fraction | None
    residual: float
    derivative_change: float
    digits: int
    settings: Settings


@dataclass(frozen=True)
class _Expansion:
    """F_1, F_2 and C as jets in (x, vy, mu) at one point."""

    equations: tuple[Jet, Jet]
    level: Jet
    half_period: float
    context: mpmath.MPContext

    def gradient(self, jet: Jet) -> list[Any]:
        return [jet.coefficients[jet.basis.variable(i)] for i in range(_VARIABLES)]

    def hessian(self, jet: Jet) -> list[list[Any]]:
        def entry(i: int, j: int) -> Any:
            monomial = tuple((v == i) + (v == j) for v in range(_VARIABLES))
            return jet.coefficients[jet.basis.index[monomial]] * (1 + (i == j))

        return [[entry(i, j) for j in range(_VARIABLES)] for i in range(_VARIABLES)]

    @property
    def values(self) -> list[Any]:
        return [jet.coefficients[0] for jet in self.equations]

    @property
    def tangent(self) -> list[Any]:
        return _cross(*(self.gradient(jet) for jet in self.equations))

    @property
    def determinant(self) -> Any:
        """D = grad C . (grad F_1 x grad F_2)."""
        return _dot(self.gradient(self.level), self.tangent)

    def determinant_gradient(self) -> list[Any]:
        first, second = (self.gradient(jet) for jet in self.equations)
        rows = [self.hessian(jet) for jet in (self.level, *self.equations)]
        slope, tangent = self.gradient(self.level), self.tangent
        return [
            _dot([row[i] for row in rows[0]], tangent)
            + _dot(slope, _cross([row[i] for row in rows[1]], second))
            + _dot(slope, _cross(first, [row[i] for row in rows[2]]))
            for i in range(_VARIABLES)
        ]


def _dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _expand(point: Sequence[Fraction], degree: int, settings: Settings) -> _Expansion:
    """F_1, F_2 and C around (x, vy, mu) up to `degree`; raises `IntegrationFailure`."""
    context = working_context(settings.bits)
    exponents = [m for m in product(range(degree + 1), repeat=_VARIABLES) if sum(m) <= degree]
    basis = JetBasis.of([(*m, across) for m in exponents for across in (0, 1)])
    values = [context.mpf(u.numerator) / u.denominator for u in point]
    jets = [basis.constant(value) for value in values]
    for i, jet in enumerate(jets):
        jet.coefficients[basis.variable(i)] = context.mpf(1)
    across = basis.constant(0)
    across.coefficients[basis.variable(_VARIABLES)] = context.mpf(1)
    start = [basis.constant(context.mpf(0)) for _ in CR3BP.state]
    names = CR3BP.state
    start[names.index("x")], start[names.index("vy")], start[names.index("z")] = jets[_X], jets[_VY], across
    crossing = next(
        section_crossings(
            CR3BP, {}, start, jets[_MU], context, order=settings.order, tolerance_bits=settings.tolerance_bits
        )
    )
    inner = JetBasis.of(exponents)

    def part(jet: Jet, across: int) -> Jet:
        return Jet(inner, [jet.coefficients[basis.index[(*m, across)]] for m in inner.monomials])

    program = CR3BP.first_integral_program
    assert program is not None

    def number(value: Fraction) -> Any:
        return context.mpf(value.numerator) / value.denominator

    def power(base: Any, exponent: Fraction) -> Any:
        return base.power(exponent, power) if isinstance(base, Jet) else context.mpf(base) ** number(exponent)

    level = program.evaluate([*start, jets[_MU]], number, power)[0]
    equations = (part(crossing.jets[names.index("vx")], 0), part(crossing.jets[names.index("vz")], 1))
    return _Expansion(equations, part(level, 0), crossing.time, context)


def bits_for(mu: Fraction, digits: int) -> int:
    """Working precision for that many digits: dC/dmu is a quotient of two numbers that near L3 are of order mu."""
    return ceil((digits + MARGIN_DIGITS) * log2(10)) + 2 * ceil(-log2(mu)) + GUARD_BITS


def precise_breaking(
    chart: Chart,
    mu: Fraction,
    guess: tuple[float, float],
    *,
    digits: int,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> PrecisePoint:
    """The symmetry breaking at an exact mass, with dC/dmu there.

    Arguments:
        guess: position and velocity in the chart's units, for a float64 approximation.
        digits: decimal digits of position and velocity in the chart's units, and of dC/dmu.
        settings: by default what the digits need.

    Raises `PrecisionFailure`.
    """
    lost = ceil(-log2(mu))
    settings = settings if settings is not None else Settings(bits_for(mu, digits))
    unit = chart.unit(float(mu))
    start = [Fraction(chart.origin_exact(mu)) + Fraction(guess[0] * unit), Fraction(guess[1] * unit), mu]
    return _newton(start, [unit, unit], 1, digits, settings, lost, progress)


def precise_extremum(
    chart: Chart,
    mu: float,
    guess: tuple[float, float],
    *,
    digits: int,
    settings: Settings,
    progress: Progress | None = None,
) -> PrecisePoint:
    """The local extremum of the Jacobi constant along the curve near a float64 approximation of it.

    `digits` are those of mu, relative to its size, and of the point. Raises `PrecisionFailure`.
    """
    exact = Fraction(mu)
    unit = chart.unit(mu)
    start = [chart.origin_exact(exact) + Fraction(guess[0] * unit), Fraction(guess[1] * unit), exact]
    return _newton(start, [unit, unit, mu], 2, digits, settings, ceil(-log2(mu)), progress)


def _newton(
    start: list[Fraction],
    scale: list[float],
    degree: int,
    digits: int,
    settings: Settings,
    lost: int,
    progress: Progress | None,
) -> PrecisePoint:
    """Newton's method in the first `len(scale)` coordinates of (x, vy, mu)."""
    report = progress if progress is not None else (lambda _message, _fraction: None)
    point, wanted = list(start), 10.0 ** -(digits + 1)
    known, last = 0.0, 1.0
    try:
        for iteration in range(MAXIMAL_ITERATIONS):
            here = settings.coarser(max(FIRST_BITS + 2 * lost, ceil(3 * known) + 2 * lost + GUARD_BITS))
            report(f"Newton step {iteration + 1} with {here.bits} bits", min(0.7, 0.15 * iteration))
            before = _expand(point, degree, here)
            correction = _correction(before, len(scale))
            size = max(float(abs(c)) / s for c, s in zip(correction, scale, strict=True))
            point = [_moved(u, c, settings.bits) for u, c in zip(point, correction, strict=False)] + point[len(scale) :]
            if not size < 1e-2 or (iteration > 1 and size > 10 * last and size > wanted):
                raise PrecisionFailure("Newton's method leaves the neighbourhood of the guess")
            known, last = -log2(max(size, 2.0 ** -(2 * settings.bits))), size
            # Near L3 the second derivatives are larger than the first ones of F_2 by 1/mu: what is left is size^2/mu.
            if here.bits == settings.bits and 2 * known - lost > (digits + MARGIN_DIGITS) * log2(10):
                break
        else:
            raise PrecisionFailure(f"Newton's method did not converge in {MAXIMAL_ITERATIONS} iterations")
        report("checking", 0.8)
        # The point is the result of `settings`; the same evaluated with more of everything tells how good it is.
        at, check = _expand(point, degree, settings), _expand(point, degree, settings.finer())
    except IntegrationFailure as failure:
        raise PrecisionFailure(str(failure)) from None
    except ZeroDivisionError:
        raise PrecisionFailure("the equations are singular: the point is degenerate") from None
    correction = _correction(check, len(scale))
    residual = max(float(abs(c)) / s for c, s in zip(correction, scale, strict=True))
    slopes = [e.determinant / e.tangent[_MU] for e in (at, check)]
    curvature = None
    if degree > 1:
        tangent = check.tangent
        curvature = exact(_dot(check.determinant_gradient(), tangent) / tangent[_MU] ** 2)
        change = float(abs(check.level.coefficients[0] - at.level.coefficients[0]))
    else:
        change = float(abs(slopes[1] - slopes[0]) / max(1, abs(slopes[1])))
    if residual > wanted or change > wanted:
        raise PrecisionFailure(
            f"{digits} digits are not reached with {settings.bits} bits (the last correction is {residual:.1e}, the "
            f"Jacobi constant or its derivative changes by {change:.1e}); give more bits, a higher order or a finer "
            "tolerance"
        )
    report("done", 1.0)
    return PrecisePoint(
        mu=point[_MU], x=point[_X], vy=point[_VY], half_period=check.half_period,
        jacobi_constant=exact(check.level.coefficients[0]), jacobi_derivative=exact(slopes[1]),
        jacobi_curvature=curvature, residual=residual, derivative_change=change, digits=digits, settings=settings,
    )  # fmt: skip


def _correction(expansion: _Expansion, unknowns: int) -> list[Any]:
    """Newton's correction of (x, vy), or of (x, vy, mu) with D = 0 as the third equation."""
    context = expansion.context
    rows = [expansion.gradient(jet)[:unknowns] for jet in expansion.equations]
    values = list(expansion.values)
    if unknowns == _VARIABLES:
        rows.append(expansion.determinant_gradient())
        values.append(expansion.determinant)
    # Rows of very different size (near L3 they are of order mu) would mislead the choice of pivots.
    for row, position in zip(rows, range(len(rows)), strict=True):
        size = max(abs(entry) for entry in row)
        if size == 0:
            raise ZeroDivisionError
        rows[position] = [entry / size for entry in row]
        values[position] /= size
    return [-c for c in context.lu_solve(context.matrix(rows), context.matrix(values))]


def exact(value: Any) -> Fraction:
    """The exact value of an mpmath number."""
    sign, mantissa, exponent, _ = value._mpf_
    return Fraction(int(-mantissa if sign else mantissa)) * Fraction(2) ** int(exponent)


def _moved(value: Fraction, correction: Any, bits: int) -> Fraction:
    scale = 1 << bits
    return Fraction(round((value + exact(correction)) * scale), scale)
