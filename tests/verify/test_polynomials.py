"""Exact polynomials in s: moved to another interval, added, and enclosed around a point."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import arb, arb_poly
from support.flow_checks import ball

from orbitproof.shared.claims import evaluate
from orbitproof.verify.algebra import ball_polynomial, plus, recentred, values_around


@pytest.mark.parametrize("middle", [Fraction(0), Fraction(1, 3), Fraction(-5, 7)])
@pytest.mark.parametrize("length", [0, 1, 2, 6])
def test_a_polynomial_that_is_moved_has_the_same_values(length: int, middle: Fraction) -> None:
    source = random.Random(length)
    coefficients = [Fraction(source.randint(-99, 99), source.randint(1, 99)) for _ in range(length)]
    radius = Fraction(2, 5)
    moved = recentred(coefficients, middle, radius)
    for sigma in (Fraction(n, 4) for n in range(-4, 5)):
        assert evaluate(moved, sigma) == evaluate(coefficients, middle + radius * sigma)


def test_a_multiple_of_a_longer_or_shorter_polynomial_is_added() -> None:
    left, right = [Fraction(1), Fraction(2), Fraction(3)], [Fraction(5), Fraction(7)]
    assert plus(left, right, Fraction(1, 2)) == (Fraction(7, 2), Fraction(11, 2), 3)
    assert plus(right, left, Fraction(-1)) == (4, 5, -3)


@pytest.mark.parametrize("seed", range(20))
def test_values_around_a_point_are_enclosed(seed: int) -> None:
    """Where the coefficients there have all signs, and where the enclosure is attained."""
    source = random.Random(seed)
    coefficients = [Fraction(source.randint(-9, 9)) for _ in range(source.randint(0, 5))]
    centre, reach = Fraction(source.randint(-4, 4), 4), Fraction(1, source.randint(1, 3))
    found = values_around(ball_polynomial(coefficients), ball(centre), ball(reach))
    for v in (Fraction(n, 8) for n in range(-8, 9)):
        assert found.contains(ball(evaluate(coefficients, centre + reach * v)))


def test_values_around_a_point_are_within_the_sum_of_the_other_coefficients() -> None:
    """v - v^2 is -2 at v = -1."""
    found = values_around(arb_poly([0, 1, -1]), arb(0), arb(1))
    assert found.contains(-2)
    assert found.rad() < 2.001
