"""The half return over a piece of a symmetry-breaking surface, and its derivatives for ranges of the mass.

A piece is a symmetry-breaking claim whose parameters and centre are polynomials in s (section 17).
One integration, with s as the wide variable, encloses pi_q P for all s of an interval; evaluated on a part of it this
gives tables of derivatives that are valid for every s there, and the hypotheses of section 8 and 9 apply to them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor, log2, prod

from flint import arb, arb_poly

from orbitproof.shared.formats import SurfacePiece
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Grading, Series, WideArithmetic, plus, recentred, values_around
from orbitproof.verify.curve import Interval
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, enclose, guarded
from orbitproof.verify.poincare import HalfOrbits, WideOracle, first_integral, kernel_components, table_of

_RATIO = Fraction(1, 2)
"""The box is this fraction of the polydisc on which the orbits are enclosed: large boxes ask for a large one."""


@dataclass(frozen=True)
class SurfaceLimits:
    """How to integrate a piece.

    Attributes:
        precision: fractional bits of the fixed-point format.
        order: degree of the time expansions.
        width: degree in s.
        top: the largest grade that is kept; p_1 has weight 1, the others weight 2.
    """

    precision: int = 80
    order: int = 28
    width: int = 20
    top: int = 5

    def __post_init__(self) -> None:
        if min(self.precision, self.order) < 16 or self.width < 1 or self.top < 3:
            raise ValueError(
                f"precision {self.precision}, order {self.order}, width {self.width} or top {self.top} is too small"
            )


@dataclass(frozen=True)
class SurfaceReturn:
    """The half return of all orbits of a piece with s in an interval.

    Attributes:
        kernel: the coordinates q_1, .., q_n of P; elements in t in [-1, 1], s = middle + half t.
        level: the first integral at the start.
        time: of the half return, over the piece.
        scales: p_i = scales_i xi_i.
        interval: of s.
        steps: of the integration.
        coordinates: in which the orbits were followed.
    """

    kernel: tuple[Series, ...]
    level: Series
    time: arb
    scales: tuple[Fraction, ...]
    interval: Interval
    steps: int
    coordinates: str

    def tables(self, part: Interval) -> tuple[tuple[DerivativeTable, ...], DerivativeTable]:
        """Tables of pi_q P and of the first integral that hold for every s in `part`, a part of the interval."""
        low, high = self.interval
        middle, half = (low + high) / 2, (high - low) / 2
        centre, reach = enclose(((part[0] + part[1]) / 2 - middle) / half), enclose((part[1] - part[0]) / 2 / half)

        def table(element: Series) -> DerivativeTable:
            arithmetic = element.arithmetic
            values = [
                values_around(arb_poly([arb(c) * arb(2) ** -scale for c in polynomial.coeffs()]), centre, reach)
                for polynomial, scale in zip(element.coefs, arithmetic.scales, strict=True)
            ]
            return table_of(arithmetic.grading, values, element.errors, self.scales, _RATIO)

        return tuple(table(element) for element in self.kernel), table(self.level)


def enclose_surface(
    system: ReversibleSystem,
    piece: SurfacePiece,
    interval: Interval,
    limits: SurfaceLimits,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> SurfaceReturn:
    """Follow the orbits of the piece, s in `interval`, to the first return; raises `IntegrationFailure`.

    `progress` is called after every step with the number of steps; what it raises passes through.
    """
    with guarded(limits.precision):
        return _enclose(system, piece, interval, limits, oracle, progress)


def _enclose(
    system: ReversibleSystem,
    piece: SurfacePiece,
    interval: Interval,
    limits: SurfaceLimits,
    oracle: WideOracle,
    progress: Callable[[float], None] | None,
) -> SurfaceReturn:
    if system.first_integral is None or system.normalised or system.derived_parameters:
        raise IntegrationFailure(
            "system", f"{system.name} has no first integral, or units of its own", "choose another system"
        )
    size = len(piece.radii)
    weights = tuple(1 if j == 1 else 2 for j in range(size))
    scales = tuple(radius / _RATIO for radius in piece.radii)
    # With these bits per grade scaled initial values of every weight are of size 1 in fixed point.
    further = max(0, floor(max(-log2(scale) / weight for scale, weight in zip(scales, weights, strict=True))))
    grading = Grading(weights, limits.top)
    arithmetic = WideArithmetic(grading, limits.precision, further, limits.order, width=limits.width)
    constant = (0,) * size
    middle, half = (interval[0] + interval[1]) / 2, (interval[1] - interval[0]) / 2
    point = {}
    for name, curve, row in zip(system.centre_coordinates, piece.centre, piece.frame, strict=True):
        terms: dict[tuple[int, ...], Fraction | Sequence[Fraction]] = {constant: recentred(curve, middle, half)}
        for exponents, added in coordinate_terms(piece, row).items():
            scale = prod((unit**power for unit, power in zip(scales, exponents, strict=True)), start=Fraction(1))
            terms[exponents] = [value * scale for value in recentred(added, middle, half)]
        point[name] = arithmetic.polynomial(terms)
    for name in system.parameters:
        point[name] = arithmetic.polynomial({constant: recentred(piece.parameters[name], middle, half)})
    level = first_integral(system, arithmetic, point)
    assert level is not None
    returns = HalfOrbits(system, arithmetic, point, oracle, level=level)
    state, time = returns.next_crossing(progress)
    kernel = tuple(kernel_components(system, piece.kernel_frame, state))
    return SurfaceReturn(kernel, level, time, scales, interval, returns.steps, returns.coordinates.name)


def coordinate_terms(piece: SurfacePiece, row: Sequence[Fraction]) -> dict[tuple[int, ...], tuple[Fraction, ...]]:
    """What the coordinates p add to a coordinate of Fix(R), by exponents of p, as polynomials in s.

    Args:
        row: of the piece's frame, the one of that coordinate.
    """
    size = len(row)
    unit = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    square = (0, 2, *(0,) * (size - 2))
    terms: dict[tuple[int, ...], tuple[Fraction, ...]] = {unit[j]: (value,) for j, value in enumerate(row)}
    across = range(2, size)
    for j, polynomial in zip(across, piece.tilt, strict=bool(piece.tilt)):
        terms[unit[0]] = plus(terms[unit[0]], polynomial, row[j])
    for j, polynomial in zip((0, *across), piece.bend, strict=bool(piece.bend)):
        terms[square] = plus(terms.get(square, ()), polynomial, row[j])
    return terms
