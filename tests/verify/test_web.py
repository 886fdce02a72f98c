"""Webs: proved curves that meet in certified orbits, and graphs that are false."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support.balls import agree
from support.chain_cases import (
    Case,
    alone,
    certificate,
    circle,
    circle_point,
    line_in_plane,
    loop,
    stands,
    symmetric_arc,
    symmetric_loop,
)
from support.claims import known
from support.conclusions import conclude
from support.forgeries import atlas_certificate, fabricated, forged, of_parabola
from support.stored import values

from orbitproof import verify
from orbitproof.shared.claims import Claim, Covers
from orbitproof.shared.claims.web import BRANCHES, ENDS, PASSES, Meeting, Web, WebArc
from orbitproof.shared.formats import InputError, define_system, read_atlas
from orbitproof.shared.formats.web import read_web, web_from_json
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.__main__ import main
from orbitproof.verify.branches import certified_web, resting
from orbitproof.verify.branches import web as of_webs
from orbitproof.verify.certificate import (
    Certificate,
    Finding,
    Given,
    Key,
    Level,
    Limits,
    Recheck,
    certify,
    read_certificate,
    recheck,
    write_certificate,
)
from orbitproof.verify.curve import CertifiedPoint
from orbitproof.verify.curve import conclude as conclude_of_points
from orbitproof.verify.curve.bifurcations_on_it import place_bifurcation
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.stability import conclude_list
from orbitproof.verify.stability.matching import about_the_list
from orbitproof.verify.web import Arc, Incidence, ProvedWeb, Switch, conclude_web, level_at, proved_web
from orbitproof.verify.words.web import web_in_words

DATA = Path(__file__).parents[1] / "data"
BREAKING: dict[str, Any] = {"kind": "symmetry_breaking", "k": 1, "symmetry": "S"}


def symmetric_point(name: str, x: int, vy: int) -> Certificate:
    """Of a symmetry breaking at a point of the circle in the plane."""
    point = {"x": arb(x, 2**-80), "z": arb(0), "vy": arb(vy, 2**-80)}
    return certificate(point, name=name, **BREAKING)


def arc(case: Case, name: str, *vertices: Certificate) -> Arc:
    """A fabricated arc on which certificates are looked for."""
    atlas, results = case
    conclusion = conclude(replace(atlas, id=name), results, vertices, stands, alone)
    assert isinstance(conclusion.outcome, Proved)
    return Arc(replace(atlas, id=name), conclusion.outcome.results, "", {e.id: e for e in conclusion.bifurcations})


def web(meets: Mapping[str, Mapping[str, str]], connected: bool = True) -> Web:
    """A claim, by arcs and vertices."""
    arcs = (
        WebArc(name, tuple(Meeting(vertex, how) for vertex, how in vertices.items()))  # type: ignore[arg-type]
        for name, vertices in meets.items()
    )
    return Web("a web", "a web", tuple(arcs), connected)


def refusal(claim: Web, *arcs: Arc) -> str:
    """Why a web is not proved."""
    outcome = conclude_web(claim, arcs)
    assert isinstance(outcome, NotProved)
    assert outcome.hypotheses[-1].holds is False
    return f"{outcome.reason.condition}: {outcome.reason.message}"


def proof(claim: Web, *arcs: Arc) -> ProvedWeb:
    outcome = conclude_web(claim, arcs)
    assert isinstance(outcome, Proved), outcome
    return outcome.results


def theorem(claim: Web, *arcs: Arc) -> str:
    """A web that is proved, in words."""
    outcome = conclude_web(claim, arcs)
    assert isinstance(outcome, Proved), outcome
    digests = {name: f"d{number}" for number, name in enumerate(claim.certificates, 1)}
    return web_in_words(outcome.theorem, outcome.results, digests)  # type: ignore[arg-type]


ONE, OTHER = symmetric_point("one", 1, 2), symmetric_point("other", -1, 4)
INSIDE = certificate(circle_point(0.7), name="inside")


@cache
def halo() -> Arc:
    return arc(symmetric_loop(), "halo", ONE, OTHER, INSIDE, NEAR)


def shifted(case: Case) -> Case:
    """The same curve in pieces that are written otherwise: their polynomials have one more coefficient, 0."""
    atlas, results = case
    zero = (Fraction(0),)
    pieces = tuple(
        replace(piece, polynomial=tuple(row + zero for row in piece.polynomial)) for piece in atlas.curve_pieces()
    )
    return replace(atlas, pieces=pieces), results


def test_a_loop_branches_off_at_its_symmetric_points_and_passes_through_others() -> None:
    claim = web({"halo": {"one": BRANCHES, "other": BRANCHES, "inside": PASSES}})
    found = proof(claim, halo())
    assert [(entry.vertex, entry.how) for entry in found.incidences] == [
        ("one", BRANCHES), ("other", BRANCHES), ("inside", PASSES)
    ]  # fmt: skip
    assert found.parts == (("halo",),)
    assert found.switches == ()


def test_the_ranges_contain_levels_and_periods_of_random_orbits_of_the_arc() -> None:
    found = proof(web({"halo": {}}), halo()).arcs[0]
    integral = halo().system.first_integral_program
    assert integral is not None
    for number in range(200):
        angle = number * math.pi / 200
        at = {
            "x": math.cos(angle),
            "y": 0,
            "z": math.sin(angle),
            "vx": 0,
            "vy": 3 - math.cos(angle),
            "vz": 0,
            "mu": 1 / 80,
        }
        (level,) = integral.evaluate(
            [at[name] for name in integral.inputs], float, lambda base, power: base ** float(power)
        )
        assert found.level.contains(arb(level, 1e-5)), angle
    assert found.level.is_finite()
    assert found.period.contains(arb(6))
    assert not found.period.contains(arb(7))


NEAR = certificate(circle_point(0.05), name="near")
FALSE: dict[str, tuple[dict[str, str], str]] = {
    "a branch at a point off the plane": ({"inside": BRANCHES}, "no symmetric point of it"),
    "a branch at another point of a symmetric piece": ({"near": BRANCHES}, "no symmetric point of it"),
    "another way": ({"inside": "crosses"}, "no such way to meet"),
    "a passage at a symmetric point": ({"one": PASSES}, "branches off there"),
    "an end at a libration point": ({"L1": ENDS}, "the family that shrinks to L1"),
    "a passage through a libration point": ({"L2": PASSES}, "end at libration points, and at nothing else"),
    "an end at an orbit": ({"inside": ENDS}, "end at libration points, and at nothing else"),
    "a vertex that was not looked for": ({"elsewhere": PASSES}, "was not looked for"),
}


@pytest.mark.parametrize(("meets", "why"), FALSE.values(), ids=FALSE.keys())
def test_an_arc_that_meets_a_vertex_in_another_way_is_refused(meets: dict[str, str], why: str) -> None:
    said = refusal(web({"halo": meets}), halo())
    assert said.startswith("meetings: ")
    assert why in said


def test_the_other_point_of_an_orbit_is_no_symmetric_point() -> None:
    one = halo().placed["one"]
    assert one.place is not None
    other = replace(halo(), placed={"one": replace(one, place=replace(one.place, other_point=True))})
    assert "no symmetric point of it" in refusal(web({"halo": {"one": BRANCHES}}), other)
    words = theorem(web({"halo": {"one": PASSES}}), other)
    assert "passes through one: the other point of the orbit, on piece p000" in words


def test_an_arc_that_stops_before_its_vertex_does_not_meet_it() -> None:
    beyond, at_end = (certificate(circle_point(angle), name="v") for angle in (2.9, 2.297))
    for vertex in (beyond, at_end):
        said = refusal(web({"short": {"v": PASSES}}), arc(symmetric_arc(), "short", vertex))
        assert said.startswith("meetings: "), said


def test_an_orbit_at_the_very_end_of_an_arc_is_not_passed_through() -> None:
    placed = arc(circle(Claim("arc"), [1.0]), "arc", certificate(circle_point(1.0), name="v"))
    entry = placed.placed["v"]
    assert entry.place is not None
    for s, inside in ((arb(1), False), (arb(-1), False), (arb(0), True), (arb(1, 2**-30), False)):
        exact = replace(entry, place=replace(entry.place, s=s))
        outcome = conclude_web(web({"arc": {"v": PASSES}}), [replace(placed, placed={"v": exact})])
        assert isinstance(outcome, Proved) == inside


def test_a_vertex_of_another_mass_or_beside_the_curve_is_refused() -> None:
    for vertex, why in (
        (certificate(circle_point(0.7), name="v", parameters={"mu": "0.0125000001"}), "another value of mu"),
        (certificate({**circle_point(0.7), "vy": arb(2.5)}, name="v"), "half-widths"),
        (certificate(circle_point(0.7), name="v", crossings=2), "meet the section 2 times"),
        (certificate(circle_point(0.7), name="v", proved=False), "the certificate says 'not proved'"),
    ):
        assert why in refusal(web({"halo": {"v": PASSES}}), arc(symmetric_loop(), "halo", vertex))


def test_arcs_hang_together_by_common_vertices_only() -> None:
    arcs = halo(), arc(shifted(loop()), "loop", INSIDE), arc(shifted(symmetric_arc()), "short", ONE)
    meets = {"halo": {"inside": PASSES}, "loop": {"inside": PASSES}, "short": {"one": BRANCHES}}
    said = refusal(web(meets), *arcs)
    assert said.startswith("connected: ")
    assert "halo, loop; short" in said
    assert proof(web(meets, connected=False), *arcs).parts == (("halo", "loop"), ("short",))
    joined = proof(web({**meets, "halo": {"inside": PASSES, "one": BRANCHES}}), *arcs)
    assert joined.parts == (("halo", "loop", "short"),)


def test_an_arc_exchanged_for_another_is_refused() -> None:
    other = arc(shifted(circle(Claim("arc"), [2.2])), "halo", INSIDE)
    assert "meetings: " in refusal(web({"halo": {"inside": PASSES}}), other)
    assert "not those of the claim" in refusal(web({"loop": {}}), halo())


def test_one_curve_under_two_names_is_refused() -> None:
    said = refusal(web({"halo": {}, "again": {}}, connected=False), halo(), arc(symmetric_loop(), "again"))
    assert "have a piece in common" in said
    atlas, results = symmetric_loop()
    renamed = replace(atlas, system=replace(atlas.system, name="another", title="another"))
    said = refusal(web({"halo": {}, "again": {}}, connected=False), halo(), arc((renamed, results), "again"))
    assert "have a piece in common" in said
    twice = Web("a web", "a web", (WebArc("halo"), WebArc("halo")), False)
    assert "same id" in refusal(twice, halo(), halo())


def test_arcs_of_other_equations_or_parameters_are_refused() -> None:
    atlas, results = shifted(loop())
    heavier = replace(atlas, parameters={"mu": atlas.parameters["mu"] * 2})
    assert "different parameters" in refusal(web({"halo": {}, "b": {}}, False), halo(), arc((heavier, results), "b"))
    parabola, of_it = of_parabola()
    other = arc((parabola, of_it), "b")
    assert "different equations" in refusal(web({"halo": {}, "b": {}}, False), halo(), other)


def test_equations_are_compared_in_all_that_they_are() -> None:
    def equations(**changes: Any) -> object:
        def text(of: str) -> Any:
            return SimpleNamespace(text=lambda: of)

        what = {
            "field": "f",
            "argument": "x",
            "integral": "H",
            "function": "sin",
            "parameter": "a",
            "level": 1,
            **changes,
        }
        system = SimpleNamespace(
            name=what.get("name"), program=text(what["field"]), argument_programs=[text(what["argument"])],
            defined=[SimpleNamespace(name="s", function=what["function"])], family_parameter=what["parameter"],
            first_integral_program=text(what["integral"]), fixed_level=what["level"],
        )  # fmt: skip
        return Arc(SimpleNamespace(system=system), None).equations  # type: ignore[arg-type]

    assert equations() == equations(name="another")
    for name in ("field", "argument", "integral", "function", "parameter", "level"):
        assert equations() != equations(**{name: "other"}), name


def test_the_level_of_a_point_needs_all_coordinates_of_its_state() -> None:
    atlas, _ = symmetric_loop()
    integral = CR3BP.first_integral_program
    assert integral is not None
    point = {"x": arb(1), "z": arb(0), "vy": arb(1)}
    level = level_at(atlas, point)
    known = SimpleNamespace(
        state=CR3BP.state, normalised={"vy": Fraction(1)}, family_parameter=None, defined=(),
        first_integral_program=integral, derived_parameters={},
    )  # fmt: skip
    held = SimpleNamespace(system=known, parameters=atlas.parameters)
    assert agree(level_at(held, {"x": arb(1), "z": arb(0)}), level)  # type: ignore[arg-type]
    known.defined = ("sin_x",)
    assert not level_at(held, point).is_finite()  # type: ignore[arg-type]


def test_the_level_of_a_point_about_zero_is_known() -> None:
    circle = {"name": "c", "state": "x y", "field": {"x": "y", "y": "-x"}, "R": {"y": -1}, "section": "y"}
    system = define_system({**circle, "first_integral": "x**2 + y**2"})
    level = level_at(SimpleNamespace(system=system, parameters={}), {"x": arb(0, 1)})  # type: ignore[arg-type]
    assert level.contains(1)
    assert level.is_finite()


def test_levels_that_are_not_known_somewhere_are_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = iter(range(10**6))
    monkeypatch.setattr("orbitproof.verify.web.arc.level_at", lambda *of: arb("nan" if next(numbers) == 7 else 1))
    assert not halo().levels().is_finite()


def test_one_orbit_under_two_names_is_refused() -> None:
    first = certificate(circle_point(0.3), name="first")
    twice = certificate(circle_point(0.7), name="twice"), certificate(circle_point(0.7), name="again")
    said = refusal(web({"halo": {"twice": PASSES, "again": PASSES}}), arc(symmetric_loop(), "halo", *twice))
    assert said.startswith("vertices: ")
    assert "may be the same orbit" in said
    three = {"first": PASSES, "twice": PASSES, "again": PASSES}
    said = refusal(web({"halo": three}), arc(symmetric_loop(), "halo", first, *twice))
    assert "twice and again may be the same orbit" in said


def test_a_vertex_whose_level_is_not_known_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orbitproof.verify.web.proved_web.level_at", lambda *of: arb("nan"))
    said = refusal(web({"halo": {"inside": PASSES}}), halo())
    assert said.startswith("vertices: ")
    assert "the level of inside is not known" in said


def test_an_arc_that_is_not_proved_is_refused_with_its_reason() -> None:
    assert "arcs: " in refusal(web({"halo": {}}), replace(halo(), problem="the certificate does not stand: why"))
    assert "it is not proved" in refusal(web({"halo": {}}), replace(halo(), curve=None))


# The family around a libration point, whose results are stored, and births on it.


@cache
def lyapunov(**changes: Any) -> tuple[Case, Arc]:
    atlas = read_atlas(DATA / "atlas-lyapunov.json")
    results = json.loads((DATA / "stability-lyapunov.json").read_text())
    case: Case = (replace(atlas, **changes), results)  # type: ignore[type-var,assignment]
    return case, arc(case, atlas.id)


def birth(name: str, system: str) -> CertifiedPoint:
    """The birth of halo orbits on the family, as a certificate about either reversing symmetry would have it."""
    x, vy = arb("0.823390904575336165"), arb("0.126326399508559760")
    point = {"x": x, "vy": vy} | ({"z": arb(0)} if system == "cr3bp" else {"vz": arb(0)})
    reversor = None if system == "cr3bp" else "axial"
    signs = (1, 1, -1, 1, 1, -1)
    return CertifiedPoint(
        name, "symmetry_breaking", 1, reversor=reversor, symmetry="S", signs=signs, point=point,
        parameter_name="Jacobi constant", parameter=arb("3.17435194426883474"),
    )  # fmt: skip


def test_a_family_ends_at_its_libration_point_and_at_no_other() -> None:
    _, family = lyapunov()
    found = proof(web({family.id: {"L1": ENDS}}), family)
    assert agree(found.vertices[0].level, arb("3.18834110715128848"))
    assert found.arcs[0].level.contains(arb("3.17435194426883474"))
    assert "shrinks to L2" in refusal(web({family.id: {"L2": ENDS}}), family)
    claim = family.atlas.claim
    off = (Covers("eps", Fraction(-1, 100), Fraction(-1, 200)), Covers("eps", Fraction(1, 200), Fraction(1, 100)))
    other = Covers("vy", Fraction(-1), Fraction(1))
    claims = (replace(claim, covers=covers) for covers in (None, other, *off))
    for claimed in (replace(claim, increasing=()), *claims):
        silent = replace(family, atlas=replace(family.atlas, claim=claimed))
        assert "shrinks to L1" in refusal(web({family.id: {"L1": ENDS}}), silent)


def test_it_is_a_planar_arc_through_the_same_vertex_from_which_another_one_branches_off() -> None:
    _, family = lyapunov()
    spatial = arc(loop(), "loop", INSIDE)
    onto = Incidence("halo", "one", BRANCHES, halo().placed["one"].place)
    along, beside = replace(onto, arc=family.id, how=PASSES), replace(onto, arc="loop", how=PASSES)
    arcs = (family, halo(), spatial)
    assert proved_web._switches(arcs, (onto, along, beside)) == (Switch("one", family.id, "halo"),)
    assert proved_web._switches(arcs, (onto, replace(along, vertex="other"))) == ()
    assert along.place is not None
    assert proved_web._switches(arcs, (onto, replace(along, place=replace(along.place, other_point=True)))) == ()
    assert proved_web._switches(arcs, (replace(onto, how=PASSES), along)) == ()
    assert proved_web._switches(arcs, (onto, replace(along, how=ENDS))) == ()


def test_a_curve_of_the_planar_problem_passes_through_orbits_that_leave_the_plane_and_no_others() -> None:
    at = {"x": arb(1, 2**-80), "z": arb(0, 2**-80), "vy": arb(2, 2**-80)}
    flat = arc(line_in_plane(), "flat", ONE, certificate(at, name="doubling"))
    claim = web({"flat": {"one": PASSES}, "halo": {"one": BRANCHES}})
    found = proof(claim, flat, halo())
    assert found.switches == (Switch("one", "flat", "halo"),)
    assert found.parts == (("flat", "halo"),)
    assert "orbits in the plane, symmetric under R;" in theorem(claim, flat, halo())
    assert "not shown to be a planar orbit" in refusal(web({"flat": {"doubling": PASSES}}), flat)
    assert flat.curve is not None
    for system in ("cr3bp", "cr3bp-axial"):
        other = replace(birth("birth", system), point={**birth("birth", system).point, "x": arb(1), "vy": arb(2)})
        placed = place_bifurcation(flat.atlas, flat.curve.chain, other)
        assert placed.place is not None, placed.reason
        assert about_the_list(flat.atlas, [placed], 4) == []
        assert about_the_list(flat.atlas, [replace(placed, kind="period_tupling")], 4) != []


@pytest.mark.parametrize("system", ["cr3bp", "cr3bp-axial"])
def test_births_under_either_reversing_symmetry_lie_on_the_planar_family(system: str) -> None:
    _, family = lyapunov()
    assert family.curve is not None
    placed = place_bifurcation(family.atlas, family.curve.chain, birth("birth", system))
    assert placed.place is not None, placed.reason
    whole = replace(family, placed={"birth": placed})
    found = proof(web({family.id: {"L1": ENDS, "birth": PASSES}}), whole)
    assert [vertex.id for vertex in found.vertices] == ["L1", "birth"]
    assert agree(found.vertices[1].level, arb("3.17435194426883474"))
    others = replace(birth("birth", system), symmetry="another")
    assert place_bifurcation(family.atlas, family.curve.chain, others).place is None


def test_a_birth_is_a_point_of_the_list_for_its_own_reversing_symmetry_or_contradicts_it() -> None:
    (atlas, results), _ = lyapunov()
    found = values(results)
    for system, holds in (("cr3bp", True), ("cr3bp-axial", False)):
        curve = conclude_of_points(atlas, found, [birth("birth", system)])
        listed = conclude_list(atlas, found, curve, 1)
        assert isinstance(listed.outcome, Proved) == holds


# Certificates: a parabola's, on which a point is fabricated that stands without an integration.

ARC: Key = ("arc", "parabola")
VERTEX: Key = ("vertex", "near")


@cache
def documents() -> tuple[Web, tuple[Certificate, ...], dict[Key, Recheck]]:
    point = fabricated(certify(known("fs3"), Limits(max_precision=256)), ("2", "4e-2"), "near")
    atlas, results = of_parabola()
    curve = Certificate(atlas_certificate(atlas, results))
    claim = web({"parabola": {"near": PASSES}})
    certificates = resting(claim, [point, curve])
    return claim, certificates, {ARC: recheck(curve), VERTEX: recheck(point)}


@cache
def document() -> dict[str, Any]:
    claim, certificates, checks = documents()
    return certified_web(claim, certificates, checks)


def checked(entry: Mapping[str, Any]) -> Recheck:
    _, certificates, checks = documents()
    return recheck(Certificate(entry), given=Given(certificates, checks))


def test_the_certificate_of_a_web_stands_as_far_as_those_that_it_rests_on() -> None:
    _, certificates, checks = documents()
    found = checked(document())
    assert (found.stands, found.level, found.verdict) == (True, Level.CONCLUSION, "proved")
    assert found.rendered is None
    lower = {name: replace(check, level=Level.FORM) for name, check in checks.items()}
    assert recheck(Certificate(document()), given=Given(certificates, lower)).level is Level.FORM
    higher = {name: replace(check, level=Level.INTEGRATION, precision=90) for name, check in checks.items()}
    integrated = recheck(Certificate(document()), given=Given(certificates, higher))
    assert (integrated.level, integrated.precision) == (Level.INTEGRATION, 90)
    for bits in ((128, 90), (90, 128)):
        other_bits = {name: replace(check, precision=n) for (name, check), n in zip(higher.items(), bits, strict=True)}
        assert recheck(Certificate(document()), given=Given(certificates, other_bits)).precision == 90
    half = {**higher, VERTEX: checks[VERTEX]}
    assert recheck(Certificate(document()), given=Given(certificates, half)).level is Level.CONCLUSION


def test_what_it_rests_on_has_to_stand() -> None:
    claim, certificates, checks = documents()
    for name in checks:
        falls = {**checks, name: replace(checks[name], findings=(Finding("digest", "does not fit"),))}
        assert not recheck(Certificate(document()), given=Given(certificates, falls)).stands
        fresh = certified_web(claim, certificates, falls)
        assert fresh["verdict"] == "not proved"
        assert "does not stand" in fresh["reason"]["message"]
        assert fresh["arcs"] == fresh["vertices"] == []
        lower = {**checks, name: replace(checks[name], level=Level.FORM)}
        said = certified_web(claim, certificates, lower)["reason"]["message"]
        assert "not checked up to its conclusion" in said
    point, curve = (next(e for e in certificates if e.key[0] == part) for part in ("vertex", "arc"))
    silent = Certificate({**curve.document, "verdict": "not proved"})
    assert "says 'not proved'" in certified_web(claim, resting(claim, [point, silent]), checks)["reason"]["message"]
    with pytest.raises(ValueError, match="the check of another certificate"):
        certified_web(claim, certificates, {**checks, VERTEX: replace(checks[VERTEX], digest="sha256:" + 64 * "0")})


def test_a_file_that_was_changed_is_not_read(tmp_path: Path) -> None:
    file = tmp_path / "web.json"
    write_certificate(file, document())
    assert read_certificate(file, "web-certificate").proved
    file.write_text(file.read_text().replace("a web", "my web"))
    with pytest.raises(InputError, match="field digest"):
        read_certificate(file, "web-certificate")


def test_a_web_that_is_not_proved_claims_nothing() -> None:
    _, certificates, checks = documents()
    wrong = web({"parabola": {"near": BRANCHES}})
    fresh = certified_web(wrong, certificates, checks)
    assert (fresh["verdict"], fresh["reason"]["condition"]) == ("not proved", "meetings")
    assert "theorem" not in fresh["statement"]
    assert recheck(Certificate(fresh), given=Given(certificates, checks)).stands
    said = forged(fresh, lambda d: d.update(verdict="proved", reason=None))
    assert not recheck(Certificate(said), given=Given(certificates, checks)).stands


def test_a_certificate_that_is_missing_or_given_twice_or_of_another_kind_is_told() -> None:
    claim, (curve, point), _ = documents()
    for given, why in (
        ([curve], "no such certificate is given"),
        ([curve, point, point], "appears twice"),
        ([curve, point, certificate(circle_point(0.7), name="L1")], "has the name of a libration point"),
    ):
        with pytest.raises(InputError, match=why):
            resting(claim, given)
    with pytest.raises(InputError, match="is about a curve"):
        resting(web({"near": {"parabola": PASSES}}), [curve, point])
    assert [entry.id for entry in resting(web({"parabola": {}}), [point, curve])] == ["parabola"]


def test_a_claim_names_each_arc_and_each_meeting_once(tmp_path: Path) -> None:
    meets = [{"vertex": "near", "how": PASSES}]
    one = {"id": "parabola", "meets": meets}
    file = tmp_path / "web.json"
    for arcs, why in (
        ([one, one], "'parabola' appears twice"),
        ([{**one, "meets": meets * 2}], "'near' appears twice"),
        ([one, {"id": "near"}], "is a vertex too"),
        ([{"id": "L1"}], "is a libration point"),
        ([{**one, "meets": [{"vertex": "near", "how": "crosses"}]}], "must be"),
        ([], "needs at least 1"),
    ):
        file.write_text(json.dumps({"format": "orbitproof-web", "version": 1, "id": "w", "title": "w", "arcs": arcs}))
        with pytest.raises(InputError, match=why):
            read_web(file)
    assert web_from_json({"id": "w", "title": "w", "arcs": [one]}, "it").connected
    with pytest.raises(InputError, match="name at least one arc"):
        verify.certify(Web("w", "w", ()), quiet=True)


def test_what_is_stored_of_an_arc_is_its_own() -> None:
    claim = web({"halo": {"inside": PASSES}, "loop": {"inside": PASSES}})
    assert claim.vertices == ("inside",)
    assert web({"halo": {}, "loop": {"inside": PASSES}}).vertices == ("inside",)
    found = proof(claim, halo(), arc(shifted(loop()), "loop", INSIDE))
    plain: Any = SimpleNamespace(document={"conclusion": None}, stable=())
    stored = of_webs._stored_arc(replace(found.arcs[0], period=arb("nan")), found, plain)
    assert [entry.vertex for entry in stored.meets] == ["inside"]
    assert stored.period is None
    assert stored.level is not None


@pytest.mark.slow
def test_the_command_and_python_say_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    claim, (curve, point), _ = documents()
    files = {name: str(tmp_path / f"{name}.json") for name in ("web", "curve", "point", "out", "python")}
    assert isinstance(curve, Certificate)
    assert isinstance(point, Certificate)
    verify.write(files["curve"], curve)
    verify.write(files["point"], [point])
    entry = document()["statement"]["claim"]
    Path(files["web"]).write_text(json.dumps({"format": "orbitproof-web", "version": 1, **entry}))
    given = ["--certificates", files["curve"], files["point"], "--quiet"]
    assert main(["web", files["web"], *given, "-o", files["out"]]) == 0
    assert "PROVED" in capsys.readouterr().out
    (found,) = verify.certify(claim, rests_on=[curve, point], output=files["python"], quiet=True)
    assert found.document == verify.read(files["out"])[0].document == verify.read(files["python"])[0].document
    assert main(["web", "--recheck", files["out"], *given]) == 0
    assert verify.recheck(found, rests_on=[curve, point], quiet=True)[0].stands
    assert main(["web", files["web"], "--certificates", files["curve"], "--quiet"]) == 2
    assert "no such certificate is given" in capsys.readouterr().err
    wrong = {**entry, "arcs": [{"id": "parabola", "meets": [{"vertex": "near", "how": BRANCHES}]}]}
    Path(files["web"]).write_text(json.dumps({"format": "orbitproof-web", "version": 1, **wrong}))
    assert main(["web", files["web"], *given]) == 1
    assert "NOT PROVED: meetings" in capsys.readouterr().out
