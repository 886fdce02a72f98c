"""Planar orbits about L1 or L2 over a rectangle of masses and sizes (section 17.5).

The size eps of the orbits is the wide variable, the distance b of the libration point from the smaller mass a variable
of weight 1, and so is the speed across the tube. Interval Newton shows that for every b and eps of the piece the tube
contains exactly one symmetric orbit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from math import floor, log2

from flint import arb, arb_poly

from orbitproof.shared.formats import LibrationPiece
from orbitproof.shared.systems import OVER_MASSES
from orbitproof.verify.algebra import Grading, Series, WideArithmetic, recentred, values_around
from orbitproof.verify.curve import PROVED, Account, Computation, Interval, IntervalResult, PieceResult, attempt
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    Reason,
    dyadic_above,
    enclose,
    excludes_zero,
    guarded,
    is_inside,
    power,
)
from orbitproof.verify.poincare import PHYSICAL, HalfOrbits, WideOracle
from orbitproof.verify.surface.half_return import SurfaceLimits

BOX = Fraction(7, 8)
"""The piece and its tube are this part of the polydisc on which the orbits are enclosed."""

GRADES, LINEAR = 6, 2
"""The orbits are followed with so many powers of b, their derivatives across the tube with so many."""

_PARTS, _HALVINGS = 4, 8
"""Parts of the intervals of eps and of b to begin with, and how often a part is halved at most."""

_REMEDY = "give a narrower piece or another tube"


@dataclass(frozen=True)
class SizesTheorem:
    """For every b of the piece and every eps of the interval the tube contains exactly one point of an R-symmetric
    orbit with P^2(x) = x; it is a regular zero of pi_q P and depends smoothly on both (section 17.5).
    """

    hypotheses = ("piece", "half-return", "newton")


@dataclass(frozen=True)
class ProvedSizes:
    """For each b of a piece and s in [start, end] the tube has one symmetric orbit.

    Attributes:
        start, end: within [-1, 1].
        deviation: bound of the distance of its vy from the piece's polynomial.
        time: half periods.
    """

    start: Fraction
    end: Fraction
    deviation: Fraction
    time: arb

    def stored(self, piece: str, computation: Computation) -> IntervalResult:
        """As in `curve.piece_result.Results`."""
        interval = self.start, self.end
        return IntervalResult(piece, interval, PROVED, computation, deviation=(self.deviation,), time=self.time)


def read_sizes(piece: LibrationPiece, result: IntervalResult) -> ProvedSizes | str:
    """What a stored result proves of a piece, or why it does not count."""
    (start, end), time = result.interval, result.time
    if len(result.deviation) != 1:
        return f"a result of {piece.id} has not one bound of the deviation"
    if not -1 <= start < end <= 1:
        return f"a result of {piece.id} is not within [-1, 1]"
    if not 0 <= result.deviation[0] < piece.tube:
        return f"a result of {piece.id} has a deviation that is not below the tube"
    if time is None or not time.is_finite():
        return f"a result of {piece.id} has no half periods"
    return ProvedSizes(start, end, result.deviation[0], time)


def prove_libration_piece(
    piece: LibrationPiece,
    interval: Interval,
    oracle: WideOracle,
    limits: SurfaceLimits | None = None,
    progress: Callable[[float], None] | None = None,
) -> PieceResult[ProvedSizes]:
    """Prove the claim of a piece for all s in an interval within [-1, 1], or say why it is not proved.

    `progress` is called after every integration step with the number of steps; what it raises passes through.
    """
    limits = SurfaceLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 0, "coordinates": ""}

    def check(checklist: Checklist) -> ProvedSizes:
        with checklist.hypothesis(
            "piece", "17.5", "the interval is one of the piece, its distances are those of a point", "correct the piece"
        ) as evidence:
            start, end = interval
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            evidence.require(piece.tube > 0 and piece.distance[1] > 0 and piece.size[1] > 0, "a width is not positive")
            admissible = OVER_MASSES[piece.point].parameters["b"]
            ends = (piece.distance[0] + sign * piece.distance[1] for sign in (-1, 1))
            evidence.require(all(map(admissible.contains, ends)), f"b leaves {admissible}")
            evidence.require(len(piece.polynomial) <= GRADES + 1, f"there are more than {GRADES + 1} powers of b")
        with checklist.hypothesis(
            "half-return", "17.5", "the orbits of the piece meet the section again and are enclosed", _REMEDY
        ) as evidence:
            element, time, steps = _half_return(piece, interval, limits, oracle, progress)
            computation.update(steps=steps, coordinates=PHYSICAL)
            evidence.record("half period", time)
            evidence.require(time.is_finite(), "the half periods are not enclosed")
        with checklist.hypothesis(
            "newton", "17.5", "on parts that cover the piece the Newton operator maps the tube into itself", _REMEDY
        ) as evidence:
            largest = arb(0)
            for image in _Newton(element).images():
                largest = largest.max(image.abs_upper())
            deviation = dyadic_above(enclose(piece.tube / BOX) * largest)
            evidence.require(deviation < piece.tube, "it does not")
        return ProvedSizes(start, end, deviation, time)

    with guarded(limits.precision):
        return attempt(piece.id, interval, SizesTheorem(), computation, check)


def _half_return(
    piece: LibrationPiece,
    interval: Interval,
    limits: SurfaceLimits,
    oracle: WideOracle,
    progress: Callable[[float], None] | None,
) -> tuple[Series, arb, int]:
    """q at the first return as an element in (sigma, b, vy), the half periods, and the number of steps."""
    system = OVER_MASSES[piece.point]
    (start, end), widths = interval, (piece.distance[1] / BOX, piece.tube / BOX)
    bits = max(0, floor(-log2(max(widths))))
    arithmetic = WideArithmetic(
        Grading((1, GRADES - LINEAR), GRADES), limits.precision, bits, limits.order, width=limits.width
    )
    middle, half = (start + end) / 2, (end - start) / 2
    speed: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {
        (power, 0): [value / BOX**power for value in recentred(row, middle, half)]
        for power, row in enumerate(piece.polynomial)
    }
    speed[0, 1] = widths[1]
    point = {
        "b": arithmetic.polynomial({(0, 0): piece.distance[0], (1, 0): widths[0]}),
        "eps": arithmetic.polynomial({(0, 0): recentred(piece.size, middle, half)}),
        "vy": arithmetic.polynomial(speed),
    }
    returns = HalfOrbits(system, arithmetic, point, oracle, PHYSICAL)
    state, time = returns.next_crossing(progress)
    (kernel,) = system.kernel_coordinates
    return state[kernel], time, returns.steps


class _Newton:
    """The Newton operator in vy for F(sigma, xi_1, xi_2) = known part + unknown parts, |xi_i| <= BOX."""

    def __init__(self, element: Series) -> None:
        arithmetic = element.arithmetic
        self.known = [
            (exponents, arb_poly([arb(c) * arb(2) ** -scale for c in packed.coeffs()]))
            for exponents, packed, scale in zip(
                arithmetic.grading.monomials, element.coefs, arithmetic.scales, strict=True
            )
        ]
        box, weight = enclose(BOX), arithmetic.grading.weights[1]
        errors = [arb(e) for e in element.errors]
        # At xi_2 = 0 the grade is the degree in xi_1; for the derivatives in xi_2, j BOX^(j-1) <= 4 for all j.
        self.spread = sum((e * box**n for n, e in enumerate(errors)), arb(0))
        self.slope_spread = errors[weight] + 4 * sum(errors[weight + 1 :], arb(0))

    def images(self) -> Iterator[arb]:
        """Newton images on parts that cover [-1, 1] x [-BOX, BOX]; raises `NotEstablishedError` if one is outside."""
        edges = [Fraction(2 * k, _PARTS) - 1 for k in range(_PARTS)]
        pending = [
            ((a, a + Fraction(2, _PARTS)), (c * BOX, (c + Fraction(2, _PARTS)) * BOX), 0) for a in edges for c in edges
        ]
        while pending:
            sigma, across, halvings = pending.pop()
            image = self.image(sigma, across)
            if image is not None and is_inside(image, BOX):
                yield image
            elif halvings == _HALVINGS:
                where = f"at sigma = {float(sigma[0]):.4g}, beta = {float(across[0] / BOX):.4g}"
                message = "the derivative across the tube may vanish" if image is None else "the image leaves the tube"
                raise NotEstablishedError(Reason("newton", f"{where} {message}", _REMEDY))
            elif halvings % 2:
                pending += [(sigma, half, halvings + 1) for half in _halves(across)]
            else:
                pending += [(half, across, halvings + 1) for half in _halves(sigma)]

    def image(self, sigma: Interval, across: Interval) -> arb | None:
        """-F/F' on a part; `None` if the derivative may vanish."""
        centre, reach = (enclose((sigma[0] + sigma[1]) / 2), enclose((sigma[1] - sigma[0]) / 2))
        beta = enclose((across[0] + across[1]) / 2) + arb(0, 1) * enclose((across[1] - across[0]) / 2)
        speed, unit = arb(0, 1) * enclose(BOX), arb(0, 1)
        value, slope = unit * self.spread, unit * self.slope_spread
        for (i, j), polynomial in self.known:
            term = values_around(polynomial, centre, reach) * power(beta, Fraction(i))
            if j == 0:
                value += term
            else:
                slope += j * term * power(speed, Fraction(j - 1))
        if not (value.is_finite() and slope.is_finite() and excludes_zero(slope)):
            return None
        return -value / slope


def _halves(interval: Interval) -> tuple[Interval, Interval]:
    middle = (interval[0] + interval[1]) / 2
    return (interval[0], middle), (middle, interval[1])
