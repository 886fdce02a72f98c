"""Bifurcations of certificates are placed on the curve that they lie on, and on no other."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.chain_cases import (
    HALF_WIDTH,
    Case,
    certificate,
    circle,
    circle_point,
    concluded,
    falls,
    parabola,
    parabola_piece,
    proved,
    stands,
    symmetric_arc,
    symmetric_loop,
    with_piece,
)
from support.claims import known
from support.conclusions import conclude
from support.curve_cases import proof, refusal
from support.stored import entry_of

from orbitproof.shared.claims import Atlas, Claim, Piece
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.curve import enclose_other_point, prove_piece
from orbitproof.verify.evidence import bounds, enclose
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitResults, Stability
from orbitproof.verify.words.branches import conclusion_in_words

DATA = Path(__file__).parents[1] / "data"


def told_of(entry: Certificate, kind: str, **said: Any) -> Certificate:
    """What a certificate says, as one of another kind, with some of it changed."""
    found = Certificate(entry.document)
    vars(found).update(_said={**entry._said, **said}, kind=kind)
    return found


@pytest.mark.parametrize("angle", [0.3, 0.7, 1.5, 2.9, -0.3, -2.5])
def test_a_bifurcation_on_the_curve_or_its_mirror_image_is_found_there(angle: float) -> None:
    (entry,) = concluded(symmetric_loop(), certificate(circle_point(angle))).bifurcations
    assert entry.place is not None
    assert entry.place.mirrored == (angle < 0)
    piece_angle = int(entry.place.piece[1:]) * math.pi / 5
    assert abs(math.sin(abs(angle) - piece_angle) / float(HALF_WIDTH) - float(entry.place.s.mid())) < 1e-9


def test_a_branch_that_is_left_through_a_symmetric_point_is_found() -> None:
    # From the half circle to the line of points in the plane that goes through its symmetric point.
    def planar(piece: Piece) -> Piece:
        one, zero = Fraction(1), Fraction(0)
        frame = ((one, zero, zero), (zero, one, zero), (one, zero, one))
        flat = replace(piece, centre=(one, zero, Fraction(2)), frame=frame)
        return replace(flat, polynomial=((zero,), (zero,)))

    message = refusal(concluded(with_piece(symmetric_arc(Claim("symmetric-arc", "S")), 1, planar)))
    assert "p000 and p001" in message
    assert "beside its tube" in message


def test_a_mirror_image_counts_on_symmetric_curves_only() -> None:
    half = circle(Claim("arc"), [0.7, 1.3])
    above, below = (certificate(circle_point(angle)) for angle in (1.0, -1.0))
    on, off = concluded(half, above, below).bifurcations
    assert on.place is not None
    assert off.place is None


def test_a_symmetry_breaking_in_the_plane_is_the_symmetric_point() -> None:
    point = {"x": arb(1, 2**-80), "z": arb(0), "vy": arb(2, 2**-80)}
    breaking = certificate(point, kind="symmetry_breaking", k=1, symmetry="S")
    conclusion = concluded(symmetric_loop(), breaking)
    (entry,) = conclusion.bifurcations
    assert entry.place is not None
    assert (entry.place.piece, entry.place.s.is_zero()) == ("p000", True)
    assert proof(conclusion).ends["start"]["vy"].rad() < 2**-79
    # All that the certificate leaves open is left open.
    start = proof(conclusion).ends["start"]
    with ctx.workprec(256):
        ends = [(name, ball.mid() + side * ball.rad() * 0.99) for name, ball in point.items() for side in (1, -1)]
        assert all(start[name].contains(end) for name, end in ends)
    assert proof(conclusion).ends["end"]["vy"].rad() > 2**-40
    assert "symmetric point of piece p000" in conclusion_in_words(conclusion)


def test_a_symmetry_is_the_one_of_the_curve_by_its_signs_and_not_by_its_name() -> None:
    # The systems of two files may have one name and call different symmetries S.
    point = {"x": arb(1, 2**-80), "z": arb(0, 2**-80), "vy": arb(2, 2**-80)}
    entry = certificate(point, kind="symmetry_breaking", k=1, symmetry="S").to_json()
    for signs, holds in (([1, 1, -1, 1, 1, -1], True), ([1, -1, 1, 1, -1, 1], False), (None, False)):
        entry["statement"]["symmetry"] = signs
        (found,) = concluded(symmetric_loop(), Certificate.from_json(entry)).bifurcations
        assert (found.place is not None) == holds


def test_the_other_point_of_an_orbit_is_read_by_names_and_not_in_the_order_of_a_file() -> None:
    far = certificate({**circle_point(0.7), "x": arb(100)})
    for names in (["x", "z", "vy"], ["vy", "x", "z"]):
        other = {name: circle_point(0.7)[name] for name in names}
        orbit = OrbitResults(far.point, other, arb(1), arb(2), Stability((), (), "not decided"))
        (found,) = concluded(symmetric_loop(), told_of(far, "orbit", results=orbit)).bifurcations
        assert found.place is not None
        assert found.place.other_point


def test_the_other_end_of_a_symmetric_arc_of_one_piece_is_not_its_symmetric_point() -> None:
    point = {"x": arb(1, 2**-80), "z": arb(0), "vy": arb(2, 2**-80)}
    case = circle(Claim("symmetric-arc", "S"), [0.0], (0,))
    conclusion = concluded(case, certificate(point, kind="symmetry_breaking", k=1, symmetry="S"))
    assert conclusion.bifurcations[0].place is not None
    ends = proof(conclusion).ends
    assert ends["start"]["vy"].rad() < 2**-79
    assert agree(ends["end"]["z"], arb(2) / 5)


def test_a_certified_point_is_what_its_certificate_says() -> None:
    atlas, _ = symmetric_arc()
    point = circle_point(0.7)
    breaking: dict[str, Any] = {"kind": "symmetry_breaking", "k": 1, "symmetry": "S"}
    for changes, crossings, symmetry in ((breaking, 1, "S"), ({**breaking, "crossings": 3}, 3, "S"), ({}, 1, None)):
        entry = certificate(point, **changes)
        found = certified_point(atlas, entry, stands)
        assert (found.id, found.kind, found.k) == (entry.id, entry.kind, entry.k)
        assert (found.crossings, found.symmetry) == (crossings, symmetry)
        assert found.signs == (None if symmetry is None else atlas.system.symmetries[symmetry])
        assert (found.point, found.parameter_name) == (entry.point, "Jacobi constant")
        assert (found.problem, found.is_foreign) == ("", False)
    elsewhere = concluded(symmetric_arc(), certificate(point, crossings=2)).bifurcations[0]
    assert elsewhere.place is None
    assert "meet the section 2 times, those of the curve 1" in elsewhere.reason


@pytest.mark.parametrize("kind", ["periodic", "periodic-fold", "periodic-torus"])
def test_an_orbit_that_need_not_be_symmetric_is_not_placed_by_the_coordinates_that_r_fixes(kind: str) -> None:
    # Near a loss of R the new orbits have these nearly in common with symmetric ones.
    entry = told_of(certificate(circle_point(0.7)), kind)
    (found,) = concluded(symmetric_loop(), entry).bifurcations
    assert found.place is None
    assert "need not be symmetric" in found.reason


FOREIGN: dict[str, tuple[dict[str, Any], str]] = {
    "of another mass": (certificate(circle_point(0.7), parameters={"mu": "0.0125000001"}), "another value of mu"),
    "of another system": (certificate({"beta": arb(1), "y": arb(1)}), "another system"),
    "of an unknown system": (certificate(circle_point(0.7), system="kepler"), "cannot be read"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_certificates_about_something_else_are_counted(name: str) -> None:
    entry, words = FOREIGN[name]
    conclusion = concluded(symmetric_arc(), entry)
    (found,) = conclusion.bifurcations
    assert found.place is None
    assert words in found.reason
    assert "1 further certificate is about another system" in conclusion_in_words(conclusion)
    assert "level, about other parameters, or not readable here." in conclusion_in_words(conclusion)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "not proved": (certificate(circle_point(0.7), proved=False), "says 'not proved'"),
    "beside the curve": (
        certificate({**circle_point(0.7), "vy": arb(3 - math.cos(0.7) + 1e-5, 2**-40)}),
        "outside the tubes, in p001 by",
    ),
    "beyond the end": (certificate(circle_point(2.9)), "outside the tubes"),
    "far away": (certificate({**circle_point(0.7), "x": arb(100)}), "beyond the ends of all pieces"),
    "wider than the tube": (certificate(circle_point(0.7, 1e-5)), "too wide for the tube"),
    "on the edge of the tube": (
        certificate({**circle_point(0.7), "vy": arb(3 - math.cos(0.7) + 1e-6, 2**-22)}),
        "not shown to lie on the part",
    ),
    "in the plane but of k = 2": (
        certificate({"x": arb(1, 2**-80), "z": arb(0, 2**-80), "vy": arb(2, 2**-80)}),
        "fixed by the symmetry",
    ),
    "of another symmetry": (
        certificate({"x": arb(1), "z": arb(0), "vy": arb(2)}, kind="symmetry_breaking", k=1),
        "fixed by the symmetry",
    ),
    "without a coordinate": (certificate({"x": arb(1), "z": arb(0)}), "not have all coordinates"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_bifurcation_that_is_not_shown_to_lie_on_the_curve_is_named_with_the_reason(name: str) -> None:
    entry, words = REFUSED[name]
    conclusion = concluded(symmetric_arc(), entry)
    assert conclusion.is_proved
    (found,) = conclusion.bifurcations
    assert found.place is None
    assert words in found.reason
    assert f'"{found.id}" (k = {found.k}): {found.reason}' in conclusion_in_words(conclusion)


@pytest.mark.parametrize("beta", [1, 5])
def test_a_bifurcation_at_the_very_end_of_a_curve_is_not_shown_to_lie_on_it(beta: int) -> None:
    for radius, holds in ((2**-40, False), (0, True)):
        entry = certificate({"beta": arb(beta, radius), "y": arb(beta**2) / 100})
        (found,) = concluded(parabola(), entry).bifurcations
        assert (found.place is not None) == holds


def test_a_bifurcation_in_the_middle_of_a_piece_says_nothing_of_the_ends() -> None:
    entry = certificate({"beta": arb(2), "y": arb(4) / 100})
    conclusion = concluded(parabola(), entry)
    assert conclusion.bifurcations[0].place is not None
    assert conclusion.bifurcations[0].place.s.is_zero()
    assert "in piece p000" in conclusion_in_words(conclusion)
    assert "symmetric point" not in conclusion_in_words(conclusion)
    assert proof(conclusion).ends["start"]["beta"] == 1


def test_a_certificate_that_does_not_stand_is_not_used() -> None:
    atlas, results = symmetric_arc()
    (found,) = conclude(atlas, results, [certificate(circle_point(0.7))], falls).bifurcations
    assert found.place is None
    assert "does not fit the content" in found.reason
    (found,) = conclude(atlas, results, [certificate(circle_point(0.7))]).bifurcations
    assert found.place is None


@pytest.fixture(scope="module")
def doubling() -> Certificate:
    """The certificate of a period doubling of the Falkner-Skan equation."""
    return certify(known("fs2"))


def line(beta: Fraction, y: Fraction) -> Case:
    """A piece with constant y, on which the point (beta, y) is at s = 1/4."""
    flat = replace(parabola_piece(0, Fraction(0), Fraction(1)), polynomial=((Fraction(0),),))
    piece = replace(
        flat, centre=(beta - Fraction(1, 4), y), frame=((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    )
    return Atlas("line", "a line", FALKNER_SKAN, {}, Claim("arc"), (piece,)), [proved(piece)]


def test_a_real_certificate_is_examined_and_placed(doubling: Certificate) -> None:
    beta, y = known("fs2").centre
    atlas, results = line(beta, y)
    (found,) = conclude(atlas, results, [doubling]).bifurcations
    assert found.place is not None
    assert not found.place.other_point
    lower, upper = bounds(found.place.s)
    assert lower <= Fraction(1, 4) + Fraction(1, 10**40)
    assert upper >= Fraction(1, 4) - Fraction(1, 10**40)
    assert upper - lower < Fraction(1, 10**20)
    tampered = doubling.to_json()
    tampered["results"]["point"]["y"]["mid"] = "0x1p-1"
    (found,) = conclude(atlas, results, [Certificate.from_json(tampered)]).bifurcations
    assert "does not stand" in found.reason


def test_an_orbit_whose_other_point_lies_on_the_curve_is_placed_there(doubling: Certificate) -> None:
    other = enclose_other_point(ORACLE, FALKNER_SKAN, {}, doubling.point)
    assert other is not None
    atlas, results = line(*(sum(bounds(ball)) / 2 for ball in other.values()))
    conclusion = conclude(atlas, results, [doubling])
    (found,) = conclusion.bifurcations
    assert found.place is not None
    assert found.place.other_point
    assert "the other point of the orbit" in conclusion_in_words(conclusion)


@pytest.mark.parametrize("name", ["fs2", "em2", "em1"])
def test_the_other_point_of_the_other_point_is_the_first(name: str) -> None:
    candidate = known(name)
    system = candidate.system
    with ctx.workprec(300):
        first = {
            key: enclose(value) + arb(0, 2**-130)
            for key, value in zip(system.centre_coordinates, candidate.centre, strict=True)
        }
        other = enclose_other_point(ORACLE, system, candidate.parameters, first)
        assert other is not None
        again = enclose_other_point(ORACLE, system, candidate.parameters, other)
        assert again is not None
        assert any(not first[key].overlaps(other[key]) for key in first)
        for key, ball in first.items():
            assert agree(again[key], ball)
            assert again[key].rad() < 1e-20


def test_the_other_point_is_enclosed_for_all_points_of_a_ball() -> None:
    candidate = known("fs2")
    names = candidate.system.centre_coordinates
    with ctx.workprec(200):
        near, far = (
            {key: enclose(value) + arb(0, radius) for key, value in zip(names, candidate.centre, strict=True)}
            for radius in (2**-100, 2**-50)
        )
        small, large = (enclose_other_point(ORACLE, candidate.system, {}, point) for point in (near, far))
    assert small is not None
    assert large is not None
    assert all(large[key].contains(small[key]) for key in names)
    assert large["y"].rad() > 2**-54


def test_an_orbit_that_is_not_symmetric_has_no_other_point() -> None:
    candidate = known("em2")
    point = {
        key: enclose(value + Fraction(1, 10**6))
        for key, value in zip(candidate.system.centre_coordinates, candidate.centre, strict=True)
    }
    assert enclose_other_point(ORACLE, candidate.system, candidate.parameters, point) is None
    assert (
        enclose_other_point(ORACLE, candidate.system, candidate.parameters, {key: arb("nan") for key in point}) is None
    )


@pytest.mark.slow
def test_two_pieces_of_a_branch_are_proved_and_glued_and_carry_its_bifurcations() -> None:
    atlas = read_atlas(DATA / "atlas-falkner-skan.json")
    pieces = atlas.curve_pieces()
    results = [entry_of(prove_piece(atlas.system, {}, piece, (Fraction(-1), Fraction(1)), ORACLE)) for piece in pieces]
    certificates = [certify(known(name)) for name in ("fs2", "fs3", "fs4")]
    conclusion = conclude(atlas, results, certificates)
    assert conclusion.is_proved
    assert [entry.place is not None for entry in conclusion.bifurcations] == [True, True, True]
    assert "beta takes all values from 260 to 690" in conclusion_in_words(conclusion)
    # The same results do not join the first piece to another branch that runs 1e-6 beside the second.
    beside = replace(pieces[1], centre=(pieces[1].centre[0], pieces[1].centre[1] + Fraction(1, 10**6)))
    other = replace(atlas, pieces=(pieces[0], beside))
    assert "beside its tube" in refusal(conclude(other, results))
    # A tampered polynomial is not that of an orbit.
    (first, *rest) = pieces[0].polynomial[0]
    tampered = replace(pieces[0], polynomial=((first + Fraction(1, 10**8), *rest),))
    assert not prove_piece(atlas.system, {}, tampered, (Fraction(-1), Fraction(1)), ORACLE).is_proved
