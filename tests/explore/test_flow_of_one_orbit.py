"""One orbit, as another integrator follows it."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from orbitproof.explore.flow import flow_of
from orbitproof.shared.systems import CR3BP

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
