"""One orbit on a fixed level of a first integral: proved there with its multipliers, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.balls import agree

from orbitproof.explore.orbits import ShootingProblem
from orbitproof.explore.refinement import OrbitTask, refine_orbit
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, Candidate, Equation, InputError, read_atlas
from orbitproof.shared.systems import FixedLevel, ReversibleSystem
from orbitproof.verify.certificate import Certificate, Limits, certify
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import enclose_orbit
from orbitproof.verify.poincare import IntegratorSettings, on_sheet

DATA = Path(__file__).parents[1] / "data"
LIMITS = Limits(max_precision=256)
BITS = 160
GUESS = (1.9, -0.2446)


@cache
def system() -> ReversibleSystem:
    """u'''' + P u'' + u - u^2 = 0 on the level 0; u2 < 0 at the other point of the orbits here."""
    return read_atlas(DATA / "atlas-fixed-level.json").system


@cache
def claimed() -> Candidate:
    wanted = Equation(COORDINATE, F(19, 10), "P")
    return refine_orbit(OrbitTask("orbit", system(), {}, wanted, GUESS, 40, {}))


@cache
def certificate() -> Certificate:
    return certify(claimed(), LIMITS)


def near(ball: Any, value: float, accuracy: float = 1e-8) -> bool:
    return abs(float(ball.mid()) - value) < accuracy and float(ball.rad()) < accuracy


def test_the_orbit_and_its_stability_are_those_that_are_found_otherwise() -> None:
    proof = certificate()
    assert proof.proved, proof.reason
    assert proof.orbit is not None
    problem = ShootingProblem(system(), {})
    orbit = problem.orbit(problem.correct(np.array([*GUESS, 3.2]), np.array([1.0, 0.0, 0.0])))
    assert near(proof.point["u"], float(orbit.unknowns[1]))
    assert near(proof.orbit.half_period, float(orbit.unknowns[2]))
    (parameter,) = proof.orbit.stability.parameters
    assert near(parameter.real, orbit.stability[0])
    assert proof.orbit.level == 0
    assert "level H = 0, those of the box with u2 > 0" in str(proof.theorem)


def test_the_period_singles_it_out_as_well() -> None:
    assert certificate().orbit is not None
    value = F(1)
    with pytest.raises(InputError, match="on a level already"):
        replace(claimed(), equation=Equation(LEVEL, value))
    half = refine_orbit(OrbitTask("orbit", system(), {}, Equation(HALF_PERIOD, F(321, 100)), GUESS, 40, {}))
    assert certify(half, LIMITS).proved


WRONG: dict[str, ReversibleSystem] = {
    "another level": replace(system(), fixed_level=FixedLevel(F(1, 10**30), 1)),
    "another sheet": replace(system(), fixed_level=FixedLevel(F(0), -1)),
    "no points": replace(system(), fixed_level=FixedLevel(F(1, 2), 1)),
    "no quadratic coordinate": replace(
        system(),
        first_integral=lambda x, p: (system().first_integral(x, p)[0] + x[2],),  # type: ignore[misc]
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_it_is_no_orbit_of(case: str) -> None:
    assert not certify(replace(claimed(), system=WRONG[case]), LIMITS).proved


def test_distances_are_those_of_points_on_both_sheets() -> None:
    """Of 5 + u2: more than 5 at the point of the claim, less at the other one, as the level has it there."""
    measured = replace(system(), squared_distance=lambda x, _: (5 + x[2],), distance_name="something")
    found = enclose_orbit(replace(claimed(), system=measured), IntegratorSettings(BITS), ORACLE)
    assert found.distance is not None
    at = (0,) * len(claimed().radii)
    for table, point, sign in (
        (found.distance.start, certificate().point, 1),
        (found.distance.end, certificate().orbit.other_point, -1),
    ):
        # On the level 0 of Fix(R) u2^2 = u^2 - 2 u^3/3.
        u = point["u"]
        assert agree(table.box[at], 5 + sign * (u * u - 2 * u**3 / 3).sqrt())


def test_a_coordinate_of_no_certain_sign_is_on_no_sheet() -> None:
    one = system().fixed_level
    assert one is not None
    known = certificate().point["u"]
    assert on_sheet(system(), [-known]).fixed_level == one
    assert on_sheet(system(), [known]).fixed_level == FixedLevel(one.value, -1)
    for values in ([known, -known], [known - known], []):
        with pytest.raises(IntegrationFailure, match="one sign"):
            on_sheet(system(), values)
