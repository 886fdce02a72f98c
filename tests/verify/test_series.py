"""Every operation on graded Taylor models encloses the exact result, grade by grade."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpz, fmpz_poly
from support.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    allowed,
    exponents_of_grade,
    is_enclosed,
    known_value,
    number,
    random_arithmetic,
    random_element,
    random_point,
)
from support.within import within

from orbitproof.verify.algebra import Arithmetic, Grading, Series, correct_power

EXPONENTS = [Fraction(-1), Fraction(-1, 2), Fraction(-3, 2), Fraction(-2, 3), Fraction(-3), Fraction(-1, 3)]

_reference_precision = within(lambda: mpmath.workprec(PRECISION))


Scaled = Callable[[Any], Any]
OPERATIONS: dict[str, Callable[[Any, Any, Scaled], Any]] = {
    "sum": lambda a, b, scaled: a + b,
    "difference": lambda a, b, scaled: a - b,
    "product": lambda a, b, scaled: a * b,
    "square": lambda a, b, scaled: a * a,
    "multiple": lambda a, b, scaled: scaled(a),
    "expression": lambda a, b, scaled: (a * b - scaled(b)) * (a + b) - b * b,
}
"""Of two elements, the last with several operations in a row, whose unknown parts are correlated."""


@pytest.mark.parametrize("seed", [*range(40), *(pytest.param(n, marks=pytest.mark.slow) for n in range(40, 240))])
@pytest.mark.parametrize("wide", [False, True])
def test_operations_enclose(wide: bool, seed: int) -> None:
    """Also multiples by tiny factors, whose size in float64 has to be rounded up."""
    source = random.Random(f"{wide} {seed}")
    arithmetic = random_arithmetic(source, wide)
    left, right = random_element(source, arithmetic), random_element(source, arithmetic)
    factor = Fraction(source.randint(-100, 100) or 1, source.randint(1, 50)) * Fraction(10) ** source.randint(-40, 5)
    results = {
        name: operation(left.series, right.series, lambda x: x.scaled(factor)) for name, operation in OPERATIONS.items()
    }
    end, norm = left.series.at_end(), left.series.norm()
    assert all(polynomial.length() <= arithmetic.width + 1 for polynomial in end.coefs)
    for _ in range(8):
        theta, t, point = random_point(source, arithmetic.grading, wide)
        values = left.at(theta, point), right.at(theta, point)
        for name, operation in OPERATIONS.items():
            exact = operation(*values, lambda value: number(factor) * value)
            assert is_enclosed(results[name], exact, theta, t, point), name
        assert is_enclosed(end, left.at(mpmath.mpf(1), point), theta, t, point)
        assert abs(values[0]) <= sum(mpmath.mpf(value) * t**grade for grade, value in enumerate(norm))


@pytest.mark.parametrize("factor", [Fraction(1, 10**25), Fraction(-1, 3 * 2**62), Fraction(2, 3), Fraction(10**30)])
def test_multiples_keep_their_error(factor: Fraction) -> None:
    arithmetic = Arithmetic(Grading((1,), 1), 200, 0, 0)
    element = Series(arithmetic, [fmpz_poly([])] * 2, [1.0, 0.5, 0.25])
    for bound, error in zip(element.scaled(factor).errors, element.errors, strict=True):
        assert Fraction(bound) >= abs(factor) * Fraction(error)


@pytest.mark.parametrize("value", [Fraction(3 * 2**40), Fraction(1), Fraction(2**60, 3), Fraction(-(10**9), 7)])
def test_coarser_units_than_one_enclose(value: Fraction) -> None:
    """A box wider than 1: the unit of grade 1 is 2^20."""
    element = Arithmetic(Grading((1,), 1), 10, -30, 2).polynomial({(1,): value})
    unit = Fraction(2) ** 20
    assert abs(int(element.coefs[1][0]) * unit - value) <= Fraction(element.errors[1])
    assert element.errors[1] <= 1.001 * unit


@pytest.mark.parametrize("exponent", EXPONENTS, ids=str)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("wide", [False, True])
def test_powers_enclose(wide: bool, exponent: Fraction, seed: int) -> None:
    """Reciprocals of negative elements, too."""
    source = random.Random(f"{exponent} {seed} {wide}")
    arithmetic = random_arithmetic(source, wide)
    element = random_element(source, arithmetic, centre=source.uniform(0.5, 3))
    sign = -1 if exponent.denominator == 1 and seed % 2 else 1
    base = element.series.scaled(Fraction(sign))
    approximate = arithmetic.power(base.coefs[0], exponent)
    coefs = [approximate] + [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)
    result = correct_power(Series(arithmetic, coefs, arithmetic.zero_errors()), base, exponent)
    assert result is not None
    for _ in range(8):
        theta, t, point = random_point(source, arithmetic.grading, wide)
        exact = mpmath.power(sign * element.at(theta, point), number(exponent))
        assert is_enclosed(result, exact, theta, t, point)


def constant_pair(value: float, approximation: float, errors: Sequence[float]) -> tuple[Series, Series]:
    """A base with given errors and an exact approximation of its power."""
    arithmetic = Arithmetic(Grading((1,), 1), 60, 0, 2)
    base = arithmetic.constant(Fraction(value)).with_errors(list(errors))
    return base, arithmetic.constant(Fraction(approximation))


def test_any_approximation_is_corrected() -> None:
    """A poor approximation widens the enclosure and nothing else."""
    base, approximate = constant_pair(4.0, 0.45, [0.125, 0.0, 0.0])
    result = correct_power(approximate, base, Fraction(-1, 2))
    assert result is not None
    for value in (3.875, 4.0, 4.125):
        assert abs(mpmath.mpf(value) ** -0.5 - 0.45) <= result.errors[0]


def test_the_other_square_root_is_refused() -> None:
    base, approximate = constant_pair(4.0, -0.5, [0.0, 0.0, 0.0])
    assert correct_power(approximate, base, Fraction(-1, 2)) is None
    base, approximate = constant_pair(4.0, -0.125, [0.0, 0.0, 0.0])
    assert correct_power(approximate, base, Fraction(-3, 2)) is None


@pytest.mark.parametrize("exponent", EXPONENTS, ids=str)
def test_powers_of_elements_that_may_vanish_are_refused(exponent: Fraction) -> None:
    base, approximate = constant_pair(1.0, 1.0, [0.5, 0.5, 0.0])
    assert correct_power(approximate, base, exponent) is None
    base, approximate = constant_pair(1.0, 1.0, [0.0, 0.0, float("nan")])
    assert correct_power(approximate, base, exponent) is None
    base, approximate = constant_pair(1.0, 1.0, [0.0, float("inf"), 0.0])
    assert correct_power(approximate, base, exponent) is None


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("exponent", [each for each in EXPONENTS if each.denominator > 1], ids=str)
def test_fractional_powers_of_negative_elements_are_refused(exponent: Fraction, seed: int) -> None:
    """Roots of odd order too, of which there is a real one: a program is defined at positive bases only (1.4)."""
    source = random.Random(f"{exponent} {seed}")
    arithmetic = random_arithmetic(source)
    positive = random_element(source, arithmetic, centre=source.uniform(0.5, 3)).series
    power = arithmetic.power(positive.coefs[0], exponent)
    rest = [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)
    for sign in (1, -1):
        approximate = Series(arithmetic, [sign * power, *rest], arithmetic.zero_errors())
        assert correct_power(approximate, positive.scaled(Fraction(-1)), exponent) is None
        assert (correct_power(approximate, positive, exponent) is None) == (sign < 0)


@pytest.mark.parametrize("seed", range(30))
def test_constants_and_polynomials_enclose(seed: int) -> None:
    """Monomials above the top grade are charged to the last slot."""
    source = random.Random(seed)
    arithmetic = random_arithmetic(source)
    grading = arithmetic.grading
    monomials = [e for grade in range(grading.top + 4) for e in exponents_of_grade(grading, grade)]
    coefficients = {
        exponents: Fraction(source.randint(-(10**9), 10**9), 3 ** source.randint(0, 20))
        * Fraction(10) ** source.randint(-400, 0)
        for exponents in source.sample(monomials, min(5, len(monomials)))
    }
    result = arithmetic.polynomial(coefficients)
    constant = Fraction(source.randint(-(10**6), 10**6), 7 * 10**5)
    for _ in range(12):
        theta, t, point = random_point(source, grading)
        exact = mpmath.mpc(0)
        for exponents, value in coefficients.items():
            term = number(value)
            for base, exponent in zip(point, exponents, strict=True):
                term = term * base**exponent
            exact += term
        assert is_enclosed(result, exact, theta, t, point)
        assert is_enclosed(arithmetic.constant(constant), number(constant), theta, t, point)


@pytest.mark.parametrize("length", [1, 7, 8, 9, 30])
def test_sizes_bound_sums_of_coefficients(length: int) -> None:
    source = random.Random(length)
    arithmetic = Arithmetic(Grading((1,), 1), 50, 10, 40)
    for _ in range(50):
        values = [source.randint(-(2**60), 2**60) >> source.randint(0, 59) for _ in range(length)]
        size = arithmetic.size(fmpz_poly(values), 70)
        assert Fraction(size) >= Fraction(sum(map(abs, values)), 2**70)


def test_the_error_of_a_product_is_attained() -> None:
    """With all signs alike the bound is the exact distance: smaller errors would fail the tests above."""
    arithmetic = Arithmetic(Grading((1, 2), 2), 60, 0, 3)
    one = int(arithmetic.one)
    coefs = [fmpz_poly([one >> 1, one >> 2]) if i < 3 else fmpz_poly([]) for i in range(len(arithmetic.scales))]
    unknown = tuple(Unknown(2.0**-20, exponents_of_grade(arithmetic.grading, grade)[0], 0) for grade in range(4))
    element = Element(Series(arithmetic, coefs, [2.0**-20] * 4), unknown)
    result = element.series * element.series
    theta, point = mpmath.mpf(1), [mpmath.mpf(1), mpmath.mpf(1)]
    distance = abs(element.at(theta, point) ** 2 - known_value(result, theta, point))
    assert distance <= allowed(result, mpmath.mpf(1)) <= distance * (1 + mpmath.mpf(2) ** -30)


def test_shifts_and_sizes_of_polynomials_are_those_of_the_format() -> None:
    """What the format relies on: right_shift divides by a power of theta, height_bits is that of the largest."""
    polynomial = fmpz_poly([5, -5, 7, -9])
    assert polynomial.right_shift(2) == fmpz_poly([7, -9])
    assert polynomial.height_bits() == 4


def test_division_of_polynomials_changes_coefficients_by_less_than_one_unit() -> None:
    """Section 2.2: in either direction, because a coefficient smaller than the divisor becomes 0, not -1."""
    source = random.Random("division")
    down = up = 0
    for _ in range(2000):
        divisor = source.choice([2**80, 3, 10**30, source.getrandbits(source.randrange(2, 200)) | 1])
        given = [source.randrange(-(2**bits), 2**bits) for bits in source.choices([2, 8, 60, 64, 100, 300], k=5)]
        quotients = (fmpz_poly(given) // fmpz(divisor)).coeffs() + [fmpz(0)] * 5
        for value, quotient in zip(given, quotients, strict=False):
            left = value - int(quotient) * divisor
            assert abs(left) < divisor
            down, up = down + (left > 0), up + (left < 0)
    assert down > 0
    assert up > 0


@pytest.mark.parametrize("value", [-1, 1, -(2**100) - 1, 2**100 - 1])
def test_rounding_of_products_is_accounted_for_in_both_directions(value: int) -> None:
    arithmetic = Arithmetic(Grading((1,), 1), 100, 0, 3)
    rounded, lost = arithmetic.round_product(fmpz_poly([value] * 4), 0)
    change = sum(abs(Fraction(value, 2**100) - int(rounded[n])) for n in range(4)) / 2**100
    assert 0 < change <= Fraction(lost)


def test_bits_that_are_cut_from_factors_are_accounted_for() -> None:
    """Section 2.2: factors of very unequal size, with all cut bits set, so that the changes add up."""
    source = random.Random("cuts")
    arithmetic = Arithmetic(Grading((1,), 1), 200, 0, 5)
    shares = []
    for _ in range(1000):
        sizes = source.choices([2, 60, 120, 195, 200], k=2)
        left, right = ([(2**size - 1) * source.choice([1, 1, -1])] * 3 for size in sizes)
        value, lost = arithmetic.product_slice([fmpz_poly(left)], [fmpz_poly(right)], 0)
        exact = fmpz_poly(left) * fmpz_poly(right)
        rounded, allowed_by_rounding = arithmetic.round_product(exact, 0)
        change = sum(abs(Fraction(int(exact[n]), 2**200) - int(value[n])) for n in range(6)) / 2**200
        assert change <= Fraction(lost)
        shares.append((value != rounded, lost > 1.01 * allowed_by_rounding))
    assert all(cut for changed, cut in shares if changed)
    assert 100 < sum(cut for _, cut in shares) < 900


def test_a_cut_changes_a_product_by_at_most_a_sixteenth_of_its_rounding() -> None:
    source = random.Random("a cut")
    arithmetic = Arithmetic(Grading((1,), 1), 200, 0, 30)
    largest = Fraction(0)
    for _ in range(1000):
        other = fmpz_poly([source.randrange(2**60) for _ in range(31)])
        factor = fmpz_poly([source.randrange(2**200) | (2**120 - 1) for _ in range(31)])
        product, cuts = arithmetic._product(other, factor)
        change = sum(abs(int(c)) for c in (other * factor - product).coeffs())
        largest = max(largest, Fraction(change, 31 * 2**200))
        assert cuts == 1
    assert Fraction(1, 1000) < largest <= Fraction(1, 16)


def test_an_element_that_is_widened_twice_has_both_sizes_for_its_error() -> None:
    element = Arithmetic(Grading((1,), 1), 60, 0, 2).constant(Fraction(1))
    assert element.widened(Fraction(1, 4)).widened(Fraction(1, 3)).errors[0] >= Fraction(7, 12)
