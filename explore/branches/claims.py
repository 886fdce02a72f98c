"""Orbits of a branch that R does not map to themselves, to be refined to claims about periodic orbits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from orbitproof.explore.branches.file import BranchOrbit, BranchRecord
from orbitproof.explore.periodic import AffineSection, PeriodicTask

_LEVEL_DIGITS = 12
"""Digits of the level, which is a number of the claim."""


def numbered(record: BranchRecord, number: int) -> BranchOrbit:
    """An orbit of a branch: 1 is the first one on the positive side, -1 the first one on the other.

    Raises `ValueError` if there is none of that number.
    """
    orbits = record.sides[int(number > 0)].orbits if record.sides else ()
    if not 1 <= abs(number) <= len(orbits):
        raise ValueError(f"there is no orbit {number}: that side of {record.id} has {len(orbits)}")
    return orbits[abs(number) - 1]


def task_of(record: BranchRecord, number: int, digits: int = 50) -> PeriodicTask:
    """What there is to refine of an orbit, in the system's section, in the direction of its start beside Fix(R).

    Its level is that of the orbit to 12 digits, exactly; a family parameter is that of the orbit. Raises `ValueError`
    if there is no such orbit, or it is symmetric.
    """
    if not record.loses_reversor:
        raise ValueError(f"{record.id}: the orbits of this branch are symmetric; explore orbit makes claims of such")
    orbit, system, parameters = numbered(record, number), record.system, dict(record.parameters)
    level = Fraction(f"{orbit.level:.{_LEVEL_DIGITS - 1}e}")
    if system.fixed_level is not None:
        exact: Fraction | None = system.fixed_level.value
    else:
        exact = None if system.first_integral is None else level
    if system.family_parameter is not None:
        parameters[system.family_parameter] = level
    values, place = [float(parameters[name]) for name in system.parameters], system.section_index
    rates = np.array([system.vector_field(state.tolist(), values)[place] for state in orbit.crossings], dtype=float)
    normal = tuple(Fraction(int(i == place)) for i in range(len(system.state)))
    section = AffineSection(normal, Fraction(0), 1 if rates[0] > 0 else -1)
    return PeriodicTask(
        f"{record.id}-orbit{number}", system, parameters, section, int(np.sum(rates * rates[0] > 0)),
        tuple(map(float, orbit.crossings[0])), float(orbit.times.sum()), exact, digits,
        {"branch": record.id, "number": number},
    )  # fmt: skip
