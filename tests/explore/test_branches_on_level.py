"""Branches of new orbits on a fixed level of a first integral, and the stability of their orbits."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from orbitproof.explore.branches import BranchRecord, branch_point, follow
from orbitproof.explore.orbits import ShootingProblem
from orbitproof.explore.refinement.newton import refine
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import ReversibleSystem

DATA = Path(__file__).parents[1] / "data"


@cache
def system() -> ReversibleSystem:
    return read_atlas(DATA / "atlas-fixed-level.json").system


@cache
def branch() -> BranchRecord:
    claim = refine(system(), {}, "period_tupling", 4, [1.909118763, -0.2369648123], digits=40)
    return follow(branch_point(claim.to_candidate("quadrupling", {}))).record(None, None)


def test_new_orbits_are_on_the_side_that_is_certified_and_on_the_level() -> None:
    assert branch().birth is not None
    assert branch().birth.side == "below"
    for side in branch().sides:
        assert len(side.orbits) > 5
        for orbit in side.orbits:
            assert system().first_integral is not None
            for state in orbit.crossings:
                (value,) = system().first_integral(state.tolist(), [orbit.point[0]])
                assert abs(value) < 1e-9


def test_their_stability_is_that_of_single_shooting() -> None:
    """By way of four half returns between crossings off Fix(R), and at once."""
    problem = ShootingProblem(system(), {})
    orbit = branch().sides[0].orbits[-1]
    unknowns = np.array([*orbit.point, orbit.half_period])
    (expected,) = problem.orbit(problem.correct(unknowns, np.array([1.0, 0.0, 0.0]))).stability
    (found,) = orbit.stability
    assert abs(found - expected) < 1e-5 * abs(expected)
