"""Jets of the high-precision flow: exact algebra, flows in closed form, independent integration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from support.independent_flow import CONSTANTS, EARTH_MOON, crossings, extrapolated_crossings

from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement import (
    Crossing,
    IntegrationFailure,
    Jet,
    JetBasis,
    JetStepper,
    Tape,
    section_crossings,
    section_jets,
    start_jets,
)
from orbitproof.explore.refinement.crossing import shorter_coordinates
from orbitproof.explore.refinement.floats import FLOAT_BITS
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, Regularisation, ReversibleSystem, record
from orbitproof.shared.systems.regularised import KUSTAANHEIMO_STIEFEL


def test_basis_refuses_monomials_not_closed_under_division() -> None:
    with pytest.raises(ValueError, match="not closed"):
        JetBasis(((0, 0), (1, 1)))


def test_graded_basis_of_even_k_has_eight_monomials() -> None:
    assert len(JetBasis.graded((2, 1, 2), 3).monomials) == 8
    assert len(JetBasis.graded((1, 1, 2), 2).monomials) == 7
    assert len(JetBasis.graded((1, 1, 1), 3).monomials) == 20


def test_power_and_quotient_of_jets_are_consistent() -> None:
    basis = JetBasis.graded((1, 1), 4)
    x = Jet(basis, [2] + [0.5 ** (i + 1) for i in range(len(basis.monomials) - 1)])
    root = x.power(Fraction(1, 2))
    for left, right in ((root * root, x), (x.power(Fraction(-3, 2)) * x * root, basis.constant(1)), (1 / x * x * x, x)):
        assert left.coefficients == pytest.approx(right.coefficients, abs=1e-13)


def test_composition_of_jets_is_substitution() -> None:
    basis, line = JetBasis.graded((1, 1), 3), JetBasis.graded((1,), 3)
    x, y = (Jet(basis, [int(i == basis.variable(v)) for i in range(len(basis.monomials))]) for v in (0, 1))
    f = x * x * y + 3 * x - 2
    t = Jet(line, [0, 1, 0, 0])
    assert f.compose([t, 2 * t * t + t]).coefficients == (t * t * (2 * t * t + t) + 3 * t - 2).coefficients


def step_at(
    function: Callable[..., Sequence[Any]], names: Sequence[str], start: Sequence[float], degree: int
) -> Callable[[int, tuple[int, ...], float], float]:
    """One Taylor step for x' = function(x); returns (state, monomial, time) -> coefficient of the jet."""
    bits = 160
    basis = JetBasis.graded((1,) * len(names), degree)
    stepper = JetStepper(Tape(record(lambda x: function(x), names), {}), len(names), basis, bits)
    state = [[0] * len(basis.monomials) for _ in names]
    for i, x in enumerate(start):
        state[i][0] = round(Fraction(x) * 2**bits)
        if degree:
            state[i][basis.variable(i)] = 1 << bits
    result = stepper.step(state, -2)

    def value(i: int, monomial: tuple[int, ...], time: float) -> float:
        theta = time * 2.0**-result.exponent
        assert theta <= result.length
        series = result.series[i][basis.index[monomial]]
        return sum(float(Fraction(c, 2**bits)) * theta**n for n, c in enumerate(series))

    return value


def test_step_follows_a_rational_flow_with_its_derivatives() -> None:
    # x' = x^2, y' = y / x: x = x0 / (1 - x0 t), y = y0 exp(t / x0 - t^2 / 2).
    value = step_at(lambda s: (s[0] ** 2, s[1] / s[0]), ("x", "y"), (0.75, 1.5), 3)
    t, x, y = 1 / 32, 0.75, 1.5
    growth = float(mpmath.exp(t / x - t * t / 2))
    assert value(0, (0, 0), t) == pytest.approx(x / (1 - x * t), rel=1e-14)
    assert value(0, (3, 0), t) == pytest.approx(t**2 / (1 - x * t) ** 4, rel=1e-13)
    assert value(1, (0, 0), t) == pytest.approx(y * growth, rel=1e-14)
    assert value(1, (1, 1), t) == pytest.approx(-t / x**2 * growth, rel=1e-13)
    assert value(1, (2, 0), t) == pytest.approx(y * growth * (t**2 / x**4 + 2 * t / x**3) / 2, rel=1e-13)


