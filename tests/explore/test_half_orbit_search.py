"""Families whose half orbits change how often they meet the section, and refinement where they meet it twice."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from orbitproof import explore
from orbitproof.explore.refinement.newton import RefinementFailure, refine
from orbitproof.shared.formats import load_system, read_candidates
from orbitproof.shared.systems import ReversibleSystem

ROOT = Path(__file__).parents[2]
KNOWN = {item.id: item for item in read_candidates(ROOT / "tests" / "data" / "known-crossings.json")}


@pytest.fixture(scope="module")
def michelson() -> ReversibleSystem:
    return load_system(ROOT / "docs" / "examples" / "michelson.py")


def test_the_search_says_where_the_number_of_crossings_changes(michelson: ReversibleSystem) -> None:
    traced = explore.trace_from(michelson, {"c": 0.6, "y": -0.076}, bounds={"c": (0.58, 0.75)}, quiet=True)
    family = traced._traced.family
    assert {orbit.crossings for orbit in family.orbits} == {1, 2}
    (line,) = family.tangencies
    assert "becomes tangent to the section" in line
    # The first point passes y = 0 there, on either side of which orbits leave the section in another direction.
    for left, right in zip(family.arclengths, family.arclengths[1:], strict=False):
        orbit = family.orbit_at(left + 0.9 * (right - left))
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
