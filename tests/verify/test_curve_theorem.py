"""Pieces in order are proved to be one curve, and whatever is wrong with them is found."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st
from support.balls import agree
from support.chain_cases import (
    HALF_WIDTH,
    TUBE,
    Case,
    certificate,
    circle,
    circle_piece,
    circle_point,
    concluded,
    loop,
    parabola,
    reversed_piece,
    symmetric_arc,
    symmetric_loop,
    with_piece,
    with_results,
    without,
)
from support.curve_cases import proof, refusal
from support.stored import values

from orbitproof.shared.claims import Claim, Piece
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.curve import read_tube
from orbitproof.verify.curve.conditions import hypotheses_of
from orbitproof.verify.evidence import Proved, bounds, enclose
from orbitproof.verify.words.branches import conclusion_in_words

CASES: dict[str, Callable[[], Case]] = {
    "arc": parabola,
    "loop": loop,
    "symmetric arc": symmetric_arc,
    "symmetric loop": symmetric_loop,
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_true_curve_is_proved_with_all_its_hypotheses(case: Callable[[], Case]) -> None:
    conclusion = concluded(case())
    assert isinstance(conclusion.outcome, Proved)
    assert [hypothesis.name for hypothesis in conclusion.outcome.hypotheses] == list(hypotheses_of(case()[0]))
    assert json.loads(json.dumps(told(conclusion)))["verdict"] == "proved"


def test_the_symmetric_loop_meets_the_plane_in_two_points_whose_enclosures_are_right() -> None:
    conclusion = concluded(symmetric_loop())
    for key, truth in (("start", (1, 0, 2)), ("end", (-1, 0, 4))):
        for ball, value in zip(proof(conclusion).ends[key].values(), truth, strict=True):
            lower, upper = bounds(ball)
            assert lower <= value <= upper
            assert upper - lower < Fraction(1, 10**8)
    assert "exactly two points" in conclusion_in_words(conclusion)
    assert "half periods lie in [2.749, 3.251]" in conclusion_in_words(conclusion)


def test_joints_are_where_the_pieces_overlap() -> None:
    chain = proof(concluded(loop())).chain
    assert len(chain.joints) == 10
    for joint in chain.joints:
        # The end of a piece is at the angle asin(0.4) from its centre, and the centres are pi/5 apart.
        expected = math.sin(math.asin(float(joint.leaves * HALF_WIDTH)) - math.pi / 5) / float(HALF_WIDTH)
        assert abs(float(joint.enters.mid()) - expected) < 1e-6
        assert joint.turn > 0


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_stretch_is_entered_between_bounds_and_holds_what_lies_surely_behind_them(case: Callable[[], Case]) -> None:
    chain = proof(concluded(case())).chain
    for joint in chain.joints:
        lower, upper = bounds(joint.enters)
        entered = [each for each in chain.stretches if each.tube.piece.id == joint.after]
        assert any(each.enters <= lower <= upper <= each.entered for each in entered)
    for stretch in chain.stretches:
        assert stretch.contains(enclose((stretch.entered + stretch.leaves) / 2))
        if stretch.enters < stretch.entered:
            assert not stretch.contains(enclose((stretch.enters + stretch.entered) / 2))


def test_slopes_of_a_regular_piece_are_known_to_their_bound_at_its_middle_too() -> None:
    atlas, results = loop()
    result = {**results[0], "slope_deviation": ["0.125", "0.25"]}
    tube = read_tube(atlas.curve_pieces()[0], values([result]))
    for s in (Fraction(0), Fraction(1, 2), Fraction(-1)):
        _, *across = tube.local_slope(tube.runs[0], s)
        assert [float(ball.rad()) >= width for ball, width in zip(across, (0.125, 0.25), strict=True)] == [True, True]


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
NO_RESULT = ("NaN", "infinite", "a float", "slope NaN", "interval not a number", "another verdict", "no verdict")


@pytest.mark.parametrize("number", [0, 2])
@pytest.mark.parametrize("name", BAD_NUMBERS)
def test_results_that_are_not_finite_exact_bounds_do_not_count(name: str, number: int) -> None:
    """What is no exact number is no result; what is none of a proof does not count."""
    case = with_results(symmetric_loop(), number, BAD_NUMBERS[name])
    if name in NO_RESULT:
        with pytest.raises(InputError):
            concluded(case)
    else:
        assert "nothing is proved" in refusal(concluded(case))


def test_a_result_of_another_piece_does_not_count() -> None:
    assert "nothing is proved" in refusal(concluded(with_results(symmetric_loop(), 2, {"piece": "p003"})))


def test_half_periods_that_are_not_known_are_not_stated() -> None:
    assert "half periods" not in conclusion_in_words(concluded(with_results(symmetric_loop(), 2, {"time": None})))


@given(st.floats(-1, 1), st.floats(-1, 1), st.integers(0, 5))
def test_enclosures_of_a_piece_contain_the_curve(at: float, share: float, number: int) -> None:
    atlas, results = symmetric_loop()
    piece = atlas.curve_pieces()[number]
    tube = read_tube(piece, values([results[number]]))
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
        assert all(agree(a, b) for a, b in zip(tube.to_local(balls), p, strict=True))
        # The derivative of sqrt(1 - (h s)^2) in s.
        sine = at * float(HALF_WIDTH)
        expected = -float(HALF_WIDTH) * sine / math.sqrt(1 - sine**2)
        assert abs(float(slope[1].mid()) - expected) <= 1e-9
        beside = [p[0], p[1] + arb(1.01 if share > 0 else -1.01) * arb(float(TUBE)), p[2]]
        assert not tube.contains(tube.parameter(p), beside)


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
