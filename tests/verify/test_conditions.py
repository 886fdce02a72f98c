"""Theorems on reversible maps in closed form: what is true is proved, and the results are those of the map."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction as F
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.closed_form_maps import ReversibleMap, claim, description, tables_of_maps, verdict
from support.map_cases import CASES, ROOT, outcome_of, proof
from support.within import within

from orbitproof.verify.evidence import bounds, enclose

precision = within(lambda: ctx.workprec(300))


@pytest.mark.parametrize("hamiltonian", [False, True], ids=["map", "Hamiltonian"])
@pytest.mark.parametrize("name", CASES)
def test_a_true_bifurcation_is_proved_with_exactly_the_hypotheses_of_its_theorem(name: str, hamiltonian: bool) -> None:
    result = proof(outcome_of(name, hamiltonian))
    assert tuple(hypothesis.name for hypothesis in result.hypotheses) == result.theorem.hypotheses
    assert all(hypothesis.holds for hypothesis in result.hypotheses)


@pytest.mark.parametrize("name", CASES)
def test_the_level_of_a_first_integral_and_a_parameter_give_the_same_bifurcation(name: str) -> None:
    system = proof(outcome_of(name)).results
    level = proof(outcome_of(name, hamiltonian=True)).results
    assert system.side == level.side
    assert agree(system.parameter, level.parameter)
    for key in ("alpha", "beta"):
        assert agree(system.normal_form[key], level.normal_form[key])
        assert level.normal_form[key].rad() < abs(level.normal_form[key]) * arb("0.02")


@pytest.mark.parametrize("name", ["k=4", "k=4, n=2"])
def test_the_bifurcation_value_is_enclosed_to_many_digits(name: str) -> None:
    for hamiltonian in (False, True):
        result = proof(outcome_of(name, hamiltonian)).results.parameter
        value = result + enclose(ROOT)
        assert (value * value).contains(arb("0.5"))
        assert value.rad() < arb("1e-80")


@pytest.mark.parametrize("name", ["k=2", "k=2, other sign", "k=2, n=2", "k=4", "k=4, n=2"])
def test_the_bifurcation_does_not_depend_on_the_direction_of_p_1(name: str) -> None:
    # With H = nu = 2 p_0 + p_1/8 + .. the branch is tilted in the box: p_0' = -1/16 at the point.
    system, kind, k, radii = CASES[name]
    wide = (radii[1] / 8, radii[1], *(radius * 2**9 for radius in radii[2:]))

    def steep(p: Sequence[Any], number: Callable[[F], Any]) -> Any:
        return p[0] * number(F(2)) + p[1] * number(F(1, 8)) + p[0] * p[1] + p[0] * p[0] + p[1] * p[1]

    tables, integral = tables_of_maps(system, k, wide, steep)
    level = proof(verdict(claim(description(len(wide) - 1, True), kind, k, wide), tables, integral)).results
    plain = proof(outcome_of(name)).results
    assert level.side == plain.side
    assert agree(level.parameter, plain.parameter)
    assert agree(level.normal_form["beta"], plain.normal_form["beta"])
    assert level.normal_form["beta"].rad() < abs(plain.normal_form["beta"]) * arb("0.1")


@pytest.mark.parametrize("name", ["k=3", "k=3, sloped family", "k=2, sloped family", "k=2", "k=4"])
def test_enclosures_of_the_reduced_function_contain_exact_values(name: str) -> None:
    system, _, k, radii = CASES[name]
    enclosures = next(h.enclosures for h in proof(outcome_of(name)).hypotheses if h.name == "C3")

    def reduced(p_0: F, p_1: F) -> F:
        (q,) = system.iterate_kernel(p_0, [p_1], k, F)[-1]
        return q / (p_1 - system.slope * p_0)

    def contains(ball: arb, value: F) -> bool:
        lower, upper = bounds(ball)
        return lower <= value <= upper

    for i in (-10, -7, -3, 1, 4, 9, 10):
        p_1 = radii[1] * i / 10
        assert contains(enclosures["g(0, P_1)"], reduced(F(0), p_1))
        for a, b in ((-1, 1), (-1, 0), (F(1, 2), 1)):
            low, high = radii[0] * a, radii[0] * b
            quotient = (reduced(high, p_1) - reduced(low, p_1)) / (high - low)
            assert contains(enclosures["g_0"], quotient)


def zeros_off_the_family(system: ReversibleMap, k: int, nu: float, width: float) -> list[float]:
    """Points p_1 where q_1 of f^k, divided by the distance to the family, changes sign (n = 1)."""

    def reduced(p: float) -> float:
        (q,) = system.iterate_kernel(nu, [p], k, float)[-1]
        return q / (p - float(system.slope) * nu)

    grid = [width * (index + 0.37) / 200 for index in range(-200, 200)]
    values = [reduced(p) for p in grid]
    return [a for a, left, right in zip(grid, values, values[1:], strict=False) if (left < 0) != (right < 0)]


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if len(case[3]) == 2])
def test_the_new_orbits_are_on_the_side_that_is_reported(name: str) -> None:
    system, _, k, _ = CASES[name]
    side = proof(outcome_of(name)).results.side
    offset = 1e-4
    width = 0.05
    above, below = (len(zeros_off_the_family(system, k, sign * offset, width)) for sign in (1, -1))
    assert (above, below) == {"above": (2, 0), "below": (0, 2), "both": (1, 1)}[side]


@pytest.mark.parametrize(
    "name", [name for name, case in CASES.items() if len(case[3]) == 2 and case[1] != "touch_and_go"]
)
def test_beta_is_the_curvature_of_the_new_branch(name: str) -> None:
    system, _, k, _ = CASES[name]
    result = proof(outcome_of(name)).results
    beta, nu = float(result.normal_form["beta"].mid()), 1e-4 if result.side == "above" else -1e-4
    left, right = zeros_off_the_family(system, k, nu, 4 * abs(nu / beta) ** 0.5)
    assert nu == pytest.approx(beta * ((right - left) / 2) ** 2, rel=0.1)


def test_beta_of_touch_and_go_is_the_slope_of_the_crossing_branch() -> None:
    system, _, k, _ = CASES["k=3"]
    beta = float(proof(outcome_of("k=3")).results.normal_form["beta"].mid())
    (zero,) = zeros_off_the_family(system, k, 1e-4, 1e-3)
    assert beta * zero == pytest.approx(1e-4, rel=0.05)


def test_the_point_lies_in_the_box_and_the_enclosures_are_finite() -> None:
    for name, (_, _, _, radii) in CASES.items():
        result = proof(outcome_of(name))
        for ball, radius in zip(result.results.point.values(), radii, strict=True):
            lower, upper = bounds(ball)
            assert -radius < lower <= upper < radius
        assert all(ball.is_finite() for hypothesis in result.hypotheses for ball in hypothesis.enclosures.values())
