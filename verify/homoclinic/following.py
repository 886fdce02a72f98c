"""The return to the box of a claim, and the way from a sliver of it to Fix(R), on the level (section 40.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.shared.stored import stored
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Series, at_start
from orbitproof.verify.claim import level_program, quadratic_coefficient
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, guarded
from orbitproof.verify.maps import Format, FramedOrbits, FramingOracle, StartingSet, time_at_crossing
from orbitproof.verify.periodic import Linearised
from orbitproof.verify.poincare import BOX_RATIO, IntegratorSettings, default_order, derivative_table, physical

_OF_RETURN, _OF_ARRIVAL = 3, 2
"""Degrees of the polynomials in (a, s): the cone wants derivatives that are known well over all of the box."""


@dataclass(frozen=True)
class Way:
    """Where the orbits of a box cross the section after a number of crossings, as functions of (a, s) on the box.

    Attributes:
        first, second: coordinates of the crossing: (a, s) of a return, (p, q) of an arrival.
        w: the level coordinate.
        time: when it happens.
    """

    first: Linearised
    second: Linearised
    w: Linearised
    time: Linearised

    @property
    def functions(self) -> tuple[Linearised, ...]:
        """All of them."""
        return self.first, self.second, self.w, self.time


@dataclass(frozen=True)
class HomoclinicEnclosures:
    """What one proof is evaluated from.

    Attributes:
        returned: where the box comes back.
        arrived: where the sliver arrives, its variables counted from its middle.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    returned: Way
    arrived: Way
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


def reversible(claim: HomoclinicOrbit) -> ReversibleSystem:
    """The system with the reversing symmetry, the section and the level coordinate of the claim."""
    system = claim.system
    return ReversibleSystem(
        name=system.name,
        title=system.title,
        state=system.state,
        parameters=system.parameters,
        vector_field=system.vector_field,
        reversing_symmetry=claim.reversing_symmetry,
        section=claim.section,
        level_coordinate=claim.level_coordinate,
        first_integral=system.first_integral,
        first_integral_name=system.first_integral_name,
    )


def width_of_sliver(claim: HomoclinicOrbit) -> Fraction:
    """|s| <= 2 cone (|a| + its half-width): twice as wide as the cone is where the homoclinic orbit begins."""
    return 2 * claim.cone * (abs(claim.centre[1]) + claim.radii[1])


def enclose_homoclinic(
    claim: HomoclinicOrbit,
    settings: IntegratorSettings,
    oracle: FramingOracle,
    progress: Callable[[float], None] | None = None,
) -> HomoclinicEnclosures:
    """Follow the box through one return, and the sliver to its arrival.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    order = default_order(settings.precision) if settings.order is None else settings.order
    whole = claim.crossings + claim.arrival
    radius, half_width = claim.radii

    def chosen(degree: int) -> Format:
        return Format(settings.precision, degree, order)

    def report(before: int) -> Callable[[int], None]:
        return lambda crossings: None if progress is None else progress((before + crossings) / whole)

    returned, first = _follow(
        claim, Fraction(0), (radius, radius), claim.crossings, chosen(_OF_RETURN), oracle, True, report(0)
    )
    arrived, second = _follow(
        claim,
        claim.centre[1],
        (half_width, width_of_sliver(claim)),
        claim.arrival,
        chosen(_OF_ARRIVAL),
        oracle,
        False,
        report(claim.crossings),
    )
    return HomoclinicEnclosures(returned, arrived, order, settings.precision, first + second)


def _follow(
    claim: HomoclinicOrbit,
    a: Fraction,
    radii: tuple[Fraction, Fraction],
    crossings: int,
    chosen: Format,
    oracle: FramingOracle,
    is_return: bool,
    report: Callable[[int], None],
) -> tuple[Way, int]:
    """The crossing of that number of the points (a + p_0, p_1) with abs(p_j) <= radii_j, and the number of steps."""
    system, names = reversible(claim), claim.system.state
    assert claim.level is not None
    if not quadratic_coefficient(system):
        raise IntegrationFailure("level", f"no coordinate of {system.name} follows from the level", "give another one")
    c, slope = claim.centre[0], claim.slope
    none = (Fraction(0), Fraction(0))
    centre = {claim.along: c + a, claim.across: slope * a}
    frame = {claim.along: (Fraction(1), Fraction(1)), claim.across: (slope, -slope)}
    values = claim.values
    start = StartingSet(
        len(names),
        (*(centre.get(name, Fraction(0)) for name in names), *values),
        (*(frame.get(name, none) for name in names), *(none for _ in values)),
        radii,
    )
    with guarded(chosen.precision):
        arithmetic = start.arithmetic(chosen)
        state, parameters = start.elements(arithmetic)
        place = names.index(claim.level_coordinate)
        level = arithmetic.constant(claim.level)
        (state[place],) = at_start(level_program(system, claim.level_sign), (*state, *parameters, level))
        orbits = FramedOrbits(physical(system), arithmetic, state, parameters, oracle)
        for number in range(crossings):
            image, _ = orbits.next_crossing(lambda _steps, number=number: report(number))  # type: ignore[misc]
        p, q = (image[names.index(name)] for name in (claim.along, claim.across))
        first, second = _own(arithmetic, p, q, c, slope) if is_return else (p, q)
        found = (first, second, image[place], time_at_crossing(orbits))
        tables = [derivative_table(element, start.scales, BOX_RATIO) for element in found]
        return Way(*map(_linearised, tables)), orbits.steps


def _own(arithmetic: Arithmetic, p: Series, q: Series, c: Fraction, slope: Fraction) -> tuple[Series, Series]:
    """(a, s) of points (p, q) of the section."""
    half = Fraction(1, 2)
    along, across = (p - arithmetic.constant(c)).scaled(half), q.scaled(half / slope)
    return along + across, along - across


def _linearised(table: DerivativeTable) -> Linearised:
    return Linearised(table.centre[(0, 0)], (table.box[(1, 0)], table.box[(0, 1)]))


def balls_of(ways: Sequence[Way]) -> list[arb]:
    """All that is enclosed."""
    return [ball for way in ways for function in way.functions for ball in function.balls]
