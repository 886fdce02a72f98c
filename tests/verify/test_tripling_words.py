"""What is said of a tripling by symmetry: two orbits that S exchanges, to one side; and of other tuplings."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pytest
from flint import arb, ctx
from support.closed_form_maps import ReversibleMap, claim, description, tables_of_maps, verdict
from support.map_cases import WIDE, outcome_of, proof
from support.told import theorem_in_words

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import BifurcationTheorem
from orbitproof.verify.words.bifurcation import kind_in_words

EXCHANGES = "fixes the points of the first curve and maps the two orbits to each other"


def claim_of(name: str, hamiltonian: bool = False, symmetry: str | None = "S") -> Candidate:
    theorem = proof(outcome_of(name, hamiltonian, symmetry=symmetry)).theorem
    assert isinstance(theorem, BifurcationTheorem)
    return theorem.claim


@pytest.mark.parametrize("hamiltonian", [False, True])
def test_a_tripling_is_told_as_two_orbits_that_the_symmetry_exchanges(hamiltonian: bool) -> None:
    claim = claim_of("k=3, symmetric", hamiltonian)
    assert claim.uses_symmetry
    assert claim.is_tangential
    found = proof(outcome_of("k=3, symmetric", hamiltonian))
    told = theorem_in_words(found.theorem)
    assert "two R-symmetric orbits of period 3 of P^2, each of which meets Fix(R) once near the point" in told
    assert f"S {EXCHANGES}" in told
    assert "no further R-symmetric point x with P^6(x) = x" in told
    assert "on one side of this value only" in kind_in_words(claim)
    assert "with P^6(x) = x, exchanged by S," in kind_in_words(claim)
    names = [hypothesis.name for hypothesis in found.hypotheses]
    assert ("h_b''" if hamiltonian else "G_111") in names
    assert ("h_b'" if hamiltonian else "G_11") not in names
    assert found.results.side in ("above", "below")


def test_other_tuplings_do_not_use_a_symmetry_that_a_claim_names() -> None:
    # At even k the new points are exchanged by P^k and belong to one orbit.
    for name in ("k=2", "k=4"):
        claim = claim_of(name, symmetry=None)
        assert not claim.uses_symmetry
        assert f"exchanged by P^{name[2:]}," in kind_in_words(claim)
        assert EXCHANGES not in theorem_in_words(proof(outcome_of(name)).theorem)
    touching = claim_of("k=3", symmetry=None)
    assert not touching.uses_symmetry
    assert not touching.is_tangential
    assert "exchanged" not in kind_in_words(touching)
    assert "which also has one point for every such value" in kind_in_words(touching)


def new_points(system: ReversibleMap, nu: float) -> int:
    """Of Fix(R) with f^6(x) = x and 0 < p_1 < 1/32, by changes of sign of q(f^3)."""
    places = [(n + 0.5) / 3200 for n in range(100)]
    signs = [system.iterate_kernel(nu, [place], 3, float)[-1][0] > 0 for place in places]
    return sum(before != after for before, after in pairwise(signs))


@pytest.mark.parametrize("factor", [1, -1])
def test_the_side_of_a_tripling_is_where_the_new_points_are(factor: int) -> None:
    def shear(p: Sequence[Any]) -> Sequence[Any]:
        cube = p[0] * p[0] * p[0]
        return [cube if factor > 0 else -1.0 * cube if isinstance(cube, float) else cube.scaled(arb(-1))]

    system = ReversibleMap(Fraction(-1, 2), shear)
    with ctx.workprec(300):
        tables, integral = tables_of_maps(system, 3, WIDE, None)
        candidate = claim(description(1, False, symmetric_system=True), "period_tupling", 3, WIDE, symmetry="S")
        side = proof(verdict(candidate, tables, integral)).results.side
    found = {word: new_points(system, nu) for word, nu in (("above", 2.0**-13), ("below", -(2.0**-13)))}
    assert found == {side: 1, ({"above", "below"} - {side}).pop(): 0}
