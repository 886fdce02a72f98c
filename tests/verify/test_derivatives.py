"""Derivatives on a box: Cauchy's estimate for unknown parts, exact derivatives for known ones."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from math import factorial, prod

import pytest
from flint import ctx, fmpz_poly
from support.flow_checks import contains, random_fraction

from orbitproof.verify.algebra import Arithmetic, Exponents, Grading, Series
from orbitproof.verify.evidence import MAX_ORDER, indices_up_to
from orbitproof.verify.poincare import derivative_table

GRADINGS = (Grading((1, 1), 3), Grading((2, 1), 3), Grading((1, 1, 2), 2), Grading((2, 1, 2), 3))
Polynomial = dict[Exponents, Fraction]


def derivative_at(polynomial: Polynomial, alpha: Exponents, point: Sequence[Fraction]) -> Fraction:
    """The derivative of a polynomial in xi at a point."""
    result = Fraction(0)
    for exponents, coefficient in polynomial.items():
        if all(n >= a for n, a in zip(exponents, alpha, strict=True)):
            falling = prod(factorial(n) // factorial(n - a) for n, a in zip(exponents, alpha, strict=True))
            powers = (x ** (n - a) for x, n, a in zip(point, exponents, alpha, strict=True))
            result += coefficient * falling * prod(powers, start=Fraction(1))
    return result


def random_element(source: random.Random, grading: Grading) -> tuple[Series, Polynomial]:
    """An element that is constant in time: its enclosure and the exact polynomial, of degree up to 9."""
    arithmetic = Arithmetic(grading, 60, 10, 0)
    exact: Polynomial = {}
    coefs = []
    for exponents, scale in zip(grading.monomials, arithmetic.scales, strict=True):
        numerator = source.randint(-(2**50), 2**50)
        coefs.append(fmpz_poly([numerator]))
        exact[exponents] = Fraction(numerator, 2**scale)
    errors = arithmetic.zero_errors()
    for _ in range(12):
        exponents = tuple(source.choice((0, 0, 1, 2, 3, source.randint(0, 9))) for _ in grading.weights)
        size = 2.0 ** -source.randint(0, 60)
        errors[min(grading.grade(exponents), grading.top + 1)] += size
        exact[exponents] = exact.get(exponents, Fraction(0)) + source.choice((-1, 1)) * Fraction(size)
    return Series(arithmetic, coefs, errors), exact


@pytest.mark.parametrize("ratio", [Fraction(1, 4), Fraction(3, 4)], ids=str)
@pytest.mark.parametrize("seed", range(25))
def test_derivatives_of_exact_elements_are_enclosed(seed: int, ratio: Fraction) -> None:
    source = random.Random(seed)
    grading = source.choice(GRADINGS)
    series, exact = random_element(source, grading)
    scales = [Fraction(1, source.randint(1, 10**6)) for _ in grading.weights]
    with ctx.workprec(200):
        table = derivative_table(series, scales, ratio)
        points = [[random_fraction(source, ratio) for _ in scales] for _ in range(10)]
        points += [[ratio * sign for _ in scales] for sign in (1, -1)]
        for alpha in indices_up_to(len(scales), MAX_ORDER):
            unit = prod((s**a for s, a in zip(scales, alpha, strict=True)), start=Fraction(1))
            for point in points:
                assert contains(table.box[alpha], derivative_at(exact, alpha, point) / unit)
            centre = derivative_at(exact, alpha, [Fraction(0)] * len(scales))
            assert contains(table.centre[alpha], centre / unit)


@pytest.mark.parametrize("grading", GRADINGS, ids=str)
def test_the_table_of_an_exact_element_is_that_of_its_polynomial(grading: Grading) -> None:
    """The ends of the enclosure are sums over the monomials of what each of them is at most on the box."""
    source = random.Random(str(grading))
    ratio = Fraction(1, 3)
    series, _ = random_element(source, grading)
    exact = {e: Fraction(int(c[0]), 2**scale) for e, c, scale in
             zip(grading.monomials, series.coefs, series.arithmetic.scales, strict=True)}  # fmt: skip
    size = len(grading.weights)
    with ctx.workprec(200):
        table = derivative_table(series.with_errors(series.arithmetic.zero_errors()), [Fraction(1)] * size, ratio)
        for alpha, ball in table.box.items():
            at_zero = derivative_at(exact, alpha, [Fraction(0)] * size)
            largest = derivative_at({e: abs(c) for e, c in exact.items()}, alpha, [ratio] * size)
            for end in (at_zero - largest + abs(at_zero), at_zero + largest - abs(at_zero)):
                assert contains(ball, end, Fraction(1, 2**100))
            assert float(ball.rad()) <= float(largest - abs(at_zero)) * (1 + 1e-6)
            assert contains(table.centre[alpha], at_zero)


@pytest.mark.parametrize("order, degree", [(1, 4), (2, 8), (3, 11)])
def test_the_bound_on_the_box_is_nearly_attained(order: int, degree: int) -> None:
    """One high power whose derivative at the edge of the box exceeds its norm: the estimate needs its factor."""
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 0)
    series = Series(arithmetic, [fmpz_poly([])] * 2, [0.0, 0.0, 1.0])
    ratio = Fraction(3, 4)
    with ctx.workprec(100):
        table = derivative_table(series, [Fraction(1)], ratio)
        value = derivative_at({(degree,): Fraction(1)}, (order,), [ratio])
        assert value > factorial(order)
        assert contains(table.box[(order,)], value)
        assert not contains(table.box[(order,)], value * 4)


def test_lower_grades_do_not_enter_higher_derivatives() -> None:
    """An error of the orbit itself leaves the derivatives alone."""
    arithmetic = Arithmetic(Grading((2, 1), 3), 60, 0, 0)
    nothing = [fmpz_poly([])] * len(arithmetic.scales)
    table = derivative_table(Series(arithmetic, nothing, [1.0, 0.0, 0.0, 0.0, 0.0]), [Fraction(1)] * 2, Fraction(1, 4))
    for alpha, ball in table.box.items():
        assert bool(ball == 0) == any(alpha)


@pytest.mark.parametrize("polynomial", [[1, 1], [0, 0, 1]])
def test_an_element_that_depends_on_time_has_no_table(polynomial: list[int]) -> None:
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 4)
    element = Series(arithmetic, [fmpz_poly([1]), fmpz_poly(polynomial)], arithmetic.zero_errors())
    with pytest.raises(ValueError, match="no function on the box"):
        derivative_table(element, [Fraction(1)], Fraction(1, 4))