def test_step_follows_a_flow_with_fractional_powers() -> None:
    # x' = x^(-1/2): x^(3/2) = x0^(3/2) + 3 t / 2; y' = 2 x ** -1 * y ** 3 is driven by it.
    value = step_at(lambda s: (s[0] ** -0.5, 3 - 2 * s[0] ** -2 + 0 * s[1]), ("x", "y"), (2.0, 1.0), 2)
    t, x = 1 / 64, 2.0
    base = x**1.5 + 1.5 * t
    assert value(0, (0, 0), t) == pytest.approx(base ** (2 / 3), rel=1e-14)
    assert value(0, (1, 0), t) == pytest.approx(base ** (-1 / 3) * x**0.5, rel=1e-14)
    second = -(base ** (-4 / 3)) * x / 2 + base ** (-1 / 3) * x**-0.5 / 2
    assert value(0, (2, 0), t) == pytest.approx(second / 2, rel=1e-13)
    driven = 1.0 + 3 * t - 4 * (x**-0.5 - base ** (-1 / 3)) * 1.0
    assert value(1, (0, 0), t) == pytest.approx(driven, rel=1e-13)


def test_orbit_into_a_singularity_is_refused() -> None:
    with pytest.raises(IntegrationFailure, match="singularity"):
        step_at(lambda s: (s[0] ** -0.5,), ("x",), (0.0,), 0)


@pytest.mark.parametrize(
    "system, point, steps, count",
    [(CR3BP, ("0.842", "0.16", "0.26"), 30, 2), (FALKNER_SKAN, ("340", "0.9398"), 20, 3)],
    ids=["cr3bp", "falkner-skan"],
)
def test_crossings_agree_with_independent_integration(
    system: ReversibleSystem, point: tuple[str, ...], steps: int, count: int
) -> None:
    images, times = crossings(system, point, count, 160, CONSTANTS)
    with mpmath.workdps(40):
        numbers = [mpmath.mpf(x) for x in point]
        parameters = [mpmath.mpf(EARTH_MOON["mu"].numerator) / EARTH_MOON["mu"].denominator]
        if system.family_parameter is not None:
            parameters = [numbers.pop(0)]
        state = [mpmath.mpf(0)] * len(system.state)
        for index, value in zip(system.fixed_coordinates, numbers, strict=True):
            state[index] = value
        final = extrapolated_crossings(system, parameters, state, times, steps * count)
        names = [*system.fixed_coordinates, *system.kernel_coordinates]
        jets = images[-1][-len(names) :]
        for index, jet in zip(names, jets, strict=True):
            assert abs(final[index] - mpmath.mpf(jet.coefficients[0])) < 1e-20


@pytest.mark.slow
@pytest.mark.parametrize(
    "system, point", [(CR3BP, ("0.842", "0.16", "0.26")), (FALKNER_SKAN, ("340", "0.9398"))], ids=["cr3bp", "f-s"]
)
def test_jets_of_iterates_agree_with_finite_differences(system: ReversibleSystem, point: tuple[str, ...]) -> None:
    size = 1 + 2 * len(system.kernel_coordinates)
    n = len(point) - 1
    first = [1.0, 0.5, -0.25][: n + 1] + [0.0] * n
    second = [0.0, -1.0, 0.75][: n + 1] + [0.0] * n
    images, _ = crossings(system, point, 2, 160, JetBasis.graded((1, 1), 3), (first, second))
    h = Fraction(1, 2**24)

    def shifted(a: int, b: int) -> list[Any]:
        moved = [Fraction(x) + h * (a * Fraction(first[i]) + b * Fraction(second[i])) for i, x in enumerate(point)]
        context = working_context(160)
        values = [context.mpf(x.numerator) / x.denominator for x in moved]
        start, parameter = start_jets(system, values, (), CONSTANTS)
        parameters = EARTH_MOON if system is CR3BP else {}
        returns = section_crossings(system, parameters, start, parameter, context)
        next(returns)
        return [jet.coefficients[0] for jet in section_jets(system, next(returns), parameter)]

    grid = {(a, b): shifted(a, b) for a, b in ((1, 0), (-1, 0), (2, 0), (-2, 0), (1, 1), (-1, 1), (1, -1), (-1, -1))}
    with mpmath.workprec(160):
        step = mpmath.mpf(h.numerator) / h.denominator
        index = images[1][0].basis.index
        for i in range(size):
            coefficients = [mpmath.mpf(c) for c in images[1][i].coefficients]
            value = {key: mpmath.mpf(grid[key][i]) for key in grid}
            scale = 1 + abs(coefficients[index[(3, 0)]]) + abs(coefficients[index[(2, 1)]])
            slope = (value[1, 0] - value[-1, 0]) / (2 * step)
            third = (value[2, 0] - 2 * value[1, 0] + 2 * value[-1, 0] - value[-2, 0]) / (2 * step**3)
            mixed = (value[1, 1] - value[1, -1] - value[-1, 1] + value[-1, -1]) / (4 * step**2)
            assert abs(slope - coefficients[index[(1, 0)]]) < 1e-10 * scale
            assert abs(mixed - coefficients[index[(1, 1)]]) < 1e-8 * scale
            assert abs(third - 6 * coefficients[index[(3, 0)]]) < 1e-6 * scale


