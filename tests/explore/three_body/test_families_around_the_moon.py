"""Families by name that begin with a construction: prograde, resonant and of doubled period."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from orbitproof.explore.families import Limits
from orbitproof.explore.names.own_systems import SEARCHED
from orbitproof.explore.orbits import stability_index
from orbitproof.explore.search.orbits import orbits_with
from orbitproof.explore.three_body.families import trace_family
from orbitproof.explore.three_body.families.resonant import half_turns
from orbitproof.explore.three_body.names import FAMILY_NAMES, family_name, is_family_name
from orbitproof.shared.formats import LEVEL, Equation
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

MASS = {"mu": MASS_PARAMETERS["jpl-earth-moon"]}
MU = float(MASS["mu"])


@pytest.mark.parametrize("ratio", ["3:1", "1:2", "4:3"])
def test_a_resonant_orbit_goes_round_p_times_in_q_turns(ratio: str) -> None:
    p, q = map(int, ratio.split(":"))
    family = trace_family(CR3BP, family_name(ratio), MASS, Limits(max_orbits=8))
    for orbit in family.orbits:
        assert abs(orbit.half_period / (np.pi * q) - 1) < 0.12
        assert half_turns(family.problem.samples(orbit.unknowns), MU) == p - q


@pytest.mark.parametrize(("name", "level", "period", "index"), [
    ("L2-dragonfly", 3.02021920207507, 5.556061061777603, 232.907198739348),
    pytest.param("L2-butterfly", 3.08496706454795, 4.2174280159238755, 12.524232768288, marks=pytest.mark.slow),
    ("dpo", 3.11058290897658, 3.008457866917875, 85.7192996723242),
    ("lpo-west", 3.2963540237492, 0.5055342974118826, 1.0),
    ("3:1", 3.13941523725127, 6.463244022604043, 6.40264059814289),
    pytest.param("4:3", 2.49471972322784, 19.170597234987476, 11.0481998896106, marks=pytest.mark.slow),
])  # fmt: skip
def test_orbits_of_the_jpl_catalogue_are_in_the_family_of_their_name(
    name: str, level: float, period: float, index: float
) -> None:
    """Jacobi constant, period and stability index of rows of <https://ssd-api.jpl.nasa.gov/doc/periodic_orbits.html>."""
    family = trace_family(CR3BP, family_name(name), MASS, Limits(max_orbits=200))
    found = min(
        orbits_with(family, Equation(LEVEL, Fraction(level))), key=lambda each: abs(float(each.period) - period)
    )
    assert found.period == pytest.approx(period, abs=1e-10)
    assert stability_index(found.stability) == pytest.approx(index, rel=1e-6)


def test_prograde_orbits_go_round_the_moon_the_way_it_goes_round_the_earth() -> None:
    for name in ("dpo", "lpo-east", "lpo-west"):
        family = trace_family(CR3BP, name, MASS, Limits(max_orbits=12))
        for orbit in family.orbits:
            x, y, _, vx, vy, _ = family.problem.samples(orbit.unknowns).T
            assert np.all(((x - 1 + MU) * vy - y * vx)[[0, -1]] > 0)


def test_distant_and_eastern_orbits_begin_at_the_greatest_jacobi_constant_between_them() -> None:
    distant, eastern = (trace_family(CR3BP, name, MASS, Limits(max_orbits=8)) for name in ("dpo", "lpo-east"))
    assert np.allclose(distant.orbits[0].unknowns, eastern.orbits[0].unknowns, atol=1e-9)
    assert all(family.orbits[-1].first_integral < family.orbits[2].first_integral for family in (distant, eastern))
    # On one side they become unstable at once.
    assert max(value.real for value in distant.orbits[-1].stability) > 1.5
    assert max(abs(value) for value in eastern.orbits[-1].stability) < 1


@pytest.mark.parametrize(("asked", "found"), [
    ("3:1", "resonant-3-1-near"), ("resonant-31", "resonant-3-1-near"), ("Resonant-5-2-NEAR", "resonant-5-2-near"),
    ("Resonant-3-1", "resonant-3-1"), ("3:1-far", "resonant-3-1"), ("21", "resonant-2-1"),
    ("LPO-Eastern", "lpo-east"), ("DPO", "dpo"), ("Dragonfly", "L2-dragonfly"), ("l4-Short-period", "L4-short"),
])  # fmt: skip
def test_names_are_found_by_their_aliases(asked: str, found: str) -> None:
    assert family_name(asked) == found


def test_a_ratio_with_a_common_divisor_is_no_family() -> None:
    assert not is_family_name("cr3bp", "resonant-4-2")
    assert tuple(FAMILY_NAMES) == SEARCHED
    assert all(is_family_name(system, name) for system, names in FAMILY_NAMES.items() for name in names)
