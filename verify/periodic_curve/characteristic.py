"""The multipliers of all orbits of a piece, as a polynomial whose coefficients are functions of s (section 26.6)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import Annotated

from flint import arb, arb_poly, ctx

from orbitproof.shared.formats import PeriodicAtlas, Piece
from orbitproof.shared.stored import rules
from orbitproof.verify.algebra import Series, ball_polynomial, recentred
from orbitproof.verify.claim import inverse
from orbitproof.verify.curve import BEYOND, Computation, Equation, Interval, IntervalResult, ProvedInterval
from orbitproof.verify.evidence import IntegrationFailure, NotKnown, all_finite, enclose, hull, total
from orbitproof.verify.functions import REACH, BoundedFunction, StoredFunction, determinant

_INSIDE = 1 / BEYOND
"""The proved interval is |sigma| <= 16/17."""
_SHARE = REACH * _INSIDE
"""dsigma/dtau."""
_MOST, _BITS = 6, 192
"""The largest matrix whose minors are not too many; bits with which stored functions are compared."""


@dataclass(frozen=True)
class MultiplierFunctions:
    """Functions of tau on an interval of a piece.

    Attributes:
        coefficients: c_1, c_2, .. of the polynomial lambda^n + c_1 lambda^(n-1) + .. whose zeros are the multipliers.
    """

    coefficients: Annotated[tuple[StoredFunction, ...], rules(minItems=1, maxItems=8)]


@dataclass(frozen=True)
class PeriodicIntervalResult(IntervalResult):
    """What was found for a piece of such a curve.

    Attributes:
        multipliers: of the orbits, or why they are not known; `None` if nothing is said of them.
    """

    multipliers: MultiplierFunctions | NotKnown | None = None


@dataclass(frozen=True)
class ProvedPeriodicInterval(ProvedInterval):
    """A `ProvedInterval` with the multipliers of its orbits.

    Attributes:
        multipliers: as of `PeriodicIntervalResult`.
    """

    multipliers: MultiplierFunctions | NotKnown | None = field(default=None, kw_only=True)

    def stored(self, piece: str, computation: Computation) -> PeriodicIntervalResult:
        """As in `Results`."""
        return PeriodicIntervalResult(**vars(super().stored(piece, computation)), multipliers=self.multipliers)


def multipliers_along(
    atlas: PeriodicAtlas,
    piece: Piece,
    interval: Interval,
    images: Sequence[Series],
    widths: Sequence[Fraction],
    omega: Sequence[arb],
) -> MultiplierFunctions | NotKnown | None:
    """The multipliers on a proved interval, or why they are not known; `None` if all are 1 for all such orbits.

    Args:
        images: the coordinates of P in (sigma, omega), of which the interval is |sigma| <= 16/17.
        widths: dp_j/domega_j.
        omega: bounds of |omega_j| on the curve.
    """
    try:
        matrix = _derivative(atlas, piece, interval, [Equation(image) for image in images], widths, omega)
        coefficients = _characteristic(matrix)
        if atlas.claim.uses_integral:
            coefficients = _without_one(coefficients)
        return MultiplierFunctions(tuple(_stored(each) for each in coefficients)) if coefficients else None
    except IntegrationFailure as failure:
        return NotKnown(failure.reason)


def _derivative(
    atlas: PeriodicAtlas,
    piece: Piece,
    interval: Interval,
    images: Sequence[Equation],
    widths: Sequence[Fraction],
    omega: Sequence[arb],
) -> list[list[BoundedFunction]]:
    """D, the derivative of P in the coordinates of the section, at the points of the curve; functions of sigma."""
    start, end = interval
    middle, radius = (start + end) / 2, (end - start) / 2 * BEYOND
    reach = hull(arb(0), *omega).abs_upper()
    turns = [ball_polynomial(recentred(row, middle, radius)).derivative() for row in piece.polynomial]
    along = 1 / enclose(piece.half_width * radius)
    rows = []
    for image in images:
        known, linear, higher = image.errors
        error = (linear + 2 * reach * higher).abs_upper()
        across = [
            BoundedFunction(image.linear(j), error).scaled(1 / enclose(width)) for j, width in enumerate(widths)
        ]  # fmt: skip
        moved = total(
            total(abs(c) for c in image.linear(j).derivative().coeffs()) * bound for j, bound in enumerate(omega)
        )
        unknown = (known + reach * linear + reach * reach * higher) / (1 - enclose(_INSIDE))
        first = BoundedFunction(image.polynomials[0].derivative(), (moved + unknown).abs_upper())
        for turn, slope in zip(turns, across, strict=True):
            first = first - slope * BoundedFunction(turn, arb(0))
        rows.append([first.scaled(along), *across])
    back = inverse(piece.frame)
    assert back is not None
    places = [place for place, name in enumerate(atlas.coordinates) if name != atlas.claim.parameter]
    return [
        [_sum([entry.scaled(enclose(back[j][place])) for j, entry in enumerate(row)]) for place in places]
        for row in rows
    ]


def _characteristic(matrix: Sequence[Sequence[BoundedFunction]]) -> list[BoundedFunction]:
    """The coefficients of det(lambda - D) after the first, from the principal minors."""
    size = len(matrix)
    if size > _MOST:
        message = f"multipliers are enclosed of returns in at most {_MOST} coordinates"
        raise IntegrationFailure("multipliers", message, "leave them out")
    found = []
    for order in range(1, size + 1):
        minors = [
            determinant([[matrix[i][k] for k in places] for i in places])
            for places in combinations(range(size), order)
        ]  # fmt: skip
        found.append(_sum(minors).scaled(arb((-1) ** order)))
    return found


def _without_one(coefficients: Sequence[BoundedFunction]) -> list[BoundedFunction]:
    """Coefficients of the quotient by lambda - 1, which is a factor."""
    found: list[BoundedFunction] = []
    for coefficient in coefficients[:-1]:
        found.append(coefficient + (found[-1] if found else BoundedFunction(arb_poly([1]), arb(0))))
    return found


def _sum(functions: Sequence[BoundedFunction]) -> BoundedFunction:
    result = functions[0]
    for each in functions[1:]:
        result = result + each
    return result


def _stored(function: BoundedFunction) -> StoredFunction:
    """The function in tau, as it is stored."""
    coefficients = function.polynomial(arb_poly([0, enclose(_SHARE)])).coeffs()
    if not all_finite([function.error, *coefficients]):
        raise IntegrationFailure("multipliers", "the derivative of the return was not enclosed", "a narrower piece")
    return StoredFunction.near(coefficients, function.error)


def unconfirmed_multipliers(stored: IntervalResult, fresh: IntervalResult) -> Iterator[str]:
    """What is stored of the multipliers and is not contained in what a new integration finds, in words."""
    old, new = stored.multipliers, fresh.multipliers
    if not isinstance(old, MultiplierFunctions):
        return
    # Functions of s are written in a variable that runs over the interval: on another one they are others.
    if fresh.interval != stored.interval or not isinstance(new, MultiplierFunctions):
        yield "multipliers are not enclosed again on this interval"
        return
    if len(old.coefficients) != len(new.coefficients):
        yield "another number of multipliers is stored"
        return
    with ctx.workprec(_BITS):
        pairs = zip(old.coefficients, new.coefficients, strict=True)
        for number, (before, after) in enumerate(pairs, start=1):
            if not before.enclosed.contains(after.enclosed.as_found):
                yield f"the stored bounds of coefficient {number} of the polynomial of multipliers are not confirmed"
