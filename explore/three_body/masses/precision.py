"""Symmetry-breaking points in the mass parameter to high precision, and extrema of the Jacobi constant along them.

Newton's method for the equations of `masses.expansion` in (x, vy) at a given mass. An extremum of the Jacobi
constant C along the curve solves F_1 = F_2 = 0 and D = grad C . (grad F_1 x grad F_2) = 0, by Newton's method in
(x, vy, mu), for which second derivatives suffice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import GrowingDigits, Linearised, fraction, newton_with_digits
from orbitproof.explore.refinement import IntegrationFailure
from orbitproof.explore.three_body.masses.charts import MassChart
from orbitproof.explore.three_body.masses.expansion import MU, VARIABLES, VY, Expansion, Settings, X, dot, expand

FIRST_BITS = 128
MARGIN_DIGITS = 3
GUARD_BITS = 40


class PrecisionFailure(Exception):
    """Newton's method found no point to the precision asked for; one line says why."""


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


def bits_for(mu: Fraction, digits: int) -> int:
    """Working precision for that many digits: dC/dmu is a quotient of two numbers that near L3 are of order mu."""
    return ceil((digits + MARGIN_DIGITS) * log2(10)) + 2 * ceil(-log2(mu)) + GUARD_BITS


def precise_breaking(
    chart: MassChart,
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
    if chart.smaller:
        return _newton(start, [unit, unit], 1, digits, settings, 0, progress)
    return _newton(_onto_family(start, settings, lost), [unit, unit], 1, digits, settings, lost, progress)


def precise_extremum(
    chart: MassChart,
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
    if chart.smaller:
        return _newton(start, [unit, unit, mu], 2, digits, settings, 0, progress)
    lost = ceil(-log2(mu))
    return _newton(_onto_family(start, settings, lost), [unit, unit, mu], 2, digits, settings, lost, progress)


def _onto_family(point: list[Fraction], settings: Settings, lost: int) -> list[Fraction]:
    """The symmetric orbit (F_1 = 0) with the same x, where a guess in double precision is too far away from it.

    Near L3 F_2 is of order mu on the family of symmetric orbits only, and of the size of the distance beside it:
    Newton's method for both equations converges from distances below mu.
    """
    coarse = settings.coarser(FIRST_BITS + 2 * lost)
    distance = 1e-14
    try:
        while distance > 2.0 ** -(lost + 10):
            at = expand(point, 1, coarse)
            first = at.equations[0]
            correction = -first.coefficients[0] / at.gradient(first)[VY]
            if not abs(correction) < 1e-6:
                raise PrecisionFailure("Newton's method leaves the neighbourhood of the guess")
            point = [point[X], _rounded(point[VY] + fraction(correction), coarse.bits), point[MU]]
            distance = float(abs(correction)) ** 2
    except IntegrationFailure as failure:
        raise PrecisionFailure(str(failure)) from None
    return point


def _newton(
    start: list[Fraction],
    scale: list[float],
    degree: int,
    digits: int,
    settings: Settings,
    lost: int,
    progress: Progress | None,
) -> PrecisePoint:
    """Newton's method in the first `len(scale)` coordinates of (x, vy, mu), from `start` in units of `scale`.

    `lost`: bits by which F_2 and its derivative in x are smaller than its other derivatives. By as much the
    second-order terms are larger, and the error of dC/dmu than that of the point.
    """
    report = progress if progress is not None else (lambda _message, _fraction: None)
    wanted = 10.0 ** -(digits + 1)

    def place(unknowns: Sequence[Fraction]) -> list[Fraction]:
        moved = [u + Fraction(s) * c for u, s, c in zip(start, scale, unknowns, strict=False)]
        return [_rounded(u, settings.bits) for u in moved] + start[len(scale) :]

    def equations(unknowns: Sequence[Fraction], context: mpmath.MPContext) -> Linearised:
        at = expand(place(unknowns), degree, settings.coarser(context.prec))
        return Linearised(*_equations(at, scale), 4.0**lost)

    first = min(FIRST_BITS + 2 * lost, settings.bits)
    rule = GrowingDigits(PrecisionFailure, farthest=1e-2, first_bits=first, guard_bits=GUARD_BITS, growth=3)
    goal = settings.bits - GUARD_BITS - 2 * lost
    enough = (digits + MARGIN_DIGITS) * log2(10) / 2 + lost
    try:
        found = newton_with_digits(equations, [Fraction(0)] * len(scale), goal, rule, report, enough=enough)
        report("checking", 0.95)
        # The point is the result of `settings`; the same evaluated with more of everything tells how good it is.
        point = place(found.unknowns)
        at, check = expand(point, degree, settings), expand(point, degree, settings.finer())
    except IntegrationFailure as failure:
        raise PrecisionFailure(str(failure)) from None
    except ZeroDivisionError:
        raise PrecisionFailure("the equations are singular: the point is degenerate") from None
    values, matrix = _equations(check, scale)
    residual = max(float(abs(c)) for c in check.context.lu_solve(matrix, values))
    slopes = [e.determinant / e.tangent[MU] for e in (at, check)]
    curvature = None
    if degree > 1:
        tangent = check.tangent
        curvature = fraction(dot(check.determinant_gradient(), tangent) / tangent[MU] ** 2)
        change = float(abs(check.level.coefficients[0] - at.level.coefficients[0]))
    else:
        change = float(abs(slopes[1] - slopes[0]) / max(1, abs(slopes[1])))
    if residual * 2.0**lost > wanted or change > wanted:
        raise PrecisionFailure(
            f"{digits} digits are not reached with {settings.bits} bits (the last correction is {residual:.1e}, the "
            f"Jacobi constant or its derivative changes by {change:.1e}); give more bits, a higher order or a finer "
            "tolerance"
        )
    report("done", 1.0)
    return PrecisePoint(
        mu=point[MU],
        x=point[X],
        vy=point[VY],
        half_period=check.half_period,
        jacobi_constant=fraction(check.level.coefficients[0]),
        jacobi_derivative=fraction(slopes[1]),
        jacobi_curvature=curvature,
        residual=residual,
        derivative_change=change,
        digits=digits,
        settings=settings,
    )


def _equations(expansion: Expansion, scale: Sequence[float]) -> tuple[Any, Any]:
    """F_1 and F_2, with three unknowns also D, and their derivatives, for unknowns in units of `scale`."""
    context = expansion.context
    rows, values = [expansion.gradient(jet) for jet in expansion.equations], list(expansion.values)
    if len(scale) == VARIABLES:
        rows.append(expansion.determinant_gradient())
        values.append(expansion.determinant)
    rows = [[entry * s for entry, s in zip(row, scale, strict=False)] for row in rows]
    # Rows of very different size (near L3 they are of order mu) would mislead the choice of pivots.
    scaling = context.diag([1 / max(map(abs, row)) for row in rows])
    return scaling * context.matrix(values), scaling * context.matrix(rows)


def _rounded(value: Fraction, bits: int) -> Fraction:
    scale = 1 << bits
    return Fraction(round(value * scale), scale)
