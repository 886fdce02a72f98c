"""Libration points, single symmetric orbits and their stability data."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from orbitproof.explore.families.continuation import crossings
from orbitproof.explore.flow import FlowFailure, flow_of
from orbitproof.explore.names import resonant_values
from orbitproof.explore.orbits import CorrectionFailure, HalfReturn, ShootingProblem, SymmetricOrbit, tupling_sides
from orbitproof.explore.orbits.stability import half_return
from orbitproof.explore.seeds import limit_orbit
from orbitproof.explore.three_body.seeds import LIBRATION_POINTS, libration_point, lyapunov_orbit
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

EARTH_MOON = MASS_PARAMETERS["earth-moon"]
MU = float(EARTH_MOON)


def halo(z: float) -> tuple[ShootingProblem, SymmetricOrbit]:
    """An Earth-Moon L1 halo orbit with the given z, from a rough guess near z = 0.17."""
    problem = ShootingProblem(CR3BP, {"mu": EARTH_MOON})
    guess = np.array([0.846, z, 0.2641, 1.308])
    correction = problem.correct(guess, np.array([0.0, 1.0, 0.0, 0.0]))
    return problem, problem.orbit(correction)


def doubling_orbit() -> tuple[ShootingProblem, SymmetricOrbit]:
    """The orbit with s = -1 near z = 0.1638, by the secant method in z."""
    low, high = 0.1630, 0.1642
    for _ in range(8):
        f_low, f_high = (min(halo(z)[1].stability, key=lambda s: s.real).real + 1 for z in (low, high))
        if f_low == f_high or low == high:
            break
        low, high = high, high - f_high * (high - low) / (f_high - f_low)
    return halo(high)


@pytest.mark.parametrize("mass", [1e-9, 1e-4, MU, 0.3, 0.5, 0.7, 1 - MU, 1 - 1e-9])
@pytest.mark.parametrize("name", LIBRATION_POINTS)
def test_no_force_acts_at_a_libration_point_for_any_mass(name: str, mass: float) -> None:
    point = libration_point(name, mass)
    acceleration = CR3BP.vector_field([point.x, 0.0, 0.0, 0.0, 0.0, 0.0], [mass])[3]
    stiffness = 1.0 + 2.0 * ((1 - mass) / abs(point.x + mass) ** 3 + mass / abs(point.x - 1 + mass) ** 3)
    assert abs(acceleration) < 1e-14 * stiffness
    low, high = {"L1": (-mass, 1 - mass), "L2": (1 - mass, 3), "L3": (-3, -mass)}[name]
    assert low < point.x < high


def test_libration_points_have_the_known_places_and_symmetry() -> None:
    places = [libration_point(name, MU).x for name in LIBRATION_POINTS]
    assert places == pytest.approx([0.8369151, 1.1556822, -1.0050626], abs=1e-7)
    assert libration_point("L1", 0.5).x == pytest.approx(0.0, abs=1e-16)
    assert libration_point("L3", 0.2).x == pytest.approx(-libration_point("L2", 0.8).x, abs=1e-15)
    hill = (1e-12 / 3) ** (1 / 3)
    assert libration_point("L1", 1e-12).distance == pytest.approx(hill, rel=1e-4)
    for mass in (0.0, 1.0, -0.1, Fraction(3, 2)):
        with pytest.raises(ValueError, match="mass"):
            libration_point("L1", mass)


@pytest.mark.parametrize(("name", "side"), [("L1", -1), ("L2", -1), ("L3", 1)])
def test_linear_orbit_solves_the_nonlinear_equations_to_second_order(name: str, side: int) -> None:
    point = libration_point(name, EARTH_MOON)
    defects = []
    for amplitude in (1e-3 * point.distance, 1e-4 * point.distance):
        orbit = lyapunov_orbit(point, amplitude, side)
        flow = flow_of(CR3BP).derivative(orbit.state, orbit.half_period, [MU])
        defects.append(float(np.linalg.norm(flow.state[[1, 3]])))
    assert defects[1] < 0.02 * defects[0]


def test_halo_orbit_closes_after_its_full_period_and_meets_fix_r_half_way() -> None:
    problem, orbit = halo(0.17)
    flow = flow_of(CR3BP)
    start = problem.initial_state(orbit.unknowns)
    assert flow.derivative(start, orbit.period, [MU]).state == pytest.approx(start, abs=1e-9)
    half = flow.derivative(start, orbit.half_period, [MU]).state
    assert half[[1, 3, 5]] == pytest.approx([0, 0, 0], abs=1e-11)
    assert half[[0, 2, 4]] == pytest.approx(orbit.second_point, abs=1e-12)
    states = problem.samples(orbit.unknowns)
    assert states[0] == pytest.approx(start, abs=0)
    assert states[-1] == pytest.approx(half, abs=1e-12)
    constants = [CR3BP.first_integral(state, [MU])[0] for state in states]  # type: ignore[misc]
    assert constants == pytest.approx([orbit.first_integral] * len(constants), abs=1e-11)
    assert crossings(problem, problem.samples(orbit.unknowns)) == 1


def test_flow_is_reversible() -> None:
    signs = np.array(CR3BP.reversing_symmetry)
    flow = flow_of(CR3BP)
    start = np.array([0.85, 0.01, 0.1, 0.02, 0.2, -0.03])
    end = flow.derivative(start, 0.9, [MU]).state
    assert signs * flow.derivative(signs * end, 0.9, [MU]).state == pytest.approx(start, abs=1e-11)
    assert flow.derivative(end, -0.9, [MU]).state == pytest.approx(start, abs=1e-11)


def test_samples_are_states_of_the_orbit_with_both_ends() -> None:
    flow, start = flow_of(CR3BP), np.array([0.85, 0.01, 0.1, 0.02, 0.2, -0.03])
    for time in (0.9, -0.4):
        path = flow.samples(start, time, [MU])
        assert path[0] == pytest.approx(start, abs=0)
        assert path[-1] == pytest.approx(flow.derivative(start, time, [MU]).state, abs=0)
        assert CR3BP.first_integral is not None
        levels = [float(CR3BP.first_integral(state, [MU])[0]) for state in path]
        assert levels == pytest.approx([levels[0]] * len(path), abs=1e-12)
    assert flow.samples(start, 0.0, [MU]) == pytest.approx(start[None], abs=0)


def test_state_transition_matrix_agrees_with_finite_differences() -> None:
    start, time, step = np.array([0.85, 0.01, 0.1, 0.02, 0.2, -0.03]), 0.7, 1e-5
    flow = flow_of(CR3BP)
    matrix = flow.derivative(start, time, [MU]).state_transition
    for column in range(6):
        shift = step * np.eye(6)[column]
        difference = flow.derivative(start + shift, time, [MU]).state - flow.derivative(start - shift, time, [MU]).state
        assert matrix[:, column] == pytest.approx(difference / (2 * step), abs=2e-5)
    sensitivity = flow_of(FALKNER_SKAN).derivative([0.0, 0.94, 0.0], 0.2, [340.0]).parameter_derivative
    values = [flow_of(FALKNER_SKAN).derivative([0.0, 0.94, 0.0], 0.2, [340.0 + h]).state for h in (1e-3, -1e-3)]
    assert sensitivity == pytest.approx((values[0] - values[1]) / 2e-3, rel=1e-5)


def test_orbit_into_a_primary_is_a_failure_with_a_reason() -> None:
    with pytest.raises(FlowFailure, match="singularity"):
        flow_of(CR3BP).derivative([1.0 - MU, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0, [MU])
    with pytest.raises(FlowFailure, match="nan"):
        flow_of(CR3BP).derivative([0.8, 0.0, 0.1, 0.0, 0.2, 0.0], float("nan"), [MU])
    problem = ShootingProblem(CR3BP, {"mu": EARTH_MOON})
    with pytest.raises(CorrectionFailure):
        problem.correct(np.array([1.0 - MU, 0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0, 0.0]))


def test_stability_parameters_are_those_of_the_monodromy_matrix() -> None:
    problem, orbit = halo(0.172)
    matrix = flow_of(CR3BP).derivative(problem.initial_state(orbit.unknowns), orbit.period, [MU]).state_transition
    for s in orbit.stability:
        multiplier = s + np.sqrt(s * s - 1)
        for eigenvalue in (multiplier, 1 / multiplier):
            shifted = matrix - eigenvalue * np.eye(6)
            values = np.linalg.svd(shifted, compute_uv=False)
            assert values[-1] < 1e-8 * values[0]


def returned(problem: ShootingProblem, state: np.ndarray, period: float) -> HalfReturn:
    """The full return, as if it were half of one: its blocks give D_p pi_q P^2."""
    return half_return(problem.system, flow_of(problem.system).derivative(state, period, [MU]))


def test_doubling_shows_at_the_point_where_the_second_return_is_singular() -> None:
    problem, orbit = doubling_orbit()
    assert min(s.real for s in orbit.stability) == pytest.approx(-1, abs=1e-9)
    first = problem.initial_state(orbit.unknowns)
    second = np.zeros(6)
    second[[0, 2, 4]] = orbit.second_point
    ratio = {}
    for side, state in (("first", first), ("second", second)):
        values = np.linalg.svd(returned(problem, state, orbit.period).kernel_block, compute_uv=False)
        ratio[side] = values[-1] / values[0]
    assert orbit.derivative is not None
    (side,) = tupling_sides(orbit.derivative, 2)
    other = {"first": "second", "second": "first"}[side]
    assert ratio[side] < 1e-6 * ratio[other]
    assert tupling_sides(orbit.derivative, 4) == ("first", "second")
    assert tupling_sides(orbit.derivative, 3) == ("first", "second")


def test_resonant_values_are_the_primitive_ones() -> None:
    assert resonant_values(1) == (1.0,)
    assert resonant_values(2) == pytest.approx([-1.0])
    assert resonant_values(3) == pytest.approx([-0.5])
    assert resonant_values(4) == pytest.approx([0.0])
    assert resonant_values(6) == pytest.approx([0.5])
    assert len(resonant_values(5)) == 2
    assert len(resonant_values(7)) == 3
    with pytest.raises(ValueError, match="multiplicity"):
        resonant_values(0)


def test_limit_orbit_of_falkner_skan_has_mean_zero_and_the_right_energy() -> None:
    orbit = limit_orbit()
    assert orbit.upper - orbit.upper**3 / 3 == pytest.approx(orbit.lower - orbit.lower**3 / 3, abs=1e-14)
    problem = ShootingProblem(FALKNER_SKAN, {}, scale=(1000.0, 1.0, 1.0))
    beta = 1e4
    guess = np.array([beta, orbit.upper, orbit.half_period / np.sqrt(beta)])
    found = problem.correct(guess, np.array([1.0, 0.0, 0.0])).unknowns
    assert found[1] == pytest.approx(orbit.upper, abs=1e-5)
