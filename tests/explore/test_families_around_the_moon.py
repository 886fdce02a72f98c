"""Families by name that begin with a construction: prograde, resonant and of doubled period."""

from __future__ import annotations

import numpy as np
import pytest

from orbitproof.explore.families import Limits, trace_family
from orbitproof.explore.families.resonant import half_turns
from orbitproof.explore.names import FAMILY_NAMES, family_name, is_family_name
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


def test_a_prograde_orbit_that_programs_quote_from_the_catalogue_is_one_of_the_west() -> None:
    """x = 1.03774, vy = 0.503284, period 1.2011, Jacobi constant 3.19."""
    family = trace_family(CR3BP, "lpo-west", MASS, Limits(max_orbits=60))
    orbit = min(family.orbits, key=lambda each: abs(each.period - 1.2011))
    assert orbit.second_point[0] == pytest.approx(1.03774, abs=3e-3)
    assert orbit.second_point[2] == pytest.approx(0.503284, abs=3e-2)
    assert orbit.first_integral == pytest.approx(3.19, abs=5e-3)


@pytest.mark.parametrize(("asked", "found"), [
    ("3:1", "resonant-3-1"), ("resonant-31", "resonant-3-1"), ("Resonant-5-2-NEAR", "resonant-5-2-near"),
    ("LPO-Eastern", "lpo-east"), ("DPO", "dpo"), ("Dragonfly", "L2-dragonfly"), ("l4-Short-period", "L4-short"),
])  # fmt: skip
def test_names_are_found_by_their_aliases(asked: str, found: str) -> None:
    assert family_name(asked) == found


def test_a_ratio_with_a_common_divisor_is_no_family() -> None:
    assert not is_family_name("cr3bp", "resonant-4-2")
    assert all(is_family_name(system, name) for system, names in FAMILY_NAMES.items() for name in names)
