"""Families of doubled period from the orbit at which they are born (section 16.14)."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.curve_cases import proof, refusal
from support.once import once
from support.stored import values

from orbitproof.shared.claims.web import Meeting, Web, WebArc
from orbitproof.shared.formats import ArgumentError, Atlas, InputError, atlas_from_json, atlas_to_json, read_atlas
from orbitproof.shared.systems import CR3BP, CR3BP_PLANAR, HILL_VARIED, LIFTED
from orbitproof.verify.branches.conclusion import conclusion_of
from orbitproof.verify.branches.curve_conclusion import follow, partner
from orbitproof.verify.curve import (
    CertifiedPoint,
    Conclusion,
    IntervalResult,
    PieceLimits,
    ProvedCurve,
    birth_piece,
    conclude,
    prove_birth_piece,
)
from orbitproof.verify.curve.equation import Equation
from orbitproof.verify.curve.other_point import Crossing
from orbitproof.verify.evidence import NotProved, Outcome, Proved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run.branches import limits_of
from orbitproof.verify.web import Arc, ProvedWeb, conclude_web, level_at
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.web import web_in_words

DATA = Path(__file__).resolve().parents[1] / "data"
ATLAS = read_atlas(DATA / "atlas-butterfly.json")
assert isinstance(ATLAS, Atlas)
FOLLOW, PARTNER = once(follow), once(partner)
RESULTS = tuple(values(json.loads((DATA / "results-butterfly.json").read_text())))
(BIRTH,) = ATLAS.birth_pieces()
# Halo orbits about that doubling, a piece of the L2 arc.
HALO = read_atlas(DATA / "atlas-halo-doubling.json")
assert isinstance(HALO, Atlas)
HALO_RESULTS = tuple(values(json.loads((DATA / "results-halo-doubling.json").read_text())))
WHOLE = (Fraction(-1), Fraction(1))


def ball(text: str) -> arb:
    with ctx.workprec(256):
        return arb(f"{text} +/- 1e-30")


DOUBLING = CertifiedPoint(
    "doubling",
    "period_tupling",
    2,
    parameters=ATLAS.parameters,
    point={
        "x": ball("1.011828910825970876794883963275550995834"),
        "z": ball("-0.1739136939779881097941602389760336581148"),
        "vy": ball("-0.07993101486005905057552844934789991244051"),
    },
)

# Those of Sun and Jupiter begin at 0.0008 from Jupiter.
JUPITER = read_atlas(DATA / "atlas-butterfly-sun-jupiter.json")
assert isinstance(JUPITER, Atlas)
JUPITER_RESULTS = tuple(values(json.loads((DATA / "results-butterfly-sun-jupiter.json").read_text())))
JUPITER_DOUBLING = replace(
    DOUBLING,
    id="doubling of Sun and Jupiter",
    parameters=JUPITER.parameters,
    point={
        "x": ball("1.00571101174249593973721019228699925625931066"),
        "z": ball("-0.0744659981651813693366464914301226723489128495"),
        "vy": ball("-0.0214944681948206141978281811238096072731743768"),
    },
)


def concluded(
    *points: CertifiedPoint, atlas: Atlas = ATLAS, results: tuple[IntervalResult, ...] = RESULTS, watch: Any = FOLLOW
) -> Conclusion[ProvedCurve]:
    return conclude(atlas, results, points, PARTNER, watch)


def changed(**changes: Any) -> Atlas:
    return replace(ATLAS, pieces=(*ATLAS.curve_pieces(), replace(BIRTH, **changes)))


@pytest.mark.slow
def test_the_curve_goes_to_the_doubling_at_which_its_orbits_are_born() -> None:
    conclusion = concluded(DOUBLING)
    curve = proof(conclusion)
    assert curve.birth is not None
    assert not curve.birth.s.contains(0)
    (entry,) = conclusion.bifurcations
    assert entry.place is not None, entry.reason
    assert (entry.place.piece, entry.place.s) == (BIRTH.id, 0)
    words = conclusion_in_words(conclusion)
    # Half periods are said of the points of the curve alone.
    assert words.index("All half periods lie in") < words.index("From one of its orbits the curve of orbits goes on")
    assert "goes on, in piece birth, to an R-symmetric periodic orbit whose half orbits meet the section once" in words
    assert "doubling: period 2-tupling, at which the orbits of piece birth are born" in words


@pytest.mark.slow
def test_that_of_sun_and_jupiter_goes_to_its_doubling_too() -> None:
    conclusion = concluded(JUPITER_DOUBLING, DOUBLING, atlas=JUPITER, results=JUPITER_RESULTS)
    assert proof(conclusion).birth is not None
    own, other = conclusion.bifurcations
    assert own.place is not None, own.reason
    assert (own.place.piece, own.place.s) == ("birth", 0)
    assert other.place is None


@pytest.mark.parametrize(
    ("point", "why"),
    [
        (replace(DOUBLING, k=4), "only period doublings"),
        (replace(DOUBLING, crossings=3), "only period doublings"),
        (replace(DOUBLING, kind="touch_and_go", k=3), "only period doublings"),
        (replace(DOUBLING, kind="symmetry_breaking", k=1), "half orbits meet the section 1 times"),
        (replace(DOUBLING, point={**DOUBLING.point, "x": DOUBLING.point["x"] + 1e-9}), "beside the tube"),
        (replace(DOUBLING, point={"x": DOUBLING.point["x"]}), "does not have all coordinates"),
        (replace(DOUBLING, problem="it is of another mass", is_foreign=True), "another mass"),
    ],
)  # fmt: skip
def test_certificates_of_other_points_are_not_at_its_birth(point: CertifiedPoint, why: str) -> None:
    (entry,) = concluded(point).bifurcations
    assert entry.place is None
    assert why in entry.reason


def test_a_doubling_in_another_direction_is_not_its_birth() -> None:
    """The orbit is the same one, but its new orbits leave it differently."""

    def turned(system: Any, parameters: Any, point: Any, crossings: int) -> Any:
        found = FOLLOW(system, parameters, point, crossings)
        if system is not HILL_VARIED or found is None:
            return found
        return [Crossing({**each.state, "dvzeta": each.state["dvzeta"] * 1.001}, each.time) for each in found]

    (entry,) = concluded(DOUBLING, watch=turned).bifurcations
    assert entry.place is None


def test_a_curve_that_does_not_reach_the_piece_of_its_birth_is_refused() -> None:
    further = tuple(
        tuple(value + (Fraction(1, 10**6) if not n else 0) for n, value in enumerate(row)) for row in BIRTH.polynomial
    )
    assert "lies beyond the ends of all pieces" in refusal(concluded(atlas=changed(polynomial=further)))
    unproved = tuple(result for result in RESULTS if result.piece != BIRTH.id)
    assert "nothing is proved of it" in refusal(concluded(results=unproved))
    assert "not enclosed" in refusal(concluded(watch=lambda *of: None))
    (own,) = (result for result in RESULTS if result.piece == BIRTH.id)
    one_sided = replace(own, interval=(Fraction(0), Fraction(1)))
    assert "nothing is proved of it" in refusal(concluded(results=(*unproved, one_sided)))
    short = replace(own, interval=(-Fraction(1, 2), Fraction(1, 2)))
    assert "does not reach it" in refusal(concluded(results=(*unproved, short)))


def test_a_curve_with_a_false_piece_of_its_birth_is_refused_whatever_results_say() -> None:
    first, *others = BIRTH.polynomial
    for wrong in (
        {"polynomial": ((*first, *[Fraction(0)] * (len(first) % 2 == 0), Fraction(1, 10**25)), *others)},
        {"directions": ((Fraction(1), Fraction(2)), (Fraction(2), Fraction(4)))},
        {"directions": BIRTH.directions[:1]},
        {"half_width": -BIRTH.half_width},
        {"tube": (*BIRTH.tube[1:], Fraction(0))},
    ):
        conclusion = concluded(atlas=changed(**wrong))
        assert isinstance(conclusion.outcome, NotProved)
        assert conclusion.outcome.reason.condition == "pieces"


def test_only_arcs_of_half_orbits_with_two_crossings_take_such_a_piece() -> None:
    claim = ATLAS.claim
    first, *_ = ATLAS.pieces
    for wrong in (
        replace(ATLAS, claim=replace(claim, crossings=1)),
        replace(ATLAS, claim=replace(claim, kind="loop"), pieces=(first, *ATLAS.pieces)),
        replace(ATLAS, pieces=(*ATLAS.pieces, replace(BIRTH, id="again"))),
        replace(ATLAS, pieces=(BIRTH, *ATLAS.curve_pieces())),
    ):
        assert "pieces: " in refusal(concluded(atlas=wrong))
    document = atlas_to_json(ATLAS)
    assert atlas_from_json(document, "file") == ATLAS
    for wrong_claim in ({**document["claim"], "crossings": 3}, {**document["claim"], "kind": "loop"}):
        with pytest.raises(InputError, match="'birth' in a curve"):
            atlas_from_json({**document, "claim": wrong_claim}, "file")


def test_no_list_is_made_of_it() -> None:
    with pytest.raises(ArgumentError, match="piece of a birth"):
        limits_of(ATLAS, complete=4)
    found = conclusion_of(ATLAS, RESULTS, [], lambda entries: [], 4)
    assert found["verdict"] == "proved"
    assert "complete" not in found


def test_false_pieces_are_refused_before_they_are_integrated() -> None:
    odd = ((Fraction(1), Fraction(1)), *BIRTH.polynomial[1:])
    for piece in (replace(BIRTH, polynomial=odd), replace(BIRTH, tube=BIRTH.tube[1:])):
        outcome = prove_birth_piece(CR3BP, ATLAS.parameters, piece, WHOLE, ORACLE).outcome
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition == "piece"
    with pytest.raises(ValueError, match="no births"):
        prove_birth_piece(CR3BP_PLANAR, ATLAS.parameters, BIRTH, WHOLE, ORACLE)


def test_levels_and_periods_hold_those_of_the_doubling() -> None:
    with ctx.workprec(128):
        arc = Arc(ATLAS, proof(concluded()))
        assert arc.levels().contains(arb("3.058022175989393155490"))
        # Twice its period.
        assert arc.period.contains(arb("2.748655"))


def test_in_a_web_it_branches_off_there_and_in_no_other_way() -> None:
    conclusion = concluded(DOUBLING)
    arc = Arc(ATLAS, proof(conclusion), "", {entry.id: entry for entry in conclusion.bifurcations})

    def claim(how: Any) -> Web:
        return Web("a web", "a web", (WebArc(ATLAS.id, (Meeting("doubling", how),)),))

    outcome = conclude_web(claim("branches off at"), [arc])
    assert isinstance(outcome, Proved), outcome
    assert outcome.results.switches == ()
    words = web_in_words(outcome.theorem, outcome.results, {ATLAS.id: "d", "doubling": "e"})  # type: ignore[arg-type]
    assert "its orbits, of about twice the period, are born" in words
    assert "; a period in [" in words
    for how in ("passes through", "ends at"):
        assert isinstance(conclude_web(claim(how), [arc]), NotProved)


def arc_of(conclusion: Conclusion[ProvedCurve], atlas: Atlas) -> Arc:
    return Arc(atlas, proof(conclusion), "", {entry.id: entry for entry in conclusion.bifurcations})


def joined(along: Arc, onto: Arc, *ways: str) -> Outcome[ProvedWeb]:
    """That both arcs meet the doubling in these ways."""
    both = (along, onto)
    met = (
        WebArc(arc.id, (Meeting("doubling", how),))  # type: ignore[arg-type]
        for arc, how in zip(both, ways or ("passes through", "branches off at"), strict=True)
    )
    return conclude_web(Web("a web", "a web", tuple(met)), both)


def halo(point: CertifiedPoint = DOUBLING) -> Arc:
    """The halo orbits about the doubling."""
    return arc_of(concluded(point, atlas=HALO, results=HALO_RESULTS), HALO)


@cache
def arcs() -> tuple[Arc, Arc]:
    """Both arcs, the halo orbits first."""
    return halo(), arc_of(concluded(DOUBLING), ATLAS)


def test_the_halo_orbits_pass_through_it_and_hang_together_with_those_that_are_born() -> None:
    along, onto = arcs()
    outcome = joined(along, onto)
    assert isinstance(outcome, Proved), outcome
    web = outcome.results
    assert web.parts == ((HALO.id, ATLAS.id),)
    assert web.switches == ()
    (vertex,) = web.vertices
    assert (vertex.kind, vertex.k) == ("period_tupling", 2)
    assert agree(vertex.level, ball("3.05802217598939315549016929377664"))
    place, birth = (entry.place for entry in web.incidences)
    assert place is not None
    assert birth is not None
    # The halo curve has the other point of the orbit.
    assert place.other_point
    assert birth.piece == BIRTH.id
    words = web_in_words(outcome.theorem, web, {HALO.id: "c", ATLAS.id: "d", "doubling": "e"})  # type: ignore[arg-type]
    assert "passes through doubling: the other point of the orbit, on piece p008" in words
    assert "branches off at doubling: from that orbit, on piece birth, its orbits, of about twice the period" in words
    assert "doubling: period tupling of order 2, Jacobi constant in [3.05802217598939" in words


def test_arcs_that_do_not_both_meet_it_as_they_do_are_refused() -> None:
    along, onto = arcs()
    born = replace(DOUBLING, kind="symmetry_breaking", k=1, symmetry="S", signs=(1, 1, -1, 1, 1, -1))
    heavier = replace(DOUBLING, problem="it is of another mass", is_foreign=True)
    claim = replace(ATLAS.claim, increasing=("x",))
    before = replace(ATLAS, claim=claim, pieces=ATLAS.curve_pieces())
    of_it = tuple(result for result in RESULTS if result.piece != BIRTH.id)
    entry = along.placed["doubling"]
    assert entry.place is not None
    at_end = replace(along, placed={"doubling": replace(entry, place=replace(entry.place, s=arb(1)))})
    for other, why in (
        (joined(onto, along), "it branches off"),
        (joined(along, onto, "branches off at", "branches off at"), "no symmetric point of it"),
        (joined(along, onto, "passes through", "passes through"), "it branches off"),
        (joined(along, arc_of(concluded(born), ATLAS)), "half orbits meet the section 1 times"),
        (joined(halo(heavier), onto), "another mass"),
        (joined(along, arc_of(concluded(DOUBLING, atlas=before, results=of_it), before)), "those of the curve 2"),
        (joined(at_end, onto), "before the end of the arc"),
    ):
        assert isinstance(other, NotProved)
        assert other.reason.condition == "meetings"
        assert why in other.reason.message


def test_states_of_a_birth_hold_the_deviation_and_nothing_lies_beyond_what_is_proved() -> None:
    birth = proof(concluded()).birth
    assert birth is not None
    tube = birth.tube
    with ctx.workprec(256):
        at = tube.states(arb(0))
        for name, row, bound in zip(("x", "z", "vy"), BIRTH.polynomial, tube.proved.deviation, strict=False):
            middle = arb(row[0].numerator) / row[0].denominator
            assert at[name].contains(middle + arb(bound.numerator) / bound.denominator)
            assert at[name].contains(middle - arb(bound.numerator) / bound.denominator)
        place = [at["x"], at["z"], at["vy"], arb(BIRTH.polynomial[3][0].numerator) / BIRTH.polynomial[3][0].denominator]
        assert tube.contains(arb(0), place)
        short = replace(tube, proved=replace(tube.proved, start=-Fraction(1, 10**9), end=Fraction(1, 10**9)))
        assert short.contains(arb(0), place)
        assert not short.contains(arb("1e-8"), place)


def test_levels_and_periods_are_of_the_orbits_of_its_birth_too() -> None:
    curve = proof(concluded())
    assert curve.birth is not None
    tube = curve.birth.tube
    (first, *rest), *others = BIRTH.polynomial
    away = replace(BIRTH, polynomial=((first + 1, *rest), *others))
    other = replace(tube, piece=away, proved=replace(tube.proved, time=arb(5)))
    with ctx.workprec(128):
        arc = Arc(ATLAS, replace(curve, birth=replace(curve.birth, tube=other)))
        assert arc.period.contains(20)
        assert arc.levels().contains(level_at(ATLAS, other.states(arb(0))))
        assert not Arc(ATLAS, curve).levels().overlaps(level_at(ATLAS, other.states(arb(0))))


def test_what_r_negates_vanishes_at_the_ends_of_its_orbits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of axial orbits what the half turn negates."""
    asked: list[Any] = []

    def newton(checklist: Any, equations: Any, *rest: Any, **more: Any) -> Any:
        asked.append(equations)
        raise ArithmeticError

    half = SimpleNamespace(state=CR3BP.state, time_of_all=arb(1))
    monkeypatch.setattr(birth_piece, "HalfReturn", SimpleNamespace(of=lambda *rest, **more: half))
    monkeypatch.setattr(birth_piece, "even_part", lambda name: ("even", name))
    monkeypatch.setattr(birth_piece, "divided_by_wide", lambda name: ("odd", name))
    monkeypatch.setattr(birth_piece, "check_newton", newton)
    for system, names in ((CR3BP, ("vx", "vz")), (LIFTED, ("z", "vx"))):
        assert isinstance(prove_birth_piece(system, ATLAS.parameters, BIRTH, WHOLE, ORACLE).outcome, NotProved)
        assert asked.pop() == [(part, name) for name in names for part in ("even", "odd")]


