"""Families of doubled period that branch off from the halo families: butterflies and dragonflies.

On its way to the smaller primary a halo family meets 1:2 resonances. At the last of those whose orbits are unstable the
dragonflies begin; at the last of the near-rectilinear ones, if there are any, the butterflies.
"""

from __future__ import annotations

import numpy as np

from orbitproof.explore.families import Family, detect, doubling_seed
from orbitproof.explore.orbits import CorrectionFailure, SymmetricOrbit, stability_index
from orbitproof.explore.three_body.seeds import primaries

DOUBLED = ("dragonfly", "butterfly")

UNSTABLE = 2.0
"""The stability index of a halo orbit in 1:2 resonance whose other multipliers are real is greater."""

NEAR_RECTILINEAR, NEAREST = 0.1, 0.003
"""Halo orbits that come so close to the smaller primary, in units of (mu/3)^(1/3), count as such, and are looked at up
to there."""


def doubled_seed(halo: Family, kind: str) -> Family:
    """The branch of one of `DOUBLED` from a traced halo family, not traced yet. Raises `CorrectionFailure`."""
    _, smaller = primaries(float(halo.problem.parameters["mu"]))
    near = NEAR_RECTILINEAR * float((halo.problem.parameters["mu"] / 3) ** (1 / 3))
    nearest = min(halo.orbits, key=lambda orbit: _distance(orbit, smaller))
    found = [
        each
        for each in detect(halo, [2]).resonances
        if each.orbit.arclength <= nearest.arclength
        and (_distance(each.orbit, smaller) < near if kind == "butterfly" else _is_unstable(each.orbit))
    ]
    if not found:
        which = "near-rectilinear" if kind == "butterfly" else "unstable"
        raise CorrectionFailure(f"no {which} halo orbit in 1:2 resonance before the family's nearest: {halo.reason}")
    return doubling_seed(halo.problem, found[-1])


def _is_unstable(orbit: SymmetricOrbit) -> bool:
    return float(stability_index(orbit.stability)) > UNSTABLE


def _distance(orbit: SymmetricOrbit, place: np.ndarray) -> float:
    """From the points of a halo orbit on Fix(R) to a place in the plane y = 0."""
    ends = np.array([orbit.centre("first"), orbit.centre("second")])[:, :2]
    return float(np.min(np.linalg.norm(ends - place[[0, 2]], axis=1)))
