"""Northern and southern orbits: where they are farthest from the smaller primary z > 0, or z < 0.

The same for their families, and the other one of the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from orbitproof.explore.families import Family
from orbitproof.explore.flow import FlowFailure, Vector
from orbitproof.explore.orbits import SymmetricOrbit
from orbitproof.explore.three_body.names import BRANCHES, NORTH, SOUTH, Branch
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.shared.systems import CR3BP

_STEP = 1e-3
"""First step of a family that is born in the plane, in units of its scale: so far from there its side shows."""

_PLANE = "S"

_SAME = 1e-6
"""Both ends of half an orbit so near to one another's mirror image, relative to the distance from the smaller primary,
are those of an orbit that is on both sides."""


def branch_at(places: Sequence[Vector] | Vector, mu: float) -> Branch | None:
    """On which side an orbit is that is symmetric under R.

    Arguments:
        places: shape (N, 3), along half of it, both ends included, which are in the plane y = 0.

    Returns `None` for an orbit in the plane z = 0, and for one that is its own mirror image.
    """
    half = np.asarray(places, dtype=float)[:, :3]
    distances = np.linalg.norm(half - primaries(mu)[1], axis=1)
    image = half[-1] * [1, 1, -1]
    height = half[int(np.argmax(distances)), 2]
    if height == 0 or np.linalg.norm(half[0] - image) <= _SAME * distances.max():
        return None
    return NORTH if height > 0 else SOUTH


def branch_of(family: Family) -> Branch | None:
    """On which side the orbits of a family are; `None` for families in the plane, on both sides and of other systems.

    It is that of the middle orbit, and of a family at its birth that of the orbits along its tangent.
    """
    problem, index = family.problem, len(family.orbits) // 2
    if problem.system is not CR3BP or problem.symmetry is not None:
        return None
    unknowns = family.orbits[index].unknowns
    if unknowns[1] == 0:
        unknowns = unknowns + _STEP * problem.scales * family.tangents[index]
    try:
        return branch_at(problem.samples(unknowns), float(problem.parameters["mu"]))
    except FlowFailure:
        return None


def on_side(family: Family, branch: Branch) -> Family:
    """The family, or its mirror image in the plane, on that side."""
    return family if branch_of(family) in (None, branch) else mirrored(family)


def side_reaching(family: Family, coordinate: str, value: float) -> Branch | None:
    """The side on which a coordinate reaches a value: that of the family, or the other one where it alone does."""
    problem, side = family.problem, branch_of(family)
    index = problem.system.centre_coordinates.index(coordinate)
    if side is None or value == 0 or index not in problem.odd_unknowns(_PLANE):
        return side
    reached = [float(orbit.unknowns[index]) / value for orbit in family.orbits]
    return next(each for each in BRANCHES if each != side) if max(reached) < 1 <= -min(reached) else side


def mirrored(family: Family) -> Family:
    """The mirror image in the plane: a family of the same system."""
    problem = family.problem
    system, signs = problem.system, np.array(problem.system.symmetries[_PLANE], dtype=float)
    unknowns = np.ones(problem.size)
    unknowns[list(problem.odd_unknowns(_PLANE))] = -1.0
    section = signs[[*system.fixed_coordinates, *system.kernel_coordinates]]

    def image(orbit: SymmetricOrbit) -> SymmetricOrbit:
        derivative = orbit.derivative
        if derivative is not None:
            derivative = replace(derivative, derivative=derivative.derivative * np.outer(section, section))
        # Zero is added since -0.0 would be written with its sign.
        second = orbit.second_point * signs[list(system.fixed_coordinates)] + 0.0
        return replace(orbit, unknowns=orbit.unknowns * unknowns + 0.0, second_point=second, derivative=derivative)

    return replace(
        family,
        orbits=tuple(map(image, family.orbits)),
        tangents=tuple(tangent * unknowns for tangent in family.tangents),
    )
