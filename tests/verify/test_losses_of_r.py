"""Where R is lost: what is found is that of the flow, in the box and on a fixed level, and what the theorem says."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb
from scipy.optimize import fsolve
from support import breaking_cases as cases
from support.balls import agree
from support.breaking_cases import results_of

from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.evidence import enclose, guarded
from orbitproof.verify.reversor_breaking import BreakingTheorem
from orbitproof.verify.words.breaking import breaking_in_words

BITS = 192


@pytest.fixture(scope="module")
def modes() -> Certificate:
    return certify(cases.modes())


def test_what_is_found_is_that_of_the_point_and_not_of_the_centre() -> None:
    true = cases.modes()
    found = results_of(
        certify(cases.modes(centre=(true.centre[0] + true.radii[0] * Fraction(15, 16), true.radii[1] / 2)))
    )
    with guarded(BITS):
        level = enclose(true.centre[0])
        for ball in (found.parameter, found.point["vy"] ** 2, found.other_point["vy"] ** 2):
            assert agree(ball, level)
            assert ball.rad() < arb(10) ** -22
    assert found.point["x"].contains(0)
    assert found.other_point["x"].contains(0)


def test_coefficients_are_those_of_the_flow(modes: Certificate) -> None:
    found = results_of(modes)
    assert (found.opening * found.gamma + found.beta).contains(0)
    # With n = 1 B is a number, and gamma its derivative by h along x = 0.
    h, step, y = float(cases.level_of(odd=True)), 1e-3, 1e-4
    b = [cases.flow([0.0, 0.0, y, np.sqrt(level - y * y)], 10.0)[0] / y for level in (h + step, h - step)]
    assert abs(float(found.gamma.mid()) - (b[0] - b[1]) / (2 * step)) < 1e-5
    assert agree(modes.parameter, found.parameter)
    assert agree(modes.normal_form["gamma"], found.gamma)
    assert agree(modes.normal_form["beta"], found.beta)
    assert agree(modes.normal_form["kappa"], found.opening)
    assert len({float(ball.mid()) for ball in modes.normal_form.values()}) == 3


def test_on_a_fixed_level_the_parameter_is_that_of_the_field() -> None:
    claim = cases.on_level()
    fixed = certify(claim)
    found, h = results_of(fixed), cases.level_of(odd=True)
    assert agree(found.parameter, enclose(cases.A))
    assert found.parameter_name == "a"
    # h = h*(a) + kappa y^2 + .., so for fixed h a changes by - kappa/(dh*/da) y^2.
    step = Fraction(1, 1000)
    slope = (cases.level_of(True, cases.A + step) - cases.level_of(True, cases.A - step)) / (2 * step)
    kappa = float(results_of(certify(cases.modes())).opening.mid())
    assert abs(float(found.opening.mid()) + kappa / float(slope)) < 1e-4
    assert found.side == "above"
    told = fixed.statement["in_full"]
    value = f"{float(h):.10f}"
    for words in (
        "D(P^2)(x) - 1, at fixed parameter on the level, has a kernel vector",
        f"All points are on the level twice the energy = {value}"[:-2],
        "those of the box with vy > 0.",
        "The parameter there, a, lies in [0.89",
    ):
        assert words in told, words
    below = breaking_in_words(BreakingTheorem(cases.on_level(-1)))
    assert "those of the box with vy < 0." in below


def test_the_theorem_about_later_crossings() -> None:
    theorem = BreakingTheorem(cases.modes(crossings=2))
    assert theorem.hypotheses == (
        "symmetries", "frames", "level", "poincare-map", "half-orbit", "sheet", "curve", "kernel", "point", "side"
    )  # fmt: skip
    words = breaking_in_words(theorem)
    assert "P is the power 2 of the Poincare map" in words
    assert "meets the section in a period 4 times, of which only x and P(x) are in Fix(R)" in words
    assert "P is the Poincare map" in breaking_in_words(BreakingTheorem(cases.modes()))


def test_fields_with_functions_have_their_own_orbits(modes: Certificate) -> None:
    found, h = results_of(certify(cases.modes(system=cases.ANGLE))), float(cases.level_of(odd=True))
    assert agree(found.parameter, results_of(modes).parameter)
    slopes = [(cases.level_beside(y, angle=True) - h) / y**2 for y in (0.02, 0.04)]
    assert abs(float(found.opening.mid()) - (4 * slopes[0] - slopes[1]) / 3) < 2e-6
    assert not found.opening.overlaps(results_of(modes).opening)


@pytest.mark.slow
def test_half_orbits_may_meet_the_section_twice() -> None:
    claim = cases.later()
    found = results_of(certify(claim))
    h, x, kappa = (float(ball.mid()) for ball in (found.parameter, found.point["x"], found.opening))
    assert found.side == "above"

    def returned(level: float, start: float, across: float) -> tuple[float, float]:
        """(x, vx) after two crossings; y -> -y, vy -> -vy leaves the field alone."""
        rest = level - across**2 - float(cases.A) * start**2
        first = cases.flow([start, 0.0, across, np.sqrt(rest)], 10.0)
        second = cases.flow([first[0], 0.0, first[2], -first[3]], 10.0)
        return float(second[0]), float(second[2])

    def slope(y: float) -> float:
        """(level - h)/y^2 of the orbit beside it with vx = y that two half returns bring back."""

        def misses(at: Any) -> list[float]:
            there, mirrored = returned(at[0], at[1], y), returned(at[0], at[1], -y)
            return [(there[0] - mirrored[0]) / y, there[1] + mirrored[1]]

        return float((fsolve(misses, [h + kappa * y * y, x], xtol=1e-12)[0] - h) / y**2)

    slopes = [slope(y) for y in (0.01, 0.02)]
    assert abs((4 * slopes[0] - slopes[1]) / 3 - kappa) < 2e-3 * kappa
    for crossings, condition in ((1, "point"), (4, "half-orbit")):
        reason = certify(replace(claim, crossings=crossings)).reason
        assert reason is not None
        assert reason.condition == condition
