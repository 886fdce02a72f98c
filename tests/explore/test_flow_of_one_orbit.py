"""One orbit, as another integrator follows it."""

from __future__ import annotations

import warnings

import diffrax
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbitproof.explore.flow import flow_of
from orbitproof.explore.flow.runge_kutta import tableau
from orbitproof.explore.orbits import PeriodicSolution
from orbitproof.shared.systems import CR3BP, ReversibleSystem, described

MU = 0.01215058560962404
NEAR_THE_MOON = np.array([0.987635278996, 0.0, 0.00444275726548, 0.0, 2.31422648693, 0.0])


def test_an_orbit_close_to_the_moon_goes_where_another_integrator_leads_it_both_ways() -> None:
    for time in (0.68, -0.4):
        found = flow_of(CR3BP).derivative(NEAR_THE_MOON, time, [MU])
        states = flow_of(CR3BP).samples(NEAR_THE_MOON, time, [MU])
        other = solve_ivp(
            lambda _, state: CR3BP.vector_field(state.tolist(), [MU]),
            (0.0, time),
            NEAR_THE_MOON,
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
        )
        assert np.allclose(found.state, other.y[:, -1], rtol=0, atol=1e-11)
        assert np.allclose(found.velocity, CR3BP.vector_field(found.state.tolist(), [MU]), rtol=1e-12, atol=1e-12)
        assert np.array_equal(states[0], NEAR_THE_MOON)
        assert np.array_equal(states[-1], found.state)
        # The flow keeps volume.
        assert abs(np.linalg.det(found.state_transition) - 1) < 1e-9


def test_the_numbers_of_the_method_are_those_of_diffrax() -> None:
    rows, error = tableau()
    theirs = diffrax.Dopri8.tableau
    assert [list(row) for row in rows] == [row.tolist() for row in theirs.a_lower]
    assert list(error) == theirs.b_error.tolist()


def test_a_first_step_out_of_where_the_field_is_defined_is_tried_again_shorter() -> None:
    system = described({
        "name": "bounced", "state": "x v", "field": {"x": "v", "v": "x**(-3/2) - 1"}, "R": {"v": -1}, "section": "v",
        "first_integral": "v**2/2 + 2/sqrt(x) + x",
    })  # fmt: skip
    assert isinstance(system, ReversibleSystem)
    assert system.first_integral is not None
    start = [1.5, 0.0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        states = flow_of(system).samples(start, 400.0, [])
    levels = [system.first_integral(state, [])[0] for state in states.tolist()]
    assert len(states) > 300
    assert np.allclose(levels, levels[0], rtol=0, atol=1e-10)
    # Zeros of the tableau times a slope that is no number, of the step before, would end it here.
    assert np.isfinite(flow_of(system).derivative(start, 400.0, []).state_transition).all()


def test_an_orbit_as_a_function_of_time_is_where_the_flow_leads_and_ends_in_a_collision() -> None:
    legs = np.array([NEAR_THE_MOON, flow_of(CR3BP).derivative(NEAR_THE_MOON, 0.3, [MU]).state])
    solution = PeriodicSolution(CR3BP, [MU], legs, np.array([0.3, 0.38]))
    times = np.array([0.0, 0.01, 0.2999, 0.3, 0.3001, 0.5, 0.6799])
    there = [flow_of(CR3BP).derivative(NEAR_THE_MOON, time, [MU]).state for time in times]
    assert np.allclose(solution.states(times), there, rtol=0, atol=1e-11)
    assert solution.defect == pytest.approx(1.40021e-6, abs=1e-11)
    into_the_moon = PeriodicSolution.symmetric(CR3BP, [MU], np.array([0.98, 0.0, 0.0, 0.0, 0.0, 0.0]), 2.0)
    with pytest.raises(ArithmeticError, match="near a singularity"):
        _ = into_the_moon.defect
