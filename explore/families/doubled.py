"""Families of doubled period that branch off from the halo families: butterflies and dragonflies.

On its way to the smaller primary a halo family meets 1:2 resonances. At the last of them before its nearest orbit the
butterflies begin, at the one before that the dragonflies, whose orbits come down to the plane.
"""

from __future__ import annotations

import numpy as np

from orbitproof.explore.families.branching import doubling_seed
from orbitproof.explore.families.continuation import Family
from orbitproof.explore.families.detection import detect
from orbitproof.explore.orbits import CorrectionFailure, SymmetricOrbit
from orbitproof.explore.seeds import primaries

DOUBLED = ("dragonfly", "butterfly")
"""The kinds, in the order of their resonances along a halo family."""


def doubled_seed(halo: Family, kind: str) -> Family:
    """The branch of one of `DOUBLED` from a traced halo family, not traced yet. Raises `CorrectionFailure`."""
    _, smaller = primaries(float(halo.problem.parameters["mu"]))
    nearest = min(halo.orbits, key=lambda orbit: _distance(orbit, smaller))
    found = [each for each in detect(halo, [2]).resonances if each.orbit.arclength <= nearest.arclength]
    back = len(DOUBLED) - DOUBLED.index(kind)
    if len(found) < back:
        known = f"{len(found)} 1:2 resonances" if found else "no 1:2 resonance"
        raise CorrectionFailure(f"{known} on the halo family before its nearest orbit: {halo.reason}")
    return doubling_seed(halo.problem, found[-back])


def _distance(orbit: SymmetricOrbit, place: np.ndarray) -> float:
    """From the points of a halo orbit on Fix(R) to a place in the plane y = 0."""
    ends = np.array([orbit.centre("first"), orbit.centre("second")])[:, :2]
    return float(np.min(np.linalg.norm(ends - place[[0, 2]], axis=1)))
