"""Periodic orbits without symmetry for scripts and notebooks; `orbitproof.explore` hands these names on."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from orbitproof.explore.engines import Reporter
from orbitproof.explore.names import exact_number, given_values, section_of
from orbitproof.explore.periodic.search import FOLLOWED, FoundOrbit, PeriodicRequest, refined
from orbitproof.explore.periodic.search import find_periodic as found_orbits
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.shared.formats import InputError, PeriodicOrbit
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
) -> list[FoundOrbit]:
    """Periodic orbits of any system, in double precision; no symmetry is used.

    Arguments:
        system: from `shared.load_system` or `shared.define_system`, or one of `shared`.
        start: all coordinates of the state by name: near the orbit, or a point whose orbit is followed.
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
        exact = given_values("parameters", _words(parameters or {}), tuple(system.parameters))
        place = given_values("start", _words(start), system.state)
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
        return list(found_orbits(request, report.update))


def refine_periodic(found: FoundOrbit, *, digits: int = 50, name: str = "orbit", quiet: bool = False) -> PeriodicOrbit:
    """The claim about an orbit, for `verify.certify`: its point to so many digits, in a box.

    Raises `RefinementFailure`.
    """
    with Reporter(quiet) as report:
        report.stage(f"refining {name}")
        return refined(found, name, digits, report.update)


def _words(values: Mapping[str, object]) -> list[str]:
    return [f"{name}={value}" for name, value in values.items()]
