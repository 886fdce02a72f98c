"""The returns of the box of a claim to its section, enclosed (section 24.2)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, enclose, guarded
from orbitproof.verify.maps import Format, FramingOracle, Image, StartingSet, enclose_poincare_map
from orbitproof.verify.periodic.box import SectionCoordinates, functions_at_start, section_coordinates, section_of
from orbitproof.verify.periodic.enclosures import Linearised, PeriodicEnclosures, SectionReturn, stops_of
from orbitproof.verify.poincare import IntegratorSettings, default_order

_DEGREE = 1
"""Degree of the polynomials in p: first derivatives over a narrow box are all that is asked for."""


def enclose_periodic(
    claim: PeriodicOrbit,
    settings: IntegratorSettings,
    oracle: FramingOracle,
    progress: Callable[[float], None] | None = None,
) -> PeriodicEnclosures:
    """Enclose the return map of a claim, and those of fewer crossings that tell whether its period is the least.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    coordinates = section_coordinates(claim)
    if coordinates is None:
        raise IntegrationFailure("section", "the frame does not span the section", "give another frame")
    order = default_order(settings.precision) if settings.order is None else settings.order
    stops, found = stops_of(claim.crossings), []
    done = steps = 0
    for stop in stops:
        image = _image(claim, stop, Format(settings.precision, _DEGREE, order), oracle, progress, done / sum(stops))
        done, steps = done + stop, steps + image.steps
        with guarded(settings.precision):
            found.append(_return(claim, coordinates, stop, image))
    return PeriodicEnclosures(tuple(found), order, settings.precision, steps)


def _image(
    claim: PeriodicOrbit,
    crossings: int,
    chosen: Format,
    oracle: FramingOracle,
    progress: Callable[[float], None] | None,
    before: float,
) -> Image:
    def stepped(steps: int) -> None:
        if progress is not None:
            # How many steps there will be is not known: the fraction only grows.
            progress(before + (1 - before) * steps / (steps + 50 * crossings))

    zero = (Fraction(0),) * len(claim.radii)
    system, frame = claim.system, (*claim.frame, *(zero for _ in claim.values))
    start = StartingSet(
        len(claim.centre), (*claim.centre, *claim.values), frame, claim.radii, functions_at_start(system)
    )
    section = section_of(system, claim.normal, claim.offset)
    program = claim.system.program
    return enclose_poincare_map(program, start, section, claim.direction, crossings, chosen, oracle, stepped)


def _return(claim: PeriodicOrbit, coordinates: SectionCoordinates, crossings: int, image: Image) -> SectionReturn:
    """The image in the coordinates p, which are affine functions of the state."""
    size = len(claim.radii)
    zero = (0,) * size
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    state = image.state[: len(claim.centre)]
    centre = coordinates.of(
        [table.centre[zero] - enclose(origin) for table, origin in zip(state, claim.centre, strict=True)]
    )
    columns = [coordinates.of([table.box[unit] for table in state]) for unit in units]
    functions = tuple(
        Linearised(value, tuple(column[i] for column in columns)) for i, value in enumerate(centre)
    )  # fmt: skip
    return SectionReturn(crossings, functions, _linearised(image.time, size))


def _linearised(table: DerivativeTable, size: int) -> Linearised:
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    return Linearised(table.centre[(0,) * size], tuple(table.box[unit] for unit in units))
