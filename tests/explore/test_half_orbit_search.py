"""Families whose half orbits change how often they meet the section, and refinement where they meet it twice."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from orbitproof import explore
from orbitproof.explore.families import Family
from orbitproof.explore.refinement import RefinementFailure, refine, refine_orbit
from orbitproof.explore.search import tasks_of_family
from orbitproof.shared.formats import COORDINATE, Equation, load_system, read_candidates
from orbitproof.shared.systems import ReversibleSystem

ROOT = Path(__file__).parents[2]
KNOWN = {item.id: item for item in read_candidates(ROOT / "tests" / "data" / "known-crossings.json")}


@pytest.fixture(scope="module")
def michelson() -> ReversibleSystem:
    return load_system(ROOT / "docs" / "examples" / "michelson.py")


@pytest.fixture(scope="module")
def traced(michelson: ReversibleSystem) -> Family:
    """A family on which the number of crossings changes."""
    found = explore.trace_from(michelson, {"c": 0.6, "y": -0.076}, bounds={"c": (0.58, 0.75)}, quiet=True)
    return found._traced.family


def test_the_search_says_where_the_number_of_crossings_changes(traced: Family) -> None:
    assert {orbit.crossings for orbit in traced.orbits} == {1, 2}
    (line,) = traced.tangencies
    assert "becomes tangent to the section" in line
    # The first point passes y = 0 there, on either side of which orbits leave the section in another direction.
    for left, right in pairwise(orbit.arclength for orbit in traced.orbits):
        orbit = traced.orbit_at(left + 0.9 * (right - left))
        assert orbit.crossings == (1 if orbit.unknowns[1] > 0 else 2)


@pytest.mark.parametrize("name", ["michelson-family-k3-3", "michelson-family-k2-3"])
def test_a_point_is_refined_with_its_number_of_crossings_and_not_with_another(
    michelson: ReversibleSystem, name: str
) -> None:
    known = KNOWN[name]
    guess = [float(value) for value in known.centre]
    point = refine(michelson, {}, known.kind, known.k, guess, digits=30, crossings=2).to_candidate("a", {})
    assert point.crossings == 2
    gaps = [abs(a - b) for a, b in zip(point.centre, known.centre, strict=True)]
    assert max(gaps) < Fraction(1, 10**30)
    with pytest.raises(RefinementFailure):
        refine(michelson, {}, known.kind, known.k, guess, digits=30)


def test_an_orbit_of_a_family_is_refined_with_its_number_of_crossings_and_not_with_another(traced: Family) -> None:
    counts = []
    for speed in ("0.59", "0.7"):
        for task in tasks_of_family(traced, Equation(COORDINATE, Fraction(speed), "c"), "orbit", 30):
            candidate = refine_orbit(task)
            assert candidate.crossings == task.crossings
            assert abs(float(candidate.centre[1]) - task.guess[1]) < 1e-6
            counts.append(task.crossings)
            if task.crossings == 2:
                with pytest.raises(RefinementFailure):
                    refine_orbit(replace(task, crossings=1))
    assert set(counts) == {1, 2}
