"""Catalogues for scripts and notebooks; `orbitproof.explore` hands these names on."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import FamilyFailure, Limits
from orbitproof.explore.flow import Device
from orbitproof.explore.names import label_of, system_named
from orbitproof.explore.three_body.catalogues.file import Catalogue, read_catalogue
from orbitproof.explore.three_body.catalogues.filters import left_out, without_hits
from orbitproof.explore.three_body.catalogues.making import CatalogueTask, catalogue_task
from orbitproof.explore.three_body.names import (
    DEFAULT_BRANCH,
    WITHOUT_SYMMETRY,
    Branch,
    families_to_give,
    family_name,
    given_parameters,
    system_with,
)
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import MASS_PARAMETERS, THREE_BODY


def catalogue(
    family: str | Path,
    mu: Fraction | float | str | None = None,
    *,
    rows: int = 1000,
    step: float | None = None,
    max_orbits: int = Limits.max_orbits,
    min_distance: float | None = None,
    branch: Branch = DEFAULT_BRANCH,
    device: Device = "cpu",
    hits: bool = False,
    quiet: bool = False,
) -> Catalogue:
    """A dense catalogue of a family by name, or one from a file, in double precision.

    Arguments:
        family: a name as for `trace`, or "L4-short", ..; or, without `mu`, the path of a catalogue (JSON or CSV).
        mu: mass parameter: a name such as "jpl-earth-moon", a `Fraction`, a decimal text or a float.
        rows: at equal steps along the family, without ends where its orbits hit the smaller primary (`hits`); what
            cannot be computed is left out.
        step: in place of that, the arclength of a step.
        max_orbits, min_distance: where the family ends: so many steps of the continuation, so close to a primary.
        branch: "north" or "south", of halo families and those that branch off from them.
        device: where the rows are corrected: "cpu", or "gpu", which is to be asked for before anything is searched.
        hits: keep rows whose orbits hit the smaller primary; else they are left out, and how many is told.
        quiet: nothing on standard error; else progress.

    The columns beside the nine of the JPL catalogue are in `more`: distances, altitude, whether an orbit hits the
    smaller primary, and what is proved. `by_period`, `by_stability`, .. choose rows; `to_csv`, `write` and
    `to_dataframe` hand them on. Raises `ValueError` for an unknown name or mass, `FamilyFailure` if no orbit is
    found, and `shared.InputError` where there is no GPU.
    """
    if mu is None:
        try:
            return read_catalogue(Path(family))
        except InputError as error:
            raise ValueError(f"mu: missing; or give the path of a catalogue ({error})") from None
    name = family_name(str(family))
    named = "cr3bp" if name in WITHOUT_SYMMETRY else system_with([name])
    if named is None or system_named(named) not in THREE_BODY:
        raise ValueError(f"family: {family!r} is unknown; there are {families_to_give('cr3bp', name)}")
    text = mu if isinstance(mu, str) else str(Fraction(mu))
    system = system_named(named)
    try:
        parameters = given_parameters(system, text, None)
    except InputError as error:
        raise ValueError(str(error)) from None
    label = next(
        (key for key, value in MASS_PARAMETERS.items() if value == parameters["mu"]), label_of(system, text, None)
    )
    limits = Limits(max_orbits, min_distance=min_distance)
    task = CatalogueTask(system, name, label, parameters, limits, rows, device, step, branch, hits=hits)
    with Reporter(quiet) as report:
        report.stage(task.title)
        made = catalogue_task(task, report.update)
        if made.catalogue is None:
            raise FamilyFailure(f"{task.title}: {made.reason}")
        hitting = f"{made.hitting}; hits=True covers them" if made.hitting else ""
        for line in filter(None, (made.left_out, hitting, made.corrected)):
            report.message(f"{task.title}: {line}")
        kept = made.catalogue if hits else without_hits(made.catalogue)
        if len(kept) < len(made.catalogue):
            report.message(f"{task.title}: {left_out(kept, made.catalogue)}; hits=True keeps them")
    return kept
