"""What a complete list assumes, dh != 0 along the curve, and how much it says of how many stability parameters."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import cos, pi
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.flow_checks import ball
from support.forgeries import checked
from support.one_piece import OnePiece
from support.stability_cases import atlas, listed, results
from support.stored import value_of, values
from support.within import within

from orbitproof.shared import parse_exact
from orbitproof.shared.systems import ReversibleSystem, record
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.evidence import NotEstablishedError, Reason, ball_from_json, reason_to_json
from orbitproof.verify.stability import open_on
from orbitproof.verify.stability.level import Level, gradient

LOSS = "loss of R"

_precision = within(lambda: ctx.workprec(160))


# dh along the curve


def energy(state: Sequence[Any]) -> Any:
    x, y, u, v = state
    return (u * u + v * v) / 2 + x**2 / 2 + x**4 / 4 - x**2 * y**2 + Fraction(5, 2) * y**2


def coupled(integral: Callable[[Any], Any]) -> ReversibleSystem:
    """x'' = -x - x^3 + 2 x y^2, y'' = -(5 - 2 x^2) y, with a function of the energy as its integral."""

    def field(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
        x, y, u, v = state
        return (u, v, -x - x**3 + 2 * x * y**2, -(5 - 2 * x**2) * y)

    return ReversibleSystem(
        name="coupled",
        title="two coupled oscillators",
        state=("x", "y", "u", "v"),
        parameters={},
        vector_field=field,
        reversing_symmetry=(-1, 1, 1, -1),
        section="x",
        first_integral=lambda state, _: (integral(energy(state)),),
        first_integral_name="level",
    )


@cache
def beside_the_loss_of_symmetry(squared: bool) -> OnePiece:
    """Orbits with y = 0 and x' from 1.8275 to 1.9525 at x = 0; R is lost near 1.893, the energy is 9/5 near 1.897."""
    system = coupled((lambda h: (h - Fraction(9, 5)) ** 2) if squared else lambda h: h)
    return OnePiece(system, 1, Fraction(189, 100), Fraction(1, 16))


def test_a_loss_of_symmetry_is_no_extremum_of_a_level_whose_derivative_vanishes_beside_it() -> None:
    """(H - 9/5)^2 is a first integral too, and stationary where H = 9/5: there the list says nothing."""
    document = beside_the_loss_of_symmetry(True).listed(6)["complete"]
    assert [point["kind"] for point in document["points"]] == [LOSS]
    (gap,) = document["gaps"]
    assert gap["about"] == "everything"
    assert "the derivative of the level on Fix(R) may vanish" in gap["reason"]
    low, high = (parse_exact(end) for end in gap["interval"])
    s = ((18 / 5) ** 0.5 - 1.89) * 16
    assert low < s < high
    assert high - low < Fraction(1, 100)
    (entry,) = document["undecided"]
    assert entry["from"]["what"] == entry["to"]["what"] == ["everything"]


def test_the_derivative_of_the_level_is_a_hypothesis_by_name() -> None:
    conclusion = beside_the_loss_of_symmetry(False).listed(6)
    document = conclusion["complete"]
    assert [point["kind"] for point in document["points"]] == [LOSS]
    assert document["gaps"] == document["undecided"] == []
    (hypothesis,) = document["hypotheses"]
    assert (hypothesis["name"], hypothesis["holds"]) == ("level", True)
    (slope,) = hypothesis["enclosures"].values()
    # dH/dx' = x' at x = y = 0.
    assert 1.8 < float(ball_from_json(slope)) < 1.8275
    assert f"Hypothesis level of the list: {hypothesis['statement']}." in conclusion["statement"]
    assert "at no point of the curve" in hypothesis["statement"]


def test_nothing_is_listed_where_the_level_is_constant() -> None:
    case = beside_the_loss_of_symmetry(False)
    constant = replace(case, system=coupled(lambda h: h - h))
    constant.__dict__["results"] = case.results
    document = constant.listed(6)["complete"]
    assert document["points"] == document["stable"] == []
    (gap,) = document["gaps"]
    assert (gap["interval"], gap["about"]) == (["-0x1", "0x1"], "everything")


def test_a_family_parameter_is_a_level_that_is_nowhere_stationary() -> None:
    document = listed(results())["complete"]
    (hypothesis,) = document["hypotheses"]
    assert (hypothesis["name"], hypothesis["holds"]) == ("level", True)
    assert "beta is a coordinate of Fix(R)" in hypothesis["statement"]


def test_a_list_whose_hypothesis_is_not_shown_is_not_proved(monkeypatch: Any) -> None:
    """And the file says what was asked for, so that checking it again makes the same."""
    reason = Reason("level", "it may vanish", "another first integral")

    def refuse(_: Any) -> Any:
        raise NotEstablishedError(reason)

    monkeypatch.setattr(Level, "hypotheses", property(refuse))
    conclusion = listed(results(), 5)
    assert conclusion["verdict"] == "not proved"
    assert conclusion["reason"] == reason_to_json(reason)
    assert conclusion["statement"] == ""
    assert conclusion["complete"]["order"] == 5
    assert checked(make_atlas_certificate(atlas(), values(results()), conclusion)).stands


