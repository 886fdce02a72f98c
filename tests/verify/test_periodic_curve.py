"""Curves of periodic orbits without symmetry: pieces, least periods, gluing, folds (section 26)."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from math import pi
from typing import Any

import pytest
from support.periodic_curves import (
    ATLASES,
    LIMITS,
    TUBE,
    attempt,
    faster_atlas,
    flipped_atlas,
    levels_atlas,
    on_level_atlas,
    proved,
    refused,
    shifted,
    turning_atlas,
    turning_piece,
    twice_atlas,
)

from orbitproof.shared.claims import evaluate
from orbitproof.shared.formats import Covers, PeriodicAtlas
from orbitproof.verify.evidence import NotProved, Proved
from orbitproof.verify.maps import framed_orbits
from orbitproof.verify.oracle.approximations import Approximations
from orbitproof.verify.periodic_curve import conclude_periodic


def condition(atlas: PeriodicAtlas, number: int = 0) -> str:
    """Why a piece is not proved."""
    outcome = attempt(atlas, number).outcome
    assert isinstance(outcome, NotProved)
    return outcome.reason.condition


@pytest.mark.parametrize("name", ATLASES)
def test_exact_curves_are_proved_and_their_periods_contained(name: str) -> None:
    for result in proved(name):
        assert result.is_proved, result.reason
        assert result.time is not None
        assert float(result.time.lower()) <= 2 * pi <= float(result.time.upper())
        # The polynomials are the curve: only bounds of rounding are left.
        assert max(result.deviation) < Fraction(1, 10**12)
    assert conclude_periodic(ATLASES[name], proved(name)).is_proved


def test_orbits_of_a_tube_may_take_as_many_steps_as_an_approximation_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """From 2 steps on; orbits that are not said to come back are given up then."""

    class Mute(Approximations):
        def further_steps(self, *_: object) -> int:
            return 0

    monkeypatch.setattr(framed_orbits, "MOST_STEPS", 1)
    atlas = turning_atlas()
    assert attempt(atlas).is_proved
    outcome = attempt(atlas, oracle=Mute()).outcome
    assert isinstance(outcome, NotProved)
    assert "was not reached in 2 steps" in outcome.reason.message


@pytest.mark.parametrize("seed", range(3))
def test_the_exact_curve_lies_within_the_deviation_of_a_piece_that_is_a_little_off(seed: int) -> None:
    source = random.Random(seed)
    by = Fraction(source.randrange(-(2**20), 2**20), 2**20) * TUBE / 200
    atlas = shifted(turning_atlas(), by)
    found = attempt(atlas)
    assert isinstance(found.outcome, Proved)
    piece = atlas.curve_pieces()[0]
    for _ in range(200):
        s = Fraction(source.randrange(-(2**30), 2**30), 2**30)
        x = piece.centre[1] + piece.half_width * s
        exact = x**4 - 2 * x**2
        assert abs(evaluate(piece.polynomial[0], s) - exact) <= found.outcome.results.deviation[0]


# An orbit that goes round twice takes longest, and is refused for the same reason.
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name == "twice" else ()) for name in ATLASES]
)
def test_pieces_beside_their_curve_are_not_proved(name: str) -> None:
    atlas = ATLASES[name]
    for row in range(len(atlas.curve_pieces()[0].polynomial)):
        assert condition(shifted(atlas, 2 * TUBE, row=row)) == "newton"


def test_nothing_is_proved_beyond_the_ends_of_a_piece() -> None:
    outcome = attempt(turning_atlas(), interval=(Fraction(-1), Fraction(9, 8))).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "piece"


@pytest.mark.slow
def test_a_curve_that_leaves_its_tube_next_to_an_end_is_not_proved() -> None:
    """At s = 16/17 the power of s is a fortieth of what it is at 1."""
    atlas = turning_atlas()
    first, second = atlas.curve_pieces()
    row = (*first.polynomial[0], *[Fraction(0)] * (60 - len(first.polynomial[0])), TUBE / 2)
    bent = replace(atlas, pieces=(replace(first, polynomial=(row,)), second))
    wide = replace(LIMITS, width=100)
    assert not attempt(bent, limits=wide).is_proved
    inside = attempt(bent, limits=wide, interval=(Fraction(-7, 8), Fraction(7, 8)))
    assert inside.is_proved, inside.outcome


def test_a_sixteenth_of_the_tube_is_what_a_curve_may_be_off() -> None:
    assert attempt(shifted(turning_atlas(), TUBE / 20)).is_proved
    assert condition(shifted(turning_atlas(), TUBE / 12)) == "newton"


def test_the_time_is_that_of_all_orbits_of_a_piece() -> None:
    found = attempt(faster_atlas()).outcome
    assert isinstance(found, Proved), found
    time = found.results.time
    assert float(time.lower()) <= 2 * pi / 1.25
    assert 2 * pi <= float(time.upper())
    assert float(time.rad()) < 1


def test_another_direction_is_refused_before_the_integration() -> None:
    assert condition(turning_atlas(direction=-1)) == "direction"


@pytest.mark.parametrize("crossings", [1, *(pytest.param(number, marks=pytest.mark.slow) for number in (3, 4))])
def test_another_number_of_crossings_is_not_proved(crossings: int) -> None:
    assert condition(twice_atlas(crossings)) == {1: "newton", 3: "newton", 4: "least-period"}[crossings]


def test_orbits_run_through_twice_have_no_longer_period() -> None:
    assert condition(turning_atlas(crossings=2)) == "least-period"


def test_a_curve_without_the_level_that_orbits_keep_is_singular() -> None:
    atlas = on_level_atlas()
    assert condition(replace(atlas, claim=replace(atlas.claim, level=None))) in ("slope", "piece")


def test_another_level_is_not_proved() -> None:
    assert condition(on_level_atlas("1.0001")) == "newton"


def test_a_function_that_is_no_integral_is_refused() -> None:
    atlas = levels_atlas()
    system = replace(atlas.system, first_integral=lambda state, _: (state[0] * state[0] + state[2],))
    assert condition(replace(atlas, system=system)) == "first-integral"
    assert refused(replace(atlas, system=system), proved("levels")).startswith("first-integral")


def test_orbits_that_come_back_to_another_point_of_their_level_are_no_curve() -> None:
    assert condition(flipped_atlas()) == "last-coordinate"


def test_an_integral_that_does_not_tell_the_last_coordinate_is_refused() -> None:
    atlas = levels_atlas()

    def integral(state: Any, _: Any) -> Any:
        x, y, _z = state
        return ((x * x + y * y - 1) * (x * x + y * y - 1),)

    assert condition(replace(atlas, system=replace(atlas.system, first_integral=integral))) == "last-coordinate"


def test_a_fold_lies_on_the_curve() -> None:
    outcome = conclude_periodic(turning_atlas(), proved("turning")).outcome
    assert isinstance(outcome, Proved)
    (turn,) = outcome.results.turns
    assert not turn.is_maximum
    assert all(float(value) > -1 for value in turn.values)
    assert all(float(value) < -0.999 for value in turn.values)
    before, after = turn.between
    first, last = (next(p for p in turning_atlas().curve_pieces() if p.id == name) for name in turn.pieces)
    assert first.point(before)[1] < 1 < last.point(after)[1]


def test_gaps_between_pieces_are_refused() -> None:
    atlas = turning_atlas()
    apart = replace(atlas, pieces=(turning_piece("p1", "9/10", "1/11"), turning_piece("p2", "11/10", "1/11")))
    results = tuple(attempt(apart, number).stored for number in (0, 1))
    assert all(result.is_proved for result in results)
    assert "gap" in refused(apart, results)


def test_a_piece_that_is_not_proved_where_the_curve_uses_it_is_a_gap() -> None:
    first, second = proved("turning")
    part = replace(first, interval=(Fraction(-1), Fraction(1, 4)))
    assert "gap" in refused(turning_atlas(), (part, second))
    assert "nothing is proved" in refused(turning_atlas(), (second,))


def test_a_piece_beside_the_next_tube_is_refused() -> None:
    """As if both were proved: two curves that come close are not one."""
    apart = shifted(turning_atlas(), 2 * TUBE, number=1)
    assert "beside its tube" in refused(apart, proved("turning"))


def test_a_piece_that_runs_backwards_is_refused() -> None:
    atlas = turning_atlas()
    first, second = atlas.curve_pieces()
    frame = tuple((-row[0], *row[1:]) for row in second.frame)
    polynomial = tuple(tuple(c * (-1) ** n for n, c in enumerate(row)) for row in second.polynomial)
    turned = replace(atlas, pieces=(first, replace(second, frame=frame, polynomial=polynomial)))
    results = (proved("turning")[0], attempt(turned, 1).stored)
    assert results[1].is_proved
    assert "direction of increasing s" in refused(turned, results)


def test_an_arc_is_no_loop() -> None:
    assert "curve" in refused(turning_atlas(kind="periodic-loop"), proved("turning"))


def test_ranges_and_increase_are_checked() -> None:
    results = proved("turning")
    good = turning_atlas(covers=Covers("x", Fraction(4, 5), Fraction(6, 5)))
    assert conclude_periodic(good, results).is_proved
    assert refused(turning_atlas(covers=Covers("x", Fraction(3, 5), Fraction(6, 5))), results).startswith("covers")
    assert refused(turning_atlas(increasing=("a",)), results).startswith("increasing-a")


def test_exact_conditions_on_pieces() -> None:
    atlas = turning_atlas()
    first, second = atlas.curve_pieces()
    singular = replace(first, frame=((Fraction(0), Fraction(0)), (Fraction(1), Fraction(1))))
    wrong = {
        "singular": (singular, second),
        "same id": (first, replace(second, id="p1")),
        "positive": (replace(first, tube=(-TUBE,)), second),
        "coordinates": (replace(first, centre=first.centre[:1]), second),
        "symmetric": (replace(first, kind="symmetric"), second),
    }
    for pieces in wrong.values():
        changed = replace(atlas, pieces=pieces)
        assert refused(changed, proved("turning")).startswith("pieces")
    for name in ("singular", "positive", "coordinates", "symmetric"):
        assert condition(replace(atlas, pieces=wrong[name])) == "piece"


def test_parameters_are_given_or_vary() -> None:
    atlas = turning_atlas()
    for changed in (replace(atlas, parameters={"a": Fraction(1)}), replace(levels_atlas(), parameters={})):
        assert refused(changed, proved("turning")).startswith("section")


def test_settings_that_make_no_sense_are_refused() -> None:
    for wrong in ({"top": 0}, {"precision": 8}, {"width": 0}):
        with pytest.raises(ValueError, match="too small"):
            replace(LIMITS, **wrong)
