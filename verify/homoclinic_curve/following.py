"""The returns to the boxes of a claim, and the ways from slivers of them to Fix(R), on all levels (section 42.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.shared.claims.homoclinic_curve import HomoclinicCurve
from orbitproof.shared.stored import stored
from orbitproof.shared.systems import record
from orbitproof.verify.algebra import Series, WideArithmetic, at_start
from orbitproof.verify.claim import level_program, quadratic_coefficient
from orbitproof.verify.evidence import IntegrationFailure, guarded
from orbitproof.verify.homoclinic import Way, reversible
from orbitproof.verify.maps import Format, FramedOrbits, FramingOracle, StartingSet
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import (
    BOX_RATIO,
    WIDE_PARTS,
    IntegratorSettings,
    WideOracle,
    WideOrbits,
    default_order,
    physical,
    table_of,
    wide_parts,
)

_OF_RETURN, _OF_ARRIVAL = 3, 2
"""Degrees of the polynomials in (a, s), as on one level."""
_POWERS = 2
"""So many times as many powers of t are followed as the claim's polynomials have."""
_OWN = record(
    lambda x: [Fraction(1, 2) * (x[0] - x[2] + side * (x[1] / x[3])) for side in (1, -1)], ("p", "q", "c", "slope")
)
"""a and s."""

Polynomial = Sequence[Fraction]
"""Coefficients of 1, t, t^2, .."""


class FramingWideOracle(WideOracle, FramingOracle, Protocol):
    """What may be asked about the orbits of a box on all levels."""


class _Orbits(FramedOrbits, WideOrbits):
    """As `WideOrbits`, the errors in a frame that the steps hand on (section 4.4)."""


@dataclass(frozen=True)
class HomoclinicCurveEnclosures:
    """What one proof is evaluated from, for each part of the interval of t.

    Attributes:
        returned: where the boxes come back.
        arrived: where the slivers arrive, their variables counted from their middles.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    returned: tuple[Way, ...]
    arrived: tuple[Way, ...]
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


def width_of_slivers(claim: HomoclinicCurve) -> Fraction:
    """|s| <= 2 cone (|a| + its half-width), for the greatest |a| of all middles."""
    return 2 * claim.cone * (sum(map(abs, claim.polynomials[1])) + claim.radii[1])


def enclose_homoclinic_curve(
    claim: HomoclinicCurve,
    settings: IntegratorSettings,
    oracle: FramingWideOracle,
    progress: Callable[[float], None] | None = None,
) -> HomoclinicCurveEnclosures:
    """Follow the boxes through one return, and the slivers to their arrival, for all t at once.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    if not quadratic_coefficient(reversible(claim.middle)):
        raise IntegrationFailure("level", f"no coordinate of {claim.system.name} follows from it", "give another one")
    order = default_order(settings.precision) if settings.order is None else settings.order
    whole = claim.crossings + claim.arrival

    def report(before: int) -> Callable[[int], None]:
        return lambda crossings: None if progress is None else progress((before + crossings) / whole)

    radius, half_width = claim.radii
    box = _Set(claim, (Fraction(0),), (radius, radius), Format(settings.precision, _OF_RETURN, order))
    sliver = _Set(
        claim,
        claim.polynomials[1],
        (half_width, width_of_slivers(claim)),
        Format(settings.precision, _OF_ARRIVAL, order),
    )
    with guarded(settings.precision):
        returned, first = box.follow(claim.crossings, oracle, True, report(0))
        arrived, second = sliver.follow(claim.arrival, oracle, False, report(claim.crossings))
    return HomoclinicCurveEnclosures(returned, arrived, order, settings.precision, first + second)