@pytest.mark.parametrize(
    ("point", "bits"),
    [
        pytest.param(("0.98783", "0.000478", "7.1"), 144, marks=pytest.mark.slow, id="near"),
        pytest.param(("0.9898", "-0.04075", "-0.7396"), 108, id="far"),
    ],
)
def test_regularised_coordinates_give_the_same_jets_of_two_returns(point: tuple[str, ...], bits: int) -> None:
    """Directions off Fix(R) as well: the embedding holds on the whole section."""
    context, numbers = working_context(bits), [Fraction(x) for x in point]
    basis = JetBasis.graded((1, 1), 3)
    directions = [[1, 0.5, -0.25, 0.5, 0], [0, -1, 0.25, 1, -0.5]]
    values = [context.mpf(x.numerator) / x.denominator for x in numbers]
    start, _ = start_jets(CR3BP, values, directions, basis)

    def images(regularisation: Regularisation | None) -> list[Crossing]:
        crossings = section_crossings(CR3BP, EARTH_MOON, start, None, context, regularisation=regularisation)
        return [next(crossings), next(crossings)]

    for own, other in zip(images(None), images(KUSTAANHEIMO_STIEFEL), strict=True):
        assert own.time == pytest.approx(other.time, abs=1e-12)
        for left, right in zip(own.jets, other.jets, strict=True):
            scale = max(1, *(abs(c) for c in left.coefficients))
            assert max(abs(a - b) for a, b in zip(left.coefficients, right.coefficients, strict=True)) < 1e-20 * scale


@pytest.mark.parametrize(
    "system, point, regularisation",
    [
        (CR3BP, ("0.842", "0.16", "0.26"), None),
        (CR3BP, ("0.9898", "-0.04075", "-0.7396"), KUSTAANHEIMO_STIEFEL),
        (FALKNER_SKAN, ("340", "0.9398"), None),
    ],
    ids=["cr3bp", "regularised", "falkner-skan"],
)
def test_floats_give_the_jets_of_many_digits(
    system: ReversibleSystem, point: tuple[str, ...], regularisation: Regularisation | None
) -> None:
    """At two returns, with the time that they take, in directions off Fix(R) too."""
    basis, size = JetBasis.graded((2, 1), 3), 1 + 2 * len(system.kernel_coordinates)
    directions = [[1, 0.5, -0.25, 0.5, 0][:size], [0, -1, 0.25, 1, -0.5][:size]]
    found = []
    for bits in (FLOAT_BITS, 120):
        context = working_context(bits)
        start, parameter = start_jets(system, [mpf(x, context) for x in point], directions, basis)
        parameters = EARTH_MOON if system is CR3BP else {}
        returns = section_crossings(system, parameters, start, parameter, context, regularisation=regularisation)
        found.append([next(returns), next(returns)])
    for rough, fine in zip(*found, strict=True):
        assert rough.time == pytest.approx(fine.time, rel=1e-13)
        for left, right in zip([*rough.jets, rough.duration], [*fine.jets, fine.duration], strict=True):
            scale = max(1e-3, *(abs(float(c)) for c in right.coefficients))
            differences = [float(abs(a - b)) for a, b in zip(left.coefficients, right.coefficients, strict=True)]
            assert max(differences) < 1e-9 * scale


@pytest.mark.parametrize(
    "point, reason", [((1 - EARTH_MOON["mu"], 0, 1), "singularity"), ((0.84, 0.16, 0), "tangent")], ids=str
)
def test_floats_refuse_what_many_digits_refuse(point: tuple[Any, ...], reason: str) -> None:
    for bits in (FLOAT_BITS, 90):
        start, _ = start_jets(CR3BP, [mpf(x, working_context(bits)) for x in point], (), CONSTANTS)
        with pytest.raises(IntegrationFailure, match=reason):
            next(section_crossings(CR3BP, EARTH_MOON, start, None, working_context(bits)))


def test_regularised_coordinates_are_chosen_close_to_the_smaller_primary_only() -> None:
    assert shorter_coordinates(CR3BP, EARTH_MOON, [0.9878404796, 0.0005064485814, 6.915437421]) is not None
    assert shorter_coordinates(CR3BP, EARTH_MOON, [0.842, 0.16, 0.26]) is None
    assert shorter_coordinates(FALKNER_SKAN, {}, [340, 0.9398]) is None
