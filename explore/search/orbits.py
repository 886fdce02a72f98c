"""Single orbits of a family, singled out by an equation, as tasks to refine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from orbitproof.explore.families import Family, family_of
from orbitproof.explore.flow import flow_batch
from orbitproof.explore.numerics import bracketed_zero
from orbitproof.explore.orbits import CorrectionFailure, SymmetricOrbit
from orbitproof.explore.records import FamilyRecord
from orbitproof.explore.refinement import OrbitTask
from orbitproof.explore.three_body.catalogues import ROW, Catalogue, correct_catalogue
from orbitproof.explore.three_body.families import branch_of
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, Equation
from orbitproof.shared.systems import CR3BP

_OFF_SYMMETRY = 1e-6
_ACCURACY = 1e-6


def orbits_with(family: Family, equation: Equation) -> Iterator[SymmetricOrbit]:
    """The orbits of a traced family that satisfy an equation, in order; none is found between two that both are off
    it to the same side.
    """
    names, value = family.problem.system.centre_coordinates, float(equation.value)

    def off(orbit: SymmetricOrbit) -> float:
        if equation.quantity == HALF_PERIOD:
            return float(orbit.half_period) - value
        if equation.quantity == COORDINATE:
            return float(orbit.unknowns[names.index(str(equation.coordinate))]) - value
        assert orbit.first_integral is not None
        return orbit.first_integral - value

    for left, right in pairwise(family.orbits):
        heights = (off(left), off(right))
        if heights[0] * heights[1] > 0:
            continue
        ends = (left.arclength, right.arclength)
        try:
            place = bracketed_zero(
                lambda arclength: off(family.orbit_at(arclength)), ends, heights, _ACCURACY * (ends[1] - ends[0])
            )
            yield family.orbit_at(place)
        except (CorrectionFailure, ZeroDivisionError):
            yield left if abs(heights[0]) < abs(heights[1]) else right


def tasks_of_family(family: Family, equation: Equation, id: str, digits: int) -> list[OrbitTask]:
    """The orbits of a family that satisfy an equation, to be refined; numbered if there are several."""
    problem, branch = family.problem, branch_of(family)
    found = list(orbits_with(family, equation))
    return [
        OrbitTask(
            id=id if len(found) == 1 else f"{id}-{number}",
            system=problem.system,
            parameters=problem.parameters,
            equation=equation,
            guess=tuple(map(float, orbit.centre("first"))),
            digits=digits,
            provenance={} if branch is None else {"branch": branch},
            crossings=orbit.crossings,
        )
        for number, orbit in enumerate(found, start=1)
    ]


def tasks_of_extrema(record: FamilyRecord, id: str, digits: int) -> list[OrbitTask]:
    """The extrema of the stability parameters that a family file lists, numbered, to be refined."""
    family, side = family_of(record), {} if record.branch is None else {"branch": record.branch}
    return [
        OrbitTask(
            id=f"{id}-extremum-{number}",
            system=record.system,
            parameters=record.parameters,
            equation=None,
            guess=tuple(map(float, orbit.centre("first"))),
            digits=digits,
            provenance={"stability_parameter": extremum.stability_parameter} | side,
            crossings=orbit.crossings,
        )
        for number, (extremum, orbit) in enumerate(
            ((each, family.orbit_at(each.arclength)) for each in record.extrema), start=1
        )
    ]


def tasks_of_catalogue(
    catalogue: Catalogue, rows: Sequence[int], equation: Equation | None, digits: int, accept: bool = False
) -> tuple[list[OrbitTask], list[str]]:
    """Orbits near rows of a catalogue, counted from 1, to be refined; and why others are not.

    Those do not start on Fix(R), or say what is not so of the orbit next to them, unless `accept` takes that one.
    """
    tasks, failures = [], []
    chosen = np.array(rows) - 1
    corrected = correct_catalogue(catalogue.chosen(chosen), accept=accept)
    is_held = equation is not None and equation.quantity == COORDINATE
    half = flow_batch(
        CR3BP,
        catalogue.states[chosen],
        0.5 * catalogue.periods[chosen],
        np.full((len(rows), 1), float(catalogue.mass_ratio)),
    )
    odd = [index for index, sign in enumerate(CR3BP.reversing_symmetry) if sign == -1]
    for index, (row, crossings) in enumerate(zip(rows, half.crossings, strict=True)):
        state, why = catalogue.states[row - 1], corrected.reasons[index]
        if np.max(np.abs(state[odd])) > _OFF_SYMMETRY:
            failures.append(f"row {row} does not start in the plane of symmetry")
            continue
        # With a coordinate held Newton's method may come to the row's orbit where it did not before.
        is_lost = bool(corrected.failures[index]) or corrected.fallen(index) is not None
        if why and not accept and not (is_held and is_lost):
            failures.append(f"row {row}: {why}")
            continue
        tasks.append(
            OrbitTask(
                id=row_id(row),
                system=CR3BP,
                parameters={"mu": catalogue.mass_ratio},
                equation=equation,
                guess=tuple(float(state[index]) for index in CR3BP.fixed_coordinates),
                digits=digits,
                provenance={"catalogue": catalogue.title, "row": row},
                crossings=int(crossings),
            )
        )
    return tasks, failures


def row_id(row: int) -> str:
    """The id of the candidate of a row."""
    return f"{ROW}{row:04d}"