class _Set:
    """The points (a(t) + p_0, p_1) with abs(p_j) <= radii_j, for all t, as elements of the algebra."""

    def __init__(self, claim: HomoclinicCurve, a: Polynomial, radii: tuple[Fraction, Fraction], chosen: Format) -> None:
        self.claim, self.start = claim, StartingSet(0, (), (), radii)
        flat = self.start.arithmetic(chosen)
        width = _POWERS * max(2, *map(len, claim.polynomials))
        self.arithmetic = WideArithmetic(
            flat.grading, flat.bits, flat.grade_bits, flat.degree, flat.grade_loss, width=width
        )
        c, _, slope = claim.polynomials
        by_a, by_s = self.start.scales
        one = self.arithmetic.polynomial
        self.p = one({(0, 0): _sum(c, a), (1, 0): by_a, (0, 1): by_s})
        self.q = one({(0, 0): _product(slope, a), (1, 0): _product(slope, [by_a]), (0, 1): _product(slope, [-by_s])})

    def follow(
        self, crossings: int, oracle: FramingWideOracle, is_return: bool, report: Callable[[int], None]
    ) -> tuple[tuple[Way, ...], int]:
        """The crossing of that number, for t in each part of its interval, and the number of steps."""
        claim, arithmetic = self.claim, self.arithmetic
        system, names = reversible(claim.middle), claim.system.state
        assert claim.level is not None
        along, across, place = map(names.index, (claim.middle.along, claim.middle.across, claim.level_coordinate))
        state = [arithmetic.constant(Fraction(0)) for _ in names]
        state[along], state[across] = self.p, self.q
        parameters = [arithmetic.constant(value) for value in claim.values]
        level = arithmetic.polynomial({(0, 0): (claim.level, claim.level_radius)})
        (state[place],) = at_start(level_program(system, claim.level_sign), (*state, *parameters, level))
        orbits = _Orbits(physical(system), arithmetic, state, parameters, oracle, 0, crossings)
        _reach(orbits, crossings, report)
        image, _ = orbits.crossing(crossings)
        p, q = image[along], image[across]
        first, second = self._own(p, q) if is_return else [p, q]
        found = (self._on_parts(each) for each in (first, second, image[place], orbits.return_time))
        return tuple(Way(*functions) for functions in zip(*found, strict=True)), orbits.steps

    def _own(self, p: Series, q: Series) -> list[Series]:
        """(a, s) of points (p, q) of the section."""
        c, _, slope = (self.arithmetic.polynomial({(0, 0): row}) for row in self.claim.polynomials)
        return at_start(_OWN, [p, q, c, slope])

    def _on_parts(self, element: Series) -> Iterator[Linearised]:
        """A function of (a, s), for t in each of the parts."""
        arithmetic = self.arithmetic
        for part in wide_parts(WIDE_PARTS):
            coefficients = []
            for polynomial, scale in zip(element.coefs, arithmetic.scales, strict=True):
                rows = arithmetic.balls_in_time(polynomial, part)
                if len(rows) > 1:
                    raise ValueError("the element is no function on the box")
                coefficients.append(rows[0] * arb(2) ** (arithmetic.bits - scale) if rows else arb(0))
            table = table_of(arithmetic.grading, coefficients, element.errors, self.start.scales, BOX_RATIO)
            yield Linearised(table.centre[(0, 0)], (table.box[(1, 0)], table.box[(0, 1)]))


def _reach(orbits: _Orbits, number: int, report: Callable[[int], None]) -> None:
    """Follow the orbits until crossing `number` can be told on each part of the interval of t."""
    while orbits.may_step(number, number):
        try:
            arrived = orbits.step()
        except IntegrationFailure as failure:
            raise failure.at(float(orbits.time)) from None
        report(min(counter.crossings for counter in orbits.counters))
        if arrived and all(counter.arrival(number) is not None for counter in orbits.counters):
            return
        if any(counter.crossings > number for counter in orbits.counters):
            what = f"orbits of some levels are beyond crossing {number}, and no step ended there for all of them"
            raise IntegrationFailure("crossing count", what, "give a shorter interval of levels")
    what = f"crossing {number} of the section was not reached in {orbits.steps} steps"
    raise IntegrationFailure("steps", what, "claim fewer crossings")


def _sum(left: Polynomial, right: Polynomial) -> list[Fraction]:
    length = max(len(left), len(right))
    rows = ([*row, *[Fraction(0)] * (length - len(row))] for row in (left, right))
    return [a + b for a, b in zip(*rows, strict=True)]


def _product(left: Polynomial, right: Polynomial) -> list[Fraction]:
    result = [Fraction(0)] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[i + j] += a * b
    return result
