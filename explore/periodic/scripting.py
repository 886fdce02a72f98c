"""Periodic orbits without symmetry for scripts and notebooks; `orbitproof.explore` hands these names on."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import chain
from typing import overload

from orbitproof.explore.engines import Reporter
from orbitproof.explore.names import exact_number, given_values, section_of, start_values, symmetry_of, varied
from orbitproof.explore.periodic.atlas import cover_curve
from orbitproof.explore.periodic.bifurcations import refine_bifurcation
from orbitproof.explore.periodic.continuation import PeriodicFamily, StepControl
from orbitproof.explore.periodic.detection import Bifurcation
from orbitproof.explore.periodic.search import (
    FOLLOWED,
    FoundOrbit,
    FoundOrbits,
    PeriodicRequest,
    followed,
    refined,
    remarks,
)
from orbitproof.explore.periodic.search import find_periodic as found_orbits
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.shared.claims import PeriodicAtlas, PeriodicBifurcation, PeriodicOrbit
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import System

Number = Fraction | int | float | str


def find_periodic(
    system: System,
    start: Mapping[str, Number],
    *,
    parameters: Mapping[str, Fraction | int | str] | None = None,
    period: float | None = None,
    section: str | None = None,
    direction: str | None = None,
    level: Fraction | int | str | None = None,
    returns: int = 1,
    follow: float = FOLLOWED,
    transient: float = 0.0,
    quiet: bool = False,
) -> FoundOrbits:
    """Periodic orbits of any system, in double precision; no symmetry is used. A list that prints as a table.

    Arguments:
        system: from `shared.load_system` or `shared.define_system`, or one of `shared`.
        start: all coordinates of the state by name, without functions of others and without the
            coordinates of a force: near the orbit, or a point whose orbit is followed.
        parameters: all parameters of the vector field by name, exact: `Fraction`, int, or text such as "1/3".
        period: near that of the orbit: Newton's method at once. `None`: the orbit of `start` is followed until it
            nearly repeats.
        section, direction: as text, "z=27" and "+" or "-"; by default one that suits the orbit.
        level: of the first integral, exact; by default that of the start.
        returns: largest number of crossings of the section within a period, if the orbit is followed.
        follow, transient: for how long it is followed, and what is left out before that, in the system's time.
        quiet: nothing on standard error; else progress.

    Raises `ValueError` for what is missing or unknown, and `PeriodicFailure` if no orbit is found.
    """
    try:
        exact = given_values("parameters", assignments(parameters or {}), tuple(system.parameters))
        place = start_values("start", assignments(start), system)
        chosen = section_of(system, section, direction)
        value = None if level is None else exact_number("level", str(level))
    except InputError as error:
        raise ValueError(str(error)) from None
    request = PeriodicRequest(
        system,
        exact,
        tuple(map(float, place.values())),
        period,
        None if chosen is None else AffineSection(*chosen),
        value,
        returns,
        transient,
        follow,
    )
    with Reporter(quiet) as report:
        report.stage(f"looking for periodic orbits of {system.name}")
        found = FoundOrbits(found_orbits(request, report.update))
        for line in chain.from_iterable(remarks(request, orbit) for orbit in found):
            report.message(line)
    return found


def follow_periodic(
    found: FoundOrbit,
    name: str | None,
    bounds: tuple[float, float],
    *,
    generations: int = 0,
    symmetry: str | None = None,
    control: StepControl | None = None,
    quiet: bool = False,
) -> list[PeriodicFamily]:
    """The family of an orbit in a parameter or over levels, both ways, with its bifurcations, in double precision.

    Arguments:
        found: from `find_periodic`.
        name: of the parameter; `None`: over the levels of the first integral.
        bounds: of the parameter or level.
        generations: follow also the orbits that are born at period doublings and pitchforks, so many times.
        symmetry: the image of the state under a linear symmetry, such as "-x,-y,z", that pitchforks may have; `None`:
            changes of sign and exchanges of coordinates are tried.
        control: steps, and the largest number of orbits of a family.
        quiet: nothing on standard error; else progress.

    Gives the family of the orbit, then those that are born from it; an interrupt ends the list early. Raises
    `ValueError` for what is unknown, and `PeriodicFailure` if the family cannot be followed at all.
    """
    system = found.problem.system
    if name is not None and name not in system.parameters:
        raise ValueError(
            f"{name}: {system.name} has no such parameter; it has {', '.join(system.parameters) or 'none'}"
        )
    try:
        rows = None if symmetry is None else symmetry_of(system, symmetry)
    except InputError as error:
        raise ValueError(str(error)) from None
    with Reporter(quiet) as report:
        report.stage(f"following the family in {name or 'the level'}")
        return list(followed(found, name, bounds, generations, rows, report.update, control))


@overload
def refine_periodic(
    found: FoundOrbit, *, digits: int = 50, name: str = "orbit", quiet: bool = False
) -> PeriodicOrbit: ...


@overload
def refine_periodic(
    found: Bifurcation,
    *,
    digits: int = 50,
    name: str = "orbit",
    section: str | None = None,
    direction: str | None = None,
    quiet: bool = False,
) -> PeriodicBifurcation: ...


def refine_periodic(
    found: FoundOrbit | Bifurcation,
    *,
    digits: int = 50,
    name: str = "orbit",
    section: str | None = None,
    direction: str | None = None,
    quiet: bool = False,
) -> PeriodicOrbit | PeriodicBifurcation:
    """The claim about an orbit, or about a bifurcation of a family, for `verify.certify`: to so many digits, in a box.

    Arguments:
        found: from `find_periodic`, or from the `bifurcations` of a family.
        digits: decimal digits of the point and of the parameter.
        name: of the claim.
        section, direction: for a bifurcation, as in `find_periodic`.

    Raises `RefinementFailure`, also for a branch point that no symmetry explains, of which there is no claim.
    """
    with Reporter(quiet) as report:
        report.stage(f"refining {name}")
        if isinstance(found, FoundOrbit):
            return refined(found, name, digits, report.update)
        try:
            chosen = section_of(found.problem.system, section, direction)
        except InputError as error:
            raise ValueError(str(error)) from None
        return refine_bifurcation(
            found, name, digits, report.update, None if chosen is None else AffineSection(*chosen)
        )


def periodic_atlas(
    found: FoundOrbit,
    along: tuple[str, float, float],
    *,
    name: str = "curve",
    quiet: bool = False,
) -> PeriodicAtlas:
    """The curve of an orbit in a parameter, or over the levels of the first integral, for `verify.certify`.

    It is followed through its folds, both ways, until it leaves the interval; where no further piece is found it ends
    before, and its title and pieces are of what there is.

    Arguments:
        along: name of the parameter, or "level", with the least and the greatest value; of a system with a parameter
            of that name "(level)".

    Raises `ValueError` for what cannot vary, and `PeriodicFailure` if there is no piece at all.
    """
    varies, low, high = along
    system = found.problem.system
    try:
        parameter = varied(system, varies)
    except LookupError as error:
        raise ValueError(f"along: {varies!r}: {error}") from None
    if not low < high:
        raise ValueError(f"along: {varies!r}: an empty interval; give the smaller value first")
    with Reporter(quiet) as report:
        report.stage(f"covering the curve in {varies}")
        return cover_curve(found, parameter, (low, high), name, progress=lambda text: report.update(text, None)).atlas


def assignments(values: Mapping[str, object]) -> list[str]:
    """Values by name as a command takes them: ``name=value``."""
    return [f"{name}={value}" for name, value in values.items()]
