"""The files that traced families are written to: a family file and, for the CR3BP, catalogue files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import TracedFamily, family_record
from orbitproof.explore.records import write_families
from orbitproof.explore.three_body.catalogues import (
    Catalogue,
    catalogue_of,
    libration_places,
    write_catalogue_csv,
    write_catalogue_json,
)
from orbitproof.shared.systems import THREE_BODY
from orbitproof.shared.wording import counted


def write_outputs(items: Sequence[TracedFamily], family: Path | None, report: Reporter) -> None:
    """Write the family file if it is asked for. Raises `InputError` if it cannot be written."""
    if family is not None:
        write_families(family, [family_record(item) for item in items])
        report.message(f"families written to {family}")


def write_traced(items: Sequence[TracedFamily], csv: Path | None, catalogue: Path | None, report: Reporter) -> None:
    """Write the orbits of traced CR3BP families in the catalogue's forms. Raises `InputError`."""
    spatial = [item for item in items if item.system in THREE_BODY]
    for item in spatial:
        form = catalogue_of(item.family, item.name, item.label)
        paths = [None if path is None else path_for(path, item, len(spatial)) for path in (csv, catalogue)]
        write_catalogue(form, item.title, *paths, report)


def write_catalogue(form: Catalogue, title: str, csv: Path | None, catalogue: Path | None, report: Reporter) -> None:
    """Write orbits in the catalogue's forms. Raises `InputError`."""
    if csv is not None:
        write_catalogue_csv(csv, form)
        report.message(f"{title}: {counted(len(form), 'orbit')} written to {csv}")
    if catalogue is not None:
        write_catalogue_json(catalogue, form, libration_places(float(form.mass_ratio)))
        report.message(f"{title}: {counted(len(form), 'orbit')} written to {catalogue}")


def path_for(path: Path, item: TracedFamily, count: int) -> Path:
    """The file of one of `count` families: `path` itself for one, else with the family's name before the extension."""
    if count == 1:
        return path
    name = "-".join(part for part in (item.label, item.name) if part)
    return path.with_name(f"{path.stem}-{name}{path.suffix}")
