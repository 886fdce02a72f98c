"""Pieces in order are proved to be one curve, and whatever is wrong with them is found."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st
from support.chain_cases import (
    HALF_WIDTH,
    TUBE,
    Case,
    certificate,
    circle,
    circle_piece,
    circle_point,
    concluded,
    falls,
    loop,
    parabola,
    parabola_piece,
    proved,
    reversed_piece,
    symmetric_arc,
    symmetric_loop,
    with_piece,
    with_results,
    without,
)
from support.claims import known

from orbitproof.shared.formats.atlas import Atlas, Claim, Covers, Piece, read_atlas
from orbitproof.shared.systems.system import CR3BP, FALKNER_SKAN
from orbitproof.verify.certificate.certificate import Certificate
from orbitproof.verify.certificate.certify import certify
from orbitproof.verify.curve.conclusion import Conclusion
from orbitproof.verify.curve.conditions import check_two_points, hypotheses_of
from orbitproof.verify.curve.other_point import other_point
from orbitproof.verify.curve.piece import prove_piece
from orbitproof.verify.curve.theorem import ProvedCurve, conclude
from orbitproof.verify.curve.tube import read_tube
from orbitproof.verify.evidence.balls_as_text import bounds
from orbitproof.verify.evidence.comparisons import enclose
from orbitproof.verify.evidence.outcome import Checklist, NotEstablishedError, NotProved, Proved

DATA = Path(__file__).parents[1] / "data"

CASES: dict[str, Callable[[], Case]] = {
    "arc": parabola,
    "loop": loop,
    "symmetric arc": symmetric_arc,
    "symmetric loop": symmetric_loop,
}


def refusal(conclusion: Conclusion[ProvedCurve]) -> str:
    """Condition and message of what is not proved, which says nothing of the curve."""
    assert isinstance(conclusion.outcome, NotProved)
    assert conclusion.statement == ""
    assert conclusion.outcome.hypotheses[-1].holds is False
    return f"{conclusion.outcome.reason.condition}: {conclusion.outcome.reason.message}"


def proof(conclusion: Conclusion[ProvedCurve]) -> ProvedCurve:
    """What is known of a curve that is proved."""
    assert isinstance(conclusion.outcome, Proved)
    return conclusion.outcome.results


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_true_curve_is_proved_with_all_its_hypotheses(case: Callable[[], Case]) -> None:
    conclusion = concluded(case())
    assert isinstance(conclusion.outcome, Proved)
    assert [hypothesis.name for hypothesis in conclusion.outcome.hypotheses] == list(hypotheses_of(case()[0]))
    assert json.loads(json.dumps(conclusion.to_json()))["verdict"] == "proved"


def test_the_symmetric_loop_meets_the_plane_in_two_points_whose_enclosures_are_right() -> None:
    conclusion = concluded(symmetric_loop())
    for key, truth in (("start", (1, 0, 2)), ("end", (-1, 0, 4))):
        for ball, value in zip(proof(conclusion).ends[key].values(), truth, strict=True):
            lower, upper = bounds(ball)
            assert lower <= value <= upper
            assert upper - lower < Fraction(1, 10**8)
    assert "exactly two points" in conclusion.statement
    assert "half periods lie in [2.74, 3.26]" in conclusion.statement


def test_joints_are_where_the_pieces_overlap() -> None:
    chain = proof(concluded(loop())).chain
    assert len(chain.joints) == 10
    for joint in chain.joints:
        # The end of a piece is at the angle asin(0.4) from its centre, and the centres are pi/5 apart.
        expected = math.sin(math.asin(float(joint.leaves * HALF_WIDTH)) - math.pi / 5) / float(HALF_WIDTH)
        assert abs(float(joint.enters.mid()) - expected) < 1e-6
        assert joint.turn > 0


def test_intervals_of_a_piece_that_touch_are_enough() -> None:
    parts = ({"interval": ["-1", "0.25"]}, {"interval": ["0.25", "0.5"]}, {"interval": ["0.375", "1"]})
    assert concluded(with_results(symmetric_loop(), 2, *parts)).is_proved


def test_what_the_curve_does_not_use_need_not_be_proved() -> None:
    # Piece 3 is entered at s = -0.54 and left at s = 1 at the earliest where piece 4 begins, s = 0.54.
    assert concluded(with_results(symmetric_loop(), 3, {"interval": ["-0.75", "0.75"]})).is_proved


@pytest.mark.parametrize("interval", [["0", "1"], ["-1", "0"]])
def test_half_of_a_symmetric_piece_is_enough(interval: list[str]) -> None:
    assert concluded(with_results(symmetric_arc(), 0, {"interval": interval})).is_proved
    assert concluded(with_results(symmetric_loop(), 5, {"interval": interval})).is_proved


GAPS: dict[str, tuple[Case, str]] = {
    "piece missing": (without(symmetric_loop(), 2), "there is a gap"),
    "piece missing in a loop": (without(loop(), 9), "there is a gap"),
    "interval missing": (
        with_results(symmetric_loop(), 2, {"interval": ["-1", "0"]}, {"interval": ["0.125", "1"]}),
        "nothing is proved at s just above 0",
    ),
    "interval not proved": (
        with_results(
            symmetric_loop(), 2, {"interval": ["-1", "0"]},
            {"interval": ["0", "1"], "verdict": "not proved", "reason": {"message": "the tube does not hold"}},
        ),
        "the tube does not hold",
    ),
    "interval and a part of it not proved": (
        with_results(
            symmetric_loop(), 2, {"interval": ["-1", "0"]},
            {"interval": ["0", "1"], "verdict": "not proved", "reason": {"message": "the whole"}},
            {"interval": ["0", "0.5"], "verdict": "not proved", "reason": {"message": "the part"}},
            {"interval": ["0.5", "1"]},
        ),
        "s in [0, 0.5]: the part",
    ),
    "piece not proved": (with_results(loop(), 3), "nothing is proved"),
    "first piece not proved": (with_results(loop(), 0), "nothing is proved"),
    "begins late": (with_results(parabola(), 0, {"interval": ["-0.875", "1"]}), "nothing is proved at s = -1"),
    "ends early": (with_results(parabola(), 2, {"interval": ["-1", "0.875"]}), "s from 0.875 to 1"),
    "symmetric point not proved": (with_results(symmetric_arc(), 0, {"interval": ["0.125", "1"]}), "at s = 0"),
    "last symmetric point not proved": (
        with_results(symmetric_loop(), 5, {"interval": ["-1", "-0.125"]}),
        "s from -0.125 to 0",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", GAPS)
def test_gaps_are_found(name: str) -> None:
    case, words = GAPS[name]
    message = refusal(concluded(case))
    assert message.startswith("curve: ")
    assert words in message


def test_a_loop_that_does_not_close_is_found() -> None:
    open_arc = circle(Claim("loop"), [0.1 + k * math.pi / 5 for k in range(8)])
    assert "p007 and p000: there is a gap" in refusal(concluded(open_arc))


def test_a_loop_that_is_not_proved_where_it_closes_is_found() -> None:
    assert "there is a gap" in refusal(concluded(with_results(loop(), 0, {"interval": ["-0.25", "1"]})))
    # The last piece enters the first one at -0.54, on a part from which the rest is cut off.
    parts = ({"interval": ["-1", "-0.375"]}, {"interval": ["-0.25", "1"]})
    assert "the loop does not close" in refusal(concluded(with_results(loop(), 0, *parts)))


def test_a_loop_whose_first_piece_is_left_before_it_is_entered_is_found() -> None:
    # The second piece lies behind the first, which is left at 0.21, while the last one reaches it at 0.41.
    angles = [0.1, -0.2, *(0.3 + 0.6 * k for k in range(10)), 2 * math.pi]
    assert "the loop does not close" in refusal(concluded(circle(Claim("loop"), angles)))


@pytest.mark.parametrize("lift", [2e-6, -1e-3])
def test_a_piece_on_another_branch_is_found(lift: float) -> None:
    case = with_piece(symmetric_loop(), 2, lambda piece: circle_piece(2, 2 * math.pi / 5, lift=lift))
    message = refusal(concluded(case))
    assert "p001 and p002" in message
    assert "lies beside its tube" in message


def test_a_tube_that_does_not_hold_the_end_of_the_former_piece_is_found() -> None:
    narrow = with_piece(symmetric_loop(), 2, lambda piece: replace(piece, tube=(Fraction(1, 10**12),) * 2))
    small = {"deviation": ["1e-13", "1e-13"]}
    assert "beside its tube" in refusal(concluded(with_results(narrow, 2, small)))


@pytest.mark.parametrize("number", [1, 2, 4])
def test_a_piece_the_wrong_way_round_is_found(number: int) -> None:
    message = refusal(concluded(with_piece(symmetric_loop(), number, reversed_piece)))
    assert f"p{number - 1:03} and p{number:03}" in message
    assert "in the direction of increasing s" in message


def test_the_last_symmetric_piece_the_wrong_way_round_is_found() -> None:
    assert "entered before s = 0" in refusal(concluded(with_piece(symmetric_loop(), 5, reversed_piece)))


@pytest.mark.parametrize("angle", [math.pi - math.asin(0.4), 2.9])
def test_the_last_symmetric_piece_is_entered_before_its_symmetric_point(angle: float) -> None:
    # The piece before it reaches to the symmetric point, or beyond.
    conclusion = concluded(circle(Claim("symmetric-loop", "S"), [0, 0.6, 1.2, 1.8, 2.3, angle, math.pi], (0, 6)))
    assert proof(conclusion).chain.joints[-1].enters < 0


def test_the_direction_has_to_be_certain() -> None:
    vague = {"slope_deviation": ["1000", "1000"]}
    assert "direction of increasing s" in refusal(concluded(with_results(symmetric_loop(), 1, vague)))


@pytest.mark.parametrize("number", [0, 5])
def test_an_odd_coefficient_in_a_symmetric_piece_is_found(number: int) -> None:
    def tilt(piece: Piece) -> Piece:
        first, second = piece.polynomial
        return replace(piece, polynomial=(first, (*second, Fraction(1, 2**200))))

    message = refusal(concluded(with_piece(symmetric_loop(), number, tilt)))
    assert f"p{number:03} has an odd coefficient" in message


def off_centre(piece: Piece) -> Piece:
    x, z, vy = piece.centre
    return replace(piece, centre=(x, z + Fraction(1, 2**200), vy))


def tilted_along(piece: Piece) -> Piece:
    x, z, vy = piece.frame
    return replace(piece, frame=((x[0] + Fraction(1, 2**200), *x[1:]), z, vy))


def tilted_across(piece: Piece) -> Piece:
    x, z, vy = piece.frame
    return replace(piece, frame=(x, (z[0], z[1], Fraction(1, 2**200)), vy))


@pytest.mark.parametrize("change", [off_centre, tilted_along, tilted_across])
def test_a_symmetric_piece_that_is_not_adapted_is_found(change: Callable[[Piece], Piece]) -> None:
    assert "negate column 0 only" in refusal(concluded(with_piece(symmetric_loop(), 0, change)))


def singular(piece: Piece) -> Piece:
    return replace(piece, frame=(*piece.frame[:-1], tuple(2 * value for value in piece.frame[0])))


BAD_PIECES: dict[str, Callable[[Piece], Piece]] = {
    "is symmetric": lambda piece: replace(piece, kind="symmetric"),
    "is singular": singular,
    "have to be positive": lambda piece: replace(piece, tube=(TUBE, Fraction(0))),
    "half_width and tube": lambda piece: replace(piece, half_width=-piece.half_width),
    "does not have 3 coordinates": lambda piece: replace(piece, polynomial=piece.polynomial[:1]),
    "same id": lambda piece: replace(piece, id="p000"),
}


@pytest.mark.parametrize("words", BAD_PIECES)
def test_a_piece_that_makes_no_sense_is_found(words: str) -> None:
    message = refusal(concluded(with_piece(symmetric_loop(), 2, BAD_PIECES[words])))
    assert message.startswith("pieces: ")
    assert words in message


@pytest.mark.parametrize("number", [0, 5])
def test_a_symmetric_curve_begins_and_ends_in_symmetric_pieces(number: int) -> None:
    message = refusal(concluded(with_piece(symmetric_loop(), number, lambda piece: replace(piece, kind="regular"))))
    assert "it has to be symmetric" in message


def test_a_claim_that_is_not_about_a_curve_is_refused() -> None:
    atlas, results = symmetric_arc()
    for claim in (Claim("symmetry-breaking-surface", "S"), Claim("symmetric-arc"), Claim("symmetric-arc", "T")):
        assert not concluded((replace(atlas, claim=claim), results)).is_proved


def test_a_curve_that_goes_through_the_plane_on_its_way_is_found() -> None:
    # From the angle 0 upwards all around to -0.6: z changes its sign at the angle pi, on regular pieces.
    case = circle(Claim("symmetric-arc", "S"), [k * math.pi / 5 for k in range(9)], (0,))
    message = refusal(concluded(case))
    assert message.startswith("plane: ")
    assert "p005" in message


def test_a_symmetric_loop_that_comes_back_to_its_first_point_is_found() -> None:
    case = circle(Claim("symmetric-loop", "S"), [k * math.pi / 5 for k in range(11)], (0, 10))
    atlas, results = case
    pieces = list(atlas.curve_pieces())
    pieces[10] = replace(circle_piece(10, 0.0, "symmetric"))
    assert refusal(concluded((replace(atlas, pieces=tuple(pieces)), results))).startswith("plane: ")


@pytest.mark.parametrize("coordinate", ["x", "z"])
def test_a_coordinate_that_does_not_increase_is_found(coordinate: str) -> None:
    message = refusal(concluded(symmetric_arc(Claim("symmetric-arc", "S", ("vy", coordinate)))))
    assert message.startswith(f"increasing-{coordinate}: ")


def test_what_increases_from_a_symmetric_point_is_shown_from_there_on() -> None:
    short = circle(Claim("symmetric-arc", "S", ("z", "vy")), [0, math.pi / 5], (0,))
    conclusion = concluded(short)
    assert "From end to end z increases strictly" in conclusion.statement
    assert "minimum of vy" in conclusion.statement


def test_a_slope_that_is_known_too_badly_does_not_show_an_increase() -> None:
    # d(vy)/ds = half_width^2 s + ..: its error, divided by s, has to be smaller than 0.16.
    case = with_results(symmetric_arc(), 0, {"slope_deviation": ["0.1", "0.01"]})
    assert concluded(case).is_proved
    case = with_results(symmetric_arc(), 0, {"slope_deviation": ["0.16", "0.01"]})
    assert "increasing-vy" in refusal(concluded(case))


@pytest.mark.parametrize(("start", "end"), [("0.9999999", "5"), ("1", "5.0000001"), ("0", "5"), ("1", "6")], ids=str)
def test_a_range_that_is_not_covered_is_found(start: str, end: str) -> None:
    claim = Claim("arc", None, (), Covers("beta", Fraction(start), Fraction(end)))
    assert refusal(concluded(parabola(claim))).startswith("covers: ")


@pytest.mark.parametrize(
    ("start", "end", "holds"),
    [
        ("0.0100001", "0.2499999", True),
        ("0.01", "0.2499999", False),
        ("0.0100001", "0.25", False),
    ],
)
def test_a_range_that_is_covered_up_to_an_error_only_is_not_covered(start: str, end: str, holds: bool) -> None:
    claim = Claim("arc", None, (), Covers("y", Fraction(start), Fraction(end)))
    assert concluded(parabola(claim)).is_proved == holds


def test_along_a_symmetric_loop_a_coordinate_can_increase_from_one_symmetric_point_to_the_other() -> None:
    conclusion = concluded(symmetric_loop(Claim("symmetric-loop", "S", ("vy",))))
    assert "vy increases strictly" in conclusion.statement
    assert "increasing-x" in refusal(concluded(symmetric_loop(Claim("symmetric-loop", "S", ("x",)))))


def test_on_both_sides_of_a_symmetric_point_only_what_the_symmetry_negates_increases() -> None:
    piece = circle_piece(0, 0.0, "symmetric")
    back = reversed_piece(piece)
    tube, other = read_tube(piece, [proved(piece)]), read_tube(back, [proved(back)])
    everywhere = (Fraction(-1), Fraction(1))
    with ctx.workprec(128):
        assert tube.coordinate_increases(1, tube.runs[0], *everywhere)
        assert not other.coordinate_increases(1, other.runs[0], *everywhere)
        assert not tube.coordinate_increases(2, tube.runs[0], *everywhere)
        assert not tube.coordinate_increases(0, tube.runs[0], *everywhere)
        assert tube.coordinate_increases(2, tube.runs[0], Fraction(0), Fraction(1))
        assert not tube.coordinate_increases(2, tube.runs[0], Fraction(-1), Fraction(0))
        assert tube.coordinate_increases(0, tube.runs[0], Fraction(-1), Fraction(0))


def test_two_points_that_are_not_told_apart_may_be_one() -> None:
    first, last = ([arb(value, 2**-20) for value in values] for values in ((1, 0, 2), (1, 0, 2.000001)))
    with pytest.raises(NotEstablishedError, match="the same point"):
        check_two_points(Checklist(), ("x", "z", "vy"), first, last)
    check_two_points(Checklist(), ("x", "z", "vy"), first, [*last[:2], arb(3)])


def without_reversibility(state: Any, parameters: Any) -> Any:
    field = list(CR3BP.vector_field(state, parameters))
    return (*field[:3], field[3] + state[3], *field[4:])


def without_mirror_symmetry(state: Any, parameters: Any) -> Any:
    field = list(CR3BP.vector_field(state, parameters))
    return (*field[:3], field[3] + state[2], *field[4:])


@pytest.mark.parametrize("field", [without_reversibility, without_mirror_symmetry])
def test_the_symmetries_of_the_system_are_checked(field: Any) -> None:
    atlas, results = symmetric_loop()
    broken = replace(atlas, system=replace(CR3BP, vector_field=field))
    assert refusal(concluded((broken, results))).startswith("symmetries: ")


BAD_NUMBERS: dict[str, dict[str, Any]] = {
    "NaN": {"deviation": ["NaN", "0"]},
    "infinite": {"deviation": ["inf", "0"]},
    "a float": {"deviation": [1e-9, 1e-9]},
    "negative": {"deviation": ["-1e-9", "1e-9"]},
    "one too few": {"deviation": ["1e-9"]},
    "none": {"deviation": None},
    "slope NaN": {"slope_deviation": ["NaN", "0"]},
    "slope missing": {"slope_deviation": []},
    "as wide as the tube": {"deviation": ["1e-6", "0"]},
    "wider than the tube": {"deviation": ["0", "1e-5"]},
    "interval too wide": {"interval": ["-1.5", "1"]},
    "interval empty": {"interval": ["1", "-1"]},
    "interval not a number": {"interval": ["-1", "nan"]},
    "another verdict": {"verdict": "Proved"},
    "no verdict": {"verdict": True},
}


@pytest.mark.parametrize("number", [0, 2])
@pytest.mark.parametrize("name", BAD_NUMBERS)
def test_results_that_are_not_finite_exact_bounds_do_not_count(name: str, number: int) -> None:
    assert "nothing is proved" in refusal(concluded(with_results(symmetric_loop(), number, BAD_NUMBERS[name])))


def test_a_result_of_another_piece_does_not_count() -> None:
    assert "nothing is proved" in refusal(concluded(with_results(symmetric_loop(), 2, {"piece": "p003"})))


def test_half_periods_that_are_not_known_are_not_stated() -> None:
    assert "half periods" not in concluded(with_results(symmetric_loop(), 2, {"time": None})).statement


@given(st.floats(-1, 1), st.floats(-1, 1), st.integers(0, 5))
def test_enclosures_of_a_piece_contain_the_curve(at: float, share: float, number: int) -> None:
    atlas, results = symmetric_loop()
    piece = atlas.curve_pieces()[number]
    tube = read_tube(piece, [results[number]])
    s = Fraction(at)
    angle = number * math.pi / 5 + math.asin(at * float(HALF_WIDTH))
    truth = (math.cos(angle), math.sin(angle), 3 - math.cos(angle))
    with ctx.workprec(128):
        balls = tube.point(tube.runs[0], s)
        for ball, value in zip(balls, truth, strict=True):
            lower, upper = bounds(ball)
            assert lower - Fraction(1, 10**14) <= value <= upper + Fraction(1, 10**14)
        p, slope = tube.local(tube.runs[0], s), tube.local_slope(tube.runs[0], s)
        assert tube.contains(tube.parameter(p), p)
        assert all(a.overlaps(b) for a, b in zip(tube.to_local(balls), p, strict=True))
        # The derivative of sqrt(1 - (h s)^2) in s.
        sine = at * float(HALF_WIDTH)
        expected = -float(HALF_WIDTH) * sine / math.sqrt(1 - sine**2)
        assert abs(float(slope[1].mid()) - expected) <= 1e-9
        beside = [p[0], p[1] + arb(1.01 if share > 0 else -1.01) * arb(float(TUBE)), p[2]]
        assert not tube.contains(tube.parameter(p), beside)


@given(st.integers(-8, 8), st.integers(1, 40))
def test_signs_on_an_interval_are_those_of_the_curve(centre: int, width: int) -> None:
    """z - zero of the circle's regular piece around 0: positive exactly where the whole interval is."""
    piece = replace(circle_piece(0, 0.0), id="p")
    tube = read_tube(piece, [proved(piece)])
    lower, upper = (Fraction(max(-1, min(1, value))) for value in (centre / 8 - width / 80, centre / 8 + width / 80))
    with ctx.workprec(128):
        positive = tube.coordinate_is_beyond_zero(1, 1, tube.runs[0], lower, upper)
        negative = tube.coordinate_is_beyond_zero(1, -1, tube.runs[0], lower, upper)
    assert positive == (lower > 0)
    assert negative == (upper < 0)


