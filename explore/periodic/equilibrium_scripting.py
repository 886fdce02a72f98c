"""Equilibria, Hopf points and the orbits born there, for scripts and notebooks; `orbitproof.explore` hands these on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import overload

from orbitproof.explore.engines import Reporter
from orbitproof.explore.names import given_values, symmetry_of
from orbitproof.explore.periodic.continuation import PeriodicFamily, StepControl
from orbitproof.explore.periodic.equilibrium_claims import equilibrium_claim, hopf_claim
from orbitproof.explore.periodic.equilibrium_curve import EquilibriumControl, EquilibriumCurve, continue_equilibrium
from orbitproof.explore.periodic.equilibrium_search import FoundEquilibria, FoundEquilibrium
from orbitproof.explore.periodic.equilibrium_search import find_equilibria as found_equilibria
from orbitproof.explore.periodic.hopf import Hopf
from orbitproof.explore.periodic.hopf_cycles import families_from
from orbitproof.explore.periodic.scripting import assignments
from orbitproof.explore.periodic.search import symmetries_for
from orbitproof.shared import claims
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import System

Number = Fraction | int | float | str


def find_equilibria(
    system: System,
    start: Mapping[str, Number] | None = None,
    *,
    parameters: Mapping[str, Fraction | int | str] | None = None,
    quiet: bool = False,
) -> FoundEquilibria:
    """Equilibria of any system, in double precision. A list that prints as a table.

    Arguments:
        system: as in `find_periodic`.
        start: near an equilibrium, all coordinates of the state by name, without functions of others; `None`: many
            starts are tried, and there may be equilibria to which none of them leads.
        parameters: all parameters of the vector field by name, exact: `Fraction`, int, or text such as "1/3".
        quiet: nothing on standard error; else progress.

    Raises `ValueError` for what is missing or unknown, and `PeriodicFailure` if none is found.
    """
    try:
        exact = given_values("parameters", assignments(parameters or {}), tuple(system.parameters))
        place = None
        if start is not None:
            place = tuple(map(float, given_values("start", assignments(start), system.given_state).values()))
    except InputError as error:
        raise ValueError(str(error)) from None
    with Reporter(quiet) as report:
        report.stage(f"looking for equilibria of {system.name}")
        return FoundEquilibria(found_equilibria(system, exact, place, report.update))


def follow_equilibrium(
    found: FoundEquilibrium,
    name: str,
    bounds: tuple[float, float],
    *,
    control: EquilibriumControl | None = None,
    quiet: bool = False,
) -> EquilibriumCurve:
    """The curve of an equilibrium in a parameter, both ways, with its folds, branch points and Hopf points.

    Arguments:
        found: from `find_equilibria`.
        name: of the parameter.
        bounds: of the parameter.
        control: steps, and the largest number of points.
        quiet: nothing on standard error; else progress.

    Raises `ValueError` for an unknown parameter, and `PeriodicFailure` if the curve cannot be followed at all.
    """
    system = found.problem.system
    if name not in system.parameters:
        known = ", ".join(system.parameters) or "none"
        raise ValueError(f"{name}: {system.name} has no such parameter; it has {known}")
    with Reporter(quiet) as report:
        report.stage(f"following the equilibrium in {name}")
        return continue_equilibrium(
            found.problem, found.equilibrium, name, bounds, control, lambda done: report.update("", done)
        )


def follow_cycles(
    points: Hopf | Sequence[Hopf],
    bounds: tuple[float, float],
    *,
    generations: int = 0,
    symmetry: str | None = None,
    control: StepControl | None = None,
    quiet: bool = False,
) -> list[PeriodicFamily]:
    """The families of periodic orbits that are born at Hopf points, with their bifurcations, in double precision.

    Arguments:
        points: from `follow_equilibrium` (`hopf` of the curve).
        bounds: of the parameter.
        generations, symmetry, control, quiet: as in `follow_periodic`.

    Points to which no family leads are left out; an interrupt ends the list early.
    """
    given = [points] if isinstance(points, Hopf) else list(points)
    with Reporter(quiet) as report:
        if not given:
            return []
        problem, name = given[0].problem, given[0].name
        try:
            rows = None if symmetry is None else symmetry_of(problem.system, symmetry)
        except InputError as error:
            raise ValueError(str(error)) from None
        symmetries = symmetries_for(problem, rows, name)
        report.stage(f"following the orbits of the Hopf points in {name}")
        return list(families_from(given, bounds, generations, control, report.update, symmetries))


@overload
def refine_equilibrium(
    found: FoundEquilibrium, *, digits: int = 50, name: str = "equilibrium", quiet: bool = False
) -> claims.Equilibrium: ...


@overload
def refine_equilibrium(
    found: Hopf, *, digits: int = 50, name: str = "equilibrium", quiet: bool = False
) -> claims.HopfPoint: ...


def refine_equilibrium(
    found: FoundEquilibrium | Hopf, *, digits: int = 50, name: str = "equilibrium", quiet: bool = False
) -> claims.Equilibrium | claims.HopfPoint:
    """The claim about an equilibrium or a Hopf point, for `verify.certify`: to so many digits, in a box.

    Raises `RefinementFailure`, also for a Hopf point whose speed or first Lyapunov coefficient vanishes.
    """
    with Reporter(quiet) as report:
        report.stage(f"refining {name}")
        if isinstance(found, Hopf):
            return hopf_claim(found, name, digits, report.update)
        return equilibrium_claim(found.problem, found.equilibrium, name, digits, report.update)
