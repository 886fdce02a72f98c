"""What pictures of a bifurcating branch are drawn from: its curve through the bifurcation point, dense."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from orbitproof.explore.branches import BranchOrbit, BranchRecord
from orbitproof.figures.model import SampledFamily, interpolate
from orbitproof.figures.orbits import Array, state_on_fixed_set

_PARTS = 8


@dataclass(frozen=True)
class BranchCurve:
    """A branch through its bifurcation point, dense; M places.

    Attributes:
        points: shape (M, 1 + n), starting points.
        starts: shape (M, m), the states there.
        differences: shape (M,), level minus that of the bifurcation.
        elliptic: shape (M,), whether the pair of multipliers that is resonant at the bifurcation is elliptic.
    """

    points: Array
    starts: Array
    differences: Array
    elliptic: Array


def curve_of(branch: BranchRecord) -> BranchCurve:
    orbits = [*reversed(branch.sides[0].orbits), *branch.sides[1].orbits]
    middle = len(branch.sides[0].orbits)
    nodes = np.insert(np.array([orbit.arclength for orbit in orbits]), middle, 0.0)
    points = np.insert(np.array([orbit.point for orbit in orbits]), middle, branch.point, axis=0)
    differences = np.insert(np.array([orbit.level_difference for orbit in orbits]), middle, 0.0)
    elliptic = np.concatenate([_elliptic(branch.sides[0].orbits)[::-1], _elliptic(branch.sides[1].orbits)])
    dense = np.concatenate([np.linspace(a, b, _PARTS, endpoint=False) for a, b in pairwise(nodes)] + [nodes[-1:]])
    nearest = np.searchsorted(0.5 * (np.delete(nodes, middle)[:-1] + np.delete(nodes, middle)[1:]), dense)
    starts = np.insert(np.array([start_of(branch, orbit) for orbit in orbits]), middle, origin_of(branch), axis=0)
    return BranchCurve(
        *(interpolate(nodes, values, dense) for values in (points, starts, differences)), elliptic[nearest]
    )


def start_of(branch: BranchRecord, orbit: BranchOrbit) -> Array:
    if branch.loses_reversor:
        return orbit.crossings[0]
    return np.array(state_on_fixed_set(branch.system, branch.parameters, list(orbit.point)))


def origin_of(branch: BranchRecord) -> Array:
    return np.array(state_on_fixed_set(branch.system, branch.parameters, list(branch.point)))


def _elliptic(orbits: Sequence[BranchOrbit]) -> Array:
    """Whether the pair is elliptic whose stability parameter is 1 at the bifurcation, followed outwards."""
    value, result = 1.0 + 0.0j, []
    for orbit in orbits:
        value = min(orbit.stability, key=lambda s: float(abs(s - value)))
        result.append(value.imag == 0 and abs(value) < 1.0)
    return np.array(result)


def widest_coordinate(branch: BranchRecord, among: Sequence[int]) -> int:
    """The state coordinate that changes most along the branch, of some."""
    rows = np.vstack([start_of(branch, orbit) for side in branch.sides for orbit in side.orbits])
    return among[int(np.argmax(np.ptp(rows[:, list(among)], axis=0)))]


def nearest_curve(family: SampledFamily, branch: BranchRecord) -> tuple[Array, Array]:
    """The curve of the family, of its two, that passes through the bifurcation point, with its levels."""
    curves = (family.points, family.second_points)
    misses = [float(np.linalg.norm((curve - branch.point) / branch.scale, axis=1).min()) for curve in curves]
    return curves[int(np.argmin(misses))], family.levels


def is_certified(branch: BranchRecord) -> bool:
    return branch.verdict == "proved"


def shown_orbit(branch: BranchRecord) -> BranchOrbit:
    return branch.sides[1].orbits[-1]
