"""From a family file, written and checked by `explore.records.family_file`, to the arrays that pictures need."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from orbitproof.explore.records import FamilyRecord
from orbitproof.explore.records import read_families as read_records
from orbitproof.figures.model.family import SampledFamily
from orbitproof.shared.formats import InputError


def read_families(path: Path) -> list[SampledFamily]:
    """The families of a file. Raises `InputError`, also for a family of fewer than two orbits."""
    families = []
    for index, record in enumerate(read_records(path)):
        if len(record.orbits) < 2:
            raise InputError(f"{path}: field families[{index}].orbits: one orbit is no curve; trace at least two")
        families.append(_family(record))
    return families


def _family(record: FamilyRecord) -> SampledFamily:
    orbits = record.orbits
    points = np.array([orbit.point for orbit in orbits])
    integrals = [orbit.first_integral for orbit in orbits if orbit.first_integral is not None]
    return SampledFamily(
        name=f"{record.label}-{record.name}" if record.label else record.name,
        system=record.system,
        parameters=record.parameters,
        points=points,
        second_points=np.array([orbit.second_point for orbit in orbits]),
        periods=np.array([2 * orbit.half_period for orbit in orbits]),
        levels=points[:, 0] if record.system.family_parameter is not None else np.array(integrals),
        coefficients=np.array([orbit.coefficients for orbit in orbits]),
        arclength=np.array([orbit.arclength for orbit in orbits]),
        branch=record.branch,
    )
