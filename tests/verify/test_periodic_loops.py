"""Closed curves of periodic orbits without symmetry, and what is said of their extrema (sections 26.4 and 26.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from support.periodic_curves import (
    ROUND,
    attempt,
    closed_atlas,
    levels_atlas,
    on_level_atlas,
    proved,
    refused,
    turning_atlas,
)

from orbitproof.shared.formats import PeriodicAtlas, define_system
from orbitproof.shared.systems import ParameterRange
from orbitproof.verify.curve import IntervalResult
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.periodic_curve import conclude_periodic
from orbitproof.verify.theorems.periodic_curve import told


def said(atlas: PeriodicAtlas, results: Sequence[IntervalResult]) -> str:
    """The theorem about a curve that is proved."""
    found = conclude_periodic(atlas, results)
    assert found.is_proved, found.outcome
    return str(told(found)["statement"])


def test_what_is_said_of_parts_of_the_closed_curve_is_found_by_integration() -> None:
    atlas, results = closed_atlas(ROUND[4:5])
    found = attempt(atlas, interval=(Fraction(-1, 8), Fraction(1, 8)))
    assert isinstance(found.outcome, Proved), found.outcome
    known = found.outcome.results
    assert (known.start, known.end) == (Fraction(-1, 8), Fraction(1, 8))
    assert known.deviation[0] <= results[0].deviation[0]
    assert known.slope_deviation[0] <= results[0].slope_deviation[0]


def test_a_curve_that_leaves_the_tube_of_a_piece_is_proved_where_it_is_in_it() -> None:
    """The polynomial is off by 2 s^8 times the width of the tube."""
    atlas = turning_atlas()
    first, second = atlas.curve_pieces()
    (row,) = first.polynomial
    bent = replace(first, polynomial=((*row, *[Fraction(0)] * (8 - len(row)), 2 * first.tube[0]),))
    for interval, holds in (((Fraction(1, 2), Fraction(1)), False), ((Fraction(-1, 4), Fraction(1, 4)), True)):
        found = attempt(replace(atlas, pieces=(bent, second)), interval=interval)
        assert found.is_proved == holds


def test_the_slope_of_the_curve_is_within_that_of_its_polynomial_and_the_bound() -> None:
    """The polynomial is off by c s, the curve's own slope by c."""
    atlas = turning_atlas()
    first, second = atlas.curve_pieces()
    ((constant, linear, *others),) = first.polynomial
    off = first.tube[0] / 200
    bent = replace(first, polynomial=((constant, linear + off, *others),))
    outcome = attempt(replace(atlas, pieces=(bent, second)), interval=(Fraction(0), Fraction(1, 4))).outcome
    assert isinstance(outcome, Proved)
    assert off <= outcome.results.slope_deviation[0] < 2 * off
    assert off / 4 <= outcome.results.deviation[0]


def test_a_closed_curve_is_one_with_a_maximum_and_a_minimum() -> None:
    atlas, results = closed_atlas()
    outcome = conclude_periodic(atlas, results).outcome
    assert isinstance(outcome, Proved)
    turns = outcome.results.turns
    assert sorted(turn.is_maximum for turn in turns) == [False, True]
    for turn in turns:
        assert all(0.99 < (value if turn.is_maximum else -value) < 1 for value in map(float, turn.values))
        for name, s, value in zip(turn.pieces, turn.between, turn.values, strict=True):
            (piece,) = (piece for piece in atlas.curve_pieces() if piece.id == name)
            assert abs(float(piece.point(s)[0]) - float(value)) < 1e-8
    words = said(atlas, results)
    for expected in (
        "a smooth closed curve without self-intersections in the coordinates (a, x) through (",
        "a has at least 2 extrema: ",
        "no other points of such orbits but those of the curve.",
    ):
        assert expected in words


