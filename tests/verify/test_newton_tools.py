"""The tools under the conditions: comparisons, jets, Taylor forms, interval Newton."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from fractions import Fraction as F
from math import comb, factorial, prod

import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from support.balls import agree

from orbitproof.verify.evidence import (
    DerivativeTable,
    EmptyIntersectionError,
    all_finite,
    bounds,
    enclose,
    excludes_zero,
    hull,
    indices_up_to,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    meet,
    power,
    sign,
    symmetric,
    up_to,
)
from orbitproof.verify.newton import BoxFunction, ImplicitGraph, Jet, compose, implicit_jets, is_regular, newton_image
from orbitproof.verify.newton.jets import increment

Polynomial = Mapping[tuple[int, ...], F]
fractions = st.fractions(min_value=-8, max_value=8, max_denominator=64)


def contains(ball: arb, value: F) -> bool:
    lower, upper = bounds(ball)
    return lower <= value <= upper


@given(fractions, fractions, st.integers(min_value=-3, max_value=6))
def test_powers_of_the_points_of_a_ball_are_in_its_power(point: F, other: F, n: int) -> None:
    result = power(hull(enclose(point), enclose(other)), F(n))
    assert contains(result, point**n) if n > 0 or point * other > 0 else not result.is_finite() or n == 0


@pytest.mark.parametrize("n", [1, 2, 3, 8])
def test_powers_of_a_ball_about_zero_are_finite(n: int) -> None:
    lower, upper = bounds(power(arb(0, 0.25), F(n)))
    assert -(F(1, 4) ** n) * F(101, 100) < lower <= -(F(1, 4) ** n) < F(1, 4) ** n <= upper < F(1, 4) ** n * F(101, 100)


def derivative_at(polynomial: Polynomial, index: Sequence[int], point: Sequence[F]) -> F:
    """Exact derivative of a polynomial at an exact point."""
    result = F(0)
    for exponents, coefficient in polynomial.items():
        if all(e >= i for e, i in zip(exponents, index, strict=True)):
            falling = prod(comb(e, i) * factorial(i) for e, i in zip(exponents, index, strict=True))
            powers = prod((x ** (e - i) for e, i, x in zip(exponents, index, point, strict=True)), start=F(1))
            result += coefficient * falling * powers
    return result


def table_of(polynomial: Polynomial, radii: Sequence[F]) -> DerivativeTable:
    """Crude but right tables: every monomial bounded on its own."""
    size = len(radii)

    def over(index: tuple[int, ...]) -> arb:
        return symmetric(sum((abs(derivative_at({e: c}, index, radii)) for e, c in polynomial.items()), F(0)))

    indices = indices_up_to(size, 3)
    origin = [F(0)] * size
    return DerivativeTable(
        {index: over(index) for index in indices},
        {index: enclose(derivative_at(polynomial, index, origin)) for index in indices},
    )


NAN, INFINITE, WIDE = arb("nan"), arb("inf"), arb(0, "inf")


@pytest.mark.parametrize("ball", [NAN, INFINITE, -INFINITE, WIDE], ids=["nan", "inf", "-inf", "whole line"])
def test_no_comparison_holds_for_a_ball_that_is_not_finite(ball: arb) -> None:
    assert not is_positive(ball)
    assert not is_positive(-ball)
    assert not excludes_zero(ball)
    assert sign(ball) == 0
    assert not is_below(ball, arb(1))
    assert not is_below(arb(1), ball)
    assert not is_inside(ball, F(1))
    assert not is_outside(ball, F(1))
    assert not all_finite([arb(1), ball])


def test_undecided_comparisons_do_not_hold() -> None:
    assert not is_inside(arb(1), F(1))
    assert not is_inside(symmetric(F(1, 3)), F(1, 3))
    assert not is_positive(arb(0))
    assert not excludes_zero(up_to(arb(1)))
    assert not is_below(arb(1, 1), arb(2))
    assert not all_finite([])


@given(fractions, fractions, fractions)
def test_hull_and_up_to_contain_what_they_say(a: F, b: F, c: F) -> None:
    ball = hull(enclose(a), enclose(b), enclose(c))
    assert all(contains(ball, value) for value in (a, b, c, (a + b + c) / 3))
    assert contains(up_to(enclose(abs(a))), abs(a) / 3)


@given(fractions, fractions, fractions)
def test_meet_keeps_every_common_point(centre: F, r: F, s: F) -> None:
    first = enclose(centre + r) + symmetric(abs(r))
    second = enclose(centre - s) + symmetric(abs(s))
    assert contains(meet(first, second), centre)
    assert contains(meet(first, NAN, second), centre)


def test_meet_of_disjoint_enclosures_is_an_error() -> None:
    with pytest.raises(EmptyIntersectionError):
        meet(arb(0), arb(1))


POLYNOMIAL: Polynomial = {(1, 0): F(1, 3), (0, 1): F(2), (2, 1): F(-5), (1, 3): F(7), (0, 2): F(1), (4, 0): F(3)}


def test_composition_of_jets_agrees_with_exact_differentiation() -> None:
    # f(u(s), v(s)) with u = s + s^2, v = 2 s - s^3, f as above, expanded by hand through exact powers of s.
    one = increment(1, 3, 0)
    square, cube = one * one, one * one * one
    u = one + square
    v = one.scaled(arb(2)) + cube.scaled(arb(-1))
    origin = [F(0), F(0)]
    derivatives = {index: enclose(derivative_at(POLYNOMIAL, index, origin)) for index in indices_up_to(2, 3)}
    result = compose(derivatives, [u, v])

    def value(s: F) -> F:
        return derivative_at(POLYNOMIAL, (0, 0), [s + s * s, 2 * s - s**3])

    # Exact Taylor coefficients from the values at seven points and more (degree at most 16).
    points = [F(i, 8) for i in range(-10, 11)]
    coefficients = interpolate(points, [value(point) for point in points])
    for degree in range(4):
        assert contains(result[(degree,)], coefficients[degree])
        assert result[(degree,)].rad() < 1e-12


def interpolate(points: Sequence[F], values: Sequence[F]) -> list[F]:
    """Coefficients of the interpolating polynomial, by Newton's divided differences."""
    table = list(values)
    for level in range(1, len(points)):
        for i in range(len(points) - 1, level - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (points[i] - points[i - level])
    result = [F(0)] * len(points)
    for i in range(len(points) - 1, -1, -1):
        shifted = [F(0), *result[:-1]]
        result = [a - points[i] * b for a, b in zip(shifted, result, strict=True)]
        result[0] += table[i]
    return result


def test_implicit_jets_satisfy_the_equations_to_their_order() -> None:
    # Two equations for y(x) in two unknowns over two variables, away from the origin.
    f: Polynomial = {(1, 0, 0, 0): F(1), (0, 0, 1, 0): F(3), (0, 0, 0, 1): F(1), (0, 1, 1, 0): F(2), (0, 0, 2, 1): F(1)}
    g: Polynomial = {
        (0, 1, 0, 0): F(-1),
        (0, 0, 0, 1): F(2),
        (1, 0, 1, 0): F(1),
        (0, 0, 1, 2): F(-1),
        (2, 0, 0, 0): F(4),
    }
    point = [F(1, 4), F(-1, 8), F(1, 2), F(3, 8)]
    tables = [
        {index: enclose(derivative_at(function, index, point)) for index in indices_up_to(4, 3)} for function in (f, g)
    ]
    jets = implicit_jets(tables, 2, 3)
    for function in tables:
        residual = compose(function, jets)
        for index, ball in residual.coefficients.items():
            if sum(index):
                assert ball.contains(0)
                assert ball.rad() < 1e-10
    assert not jets[2][(2, 0)].contains(0)


def test_jet_refuses_a_derivative_that_it_does_not_have() -> None:
    with pytest.raises(ValueError, match="no derivative"):
        increment(2, 3, 0).derivative(2, 2)
    with pytest.raises(ValueError, match="no derivative"):
        Jet(2, 3, {}).derivative(1)


def test_a_derivative_is_the_coefficient_times_the_factorials() -> None:
    x, y = increment(2, 3, 0), increment(2, 3, 1)
    assert contains((x * x * y).derivative(2, 1), F(2))
    assert contains((y * y * y).derivative(0, 3), F(6))


@settings(max_examples=40)
@given(st.lists(fractions, min_size=20, max_size=20), st.integers(0, 10**9))
def test_taylor_forms_contain_the_derivatives_at_random_points(coefficients: list[F], seed: int) -> None:
    generator = random.Random(seed)
    indices = [*indices_up_to(3, 2), (3, 0, 0), (1, 1, 1), (0, 2, 2), (4, 0, 1), (0, 0, 5)]
    polynomial = dict(zip(indices, coefficients, strict=False))
    radii = [F(1, 4), F(1, 32), F(2)]
    function = BoxFunction(table_of(polynomial, radii))
    centres = [radius * generator.randint(-90, 90) / 100 for radius in radii]
    where = [enclose(centre) + symmetric(radius / 10) for centre, radius in zip(centres, radii, strict=True)]
    for _ in range(5):
        point = [c + r * generator.randint(-100, 100) / 1000 for c, r in zip(centres, radii, strict=True)]
        for index in indices_up_to(3, 3):
            assert contains(function.derivative(index, where), derivative_at(polynomial, index, point))


def test_taylor_forms_are_tight_near_the_centre() -> None:
    polynomial: Polynomial = {(0, 0): F(1), (1, 0): F(1), (2, 1): F(50), (3, 3): F(100)}
    function = BoxFunction(table_of(polynomial, [F(1), F(1)]))
    assert function.value([symmetric(F(1, 2**20)), arb(0)]).rad() < 1e-5
    assert function.table.box[(0, 0)].rad() > 100


@settings(max_examples=60)
@given(st.lists(fractions, min_size=4, max_size=4), st.fractions(min_value=0, max_value=2, max_denominator=32))
def test_a_ball_matrix_with_a_singular_member_is_not_regular(entries: list[F], radius: F) -> None:
    a, b, c, d = entries
    if a:
        d = b * c / a
    elif c:
        b = F(0)
    matrix = [[enclose(value) + symmetric(radius) for value in row] for row in ((a, b), (c, d))]
    assert not is_regular(matrix)


def test_regular_ball_matrices_are_recognised_whatever_the_scales() -> None:
    tiny, huge = arb("1e-30"), arb("1e30")
    assert is_regular([[arb(1, 0.3), arb(0, 0.3) * huge], [arb(0, 0.3) * tiny, arb(1, 0.3)]])
    assert not is_regular([[arb(1, 0.6), arb(0, 0.6) * huge], [arb(0, 0.6) * tiny, arb(1, 0.6)]])
    assert is_regular([[tiny]])
    assert not is_regular([[arb(0)]])
    assert not is_regular([[NAN]])
    assert not is_regular([[WIDE]])


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_one_direction_in_which_a_matrix_may_be_singular_is_enough(order: tuple[int, int]) -> None:
    diagonal = [arb(1, 0.1), arb(1, 1.5)]
    assert not is_regular([[diagonal[i] if i == j else arb(0) for j in order] for i in order])


@settings(max_examples=40)
@given(st.lists(fractions, min_size=6, max_size=6), st.integers(0, 10**9))
def test_newton_image_contains_the_solution_for_every_member(entries: list[F], seed: int) -> None:
    a, b, c, d, e, f = entries
    matrix = [[enclose(9 + abs(a)) + symmetric(F(1, 4)), enclose(b / 4)], [enclose(c / 4), enclose(-9 - abs(d))]]
    residual = [enclose(e) + symmetric(F(1, 8)), enclose(f)]
    image = newton_image(matrix, residual)
    generator = random.Random(seed)
    for _ in range(10):
        m = 9 + abs(a) + F(generator.randint(-100, 100), 400)
        r = e + F(generator.randint(-100, 100), 800)
        determinant = m * (-9 - abs(d)) - b * c / 16
        x = -((-9 - abs(d)) * r - b / 4 * f) / determinant
        y = -(m * f - c / 4 * r) / determinant
        assert contains(image[0], x)
        assert contains(image[1], y)


def test_newton_image_of_a_singular_matrix_is_an_error() -> None:
    with pytest.raises(ZeroDivisionError):
        newton_image([[arb(0, 1)]], [arb(1)])


def test_implicit_graph_encloses_the_graph_of_a_known_function() -> None:
    # y + y^3/8 = x^2 + x/100 + 1/1000 has one solution; sample it by bisection.
    polynomial: Polynomial = {(0, 1): F(1), (0, 3): F(1, 8), (2, 0): F(-1), (1, 0): F(-1, 100), (0, 0): F(-1, 1000)}
    radii = [F(1, 8), F(1, 8)]
    box = tuple(symmetric(radius) for radius in radii)
    graph = ImplicitGraph((BoxFunction(table_of(polynomial, radii)),), box, 1)
    assert graph.is_regular()
    assert is_inside(graph.image(box[:1])[0], radii[1])
    for position in range(-8, 9):
        x = F(position, 64)
        low, high = -radii[1], radii[1]
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if derivative_at(polynomial, (0, 0), [x, middle]) > 0 else (middle, high)
        for where in (graph.over((box[0],)), graph.over((enclose(x),))):
            assert agree(where[1], hull(enclose(low), enclose(high)))
    assert graph.over((arb(0),))[1].rad() < 1e-6


def test_implicit_graph_far_from_zero_keeps_its_solution() -> None:
    # y + 3 y^2 = 13/100 at y = 1/10: the mean of the derivative over [0, y] is not its value near y.
    polynomial: Polynomial = {(0, 1): F(1), (0, 2): F(3), (0, 0): F(-13, 100)}
    radii = [F(1), F(1, 8)]
    graph = ImplicitGraph((BoxFunction(table_of(polynomial, radii)),), tuple(symmetric(r) for r in radii), 1)
    assert contains(graph.over((arb(0),))[1], F(1, 10))


def test_a_graph_whose_slope_vanishes_beside_the_centre_is_not_regular() -> None:
    # The derivative of y - 3 y^2 in y is 1 at 0, and 0 at y = 1/6.
    radii = [F(1), F(1, 4)]
    graph = ImplicitGraph(
        (BoxFunction(table_of({(0, 1): F(1), (0, 2): F(-3)}, radii)),), tuple(symmetric(r) for r in radii), 1
    )
    assert not graph.is_regular()
