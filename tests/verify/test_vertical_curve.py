"""A piece of the vertical family of L2: half orbits that meet the section twice, proved as a curve."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from support.conclusions import conclude
from support.stored import entry_of

from orbitproof.shared.formats import read_atlas, read_candidates
from orbitproof.verify.certificate import Limits, certify
from orbitproof.verify.curve import prove_piece
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.words.branches import conclusion_in_words

ATLAS = Path(__file__).parents[1] / "data" / "atlas-vertical.json"
WHOLE = (Fraction(-1), Fraction(1))


@pytest.mark.slow
def test_an_arc_of_the_vertical_family_is_one_curve_and_none_with_another_number_of_crossings() -> None:
    atlas = read_atlas(ATLAS)
    (piece,) = atlas.curve_pieces()
    assert atlas.claim.crossings == 2
    found = prove_piece(atlas.system, atlas.parameters, piece, WHOLE, ORACLE, crossings=2)
    results = [json.loads(json.dumps(entry_of(found)))]
    conclusion = conclude(atlas, results)
    assert conclusion.is_proved
    assert "z takes all values from 0.1 to 0.12" in conclusion_in_words(conclusion)
    assert "the half orbits from Fix(R) to Fix(R) meet the section 2 times" in conclusion_in_words(conclusion)
    # One certified orbit lies on it; a certificate that counts crossings differently says nothing of it.
    certificate = certify(read_candidates(ATLAS.with_name("orbit-vertical.json"))[0], Limits(digits=12))
    (entry,) = conclude(atlas, results, [certificate]).bifurcations
    assert entry.place is not None
    assert entry.place.piece == "p001"
    other = replace(atlas, claim=replace(atlas.claim, crossings=1))
    (elsewhere,) = conclude(other, [], [certificate]).bifurcations
    assert elsewhere.reason.startswith("its half orbits meet the section 2 times")
    once = prove_piece(atlas.system, atlas.parameters, piece, WHOLE, ORACLE)
    assert not once.is_proved
    beside = replace(piece, centre=(piece.centre[0] + Fraction(1, 10**6), *piece.centre[1:]))
    assert not prove_piece(atlas.system, atlas.parameters, beside, WHOLE, ORACLE, crossings=2).is_proved
