"""Axial families from the planar to the vertical orbit at which they are born (sections 16.9 to 16.13)."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.balls import agree
from support.curve_cases import proof, refusal
from support.once import once
from support.stored import values

from orbitproof.shared import systems
from orbitproof.shared.claims.web import Meeting, Web, WebArc
from orbitproof.shared.formats import Atlas, BirthPiece, InputError, atlas_from_json, atlas_to_json, read_atlas
from orbitproof.shared.systems import BRANCH_SYSTEMS, CR3BP, CR3BP_AXIAL, HILL_VARIED, LIFTED
from orbitproof.verify.branches.curve_conclusion import follow, partner
from orbitproof.verify.claim import check_symmetries
from orbitproof.verify.curve import (
    CertifiedPoint,
    Conclusion,
    IntervalResult,
    PieceLimits,
    ProvedCurve,
    certified_systems,
    conclude,
    jacobi_constant,
    prove_birth_piece,
)
from orbitproof.verify.curve.birth_piece import even_part, read_birth
from orbitproof.verify.curve.equation import divided_by_wide
from orbitproof.verify.curve.lifted_family import _birth_at_end
from orbitproof.verify.curve.other_point import Crossing, meets_section_once
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits, is_of_doublings
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.evidence import Checklist, Evidence, NotProved, Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability.units import is_of_vertical_orbits
from orbitproof.verify.web import Arc, conclude_web
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.web import web_in_words

DATA = Path(__file__).resolve().parents[1] / "data"
ATLAS = read_atlas(DATA / "atlas-axial-family.json")
assert isinstance(ATLAS, Atlas)
FOLLOW, PARTNER = once(follow), once(partner)
RESULTS = tuple(values(json.loads((DATA / "results-axial-family.json").read_text())))
(BIRTH,) = ATLAS.birth_pieces()
SIGNS = (1, 1, -1, 1, 1, -1)


def ball(text: str) -> arb:
    return arb(f"{text} +/- 1e-22")


PLANAR = CertifiedPoint(
    "planar",
    "symmetry_breaking",
    1,
    reversor="axial",
    symmetry="S",
    signs=SIGNS,
    point={"x": ball("0.78157393766921286330620791"), "vy": ball("0.44319778622252200577479133"), "vz": arb(0)},
)
VERTICAL = CertifiedPoint(
    "vertical",
    "reversor_breaking",
    1,
    crossings=2,
    shifted_by=("S",),
    point={
        "x": ball("0.92228426972364336454839546"),
        "z": ball("0.24008636864568002196203586"),
        "vy": ball("-0.06530654733792410464543033"),
    },
    direction={"vx": ball("0.30324725783084851764104512"), "vz": ball("0.95291190601137298203588847")},
)


def concluded(
    *points: CertifiedPoint, atlas: Atlas = ATLAS, results: tuple[IntervalResult, ...] = RESULTS, watch: Any = FOLLOW
) -> Conclusion[ProvedCurve]:
    return conclude(atlas, results, points, PARTNER, watch)


def changed(**changes: Any) -> Atlas:
    return replace(ATLAS, pieces=(*ATLAS.curve_pieces(), replace(BIRTH, **changes)))


def test_the_field_is_that_of_the_three_body_problem() -> None:
    """At random states; at size 0 that of the planar problem, with the variation out of the plane."""
    source = random.Random("lifted")
    check_symmetries(Checklist(), LIFTED)
    with mpmath.workdps(40):
        for _ in range(5):
            mu, eps = (mpmath.mpf(source.uniform(0.01, 0.4)) for _ in range(2))
            x, y, z, vx, vy, vz = (mpmath.mpf(source.uniform(-2, 2)) for _ in range(6))
            found = LIFTED.vector_field((x, y, z, vx, vy, vz), (mu, eps**2))
            wanted = CR3BP.vector_field((x, y, eps * z, vx, vy, eps * vz), (mu,))
            scaled = [*wanted[:2], wanted[2] / eps, *wanted[3:5], wanted[5] / eps]
            assert all(abs(a - b) < 1e-30 for a, b in zip(found, scaled, strict=True))


def test_the_curve_goes_from_birth_to_birth() -> None:
    conclusion = concluded(PLANAR, VERTICAL)
    curve = proof(conclusion)
    assert curve.birth is not None
    assert not curve.birth.s.contains(0)
    at_plane, at_vertical = conclusion.bifurcations
    assert at_plane.place is not None
    assert at_plane.place.piece == "p001"
    assert at_vertical.place is not None
    assert at_vertical.place.piece == BIRTH.id
    words = conclusion_in_words(conclusion)
    assert "goes on, in piece birth" in words
    assert "at which the orbits of piece birth are born" in words
    assert certified_systems(LIFTED) == (CR3BP_AXIAL, CR3BP)


def test_its_planar_orbit_is_found_by_its_other_point_too() -> None:
    (crossing,) = follow(CR3BP_AXIAL, ATLAS.parameters, PLANAR.point, 1) or ()
    other = replace(PLANAR, point={name: crossing.state[name] for name in ("x", "vy")})
    assert not other.point["x"].overlaps(PLANAR.point["x"])
    (placed,) = concluded(other).bifurcations
    assert placed.place is not None, placed.reason


@pytest.mark.parametrize(
    ("point", "why"),
    [
        (replace(PLANAR, symmetry="T"), "no birth of axial orbits"),
        (replace(PLANAR, reversor=None), "no birth of axial orbits"),
        (replace(PLANAR, signs=(1, 1, 1, 1, 1, 1)), "no birth of axial orbits"),
        (replace(PLANAR, crossings=2), "no birth of axial orbits"),
        (replace(PLANAR, point={**PLANAR.point, "x": PLANAR.point["x"] + 1e-4}), "lies"),
        (replace(PLANAR, kind="period_tupling", k=2), "only orbits at which"),
        (replace(PLANAR, problem="it is of another mass", is_foreign=True), "another mass"),
        (replace(VERTICAL, shifted_by=()), "not shown that z -> -z"),
        (replace(VERTICAL, crossings=1), "do not meet the section twice"),
        (replace(VERTICAL, reversor="axial"), "do not meet the section twice"),
        (replace(VERTICAL, direction=None), "not shown that z -> -z"),
        (replace(VERTICAL, direction={"vx": arb(1), "vz": arb(1)}), "beside the tube"),
        (replace(VERTICAL, point={**VERTICAL.point, "z": VERTICAL.point["z"] + 1e-6}), "beside the tube"),
    ],
)  # fmt: skip
def test_certificates_of_other_points_are_not_on_it(point: CertifiedPoint, why: str) -> None:
    (entry,) = concluded(point).bifurcations
    assert entry.place is None
    assert why in entry.reason


def test_the_mirror_image_of_a_vertical_orbit_is_the_same_one() -> None:
    turned = [{name: -value if name in ("z", "vz") else value for name, value in each.items()} for each in (
        VERTICAL.point, VERTICAL.direction or {},
    )]  # fmt: skip
    (entry,) = concluded(replace(VERTICAL, point=turned[0], direction=turned[1])).bifurcations
    assert entry.place is not None
    assert entry.place.mirrored


def test_a_birth_whose_variation_is_not_shown_to_vanish_first_is_not_placed() -> None:
    def late(system: Any, parameters: Any, point: Any, crossings: int) -> Any:
        found = FOLLOW(system, parameters, point, crossings)
        is_planar = system is LIFTED and point["eps2"] == 0
        return [Crossing(each.state, each.time + 1) for each in found or ()] if is_planar else found

    (entry,) = concluded(PLANAR, watch=late).bifurcations
    assert entry.place is None
    assert "not shown to vanish first" in entry.reason


def test_a_curve_that_does_not_reach_the_piece_of_its_birth_is_refused() -> None:
    # It stops at its second piece.
    short = replace(ATLAS, pieces=(*ATLAS.curve_pieces()[:-1], BIRTH), claim=replace(ATLAS.claim, covers=replace(
        ATLAS.claim.covers, end=Fraction(1, 10)
    )))  # fmt: skip  # type: ignore[type-var]
    assert "birth: " in refusal(concluded(atlas=short))
    far = changed(
        polynomial=(BIRTH.polynomial[0], tuple(value * 2 for value in BIRTH.polynomial[1]), *BIRTH.polynomial[2:])
    )
    assert "beside the tube" in refusal(concluded(atlas=far))
    unproved = tuple(result for result in RESULTS if result.piece != BIRTH.id)
    assert "nothing is proved of it" in refusal(concluded(results=unproved))
    assert "not enclosed" in refusal(concluded(watch=lambda *of: None))


def test_all_orbits_that_may_be_at_its_end_are_followed() -> None:
    """Also where the end is known badly: eps2 up to 2^-10, the others in proportion."""
    asked: list[Any] = []

    def watch(system: Any, parameters: Any, point: Any, crossings: int) -> None:
        asked.append((system, point, crossings))

    deviation = Fraction(1, 2**12)
    curve = proof(concluded())
    last = curve.chain.stretches[-1]
    piece, size = last.tube.piece, LIFTED.centre_coordinates.index("eps2")
    frame = tuple((row[0], row[1] + (i == size), row[2]) for i, row in enumerate(piece.frame))
    run = replace(last.run, intervals=tuple(replace(part, deviation=(deviation,) * 2) for part in last.run.intervals))
    tube = Tube(replace(piece, tube=(2 * deviation,) * 2, frame=frame), (run,))
    chain = replace(curve.chain, stretches=(replace(last, tube=tube, run=run),))
    evidence = Evidence("birth")
    with ctx.workprec(128):
        assert _birth_at_end(evidence, ATLAS, chain, RESULTS, watch) is None
        end = dict(zip(LIFTED.centre_coordinates, tube.point(run, last.leaves), strict=True))
        (axial, start, twice), (lifted, point, once_only) = asked
        assert (axial, twice, lifted, once_only) == (CR3BP_AXIAL, 2, LIFTED, 1)
        assert all(point[name].contains(ball) for name, ball in end.items())
        assert end["eps2"].rad() > 0
        for side in (end["eps2"].lower(), end["eps2"].upper()):
            assert start["vz"].contains(side.sqrt().mid())
        assert all(start[name].contains(end[name]) for name in ("x", "vy"))


def test_a_second_crossing_at_another_time_is_refused() -> None:
    def late(system: Any, parameters: Any, point: Any, crossings: int) -> Any:
        found = FOLLOW(system, parameters, point, crossings)
        return found if crossings < 2 or found is None else [found[0], Crossing(found[1].state, found[1].time + 1)]

    assert "not shown to be on the axis again" in refusal(concluded(watch=late))


def test_the_curve_has_to_begin_in_the_plane() -> None:
    claim = ATLAS.claim
    assert claim.covers is not None
    for claimed in (
        replace(claim, increasing=()),
        replace(claim, covers=None),
        replace(claim, covers=replace(claim.covers, start=Fraction(1, 100))),
    ):
        assert "from-plane: " in refusal(concluded(atlas=replace(ATLAS, claim=claimed)))
    first, *_ = ATLAS.pieces
    twice = replace(ATLAS, pieces=(*ATLAS.pieces, replace(BIRTH, id="again")))
    for wrong in (twice, replace(ATLAS, pieces=(BIRTH, first))):
        assert "pieces: " in refusal(concluded(atlas=wrong))


def test_false_pieces_of_a_birth_are_refused_before_they_are_integrated() -> None:
    whole = (Fraction(-1), Fraction(1))
    odd = ((Fraction(1), Fraction(1)), *BIRTH.polynomial[1:])
    for piece, parameters, interval in (
        (replace(BIRTH, directions=((Fraction(1), Fraction(2)), (Fraction(2), Fraction(4)))), ATLAS.parameters, whole),
        (replace(BIRTH, polynomial=odd), ATLAS.parameters, whole),
        (replace(BIRTH, tube=(*BIRTH.tube[1:], Fraction(0))), ATLAS.parameters, whole),
        (replace(BIRTH, tube=BIRTH.tube[1:]), ATLAS.parameters, whole),
        (BIRTH, {}, whole),
        (BIRTH, ATLAS.parameters, (Fraction(-2), Fraction(1))),
    ):
        found = prove_birth_piece(LIFTED, parameters, piece, interval, ORACLE)
        assert isinstance(found.outcome, NotProved)
        assert found.outcome.reason.condition == "piece"


@pytest.mark.slow
def test_the_piece_of_a_birth_is_proved_and_a_false_one_is_not() -> None:
    interval = (Fraction(-1), Fraction(1))
    found = prove_birth_piece(LIFTED, ATLAS.parameters, BIRTH, interval, ORACLE)
    assert isinstance(found.outcome, Proved), found.outcome
    (stored,) = (result for result in RESULTS if result.piece == BIRTH.id)
    assert agree(found.outcome.results.time, stored.time)
    beside = replace(BIRTH, polynomial=((BIRTH.polynomial[0][0] + Fraction(1, 10**6),), *BIRTH.polynomial[1:]))
    assert isinstance(prove_birth_piece(LIFTED, ATLAS.parameters, beside, interval, ORACLE).outcome, NotProved)


@pytest.mark.slow
def test_a_piece_whose_ends_are_not_shown_to_differ_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orbitproof.verify.curve.birth_piece.range_of_odd", lambda function: arb(0, 1))
    outcome = prove_birth_piece(LIFTED, ATLAS.parameters, BIRTH, (Fraction(-1), Fraction(1)), ORACLE).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "side"


def test_results_on_intervals_that_are_not_symmetric_count_for_nothing() -> None:
    (result,) = (each for each in RESULTS if each.piece == BIRTH.id)
    half = replace(result, interval=(Fraction(0), Fraction(1)))
    assert isinstance(read_birth(BIRTH, [half]), str)
    assert not isinstance(read_birth(BIRTH, [half, result]), str)


def test_even_and_odd_part_are_those_of_polynomials() -> None:
    arithmetic = PieceLimits(64, 24, 8).arithmetic([Fraction(1, 8)])
    element = arithmetic.polynomial({(0,): [Fraction(n + 1) for n in range(6)], (1,): [Fraction(7), Fraction(8)]})
    for part, wanted in ((even_part(element), [1, 0, 3, 0, 5]), (divided_by_wide(element), [2, 0, 4, 0, 6])):
        assert [int(c) >> arithmetic.scales[0] for c in part.coefs[0].coeffs()] == wanted
        assert list(part.errors) == list(element.errors)


def test_an_orbit_meets_the_section_once_unless_the_span_is_long_or_it_may_be_along_it() -> None:
    state = {name: arb(0) for name in CR3BP.state} | {"x": arb("0.85"), "vy": arb("0.1"), "vz": arb("0.4")}
    mu = {"mu": arb("0.0121")}
    assert meets_section_once(CR3BP_AXIAL, mu, state, arb("0.01"))
    assert not meets_section_once(CR3BP_AXIAL, mu, state, arb("3"))
    assert not meets_section_once(CR3BP_AXIAL, mu, {**state, "vy": arb(0, 0.01)}, arb("0.01"))
    assert not meets_section_once(CR3BP_AXIAL, mu, state, arb("nan"))


def test_levels_and_periods_hold_those_of_the_orbits_of_both_births() -> None:
    with ctx.workprec(128):
        curve = proof(concluded())
        arc = Arc(ATLAS, curve)
        levels = arc.levels()
        for level in ("2.99179892953226506", "3.02139212923076323"):
            assert levels.contains(arb(level))
        # Of the vertical orbit, four quarters.
        assert arc.period.contains(arb("4.06518173918056464"))
        at_birth = jacobi_constant(LIFTED, ATLAS.parameters, VERTICAL.point)
        assert at_birth is not None
        assert agree(at_birth, arb("2.991798929532265 +/- 1e-12"))


def test_in_a_web_it_branches_off_at_both_and_in_no_other_way() -> None:
    conclusion = concluded(PLANAR, VERTICAL)
    arc = Arc(ATLAS, proof(conclusion), "", {entry.id: entry for entry in conclusion.bifurcations})

    def claim(how: Any) -> Web:
        return Web("a web", "a web", (WebArc(ATLAS.id, (Meeting("planar", how), Meeting("vertical", how))),))

    outcome = conclude_web(claim("branches off at"), [arc])
    assert isinstance(outcome, Proved), outcome
    words = web_in_words(outcome.theorem, outcome.results, {ATLAS.id: "d", "planar": "e", "vertical": "f"})  # type: ignore[arg-type]
    assert "from that vertical orbit, on piece birth" in words
    assert "from that planar orbit, on piece p001" in words
    for how in ("passes through", "ends at"):
        assert isinstance(conclude_web(claim(how), [arc]), NotProved)
    without = concluded(PLANAR, replace(VERTICAL, point={**VERTICAL.point, "x": arb("0.98")}))
    other = Arc(ATLAS, proof(without), "", {entry.id: entry for entry in without.bifurcations})
    assert isinstance(conclude_web(claim("branches off at"), [other]), NotProved)


def test_files_hold_such_a_piece_last_in_an_atlas_of_this_system_only() -> None:
    document = atlas_to_json(ATLAS)
    assert atlas_from_json(document, "file") == ATLAS
    *others, last = document["pieces"]
    for wrong in ({"pieces": [last, *others]}, {"pieces": [last]}, {"system": "cr3bp-l1-vertical"}):
        with pytest.raises(InputError, match="'birth' in a curve"):
            atlas_from_json({**document, **wrong}, "file")
    for field, value in (("directions", [["1", "2"], ["2", "4"]]), ("half_width", "0"), ("tube", ["1"] * 3)):
        with pytest.raises(InputError, match=field):
            atlas_from_json({**document, "pieces": [*others, {**last, field: value}]}, "file")
    assert isinstance(atlas_from_json(document, "file").pieces[-1], BirthPiece)


def test_what_points_of_a_system_stand_for_is_known_by_the_system_itself() -> None:
    told = {system.name: (is_of_axial_orbits(system), is_of_doublings(system), is_of_vertical_orbits(system))
            for system in BRANCH_SYSTEMS.values()}  # fmt: skip
    vertical = {system.name for system in systems.VERTICAL.values()}
    assert {name for name, (axial, _, _) in told.items() if axial} == {LIFTED.name}
    assert {name for name, (_, doublings, _) in told.items() if doublings} == {HILL_VARIED.name}
    assert {name for name, (_, _, upright) in told.items() if upright} == vertical
    assert not is_of_axial_orbits(replace(LIFTED))
    assert not is_of_doublings(replace(HILL_VARIED))