@pytest.mark.parametrize(("kind", "angles"), [("periodic-loop", ROUND * 2), ("periodic-arc", ROUND)])
def test_extrema_that_may_be_the_same_are_not_counted(kind: str, angles: tuple[float, ...]) -> None:
    """Pieces that go round twice, or an arc that meets its beginning again."""
    words = said(*closed_atlas(angles, kind=kind))
    assert "a has extrema, some of which are listed more than once if the curve runs through parts" in words
    assert "at least" not in words
    assert ("without self-intersections" in words) == (kind == "periodic-loop")


def test_extrema_of_a_curve_along_which_a_coordinate_increases_are_counted() -> None:
    assert "a has at least one extremum: a minimum" in said(turning_atlas(), proved("turning"))


def test_the_curve_goes_on_beyond_its_ends() -> None:
    for name, atlas in (("levels", levels_atlas()), ("turning", turning_atlas())):
        words = "points of such orbits but those of the curve and, next to its ends, of its continuation."
        assert words in said(atlas, proved(name))
    assert "points of such orbits of that level but those" in said(on_level_atlas(), proved("on-level"))


ORDERS: dict[str, Callable[[list[Any]], list[Any]]] = {
    "left out": lambda pieces: pieces[:-1],
    "exchanged": lambda pieces: [*pieces[:3], pieces[4], pieces[3], *pieces[5:]],
    "backwards": lambda pieces: pieces[::-1],
    "every other": lambda pieces: pieces[::2],
    "one alone": lambda pieces: pieces[:1],
    "none": lambda pieces: [],
    "one that does not close": lambda pieces: pieces[:2],
}


@pytest.mark.parametrize("name", ORDERS)
def test_pieces_in_another_order_are_no_closed_curve(name: str) -> None:
    atlas, results = closed_atlas()
    pieces = tuple(ORDERS[name](list(atlas.pieces)))
    kept = [result for result in results if result.piece in {piece.id for piece in pieces}]
    assert refused(replace(atlas, pieces=pieces), kept).startswith(("curve", "pieces"))


def test_pieces_of_another_curve_do_not_close_it() -> None:
    """One piece a little off, by more than its tube: as if another curve ran beside this one."""
    atlas, results = closed_atlas()
    pieces = list(atlas.curve_pieces())
    a, x = pieces[6].centre
    pieces[6] = replace(pieces[6], centre=(a + Fraction(1, 10**4), x))
    assert "beside its tube" in refused(replace(atlas, pieces=tuple(pieces)), results)


@pytest.mark.parametrize(
    ("lower", "upper", "holds"), [("-1", None, False), (None, "1", True), (None, "-4/5", False), ("-2", "1", True)]
)
def test_the_parameter_lies_inside_its_range(lower: str | None, upper: str | None, holds: bool) -> None:
    ends = (None if end is None else Fraction(end) for end in (lower, upper))
    atlas = turning_atlas()
    system = replace(atlas.system, parameters={"a": ParameterRange(*ends)})
    narrow = replace(atlas, system=system)
    assert conclude_periodic(narrow, proved("turning")).is_proved == holds
    if not holds:
        assert refused(narrow, proved("turning")).startswith("pieces")
        found = attempt(narrow, 1).outcome
        assert isinstance(found, NotProved)
        assert found.reason.condition == "piece"


def test_a_normal_over_coordinates_that_are_functions_of_others_is_refused() -> None:
    atlas = turning_atlas()
    field = {"x": "v", "v": "-a*sin(x)"}
    system = define_system({"name": "pendulum", "state": "x v", "parameters": "a", "field": field})
    claim = replace(atlas.claim, normal=tuple(Fraction(int(name == "v")) for name in system.state))
    found = refused(replace(atlas, system=system, claim=claim), proved("turning"))
    assert found.startswith("section: ")
    assert "no normal" in found


def test_parameters_are_those_of_their_names_in_any_order() -> None:
    where = {"rate": "(a + 2*(x**2 + y**2) - (x**2 + y**2)**2)/10"}
    field = {"x": "rate*x - b*y", "y": "rate*y + b*x"}
    system = define_system({"name": "two", "state": "x y", "parameters": "b a", "where": where, "field": field})
    assert attempt(replace(turning_atlas(), system=system, parameters={"b": Fraction(2)})).is_proved
