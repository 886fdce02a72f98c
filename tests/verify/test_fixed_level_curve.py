"""Curves of orbits on a fixed level of a first integral: proved on that level and sheet, and on no other."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.balls import agree
from support.conclusions import conclude
from support.curve_cases import refusal
from support.stored import entry_of, values

from orbitproof.explore.orbits import ShootingProblem
from orbitproof.explore.refinement import refine
from orbitproof.shared.formats import (
    SURFACE,
    Atlas,
    Candidate,
    InputError,
    atlas_from_json,
    read_atlas,
)
from orbitproof.shared.systems import FixedLevel, ReversibleSystem, completed
from orbitproof.verify.__main__ import main
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, write_certificates
from orbitproof.verify.curve import (
    CertifiedPoint,
    PieceLimits,
    PieceResult,
    ProvedInterval,
    enclose_other_point,
    prove_piece,
)
from orbitproof.verify.curve import conclude as conclude_of_points
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, orbit_functions
from orbitproof.verify.words.branches import conclusion_in_words

FILE = Path(__file__).parents[1] / "data" / "atlas-fixed-level.json"
WHOLE = (F(-1), F(1))


@cache
def atlas() -> Atlas:
    return read_atlas(FILE)


def prove(system: ReversibleSystem) -> PieceResult[ProvedInterval]:
    (piece,) = atlas().curve_pieces()
    return prove_piece(system, {}, piece, WHOLE, ORACLE)


@cache
def results() -> list[Any]:
    return [entry_of(prove(atlas().system))]


@cache
def claimed() -> Candidate:
    guess = [1.909118763, -0.2369648123]
    return refine(atlas().system, {}, "period_tupling", 4, guess, digits=40).to_candidate("quadrupling", {})


@cache
def certificate() -> Certificate:
    return certify(claimed(), Limits(max_precision=512))


def on(level: FixedLevel) -> ReversibleSystem:
    return replace(atlas().system, fixed_level=level)


def test_the_curve_is_proved_with_its_bifurcation_and_says_on_which_level() -> None:
    conclusion = conclude(atlas(), results(), [certificate()])
    assert conclusion.is_proved
    words = conclusion_in_words(conclusion)
    assert "All orbits are on the level H = 0, and the points of the curve have u2 > 0." in words
    assert "Along it P_parameter takes all values from 1.86 to 1.92." in words
    assert [entry.place is not None for entry in conclusion.bifurcations] == [True]


def test_the_curve_contains_orbits_that_are_found_otherwise() -> None:
    (piece,) = atlas().curve_pieces()
    found = prove(atlas().system)
    assert isinstance(found.outcome, Proved)
    problem = ShootingProblem(atlas().system, {})
    along = np.array([1.0, 0.0, 0.0])
    for s in (F(-9, 10), F(0), F(7, 10)):
        parameter, place = (float(value) for value in piece.point(s))
        orbit = problem.correct(np.array([parameter, place + 1e-3, 4.0]), along)
        bound = float(found.outcome.results.deviation[0]) + 1e-11
        assert abs(orbit.unknowns[0] - parameter) < 1e-13
        assert abs(orbit.unknowns[1] - place) < bound


@pytest.mark.parametrize(
    "level", [FixedLevel(F(1, 10**7), 1), FixedLevel(F(0), -1), FixedLevel(F(1, 2), 1)], ids=["near", "sheet", "none"]
)
def test_it_is_no_curve_of_another_level(level: FixedLevel) -> None:
    found = prove(on(level))
    assert isinstance(found.outcome, NotProved)
    assert found.outcome.hypotheses[0].holds


def between(low: F, high: F) -> FixedLevel:
    return FixedLevel(F(0), between=(low, high))


def ends() -> list[float]:
    """u2 at both ends of the piece."""
    (piece,) = atlas().curve_pieces()
    points = (list(map(float, piece.point(s))) for s in WHOLE)
    return sorted(completed(atlas().system, [u, 0.0, 0.0, 0.0], [p])[2] for p, u in points)


def test_with_an_interval_for_the_sign_it_is_the_same_curve() -> None:
    low, high = ends()
    assert 0 < low < high
    found = prove(on(between(F(low) / 2, F(high) + 1)))
    assert isinstance(found.outcome, Proved), found.outcome
    assert isinstance(prove(on(between(F(low) - F(1, 50), F(high) + F(1, 50)))).outcome, Proved)


@pytest.mark.parametrize("case", ["both sheets", "too high", "left below", "left above", "the other sheet"])
def test_an_interval_has_to_hold_the_whole_curve_and_no_other_sheet(case: str) -> None:
    low, high = map(F, ends())
    middle = (low + high) / 2
    intervals = {
        "both sheets": (-high - 1, high + 1),
        "too high": (high + F(1, 100), high + 2),
        "left below": (middle, high + 1),
        "left above": (low / 2, middle),
        "the other sheet": (-high - 1, -low / 2),
    }
    found = prove(on(between(*intervals[case])))
    assert isinstance(found.outcome, NotProved)
    if case != "the other sheet":
        assert found.outcome.reason.condition == "level"


def test_without_a_quadratic_coordinate_there_are_no_points() -> None:
    system = atlas().system
    assert system.first_integral is not None
    found = prove(replace(system, first_integral=lambda x, p: (system.first_integral(x, p)[0] + x[2],)))  # type: ignore[misc]
    assert isinstance(found.outcome, NotProved)
    assert found.outcome.reason.condition == "piece"
    assert "u2^2" in found.outcome.reason.message


def test_a_symmetry_that_leaves_the_sheet_is_refused() -> None:
    (piece,) = atlas().curve_pieces()
    system = replace(atlas().system, symmetries={"T": (-1, -1, -1, -1)})
    assert system.level_coordinate is not None
    symmetric = replace(piece, kind="symmetric", centre=(piece.centre[0], F(0)), frame=((F(0), F(1)), (F(1), F(0))))
    found = prove_piece(system, {}, symmetric, WHOLE, ORACLE, symmetry="T")
    assert isinstance(found.outcome, NotProved)
    assert "T does not fix u2" in found.outcome.reason.message


def test_an_integral_that_is_not_conserved_gives_no_theorem() -> None:
    wrong = replace(atlas().system, first_integral=lambda x, p: (x[0] * x[0] - x[2] * x[2],))
    assert refusal(conclude(replace(atlas(), system=wrong), results())).startswith("symmetries")


def test_a_certificate_of_another_level_is_not_placed() -> None:
    for level in (FixedLevel(F(1, 10**40), 1), FixedLevel(F(0), -1)):
        other = replace(atlas(), system=on(level))
        (placed,) = conclude(other, results(), [certificate()]).bifurcations
        assert placed.place is None
        assert placed.is_foreign
        assert "another level" in placed.reason


@pytest.mark.parametrize("change", [{"section": "u3"}, {"reversing_symmetry": (-1, -1, 1, 1)}], ids=list)
def test_a_certificate_of_another_section_or_symmetry_is_not_placed(change: dict[str, Any]) -> None:
    other = replace(atlas(), system=replace(atlas().system, **change))
    (placed,) = conclude(other, results(), [certificate()]).bifurcations
    assert placed.place is None
    assert placed.is_foreign
    assert "another section" in placed.reason


def test_the_other_point_of_an_orbit_counts_on_its_sheet_only() -> None:
    """Half a period later u is at its maximum, where u2 < 0: with the level as parameter that is the other point."""
    system, point = atlas().system, certificate().point
    assert enclose_other_point(ORACLE, system, {}, point) is None
    free = replace(system, family_parameter=None, fixed_level=None)
    with ctx.workprec(200):
        u = point["u"]
        start = {"u": u, "u2": (u * u - 2 * u**3 / 3).sqrt() + arb(0, "1e-20")}
        found = enclose_other_point(ORACLE, free, {"P": claimed().centre[0]}, start)
    assert found is not None
    assert found["u2"] < 0


def test_the_other_point_of_a_certified_orbit_counts_on_its_sheet_only() -> None:
    """A certificate says no more of P(x) than its other coordinates, which points of both sheets have in common."""
    there = dict(certificate().point)
    away = {**there, "u": there["u"] + 1}
    point = CertifiedPoint("orbit", "orbit", 1, point=away, other_point=there)
    (placed,) = conclude_of_points(atlas(), values(results()), [point]).bifurcations
    assert placed.place is None
    (placed,) = conclude_of_points(atlas(), values(results()), [point], lambda *_: there).bifurcations
    assert placed.place is not None
    assert placed.place.other_point


def tube(system: ReversibleSystem) -> TubeOfOrbits:
    (piece,) = atlas().curve_pieces()
    return TubeOfOrbits(system, {}, piece, WHOLE, PieceLimits(), "physical", ORACLE)


def test_the_stability_of_orbits_found_otherwise_is_enclosed_across_two_sheets() -> None:
    """Half a period later w has the other sign: the second half begins on the other sheet."""
    (piece,) = atlas().curve_pieces()
    functions = orbit_functions(tube(atlas().system)).stored
    problem = ShootingProblem(atlas().system, {})
    for tau in (-0.9, 0.0, 0.6):
        s = F(tau) * F(33, 32)
        parameter, place = (float(value) for value in piece.point(s))
        orbit = problem.orbit(problem.correct(np.array([parameter, place, 4.0]), np.array([1.0, 0.0, 0.0])))
        (stability,) = orbit.stability
        assert abs(float(functions.characteristic[0].enclosed.value(arb(tau)).mid()) - stability) < 1e-8
        assert abs(float(functions.level.enclosed.value(arb(tau)).mid()) - parameter) < 1e-12


def test_the_stability_is_enclosed_where_both_sheets_are_intervals() -> None:
    low, high = map(F, ends())
    by_sign = orbit_functions(tube(atlas().system)).stored.characteristic[0].enclosed
    by_interval = orbit_functions(tube(on(between(low / 2, high + 1)))).stored.characteristic[0].enclosed
    for tau in ("-0.9", "0.1", "0.7"):
        one, other = by_sign.value(arb(tau)), by_interval.value(arb(tau))
        assert agree(one, other)
        assert max(one.rad(), other.rad()) < 1e-6


@pytest.mark.slow
def test_the_list_of_resonances_on_a_level_has_the_certified_one(tmp_path: Path) -> None:
    target, rows = tmp_path / "certificate.json", tmp_path / "rows.json"
    write_certificates(rows, [certificate()])
    words = ["atlas", str(FILE), "--complete", "4", "--bifurcations", str(rows), "-o", str(target), "--quiet"]
    assert main(words) == 0
    listed = json.loads(target.read_text())["conclusion"]["complete"]
    assert [(entry["k"], entry["certificates"]) for entry in listed["points"]] == [(3, []), (4, ["quadrupling"])]
    assert listed["gaps"] == []
    assert main(["atlas", "--recheck", str(target), "--quiet"]) == 0


def test_surfaces_are_refused() -> None:
    entry = json.loads(FILE.read_text())
    entry["claim"] = {"kind": SURFACE}
    del entry["parameters"]
    with pytest.raises(InputError, match="surfaces on a fixed level"):
        atlas_from_json(entry, "atlas")