# Bifurcations on the curve.


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
    assert proof(conclusion).ends["end"]["vy"].rad() > 2**-40
    assert "symmetric point of piece p000" in conclusion.statement


def test_the_other_end_of_a_symmetric_arc_of_one_piece_is_not_its_symmetric_point() -> None:
    point = {"x": arb(1, 2**-80), "z": arb(0), "vy": arb(2, 2**-80)}
    case = circle(Claim("symmetric-arc", "S"), [0.0], (0,))
    conclusion = concluded(case, certificate(point, kind="symmetry_breaking", k=1, symmetry="S"))
    assert conclusion.bifurcations[0].place is not None
    ends = proof(conclusion).ends
    assert ends["start"]["vy"].rad() < 2**-79
    assert ends["end"]["z"].overlaps(arb(2) / 5)


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
    assert "1 further certificate is about another system" in conclusion.statement


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
    assert f"{found.id} (k = {found.k}): {found.reason}" in conclusion.statement


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
    assert proof(conclusion).ends["start"]["beta"] == 1


def test_a_certificate_that_does_not_stand_is_not_used() -> None:
    atlas, results = symmetric_arc()
    (found,) = conclude(atlas, results, [certificate(circle_point(0.7))], falls).bifurcations
    assert found.place is None
    assert "does not fit the content" in found.reason
    (found,) = conclude(atlas, results, [certificate(circle_point(0.7))]).bifurcations
    assert found.place is None


