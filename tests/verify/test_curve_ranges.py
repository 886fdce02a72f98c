"""What increases along a curve, which ranges it covers, where it meets the plane, and enclosures of its points."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import given
from hypothesis import strategies as st
from support.chain_cases import (
    circle,
    circle_piece,
    concluded,
    parabola,
    proved,
    reversed_piece,
    symmetric_arc,
    symmetric_loop,
    with_results,
)
from support.curve_cases import refusal
from support.stored import values

from orbitproof.shared.claims import Claim, Covers
from orbitproof.verify.curve import check_two_points, read_tube
from orbitproof.verify.evidence import Checklist, NotEstablishedError
from orbitproof.verify.words.branches import conclusion_in_words


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
    assert "From end to end z increases strictly" in conclusion_in_words(conclusion)
    assert "minimum of vy" in conclusion_in_words(conclusion)


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
    assert "vy increases strictly" in conclusion_in_words(conclusion)
    assert "increasing-x" in refusal(concluded(symmetric_loop(Claim("symmetric-loop", "S", ("x",)))))


def test_on_both_sides_of_a_symmetric_point_only_what_the_symmetry_negates_increases() -> None:
    piece = circle_piece(0, 0.0, "symmetric")
    back = reversed_piece(piece)
    tube, other = read_tube(piece, values([proved(piece)])), read_tube(back, values([proved(back)]))
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


@given(st.integers(-8, 8), st.integers(1, 40))
def test_signs_on_an_interval_are_those_of_the_curve(centre: int, width: int) -> None:
    """z - zero of the circle's regular piece around 0: positive exactly where the whole interval is."""
    piece = replace(circle_piece(0, 0.0), id="p")
    tube = read_tube(piece, values([proved(piece)]))
    lower, upper = (Fraction(max(-1, min(1, value))) for value in (centre / 8 - width / 80, centre / 8 + width / 80))
    with ctx.workprec(128):
        positive = tube.coordinate_is_beyond_zero(1, 1, tube.runs[0], lower, upper)
        negative = tube.coordinate_is_beyond_zero(1, -1, tube.runs[0], lower, upper)
    assert positive == (lower > 0)
    assert negative == (upper < 0)


@pytest.mark.parametrize(("height", "known"), [(Fraction(1, 2**28), True), (Fraction(1, 2**32), False)])
def test_what_is_unknown_of_a_coordinate_may_change_its_sign(height: Fraction, known: bool) -> None:
    """x of the circle's piece around 0, moved such that it is `height` at s = 0, known to 2^-30."""
    piece = circle_piece(0, 0.0)
    piece = replace(piece, centre=(piece.centre[0] - piece.point(Fraction(0))[0] + height, *piece.centre[1:]))
    tube = read_tube(piece, values([{**proved(piece), "deviation": ["0x1p-30", "0x1p-30"]}]))
    with ctx.workprec(128):
        assert tube.coordinate_is_beyond_zero(0, 1, tube.runs[0], Fraction(0), Fraction(1, 2**16)) == known


def test_runs_end_at_every_gap_and_are_as_long_as_their_longest_interval() -> None:
    piece = circle_piece(0, 0.0)

    def runs(*intervals: tuple[str, str]) -> list[tuple[Fraction, Fraction]]:
        tube = read_tube(piece, values([{**proved(piece), "interval": list(interval)} for interval in intervals]))
        return [(run.start, run.end) for run in tube.runs]

    assert runs(("-1", "0x1p-20"), ("0x3p-20", "1")) == [
        (Fraction(-1), Fraction(1, 2**20)),
        (Fraction(3, 2**20), Fraction(1)),
    ]
    assert runs(("-1", "0.75"), ("-0.5", "0.25")) == [(Fraction(-1), Fraction(3, 4))]
