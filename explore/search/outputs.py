"""The files that traced families are written to: a family file and, for the CR3BP, catalogue files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from orbitproof.explore.catalogue import catalogue_of, libration_places, write_catalogue_csv, write_catalogue_json
from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import TracedFamily, family_record
from orbitproof.explore.records import write_families
from orbitproof.shared.systems import CR3BP


def write_outputs(
    items: Sequence[TracedFamily], family: Path | None, csv: Path | None, catalogue: Path | None, report: Reporter
) -> None:
    """Write each file that is asked for. Raises `InputError` if one cannot be written."""
    if family is not None:
        write_families(family, [family_record(item) for item in items])
        report.message(f"families written to {family}")
    spatial = [item for item in items if item.system is CR3BP]
    for item in spatial:
        form = catalogue_of(item.family, item.name, item.label)
        if csv is not None:
            path = path_for(csv, item, len(spatial))
            write_catalogue_csv(path, form)
            report.message(f"{item.title}: {len(form)} orbits written to {path}")
        if catalogue is not None:
            path = path_for(catalogue, item, len(spatial))
            write_catalogue_json(path, form, libration_places(float(form.mass_ratio)))
            report.message(f"{item.title}: {len(form)} orbits written to {path}")


def path_for(path: Path, item: TracedFamily, count: int) -> Path:
    """The file of one of `count` families: `path` itself for one, else with the family's name before the extension."""
    if count == 1:
        return path
    name = "-".join(part for part in (item.label, item.name) if part)
    return path.with_name(f"{path.stem}-{name}{path.suffix}")