def test_another_vector_field_is_noticed() -> None:
    entry = certificate(circle_point(0.7), after=" ")
    (found,) = concluded(symmetric_arc(), entry).bifurcations
    assert "another vector field" in found.reason


def test_nothing_lies_on_a_curve_that_is_not_proved() -> None:
    conclusion = concluded(without(symmetric_loop(), 2), certificate(circle_point(0.7)))
    assert not conclusion.is_proved
    assert [entry.place for entry in conclusion.bifurcations] == [None]


def test_a_conclusion_cannot_be_made_of_less_than_its_hypotheses() -> None:
    outcome = concluded(symmetric_loop()).outcome
    assert isinstance(outcome, Proved)
    *others, last = outcome.hypotheses
    for fewer in ((), tuple(others), (*others, replace(last, holds=False)), (last, *others)):
        with pytest.raises(ValueError, match=r"not those of the theorem|proves nothing"):
            replace(outcome, hypotheses=fewer)


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
    other = other_point(FALKNER_SKAN, {}, doubling.point)
    assert other is not None
    atlas, results = line(*(sum(bounds(ball)) / 2 for ball in other.values()))
    conclusion = conclude(atlas, results, [doubling])
    (found,) = conclusion.bifurcations
    assert found.place is not None
    assert found.place.other_point
    assert "the other point of the orbit" in conclusion.statement


