"""The returns of the box of a claim to its section with derivatives to order 3, enclosed (section 25.2)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, dot, enclose, guarded
from orbitproof.verify.maps import Format, FramingOracle, Image, StartingSet, enclose_poincare_map
from orbitproof.verify.periodic import (
    Linearised,
    SectionCoordinates,
    SectionReturn,
    functions_at_start,
    section_coordinates,
    section_of,
    stops_of,
)
from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures
from orbitproof.verify.poincare import BOX_RATIO, IntegratorSettings, at_start, default_order, derivative_table

_DEGREE = 3
"""Degree of the polynomials in p and s: third derivatives are asked for."""


def enclose_periodic_bifurcation(
    claim: PeriodicBifurcation,
    settings: IntegratorSettings,
    oracle: FramingOracle,
    progress: Callable[[float], None] | None = None,
) -> BifurcationEnclosures:
    """Enclose the return map of a claim over its box and its interval, and those of fewer crossings at first order.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    coordinates = section_coordinates(claim)
    if coordinates is None:
        raise IntegrationFailure("section", "the frame does not span the section", "give another frame")
    order = default_order(settings.precision) if settings.order is None else settings.order
    start, earlier = starting_set(claim), []
    *stops, last = stops_of(claim.crossings)
    work = sum(stops) + _DEGREE * last
    done = steps = 0
    for stop in (*stops, last):
        degree = _DEGREE if stop == last else 1
        chosen = Format(settings.precision, degree, order)
        image = _image(claim, start, stop, chosen, oracle, progress, done / work)
        done, steps = done + degree * stop, steps + image.steps
        with guarded(settings.precision):
            found = _coordinates_of(claim, coordinates, image)
            if stop != last:
                earlier.append(SectionReturn(stop, tuple(map(_linearised, found)), _linearised(image.time)))
    with guarded(settings.precision):
        integral = _integral(claim, start, chosen)
    return BifurcationEnclosures(tuple(earlier), found, image.time, integral, order, settings.precision, steps)


def starting_set(claim: PeriodicBifurcation) -> StartingSet:
    """The points of the box with their parameters; the last variable is that of a parameter that varies."""
    names = tuple(claim.system.parameters)
    frame = [*claim.frame, *((Fraction(0),) * len(claim.radii) for _ in names)]
    radii = claim.radii
    if claim.parameter is not None:
        varying = len(claim.frame) + names.index(claim.parameter)
        frame = [(*row, Fraction(int(place == varying))) for place, row in enumerate(frame)]
        radii = (*radii, claim.parameter_radius)
    functions = functions_at_start(claim.system)
    return StartingSet(len(claim.centre), (*claim.centre, *claim.values), tuple(frame), radii, functions)


def _image(
    claim: PeriodicBifurcation,
    start: StartingSet,
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

    section = section_of(claim.system, claim.normal, claim.offset)
    program = claim.system.program
    return enclose_poincare_map(program, start, section, claim.direction, crossings, chosen, oracle, stepped)


def _coordinates_of(
    claim: PeriodicBifurcation, coordinates: SectionCoordinates, image: Image
) -> tuple[DerivativeTable, ...]:
    """The image in the coordinates p, which are affine functions of the state, after S if there is one."""
    zero = (0,) * len(next(iter(image.time.box)))

    def part(tables: Sequence[DerivativeTable], name: str) -> list[dict[tuple[int, ...], arb]]:
        sources = [getattr(table, name) for table in tables[: len(claim.centre)]]
        columns = {index: moved([source[index] for source in sources]) for index in sources[0]}
        columns[zero] = [value - enclose(origin) for value, origin in zip(columns[zero], claim.centre, strict=True)]
        rows = {index: coordinates.of(column) for index, column in columns.items()}
        return [{index: row[i] for index, row in rows.items()} for i in range(len(claim.radii))]

    def moved(values: list[arb]) -> list[arb]:
        if claim.symmetry is None:
            return values
        return [dot([enclose(entry) for entry in row], values) for row in claim.symmetry]

    parts = zip(part(image.state, "box"), part(image.state, "centre"), strict=True)
    return tuple(DerivativeTable(box, centre) for box, centre in parts)


def _linearised(table: DerivativeTable) -> Linearised:
    size = len(next(iter(table.box)))
    units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
    return Linearised(table.centre[(0,) * size], tuple(table.box[unit] for unit in units))


def _integral(claim: PeriodicBifurcation, start: StartingSet, chosen: Format) -> DerivativeTable | None:
    """The first integral at the points of the box."""
    program = None if claim.level is None else claim.system.first_integral_program
    if program is None:
        return None
    state, parameters = start.elements(start.arithmetic(chosen))
    (element,) = at_start(program, [*state, *parameters])
    return derivative_table(element, start.scales, BOX_RATIO)