def test_the_coordinates_that_suit_its_orbits_are_followed_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def of(system: Any, start: Any, widths: Any, coordinates: str, oracle: Any, begun: Any, progress: Any) -> Any:
        asked.append(coordinates)
        begun("those that suit")
        raise ArithmeticError

    monkeypatch.setattr(birth_piece, "HalfReturn", SimpleNamespace(of=of))
    found = prove_birth_piece(CR3BP, ATLAS.parameters, BIRTH, WHOLE, ORACLE)
    assert asked == ["auto"]
    assert found.computation.coordinates == "those that suit"


@pytest.mark.slow
@pytest.mark.parametrize(("atlas", "results", "precision"), [(ATLAS, RESULTS, 112), (JUPITER, JUPITER_RESULTS, 128)])
def test_the_piece_is_proved_and_a_false_one_is_not(
    atlas: Atlas, results: tuple[IntervalResult, ...], precision: int
) -> None:
    limits, (piece,) = PieceLimits(precision, 48, 40), atlas.birth_pieces()
    found = prove_birth_piece(CR3BP, atlas.parameters, piece, WHOLE, ORACLE, limits)
    assert isinstance(found.outcome, Proved), found.outcome
    assert found.computation.coordinates == "Kustaanheimo-Stiefel"
    (stored,) = (result for result in results if result.piece == piece.id)
    assert agree(found.outcome.results.time, stored.time)
    beside = replace(piece, polynomial=((piece.polynomial[0][0] + Fraction(1, 10**9),), *piece.polynomial[1:]))
    outcome = prove_birth_piece(CR3BP, atlas.parameters, beside, WHOLE, ORACLE, limits).outcome
    assert isinstance(outcome, NotProved)


@pytest.mark.slow
def test_both_coordinates_enclose_the_same_orbits_of_a_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    """Off Fix(R): what the orbits of the points of s are at their ends."""
    ends: list[Any] = []

    def newton(checklist: Any, equations: Any, *rest: Any, **more: Any) -> Any:
        ends.append([Equation(equation).value(arb(0, 1)) for equation in equations])
        raise ArithmeticError

    monkeypatch.setattr(birth_piece, "check_newton", newton)
    for coordinates in ("physical", "regularised"):
        monkeypatch.setattr(birth_piece, "AUTO", coordinates)
        prove_birth_piece(CR3BP, ATLAS.parameters, BIRTH, WHOLE, ORACLE, PieceLimits(112, 40, 30))
    assert all(agree(one, other) for one, other in zip(*ends, strict=True))
