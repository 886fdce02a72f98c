"""Periodic orbits and bifurcations with closed forms in coordinates without any symmetry: what is found is the same."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
from flint import acb, arb
from support import periodic_bifurcation_cases, periodic_cases, torus_cases
from support.balls import agree
from support.other_coordinates import dot, moved_by, shear

from orbitproof.shared.formats import PERIODIC_TORUS, InSection, PeriodicBifurcation, PeriodicOrbit
from orbitproof.verify.evidence import Checklist, Proved, enclose, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import check_periodic_exactly, enclose_periodic, prove_periodic
from orbitproof.verify.periodic_bifurcation import (
    check_bifurcation_exactly,
    check_torus_exactly,
    enclose_periodic_bifurcation,
    prove_periodic_bifurcation,
    prove_torus,
)
from orbitproof.verify.poincare import IntegratorSettings

BITS = 150
CLAIMS: dict[str, InSection] = {
    "cycle": periodic_cases.hopf(),
    "level": periodic_cases.oscillators(),
    "fold": periodic_bifurcation_cases.folding(2, -1),
    "level fold": periodic_bifurcation_cases.level_fold(),
    "fixed": periodic_bifurcation_cases.breaking(1, -1, 1, Fraction(1, 2)),
    "moved": periodic_bifurcation_cases.half_a_period(1, 1, 1, -2),
    "torus": torus_cases.round_claim(),
}


def results(claim: InSection) -> Any:
    settings, checklist = IntegratorSettings(BITS), Checklist()
    with guarded(BITS):
        if isinstance(claim, PeriodicOrbit):
            check_periodic_exactly(checklist, claim)
            outcome: Any = prove_periodic(claim, checklist, enclose_periodic(claim, settings, ORACLE))
        else:
            assert isinstance(claim, PeriodicBifurcation)
            is_torus = claim.kind == PERIODIC_TORUS
            (check_torus_exactly if is_torus else check_bifurcation_exactly)(checklist, claim)
            found = enclose_periodic_bifurcation(claim, settings, ORACLE)
            outcome = (prove_torus if is_torus else prove_periodic_bifurcation)(claim, checklist, found)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


@pytest.mark.parametrize("name", CLAIMS)
def test_what_is_found_does_not_depend_on_the_coordinates(name: str) -> None:
    claim = CLAIMS[name]
    matrix = shear(len(claim.centre), random.Random(name))
    moved = moved_by(claim, matrix)
    if isinstance(moved, PeriodicBifurcation) and moved.symmetry is not None:
        rows = moved.symmetry
        assert any(rows[i][j] != rows[j][i] for i in range(len(rows)) for j in range(i))
    here, there = results(claim), results(moved)
    with guarded(BITS):
        for each, row in zip(moved.system.state, matrix, strict=True):
            expected = dot([enclose(a) for a in row], [here.point[name] for name in claim.system.state])
            assert agree(there.point[each], expected)
            assert there.point[each].rad() < 1e-9
        for field, value in vars(here).items():
            other = getattr(there, field)
            if field in ("point", "multipliers"):
                continue
            if isinstance(value, (arb, acb)):
                assert agree(value, other), field
                assert other.abs_upper() - other.abs_lower() < 0.1
            else:
                assert value == other, field
        counts, others = here.multipliers, there.multipliers
        assert (counts.inside, counts.on, counts.outside, counts.trivial) == (
            others.inside, others.on, others.outside, others.trivial
        )  # fmt: skip
        assert all(any(agree(value, other) for other in others.values) for value in counts.values)
