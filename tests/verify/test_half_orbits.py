"""Half orbits that meet the section several times: the power of the map, counted, is part of what is proved."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.balls import agree
from support.closed_form_maps import claim, description, table, tables_of_maps, verdict
from support.map_cases import CASES, failed, proof
from support.stored import values

from orbitproof.explore.orbits import ShootingProblem
from orbitproof.shared.formats import (
    Atlas,
    Candidate,
    InputError,
    atlas_to_json,
    candidate_from_json,
    candidate_to_json,
    read_atlas,
    read_candidates,
)
from orbitproof.verify.attempt import Limits
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.certificate import Certificate, certify, recheck
from orbitproof.verify.curve import Chain, CurveTheorem, PieceLimits, ProvedCurve, prove_piece
from orbitproof.verify.evidence import Proved as PieceProved
from orbitproof.verify.functions import bounded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run.branch_tasks import reusable
from orbitproof.verify.second_proof import Proved, second_proof
from orbitproof.verify.stability import TubeOfOrbits, orbit_functions
from orbitproof.verify.words.curve import curve_in_words

DATA = Path(__file__).parents[1] / "data" / "known-crossings.json"

VALUES = {
    "michelson-family-k3-3": ("both", "0.584301704433260816"),
    "michelson-family-k2-3": ("above", "0.579430540053051315"),
}
"""Side and first digits of c, where half orbits meet the section twice."""


@cache
def claims() -> dict[str, Candidate]:
    return {candidate.id: candidate for candidate in read_candidates(DATA)}


@cache
def certified(name: str) -> Certificate:
    return certify(claims()[name], Limits(max_precision=512))


def refusal(candidate: Candidate) -> str:
    certificate = certify(candidate, Limits(max_precision=256))
    return "proved" if certificate.reason is None else certificate.reason.condition


@pytest.mark.parametrize("name", VALUES)
def test_a_bifurcation_of_orbits_that_meet_the_section_twice_in_half_a_period_is_proved(name: str) -> None:
    certificate = certified(name)
    side, digits = VALUES[name]
    assert certificate.proved, certificate.reason
    assert certificate.side == side
    assert certificate.parameter is not None
    with ctx.workprec(200):
        assert agree(certificate.parameter, arb(digits) + arb(0, "1e-17"))
    assert "half-orbit" in [hypothesis.name for hypothesis in certificate.hypotheses]
    assert "power P = (Poincare map)^2" in str(certificate.theorem)
    assert "P is its power 2" in certificate.statement["in_full"]
    assert recheck(certificate, integrate=True).findings == ()


@pytest.mark.slow
def test_a_second_proof_counts_the_crossings_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    entry = certified("michelson-family-k2-3").to_json()
    result = second_proof(entry)
    assert isinstance(result, Proved)
    assert result.side == "above"
    # What is true is proved with these bits; that the other claim is not proved with more takes two minutes.
    monkeypatch.setattr("orbitproof.verify.second_proof.proof.PRECISIONS", (result.bits,))
    del entry["statement"]["candidate"]["crossings"]
    assert not isinstance(second_proof(entry), Proved)


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("crossings, condition", [(1, "family"), (3, "half-orbit")])
def test_another_number_of_crossings_is_refused(name: str, crossings: int, condition: str) -> None:
    assert refusal(replace(claims()[name], crossings=crossings)) == condition


def test_a_multiple_of_the_number_of_crossings_is_refused_for_the_half_orbit_alone() -> None:
    quadrupling = claims()["michelson-family-k4-1"]
    assert refusal(quadrupling) == "proved"
    # P^2 has a period doubling where P has a quadrupling; but its half orbits end at the first crossing.
    assert refusal(replace(quadrupling, k=2, crossings=2)) == "half-orbit"


@pytest.mark.parametrize("name", ["k=2", "k=3", "k=4, n=2"])
def test_crossings_between_are_left_out_and_may_not_be_on_the_fixed_set(name: str) -> None:
    system, kind, k, radii = CASES[name]
    with ctx.workprec(300):
        iterates, _ = tables_of_maps(system, k, radii)
        away = table(lambda p, c: p[0] + c(F(1)), radii)
        touching = table(lambda p, c: p[0], radii)
        candidate = claim(description(len(radii) - 1, False), kind, k, radii, crossings=3)

        def with_between(first: Any, second: Any) -> Any:
            between = [[component] * (len(radii) - 1) for component in (first, second)]
            return verdict(candidate, [row for power in iterates for row in (*between, power)], None)

        assert "half-orbit" in [hypothesis.name for hypothesis in proof(with_between(away, away)).hypotheses]
        failed(with_between(away, touching), "half-orbit")
        failed(with_between(touching, away), "half-orbit")
        failed(verdict(candidate, iterates, None), "poincare-map")


@pytest.mark.parametrize("wrong", [0, -1, 101, "2", 1.5])
def test_what_is_no_number_of_crossings_is_bad_input(wrong: Any, tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    path.write_text(DATA.read_text().replace('"crossings": 2', f'"crossings": {wrong!r}'.replace("'", '"')))
    with pytest.raises(InputError, match="crossings"):
        read_candidates(path)


@cache
def arc() -> Atlas:
    return read_atlas(DATA.with_name("atlas-crossings.json"))


PART = (F(-1, 64), F(1, 64))
FEW = PieceLimits(80, 30, 16)


@pytest.mark.parametrize("crossings, condition", [(1, "newton"), (2, ""), (3, "half-orbit")])
def test_a_piece_is_proved_with_its_number_of_crossings_and_with_no_other(crossings: int, condition: str) -> None:
    atlas = arc()
    result = prove_piece(
        atlas.system, atlas.parameters, atlas.curve_pieces()[1], PART, ORACLE, FEW, symmetry=None, crossings=crossings
    )
    reason = "" if isinstance(result.outcome, PieceProved) else result.outcome.reason.condition
    assert reason == condition


def test_the_stability_of_a_piece_is_that_of_its_orbits() -> None:
    atlas, piece = arc(), arc().curve_pieces()[1]
    found = orbit_functions(TubeOfOrbits(atlas.system, {}, piece, PART, FEW, "physical", ORACLE, crossings=2))
    with ctx.workprec(120):
        (trace,) = (bounded(entry) for entry in found.characteristic)
        # Stability parameters of the family at the same c, in float64.
        problem = ShootingProblem(atlas.system, {})
        point = [float(value) for value in piece.point(F(0))]
        half_period = float(bounded(found.half_period).value(arb(0)).mid())
        orbit = problem.orbit(problem.correct(np.array([*point, half_period]), np.array([1.0, 0.0, 0.0])))
        assert abs(float(trace.value(arb(0)).mid()) - orbit.stability[0].real) < 1e-6


def test_the_theorem_about_a_curve_names_the_crossings_and_only_where_there_are_several() -> None:
    twice, ends = arc(), {end: {"c": arb(1), "y": arb(0)} for end in ("start", "end")}
    curve = ProvedCurve(Chain((), ()), ends, arb(6))
    assert "P = Q^2" in curve_in_words(CurveTheorem(twice), curve)
    assert "meet the section 2 times" in curve_in_words(CurveTheorem(twice), curve)
    once = replace(twice, claim=replace(twice.claim, crossings=1))
    assert "times" not in curve_in_words(CurveTheorem(once), curve)
    assert "crossings" not in atlas_to_json(once)["claim"]


def test_no_result_of_another_number_of_crossings_is_used_again() -> None:
    atlas = arc()
    result = {
        "piece": atlas.pieces[0].id,
        "interval": ["-0x1", "0x1"],
        "verdict": "proved",
        "computation": {"seconds": 1},
    }
    document = make_atlas_certificate(atlas, values([result]), None)
    before = Certificate(document)
    assert reusable(before, atlas, ()) == values([result])
    assert reusable(before, replace(atlas, claim=replace(atlas.claim, crossings=1)), ()) == []


@pytest.mark.parametrize("name", ["surface.json", "atlas-lyapunov.json"])
def test_several_crossings_are_not_claimed_where_there_is_no_theorem_about_them(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(DATA.with_name(name).read_text().replace('"claim": {', '"claim": {"crossings": 2, ', 1))
    with pytest.raises(InputError, match=r"claim\.crossings"):
        read_atlas(path)


def test_one_crossing_is_the_default_and_is_not_written() -> None:
    once = claims()["michelson-family-k4-1"]
    assert "crossings" not in candidate_to_json(once)
    again = candidate_from_json({**candidate_to_json(once), "crossings": 1}, "claim")
    assert candidate_to_json(again) == candidate_to_json(once)
    twice = claims()["michelson-family-k2-3"]
    assert candidate_from_json(candidate_to_json(twice), "claim").crossings == 2
