"""Period doublings of halo orbits over the mass parameter (section 15.10)."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.curve_cases import proof, refusal
from support.stored import values

from orbitproof.shared.claims import SURFACE
from orbitproof.shared.claims.web import Web, WebArc
from orbitproof.shared.formats import ArgumentError, Atlas, Covers, InputError, Piece, candidate_from_json, read_atlas
from orbitproof.shared.formats.atlas import claim_from_json
from orbitproof.shared.systems import CR3BP, HILL, HILL_VARIED, DescriptionError, describe
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.branches.conclusion import conclusion_of
from orbitproof.verify.branches.curve_conclusion import follow, partner
from orbitproof.verify.certificate import Certificate, Level, Recheck
from orbitproof.verify.claim import check_symmetries
from orbitproof.verify.curve import CertifiedPoint, Conclusion, PieceLimits, ProvedCurve, conclude, prove_piece
from orbitproof.verify.curve.doubled_family import check_doubled, in_hill_units
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.run.branches import limits_of
from orbitproof.verify.web import Arc, conclude_web
from orbitproof.verify.words.branches import conclusion_in_words
from orbitproof.verify.words.curve import meaning

DATA = Path(__file__).resolve().parents[1] / "data"
ATLAS = read_atlas(DATA / "atlas-doublings.json")
assert isinstance(ATLAS, Atlas)
RESULTS = tuple(values(json.loads((DATA / "results-doublings.json").read_text())))
CERTIFICATE = next(
    each
    for each in json.loads((DATA / "figures-certificates.json").read_text())["certificates"]
    if each["id"] == "earth-moon-L1-halo-k2-1"
)
MASS = Fraction(float.fromhex("0x1.8e267d713713fp-7"))


def certified(**changes: Any) -> CertifiedPoint:
    with ctx.workprec(200):
        point = {
            name: arb(ball["decimal"].strip("[").split(",")[0] + " +/- 1e-38")
            for name, ball in CERTIFICATE["results"]["point"].items()
        }
    at = CertifiedPoint("doubling", "period_tupling", 2, parameters={"mu": MASS}, point=point)
    return replace(at, **changes)


def concluded(*points: CertifiedPoint, atlas: Atlas = ATLAS, results: Any = RESULTS) -> Conclusion[ProvedCurve]:
    return conclude(atlas, results, points, partner, follow)


def test_the_field_is_that_of_hill_and_its_derivative() -> None:
    source = random.Random("varied")
    checklist = Checklist()
    check_symmetries(checklist, HILL_VARIED)
    assert "f(V x) = V f(x) for the V of half orbits from Fix(R) to Fix(R V)" in checklist.hypotheses[0].statement
    with mpmath.workdps(40):
        for _ in range(5):
            state, variation = ([mpmath.mpf(source.uniform(-1, 1)) for _ in range(6)] for _ in range(2))
            h, small = mpmath.mpf(source.uniform(0, 0.7)), mpmath.mpf(10) ** -12
            found = HILL_VARIED.vector_field([*state, *variation], [h])
            ahead, behind = (
                HILL.vector_field([x + sign * small * w for x, w in zip(state, variation, strict=True)], [h])
                for sign in (1, -1)
            )
            wanted = [
                *HILL.vector_field(state, [h]),
                *((a - b) / (2 * small) for a, b in zip(ahead, behind, strict=True)),
            ]
            assert all(abs(a - b) < 1e-15 for a, b in zip(found, wanted, strict=True))


def test_half_orbits_end_where_the_variation_is_turned_around() -> None:
    names = [HILL_VARIED.state[i] for i in HILL_VARIED.kernel_coordinates]
    assert names == ["vxi", "vzeta", "dxi", "dzeta", "dveta"]
    assert HILL_VARIED.centre_coordinates == ("h", "xi", "zeta", "veta", "dxi", "dzeta")


def test_a_field_without_the_symmetry_is_refused() -> None:
    def other(state: Any, parameters: Any) -> Any:
        field = list(HILL_VARIED.vector_field(state, parameters))
        return [*field[:9], field[9] + 1, *field[10:]]

    with pytest.raises(NotEstablishedError):
        check_symmetries(Checklist(), replace(HILL_VARIED, vector_field=other))


def test_they_are_one_curve_over_all_masses() -> None:
    conclusion = concluded()
    assert proof(conclusion).chain.stretches
    words = conclusion_in_words(conclusion)
    assert "takes all values from 0 to 0.7938" in words
    assert "has the least period 2 T and the multiplier -1" in words
    assert "All these T lie in [1.292, 1.381]." in words


def test_of_hills_problem_it_speaks_where_h_is_shown_to_be_0() -> None:
    assert "Hill's problem" in meaning(ATLAS)
    for covers in (None, Covers("h", Fraction(1, 5), Fraction(1, 2))):
        assert "Hill's problem" not in meaning(replace(ATLAS, claim=replace(ATLAS.claim, covers=covers)))


def test_a_certified_doubling_lies_on_it() -> None:
    (entry,) = concluded(certified()).bifurcations
    assert entry.place is not None, entry.reason


@pytest.mark.slow
def test_its_certificate_is_one_of_the_three_body_problem_with_its_mass() -> None:
    certificate = Certificate.from_json(CERTIFICATE)
    check = Recheck(certificate.id, "proved", 1, (), level=Level.CONCLUSION)
    point = certified_point(ATLAS, certificate, lambda entry: check)
    assert (point.problem, point.parameters) == ("", {"mu": MASS})
    (entry,) = concluded(point).bifurcations
    assert entry.place is not None, entry.reason


def test_no_list_is_concluded_of_them() -> None:
    found = conclusion_of(ATLAS, RESULTS, [], lambda entries: [], 4)
    assert found["verdict"] == "proved"
    assert "complete" not in found


def test_half_orbits_end_where_a_symmetry_of_the_section_says() -> None:
    with pytest.raises(ValueError, match="arrival: no symmetry 'W'"):
        replace(HILL_VARIED, arrival="W")
    with pytest.raises(ValueError, match="must leave the section coordinate alone"):
        replace(CR3BP, symmetries={"S": (1, -1, 1, 1, -1, 1)}, arrival="S")


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"k": 4}, "only period doublings"),
        ({"kind": "symmetry_breaking"}, "only period doublings"),
        ({"crossings": 2}, "only period doublings"),
        ({"parameters": {"mu": Fraction(1, 80)}}, "lies outside the tubes"),
        ({"point": {"x": arb(1)}}, "does not have all coordinates"),
        ({"problem": "it is another one", "is_foreign": True}, "another one"),
    ],
)  # fmt: skip
def test_other_certificates_do_not(changes: dict[str, Any], why: str) -> None:
    (entry,) = concluded(certified(**changes)).bifurcations
    assert entry.place is None
    assert why in entry.reason


def test_a_point_is_carried_to_units_of_hill() -> None:
    found = in_hill_units(Fraction(1, 8), {"x": arb(1), "z": arb(1), "vy": arb(-1)})
    assert [round(float(found[name].mid()), 12) for name in ("h", "xi", "zeta", "veta")] == [0.5, 0.25, 2, -2]


def test_claims_that_say_too_little_are_refused() -> None:
    def claims(**changes: Any) -> Conclusion[ProvedCurve]:
        return concluded(certified(), atlas=replace(ATLAS, claim=replace(ATLAS.claim, **changes)))

    for changes, why in (
        ({"increasing": ()}, "h increases"),
        ({"covers": Covers("h", Fraction(0), Fraction(4, 5))}, "covers"),
        ({"crossings": 2}, "no arc of first returns"),
        ({"kind": "loop"}, "curve"),
    ):
        found = claims(**changes)
        assert why in refusal(found)
        (entry,) = found.bifurcations
        assert entry.place is None
        assert entry.reason == "the curve itself is not proved"
    assert "curve" in refusal(concluded(results=RESULTS[:2]))


def test_only_arcs_are_curves_of_doublings() -> None:
    chain = proof(concluded()).chain
    with pytest.raises(NotEstablishedError, match="no arc of first returns"):
        check_doubled(Checklist(), replace(ATLAS, claim=replace(ATLAS.claim, kind="loop")), chain)


@pytest.mark.parametrize("down", [Fraction(18, 25), Fraction(3, 5), Fraction(23, 50), Fraction(1)])
def test_orbits_of_which_some_lie_in_the_plane_are_refused(down: Fraction) -> None:
    """zeta is from 0.78 to 0.44, so lowered it changes its sign within one of the pieces; at last in none."""
    place = HILL_VARIED.centre_coordinates.index("zeta")

    def lowered(piece: Piece) -> Piece:
        centre = tuple(value - down if i == place else value for i, value in enumerate(piece.centre))
        return replace(piece, centre=centre)

    pieces = tuple(map(lowered, ATLAS.curve_pieces()))
    found = concluded(atlas=replace(ATLAS, pieces=pieces))
    if down == 1:
        assert proof(found).chain.stretches
    else:
        assert "zeta is not shown to keep its sign" in refusal(found)


@pytest.mark.parametrize(
    ("crossings", "why"),
    [
        (None, "the variations along its orbit are not enclosed"),
        ([SimpleNamespace(state={f"d{name}": arb(1) for name in HILL.state})], "is not enclosed"),
    ],
)
def test_a_doubling_whose_variation_is_not_enclosed_is_not_placed(crossings: Any, why: str) -> None:
    (entry,) = conclude(ATLAS, RESULTS, [certified()], partner, lambda *_: crossings).bifurcations
    assert entry.place is None
    assert why in entry.reason


def test_they_are_no_arcs_of_webs() -> None:
    arc = Arc(ATLAS, proof(concluded()))
    outcome = conclude_web(Web("a-web", "a web", (WebArc(ATLAS.id),)), [arc])
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "arcs"
    assert "orbits with a variation" in outcome.reason.message


def test_claims_and_descriptions_of_systems_whose_half_orbits_end_elsewhere_are_refused() -> None:
    candidate, other = candidate_from_json(CERTIFICATE["statement"]["candidate"], "a row"), replace(CR3BP, arrival="S")
    assert replace(candidate, system=replace(other, arrival=None)).kernel_frame
    with pytest.raises(InputError, match=r"system: half orbits of cr3bp do not end in Fix\(R\)"):
        replace(candidate, system=other)
    with pytest.raises(DescriptionError, match="arrival"):
        describe(other)


@pytest.mark.parametrize("kind", ["loop", "symmetric-arc", "symmetric-loop", SURFACE])
def test_files_that_claim_no_arc_of_them_are_refused(kind: str) -> None:
    with pytest.raises(InputError, match=r"field claim\.kind: .* of cr3bp-hill-varied; .* are claimed as an arc$"):
        claim_from_json({"kind": kind, "symmetry": "V"}, HILL_VARIED, "a.json: field claim")


def test_no_list_is_made_of_them() -> None:
    with pytest.raises(ArgumentError, match="period doublings"):
        limits_of(ATLAS, complete=4)


def narrow(shift: Fraction = Fraction(0)) -> Piece:
    """The first piece, its tube moved by so much in dzeta, in units of the tube."""
    (piece, *_) = ATLAS.curve_pieces()
    moved = [*map(list, piece.polynomial)]
    moved[-1][0] += shift * piece.tube[-1]
    return replace(piece, polynomial=tuple(map(tuple, moved)))


@pytest.mark.slow
@pytest.mark.parametrize(("shift", "holds"), [(0, True), (8, False)])
def test_a_short_piece_is_proved_and_another_variation_is_not(shift: int, holds: bool) -> None:
    limits = PieceLimits(precision=64, order=24, width=10)
    interval = Fraction(-1, 16), Fraction(1, 16)
    found = prove_piece(HILL_VARIED, {}, narrow(Fraction(shift)), interval, ORACLE, limits)
    assert found.is_proved is holds, found.outcome
    if not holds:
        assert isinstance(found.outcome, NotProved)
        assert found.outcome.reason.condition == "newton"
