"""A family parameter on a fixed level of a first integral: the same bifurcation as with the level as parameter."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from flint import arb, ctx
from support.balls import agree
from support.claims import to_the_end

from orbitproof.explore.orbits import ShootingProblem
from orbitproof.explore.refinement import refine
from orbitproof.shared.formats import (
    Candidate,
    InputError,
    candidate_from_json,
    candidate_to_json,
    load_system,
    read_candidates,
)
from orbitproof.shared.systems import DescriptionError, FixedLevel, ReversibleSystem, describe, described
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, Integrator, certify, recheck
from orbitproof.verify.certificate.kinds import enclose

DATA = Path(__file__).parents[1] / "data"

BEAM = {
    "name": "beam-level",
    "state": ["u", "u1", "u2", "u3"],
    "parameters": ["P"],
    "field": {"u": "u1", "u1": "u2", "u2": "u3", "u3": "-P*u2 - u + u**2"},
    "R": {"u1": -1, "u3": -1},
    "section": "u1",
    "family_parameter": "P",
    "first_integral": "u1*u3 - 0.5*u2**2 + 0.5*P*u1**2 + 0.5*u**2 - u**3/3",
    "first_integral_name": "H",
    "level_coordinate": "u2",
    "fixed_level": {"value": "-1.25227013", "sign": 1},
}
"""H is, to eight decimals, that of a 1:4 resonance at P = 7/3."""


def at_seven_thirds() -> Candidate:
    return read_candidates(DATA / "beam-candidate.json")[0]


@cache
def beam() -> ReversibleSystem:
    return described(BEAM)


@cache
def claimed() -> Candidate:
    guess = [7 / 3, float(at_seven_thirds().centre[0])]
    return refine(beam(), {}, "period_tupling", 4, guess, digits=40).to_candidate("beam-level", {})


@cache
def certified() -> Certificate:
    return certify(claimed(), Limits(max_precision=512))


def refusal(candidate: Candidate, integrate: Integrator = enclose) -> str:
    certificate = certify(candidate, Limits(max_precision=256), integrate=integrate)
    return "proved" if certificate.reason is None else certificate.reason.condition


def test_a_bifurcation_in_the_parameter_is_proved_on_the_level() -> None:
    certificate = certified()
    assert certificate.proved, certificate.reason
    assert certificate.side == "above"
    assert certificate.parameter_name == "P"
    assert certificate.parameter is not None
    with ctx.workprec(200):
        assert agree(certificate.parameter, arb("2.33333332964152586214034030423527") + arb(0, "1e-32"))
    assert "level" in [hypothesis.name for hypothesis in certificate.hypotheses]
    assert "on the level H = -125227013/100000000" in str(certificate.theorem)
    assert "that lie on the level" in certificate.statement["in_full"]
    assert recheck(certificate, integrate=True).findings == ()


def test_it_is_the_one_that_is_found_with_the_level_as_parameter() -> None:
    # The level of the other one differs by less than 1e-8 from this one, so P does not differ much from 7/3.
    other = at_seven_thirds()
    u, w = other.centre
    level = u * u / 2 - u**3 / 3 - w * w / 2
    assert abs(level - F("-1.25227013")) < F(1, 10**8)
    parameter, place = claimed().centre
    assert abs(parameter - F(7, 3)) < F(1, 10**8)
    assert abs(place - u) < F(1, 10**8)


def test_beside_the_point_and_on_another_level_nothing_is_proved() -> None:
    true = claimed()
    near = FixedLevel(F("-1.2522"), 1)
    assert refusal(replace(true, system=replace(true.system, fixed_level=near))) == "family"
    # With the other sign the orbit runs off to infinity.
    other = FixedLevel(F("-1.25227013"), -1)
    runs_off = replace(true, system=replace(true.system, fixed_level=other))
    assert refusal(runs_off) == "family"
    assert refusal(runs_off, to_the_end) == "singularity"
    moved = (true.centre[0] + 8 * true.radii[0], true.centre[1])
    assert refusal(replace(true, centre=moved)) != "proved"
    # No point of Fix(R) lies on so high a level.
    assert refusal(replace(true, system=replace(true.system, fixed_level=FixedLevel(F(10), 1)))) not in ("proved", "")


def test_an_integral_that_is_not_quadratic_in_the_coordinate_gives_no_level() -> None:
    system = replace(beam(), level_coordinate="u")
    centre = (claimed().centre[0], F(8, 5))
    assert refusal(replace(claimed(), system=system, centre=centre)) == "level"


def test_a_description_with_a_level_comes_back_and_a_wrong_one_is_named() -> None:
    assert described(json.loads(json.dumps(describe(beam())))) == beam()
    assert beam().centre_coordinates == ("P", "u")
    for change in ({"family_parameter": None}, {"level_coordinate": None}, {"fixed_level": None}):
        entry = {key: value for key, value in {**BEAM, **change}.items() if value is not None}
        with pytest.raises(DescriptionError):
            described(entry)
    for level in (0, {"value": "0"}, {"value": "0", "sign": 2}, {"value": 0.5, "sign": 1}):
        with pytest.raises(DescriptionError, match="fixed_level"):
            described({**BEAM, "fixed_level": level})


def test_no_level_form_is_claimed_on_a_fixed_level() -> None:
    entry = {**candidate_to_json(claimed()), "parameter": "first integral", "level_sign": 1}
    with pytest.raises(InputError, match="parameter"):
        candidate_from_json(entry, "claim")


def test_shooting_stays_on_the_level() -> None:
    problem = ShootingProblem(beam(), {})
    unknowns = np.array([2.32, -0.22, 1.9])
    state = problem.initial_state(unknowns)
    (value,) = beam().first_integral(state, [2.32])  # type: ignore[misc]
    assert value == pytest.approx(-1.25227013, abs=1e-14)
    residual, jacobian, _ = problem.evaluate(unknowns)
    for i in range(3):
        step = np.eye(3)[i] * 1e-6
        change = (problem.evaluate(unknowns + step)[0] - problem.evaluate(unknowns - step)[0]) / 2e-6
        assert change == pytest.approx(jacobian[:, i], abs=1e-6 * (1 + np.abs(residual).max()))


def test_the_zero_level_of_the_example_has_a_period_quadrupling() -> None:
    system = load_system(DATA.parents[1] / "docs" / "examples" / "beam-level.py")
    claim = refine(system, {}, "period_tupling", 4, [1.909118763, -0.2369648123], digits=40).to_candidate("a", {})
    certificate = certify(claim, Limits(max_precision=512))
    assert certificate.proved, certificate.reason
    assert certificate.side == "below"
    assert certificate.parameter is not None
    with ctx.workprec(200):
        assert agree(certificate.parameter, arb("1.90911876264061395699353781003039") + arb(0, "1e-32"))