def functions(x: Any, y: Any) -> tuple[Any, ...]:
    return (x * x * y - 3 * y**3 + 2, x / (y + 5) - y ** Fraction(1, 2), (x + y) ** 3 / x, x ** (-2) * (x - 1) ** 1)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("number", range(4))
def test_partial_derivatives_on_a_box_contain_those_at_its_points(number: int, seed: int) -> None:
    source = random.Random(seed)
    program = record(lambda state: (functions(*state)[number],), ("x", "y"))
    middle = [Fraction(source.randint(20, 60), 16), Fraction(source.randint(20, 60), 16)]
    box = [ball(value) + arb(0, 1) / 64 for value in middle]
    found = gradient(program, box, ("x", "y"))
    step = Fraction(1, 2**60)
    for _ in range(8):
        place = [value + Fraction(source.randint(-64, 64), 64**2) for value in middle]
        for index, enclosure in enumerate(found):
            ends = [list(map(ball, place)) for _ in range(2)]
            for end, side in zip(ends, (1, -1), strict=True):
                end[index] += side * ball(step)
            left, right = (program.evaluate(end, ball, lambda base, power: base ** ball(power))[0] for end in ends)
            assert (enclosure + arb(0, 1e-15)).contains((left - right) / (2 * ball(step)))
            assert float(enclosure.rad()) < 4


def test_partial_derivatives_where_a_divisor_or_root_may_vanish_are_not_finite() -> None:
    program = record(lambda state: (1 / state[0] + state[1] ** Fraction(1, 2),), ("x", "y"))
    around = arb(0, 1)
    assert not any(value.is_finite() for value in gradient(program, [around, around], ("x", "y")))


# How much is said


@cache
def over_duffing(size: int) -> OnePiece:
    """y_i'' = - (c_i + d_i x^2) y_i over x'' = -x - x^3."""
    names = [f"y{i}" for i in range(size)]
    stiffness = [(Fraction(3 + 2 * i, 4), Fraction(1 + i, 3)) for i in range(size)]

    def field(state: Sequence[Any], _: Sequence[Any]) -> Sequence[Any]:
        x, u, *others = state
        y, v = others[:size], others[size:]
        return (u, -x - x**3, *v, *(-(c + d * x**2) * z for (c, d), z in zip(stiffness, y, strict=True)))

    system = ReversibleSystem(
        name="over-duffing",
        title="oscillators over that of Duffing",
        state=("x", "u", *names, *(f"v{i}" for i in range(size))),
        parameters={},
        vector_field=field,
        reversing_symmetry=(1, -1, *[1] * size, *[-1] * size),
        section="u",
        first_integral=lambda state, _: (state[1] * state[1] / 2 + state[0] ** 2 / 2 + state[0] ** 4 / 4,),
        first_integral_name="energy",
    )
    return OnePiece(system, 0, Fraction(5, 4), Fraction(1, 16))


@pytest.mark.slow
@pytest.mark.parametrize("size", [1, 3])
def test_resonances_are_listed_for_any_number_of_stability_parameters(size: int) -> None:
    """Those of uncoupled oscillators are those of each alone; of more than two nothing else is said."""
    case = over_duffing(size)
    conclusion = case.listed(13)
    document = conclusion["complete"]
    assert document["stability_parameters"] == size
    assert document["gaps"] == []
    (functions_,) = [result["stability"]["characteristic"] for result in case.results]
    assert len(functions_) == size
    assert document["points"]
    words = "Nothing is said of where two of the 3 stability parameters are equal"
    assert (words in conclusion["statement"]) == (size == 3)
    assert ("linearly stable (" in conclusion["statement"]) == (size == 1)
    if size == 3:
        names = ("stable", "undecided", "extrema", "open_extrema")
        assert not any(document[name] for name in names)
        assert "no others" not in conclusion["statement"]
        assert "no stability parameter is stationary" not in conclusion["statement"]
        first = over_duffing(1).listed(13)["complete"]["points"]
        for point in first:
            same = [p for p in document["points"] if (p["k"], p["j"]) == (point["k"], point["j"])]
            assert any(agree(ball_from_json(p["s"]), ball_from_json(point["s"])) for p in same)
        trace = parse_exact(functions_[0]["coefficients"][0])
        assert abs(trace) < 3 * (1 + cos(pi / 64))


def test_nothing_is_open_on_an_interval_for_what_is_not_said_of_three_parameters() -> None:
    case = over_duffing(3)
    (piece,) = case.atlas.curve_pieces()
    assert open_on(piece, value_of(case.results[0]), 7) == ""


def test_functions_of_another_number_of_parameters_are_a_gap() -> None:
    case = over_duffing(1)
    (result,) = case.results
    entry = result["stability"]
    other = replace(case)
    other.__dict__["results"] = [
        {**result, "stability": {**entry, "characteristic": [*entry["characteristic"], entry["level"]]}}
    ]
    document = other.listed(3)["complete"]
    assert [gap["about"] for gap in document["gaps"]] == ["everything"]
    assert "not 1 coefficients" in document["gaps"][0]["reason"]
