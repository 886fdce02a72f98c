"""Functions along a curve contain what they enclose, and no zero is lost."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from math import cos, gcd, pi

import pytest
from flint import arb, arb_poly, ctx
from support.balls import agree
from support.flow_checks import ball
from support.stored import function_of, json_of_function
from support.within import within

from orbitproof.shared.formats import InputError
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.functions import (
    REACH,
    BoundedFunction,
    function,
    inverse,
    restricted,
    slope,
)
from orbitproof.verify.stability.along import solve
from orbitproof.verify.stability.complete_list import orders, resonant_value
from orbitproof.verify.stability.matrix import SHARE
from orbitproof.verify.stability.zeros import zeros_beside_double_one, zeros_on

END = 1 / REACH

_precision = within(lambda: ctx.workprec(160))


# Functions


ALGEBRA = WideArithmetic(Grading((1,), 0), 120, 0, 0, width=10)


def element(*coefficients: str, error: str = "0") -> Series:
    return function(ALGEBRA, [Fraction(value) for value in coefficients], Fraction(error))


def enclosed(series: Series) -> BoundedFunction:
    return function_of(json_of_function(series))


@pytest.mark.parametrize("seed", range(20))
def test_functions_hold_unknown_parts_and_their_derivatives(seed: int) -> None:
    """1/(3 - s) + e s^7 on |s| <= 1, stored, with its derivatives in tau."""
    source = random.Random(seed)
    error = Fraction(source.randint(1, 100), 10**4)
    sign = source.choice((1, -1))
    known = inverse(element("3", "-1")).widened(error)
    stored = enclosed(restricted(known, SHARE))
    share, tau = float(SHARE), source.uniform(-1, 1) * float(END)
    s = share * tau
    part = ball(Fraction(tau)) + arb(0, 1e-9)
    unknown = sign * float(error)
    assert stored.value(part).contains(arb(1 / (3 - s) + unknown * s**7))
    assert stored.slope(part).contains(arb(share * (1 / (3 - s) ** 2 + unknown * 7 * s**6)))
    assert stored.curvature(part).contains(arb(share**2 * (2 / (3 - s) ** 3 + unknown * 42 * s**5)))
    derived = enclosed(slope(known, SHARE))
    assert derived.value(part).contains(arb(1 / (3 - s) ** 2 + unknown * 7 * s**6))
    product = stored * stored
    assert product.value(part).contains(arb((1 / (3 - s) + unknown * s**7) ** 2))
    assert agree(stored.mirrored().value(-part), stored.value(part))


def test_functions_are_not_much_wider_than_what_is_known() -> None:
    stored = enclosed(restricted(element("1", "2", "3", error="1e-12"), SHARE))
    assert float(stored.error) < 2e-11
    assert float(stored.slope(arb(0)).rad()) < 1e-9


def test_a_function_with_a_zero_in_the_disc_has_no_inverse() -> None:
    for middle in ("0", "1/2", "-9/10"):
        with pytest.raises(IntegrationFailure):
            inverse(element(middle, "1"))


def test_confirmation_takes_an_enclosure_inside() -> None:
    coarse, fine = element("1", "2", error="1e-6"), element("1.0000000001", "2", error="1e-7")
    other = element("1.0001", "2", error="1e-7")
    assert enclosed(coarse).contains(enclosed(fine))
    assert not enclosed(fine).contains(enclosed(coarse))
    assert not enclosed(coarse).contains(enclosed(other))


def test_functions_without_error_are_confirmed_with_more_bits() -> None:
    """What is lost by writing a function down is less with more precision."""
    finer = WideArithmetic(Grading((1,), 0), 192, 0, 0, width=10)
    coarse = WideArithmetic(Grading((1,), 0), 160, 0, 0, width=10)
    stored, fresh = (
        enclosed(inverse(function(a, [Fraction(3), Fraction(1, 9)], Fraction(0)))) for a in (coarse, finer)
    )
    linear = [enclosed(function(a, [Fraction(1, 3), Fraction(1, 7)], Fraction(0))) for a in (coarse, finer)]
    assert linear[0].contains(linear[1])
    assert agree(stored.value(arb(0)), fresh.value(arb(0)))


@pytest.mark.parametrize(("coefficient", "error"), [("1", "-1"), ("x", "0"), ("-0x1p999999", "0"), ("1", "0x1p999999")])
def test_functions_that_are_none_are_refused(coefficient: str, error: str) -> None:
    """Among them those with numbers so long that a list from them would take hours."""
    entry = {"coefficients": [coefficient], "error": error}
    with pytest.raises((InputError, ValueError)):
        function_of(entry)


# The curve in its tube


def tube_equation(error: float = 0.0) -> Series:
    """F = s/8 + (2 + s) w + unknown parts."""
    arithmetic = WideArithmetic(Grading((1,), 1), 80, 0, 0, width=10)
    known = arithmetic.polynomial({(0,): [Fraction(0), Fraction(1, 8)], (1,): [Fraction(3), Fraction(1)]})
    return known.with_errors([error, error, error])


@pytest.mark.parametrize("sign", [1, -1])
def test_the_curve_in_its_tube_is_enclosed(sign: int) -> None:
    """With s^3/1000 + s w/1000 + w^2/1000 added, the zero w(s) is that of a quadratic equation."""
    error = 1 / 1000
    (omega,) = solve(ALGEBRA, [tube_equation(error)]).omega
    found = enclosed(restricted(omega, SHARE))
    for number in range(-20, 21):
        s = number / 21
        linear, constant = 3 + s + sign * error * s, s / 8 + sign * error * s**3
        root = 2 * -constant / (linear + (linear**2 - 4 * sign * error * constant) ** 0.5)
        assert found.value(arb(s / float(SHARE))).contains(arb(root))


def test_a_curve_that_leaves_its_tube_or_turns_is_not_enclosed() -> None:
    for equation in (tube_equation(0.5), tube_equation(float("inf")), tube_equation(float("nan"))):
        with pytest.raises(IntegrationFailure):
            solve(ALGEBRA, [equation])


# Zeros


def polynomial(roots: Sequence[Fraction], error: float = 0.0) -> BoundedFunction:
    value = arb_poly([1])
    for root in roots:
        value = value * arb_poly([-ball(root), 1])
    return BoundedFunction(value, arb(error))


@pytest.mark.parametrize("seed", range(40))
def test_all_zeros_are_found_one_by_one(seed: int) -> None:
    source = random.Random(seed)
    roots = sorted({Fraction(source.randint(-1200, 1200), 1000) for _ in range(source.randint(0, 7))})
    inside = [root for root in roots if -END < root < END]
    found = zeros_on(polynomial(roots), -END, END)
    assert not found.undecided
    assert len(found.zeros) == len(inside)
    for zero, root in zip(found.zeros, inside, strict=True):
        assert zero.lower < root < zero.upper
        assert zero.place.contains(ball(root))
        assert float(zero.place.rad()) < 1e-12


def test_double_zeros_and_wide_bounds_are_undecided() -> None:
    for function_ in (polynomial([Fraction(1, 3)] * 2), polynomial([Fraction(1, 3)], 0.5), polynomial([END])):
        found = zeros_on(function_, -END, END)
        assert found.undecided
        assert not found.zeros
    touching = zeros_on(polynomial([Fraction(1, 3)] * 2), -END, END).undecided
    assert all(low <= Fraction(1, 3) <= high for low, high in touching)


def test_zeros_beside_a_double_one_are_found() -> None:
    twice = [Fraction(0), Fraction(0), Fraction(1, 2)]
    end, found = zeros_beside_double_one(polynomial(twice), END)
    assert 0 < end < Fraction(1, 2)
    (zero,) = found.zeros
    assert zero.place.contains(ball(Fraction(1, 2)))
    _, none = zeros_beside_double_one(polynomial(twice), -END)
    assert not none.zeros
    assert not none.undecided
    _, unknown = zeros_beside_double_one(polynomial([Fraction(0)] * 4), END)
    assert unknown.undecided


def test_each_resonant_value_occurs_once() -> None:
    values = [cos(2 * pi * j / k) for k, j in orders(12)]
    every = {round(cos(2 * pi * j / k), 12) for k in range(1, 13) for j in range(k)}
    assert sorted({round(value, 12) for value in values}) == sorted(every)
    assert len(values) == len(every)
    for (k, j), value in zip(orders(12), values, strict=True):
        assert gcd(k, j) == 1
        assert abs(float(resonant_value(k, j)) - value) < 1e-15
