"""Poincare maps of affine sections on a set, with derivatives and crossings counted (section 23.3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from orbitproof.shared.systems import Program
from orbitproof.verify.algebra import Series
from orbitproof.verify.evidence import IntegrationFailure, exact_value, guarded
from orbitproof.verify.maps.affine_section import AffineSection
from orbitproof.verify.maps.framed_orbits import FramedOrbits, FramingOracle
from orbitproof.verify.maps.image import Image, image_of
from orbitproof.verify.maps.starting_set import Format, StartingSet
from orbitproof.verify.poincare import InTime


def enclose_poincare_map(
    program: Program,
    start: StartingSet,
    section: AffineSection,
    direction: int,
    crossings: int,
    chosen: Format,
    oracle: FramingOracle,
    progress: Callable[[int], None] | None = None,
) -> Image:
    """Enclose crossing number `crossings` of a section by all orbits that begin in a set, its time and derivatives.

    The first crossings are those after the start, which does not count where the set lies on the section.

    Args:
        program: the vector field; inputs: state, then parameters.
        direction: 1 for crossings at which normal . x increases, -1 where it decreases, 0 for both.
        oracle: finds approximations; nothing is believed of it.
        progress: called after every step with the number of steps; what it raises passes through.

    Raises `IntegrationFailure`, also if an orbit of the set may touch the section or does not reach it.
    """
    with guarded(chosen.precision):
        orbits = _orbits(program, start, section, chosen, oracle)
        counter = orbits.counters[0]
        number = None
        while number is None or orbits.may_step(number, crossings):
            try:
                arrived = orbits.step()
                if number is None:
                    # Each crossing within the first step has changed the side.
                    number = number_of(crossings, direction, counter.side * (-1) ** counter.crossings)
                if arrived and counter.arrival(number) is not None:
                    image = _crossing(orbits, number)
                    break
            except IntegrationFailure as failure:
                raise failure.at(float(orbits.time)) from None
            if counter.crossings >= number:
                raise IntegrationFailure(
                    "crossing count",
                    f"the orbits of the set are beyond crossing {number}, and no step ended there for all of them",
                    "give smaller radii, or more precision",
                    needs_precision=True,
                ).at(float(orbits.time))
            if progress is not None:
                progress(orbits.steps)
        else:
            raise IntegrationFailure(
                "steps",
                f"crossing number {number} of the section was not reached within {orbits.steps} steps",
                "the orbits may not come back to the section: give another section or direction, or fewer crossings",
            ).at(float(orbits.time))
        # On the section its coordinate is 0 exactly.
        on_section = list(image)
        on_section[section.pivot] = orbits.arithmetic.constant(Fraction(0))
        return image_of(start, section.own_state(on_section), time_at_crossing(orbits), orbits.steps)


def _crossing(orbits: FramedOrbits, number: int) -> Sequence[Series]:
    try:
        return orbits.crossing(number)[0]
    except IntegrationFailure as failure:
        if failure.reason.condition not in ("singularity", "tube"):
            raise
        raise IntegrationFailure(
            "section",
            f"at crossing {number} the velocity across the section is not shown to be different from 0 on the set",
            "the orbits may touch the section, or cross it at times that differ too much: give smaller radii",
            needs_precision=True,
        ) from None


def time_at_crossing(orbits: FramedOrbits) -> Series:
    """The time at the crossing that was found last."""
    middle, radius = exact_value(orbits.time.mid()), exact_value(orbits.time.rad())
    return orbits.arithmetic.constant(middle).widened(radius) + orbits.delay


def number_of(crossings: int, direction: int, side: int) -> int:
    """Which crossing, in either direction, is the one with the number `crossings` in a direction.

    Args:
        side: the sign of the section coordinate after the start.
    """
    if direction == 0:
        return crossings
    return 2 * crossings - (1 if side == -direction else 0)


def _orbits(
    program: Program, start: StartingSet, section: AffineSection, chosen: Format, oracle: FramingOracle
) -> FramedOrbits:
    arithmetic = start.arithmetic(chosen)
    coordinates = section.coordinates(program)
    state, parameters = start.elements(arithmetic)
    distance = section.section_coordinate(start, arithmetic)
    side = 0
    if not section.holds(start):
        side = InTime(distance).at_start()
        if side == 0:
            raise IntegrationFailure(
                "start",
                "some points of the set may be on the section and others are not",
                "give a frame whose columns lie in the section and a centre on it, or a set away from it",
            )
    state[section.pivot] = distance
    return FramedOrbits(coordinates, arithmetic, state, parameters, oracle, side)