@pytest.mark.parametrize("name", ["fs2", "em2", "em1"])
def test_the_other_point_of_the_other_point_is_the_first(name: str) -> None:
    candidate = known(name)
    system = candidate.system
    with ctx.workprec(300):
        first = {
            key: enclose(value) + arb(0, 2**-130)
            for key, value in zip(system.centre_coordinates, candidate.centre, strict=True)
        }
        other = other_point(system, candidate.parameters, first)
        assert other is not None
        again = other_point(system, candidate.parameters, other)
        assert again is not None
        assert any(not first[key].overlaps(other[key]) for key in first)
        for key, ball in first.items():
            assert again[key].overlaps(ball)
            assert again[key].rad() < 1e-20


def test_the_other_point_is_enclosed_for_all_points_of_a_ball() -> None:
    candidate = known("fs2")
    names = candidate.system.centre_coordinates
    with ctx.workprec(200):
        near, far = (
            {key: enclose(value) + arb(0, radius) for key, value in zip(names, candidate.centre, strict=True)}
            for radius in (2**-100, 2**-50)
        )
        small, large = (other_point(candidate.system, {}, point) for point in (near, far))
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
    assert other_point(candidate.system, candidate.parameters, point) is None
    assert other_point(candidate.system, candidate.parameters, {key: arb("nan") for key in point}) is None


