"""Between traced families and what a family file holds."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from orbitproof.explore.families.continuation import Ending, Family
from orbitproof.explore.families.tracing import TracedFamily
from orbitproof.explore.orbits import ShootingProblem, SymmetricOrbit
from orbitproof.explore.records import (
    EndingRecord,
    ExtremumRecord,
    FamilyRecord,
    OrbitRecord,
    ResonanceRecord,
    SamplesRecord,
)


def family_record(item: TracedFamily) -> FamilyRecord:
    """What is written about a traced family."""
    family = item.family
    return FamilyRecord(
        name=item.name,
        label=item.label,
        system=item.system,
        parameters=family.problem.parameters,
        symmetry=family.problem.symmetry,
        scale=tuple(float(value) for value in family.problem.scales),
        outcome=family.outcome,
        reason=family.reason,
        orbits=tuple(
            OrbitRecord(
                arclength=orbit.arclength,
                point=orbit.centre("first"),
                second_point=orbit.centre("second"),
                half_period=orbit.half_period,
                first_integral=orbit.first_integral,
                stability=orbit.stability,
                coefficients=orbit.coefficients,
                tangent=tangent,
                crossings=orbit.crossings,
            )
            for orbit, tangent in zip(family.orbits, family.tangents, strict=True)
        ),
        resonances=tuple(
            ResonanceRecord(
                k=resonance.k,
                kind=resonance.kind,
                side=resonance.side,
                point=resonance.point,
                arclength=resonance.orbit.arclength,
                first_integral=resonance.orbit.first_integral,
                stability_parameter=resonance.value,
            )
            for resonance in item.detection.resonances
        ),
        branch=item.branch,
        beginning=None if family.beginning is None else EndingRecord(**asdict(family.beginning)),
        curve=_curve(item.detection.samples),
        extrema=tuple(
            ExtremumRecord(
                arclength=extremum.orbit.arclength,
                first_integral=extremum.orbit.first_integral,
                stability_parameter=extremum.value,
                k=extremum.k,
                level=extremum.level,
            )
            for extremum in item.detection.extrema
        ),
    )


def _curve(samples: tuple[SymmetricOrbit, ...]) -> SamplesRecord | None:
    if len(samples) < 2:
        return None
    integrals = [orbit.first_integral for orbit in samples if orbit.first_integral is not None]
    return SamplesRecord(
        arclength=np.array([orbit.arclength for orbit in samples]),
        points=np.array([orbit.centre("first") for orbit in samples]),
        second_points=np.array([orbit.centre("second") for orbit in samples]),
        half_periods=np.array([orbit.half_period for orbit in samples]),
        first_integrals=np.array(integrals) if integrals else None,
        coefficients=np.array([orbit.coefficients for orbit in samples]),
    )


def family_of(record: FamilyRecord) -> Family:
    """A family from a file, ready to be searched and continued."""
    problem = ShootingProblem(record.system, record.parameters, record.symmetry, record.scale)
    fixed = len(record.system.fixed_coordinates)
    orbits = tuple(
        SymmetricOrbit(
            unknowns=np.append(orbit.point, orbit.half_period),
            second_point=orbit.second_point[-fixed:],
            first_integral=orbit.first_integral,
            coefficients=orbit.coefficients,
            arclength=orbit.arclength,
            crossings=orbit.crossings,
        )
        for orbit in record.orbits
    )
    tangents = tuple(orbit.tangent for orbit in record.orbits)
    beginning = None if record.beginning is None else Ending(**asdict(record.beginning))
    return Family(problem, orbits, tangents, record.outcome, record.reason, beginning)
