"""The search with sin, cos, exp and log: derivatives against differences, jets, complex points, equilibria."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from orbitproof.explore.atlases.complex_flow import HalfReturns
from orbitproof.explore.flow import flow_batch, flow_of
from orbitproof.explore.orbits.shooting import ShootingProblem
from orbitproof.explore.refinement.half_return import half_return
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.explore.seeds.equilibria import small_orbits
from orbitproof.shared.systems import ReversibleSystem, completed, described

SWING: dict[str, Any] = {
    "name": "pendula-searched", "state": "x y vx vy", "parameters": "e",
    "field": {"x": "vx", "y": "vy", "vx": "-sin(x) - e*sin(x - y)", "vy": "-sin(y) + e*sin(x - y)"},
    "R": {"vx": -1, "vy": -1}, "section": "vx",
    "first_integral": "(vx**2 + vy**2)/2 - cos(x) - cos(y) - e*cos(x - y)",
}  # fmt: skip
"""Fix(R) are the points at rest, where x and y, and with them the functions, are not 0."""

WAVE: dict[str, Any] = {
    "name": "wave-searched", "state": "x y z", "parameters": "c", "where": {"r": "exp(-x**2/4)"},
    "field": {
        "x": "y*cos(x*z/4)", "y": "z*r + x*z**2*log(2 + y + x**2)/9", "z": "sin(c)**2 - sin(y) - x**2/2 - y*exp(c*r)/3"
    },
    "R": {"x": -1, "z": -1}, "section": "x", "family_parameter": "c",
}  # fmt: skip


def system_of(entry: dict[str, Any]) -> ReversibleSystem:
    system = described(entry)
    assert isinstance(system, ReversibleSystem)
    return system


CASES = [
    pytest.param(SWING, [0.4, 0.9], 1.9, {"e": Fraction(2, 5)}, marks=pytest.mark.slow, id="pendula"),
    pytest.param(WAVE, [0.5, 0.6], 2.2, {}, id="wave"),
]


@pytest.mark.parametrize(("entry", "point", "time", "parameters"), CASES)
def test_derivatives_go_through_the_functions_at_the_start(
    entry: dict[str, Any], point: list[float], time: float, parameters: dict[str, Fraction]
) -> None:
    system = system_of(entry)
    problem = ShootingProblem(system, parameters)
    unknowns = np.array([*point, time])
    values = problem.parameter_values(unknowns)
    state = problem.initial_state(unknowns)
    assert state.tolist() == pytest.approx(completed(system, state.tolist(), values.tolist()), abs=1e-15)
    _, jacobian, flow = problem.evaluate(unknowns)
    step = 1e-5
    for column in range(len(unknowns)):
        shift = step * np.eye(len(unknowns))[column]
        ends = [problem.evaluate(unknowns + sign * shift)[0] for sign in (1, -1)]
        assert jacobian[:, column] == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-8)
    # The end lies where the functions have their values.
    assert flow.state.tolist() == pytest.approx(completed(system, flow.state.tolist(), values.tolist()), abs=1e-10)
    # What is given for the functions is not used.
    wrong = state.copy()
    wrong[len(system.given_state) :] = 7.0
    assert flow_of(system).derivative(wrong, time, values).state == pytest.approx(flow.state, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("entry", "point", "time", "parameters"), CASES)
def test_many_orbits_at_once_are_those_of_single_ones(
    entry: dict[str, Any], point: list[float], time: float, parameters: dict[str, Fraction]
) -> None:
    system = system_of(entry)
    problem = ShootingProblem(system, parameters)
    unknowns = np.array([*point, time])
    values, state = problem.parameter_values(unknowns), problem.initial_state(unknowns)
    _, _, flow = problem.evaluate(unknowns)
    batch = flow_batch(system, state[None], np.array([time]), values[None])
    assert batch.states[0] == pytest.approx(flow.state, abs=1e-10)
    assert batch.state_transitions[0] == pytest.approx(flow.state_transition, abs=1e-9)
    assert batch.parameter_derivatives[0] == pytest.approx(flow.parameter_derivative, abs=1e-9)
    # At points with complex coordinates: the derivative along the first of them.
    points = np.array([np.full(4, x, dtype=np.clongdouble) for x in point])
    points[0] += 1e-5 * np.array([1, 1j, -1, -1j])
    found = HalfReturns(system, parameters).evaluate(points, np.full(4, time, dtype=complex))
    along = (found.values @ np.array([1, -1j, -1, 1j])) / 4e-5
    rows = [system.section_index, *system.kernel_coordinates]
    first = (
        flow.parameter_derivative if system.family_parameter else flow.state_transition[:, system.fixed_coordinates[0]]
    )
    assert along.real == pytest.approx(first[rows], abs=1e-8)


@pytest.mark.parametrize(("entry", "point", "time", "parameters"), CASES)
def test_series_agree_with_the_flow(
    entry: dict[str, Any], point: list[float], time: float, parameters: dict[str, Fraction]
) -> None:
    system = system_of(entry)
    context = mpmath.MPContext()
    context.prec = 120
    half = half_return(system, parameters, [Fraction(x) for x in point], context)
    n = len(system.kernel_coordinates)
    problem = ShootingProblem(system, parameters)
    _, _, flow = problem.evaluate(np.array([*point, half.time]))
    kernel = list(system.kernel_coordinates)
    assert [float(q) for q in half.kernel_values] == pytest.approx(flow.state[kernel].tolist(), abs=1e-9)
    columns = [flow.state_transition[:, list(system.fixed_coordinates)]]
    if system.family_parameter is not None:
        columns.insert(0, flow.parameter_derivative[:, None])
    derivative = np.hstack(columns)
    section = system.section_index
    projected = derivative - np.outer(flow.velocity, derivative[section]) / flow.velocity[section]
    found = np.array([[float(half.derivative[1 + n + i, j]) for j in range(1 + n)] for i in range(n)])
    assert found == pytest.approx(projected[kernel], abs=1e-8)


@pytest.mark.parametrize("name", ["sin", "cos", "exp", "log"])
def test_functions_of_jets_are_taylor_series(name: str) -> None:
    context = mpmath.MPContext()
    context.prec = 100
    basis = JetBasis.graded((1, 1), 3)
    jet = basis.constant(context.mpf("0.7"))
    jet.coefficients[basis.variable(0)], jet.coefficients[basis.variable(1)] = context.mpf(2), context.mpf(-1)
    result = jet.function(name, context)
    assert isinstance(result, Jet)
    for monomial, value in zip(basis.monomials, result.coefficients, strict=True):
        order = sum(monomial)
        slope = mpmath.diff(getattr(mpmath, name), mpmath.mpf("0.7"), order)
        expected = slope * 2 ** monomial[0] * (-1) ** monomial[1]
        expected /= mpmath.factorial(monomial[0]) * mpmath.factorial(monomial[1])
        assert float(value) == pytest.approx(float(expected), rel=1e-6)


def test_small_orbits_about_an_equilibrium_with_functions() -> None:
    found = small_orbits(system_of(SWING), {"e": 0.4}, {})
    assert [orbit.half_period for orbit in found] == pytest.approx([np.pi / np.sqrt(1.8), np.pi], rel=1e-6)
    upside = {"name": "upside", "field": {**SWING["field"], "vx": "sin(x) - e*sin(x - y)"}}
    upside["first_integral"] = "(vx**2 + vy**2)/2 + cos(x) - cos(y) - e*cos(x - y)"
    found = small_orbits(system_of({**SWING, **upside}), {"e": 0.1}, {"x": 3.0})
    assert all(orbit.point[0] == pytest.approx(np.pi, abs=2e-3) for orbit in found)