@pytest.mark.slow
def test_two_pieces_of_a_branch_are_proved_and_glued_and_carry_its_bifurcations() -> None:
    atlas = read_atlas(DATA / "atlas-falkner-skan.json")
    pieces = atlas.curve_pieces()
    results = [
        json.loads(json.dumps(prove_piece(atlas.system, {}, piece, (Fraction(-1), Fraction(1))).to_json()))
        for piece in pieces
    ]
    certificates = [certify(known(name)) for name in ("fs2", "fs3", "fs4")]
    conclusion = conclude(atlas, results, certificates)
    assert conclusion.is_proved
    assert [entry.place is not None for entry in conclusion.bifurcations] == [True, True, True]
    assert "beta takes all values from 260 to 690" in conclusion.statement
    # The same results do not join the first piece to another branch that runs 1e-6 beside the second.
    beside = replace(pieces[1], centre=(pieces[1].centre[0], pieces[1].centre[1] + Fraction(1, 10**6)))
    other = replace(atlas, pieces=(pieces[0], beside))
    assert "beside its tube" in refusal(conclude(other, results))
    # A tampered polynomial is not that of an orbit.
    (first, *rest) = pieces[0].polynomial[0]
    tampered = replace(pieces[0], polynomial=((first + Fraction(1, 10**8), *rest),))
    assert not prove_piece(atlas.system, {}, tampered, (Fraction(-1), Fraction(1))).is_proved
