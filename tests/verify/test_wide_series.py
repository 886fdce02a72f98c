"""Graded Taylor models with a wide variable: every operation encloses the exact result, grade by grade."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, fmpz_poly
from support.exact_elements import (
    PRECISION,
    Element,
    Unknown,
    allowed,
    exponents_of_grade,
    is_enclosed,
    known_value,
    number,
    packed_from,
    random_element,
    rows_of,
)
from support.wide_elements import POINTS, points, shrunk, values_of, wide_arithmetic
from support.within import within

from orbitproof.shared.systems import SYSTEMS
from orbitproof.verify.algebra import Arithmetic, Grading, Series, WideArithmetic, correct_power, evaluate, prepare

_reference_precision = within(lambda: mpmath.workprec(PRECISION))


def check(
    source: random.Random, arithmetic: Arithmetic, result: Series, exact: Callable[[Any, Any], Any], count: int = POINTS
) -> None:
    for theta, t, point in points(source, arithmetic, count):
        assert is_enclosed(result, exact(theta, point), theta, t, point)


@pytest.mark.parametrize("seed", range(20))
def test_a_product_of_packed_polynomials_is_cut_to_what_is_kept(seed: int) -> None:
    """Against products of single terms: each is kept at its place or counted, with its absolute value, as lost."""
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((1,), 1), 40, 0, source.choice((0, 1, 4)), width=source.choice((1, 2, 5)))
    size = range(arithmetic.degree + 1), range(arithmetic.width + 1)
    left, right = ([[source.randint(-99, 99) for _ in size[1]] for _ in size[0]] for _ in range(2))
    terms: dict[tuple[int, int], int] = {}
    for (n, i), (m, j) in product(product(*size), product(*size)):
        terms[n + m, i + j] = terms.get((n + m, i + j), 0) + left[n][i] * right[m][j]
    kept, beyond = arithmetic.cut(packed_from(arithmetic, left) * packed_from(arithmetic, right))
    found = rows_of(arithmetic, kept)
    for n, j in product(*size):
        assert (found[n][j] if n < len(found) else 0) == terms[n, j]
    assert beyond == sum(abs(c) for (n, j), c in terms.items() if n > arithmetic.degree or j > arithmetic.width)


@pytest.mark.parametrize("seed", range(20))
def test_what_a_product_lacks_and_what_runs_into_wrong_powers_is_counted(seed: int) -> None:
    """Against products of single terms, with powers of s so high that they run into the next power of theta."""
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((1,), 1), 8, 0, source.choice((0, 1, 3)), width=source.choice((10, 14, 20)))
    assert arithmetic.stride < 2 * arithmetic.width + 1
    rows, powers = arithmetic.degree + 1, arithmetic.width + 1
    left, right = ([[source.randint(-999, 999) for _ in range(powers)] for _ in range(rows)] for _ in range(2))
    exact: dict[tuple[int, int], Fraction] = {}
    for (n, i), (m, j) in product(product(range(rows), range(powers)), repeat=2):
        place = n + m, i + j
        exact[place] = exact.get(place, Fraction(0)) + Fraction(left[n][i] * right[m][j], 2**16)
    factors = [[packed_from(arithmetic, table), fmpz_poly([])] for table in (left, right)]
    value, lost = arithmetic.product_slice(*factors, 0)
    kept = {(n, j): Fraction(c, 2**8) for n, row in enumerate(rows_of(arithmetic, value)) for j, c in enumerate(row)}
    places = set(exact) | set(kept)
    missing = sum(abs(exact.get(place, Fraction(0)) - kept.get(place, Fraction(0))) for place in places)
    assert missing <= Fraction(lost)
    # Some of it is nowhere in the packed product, or in a wrong place: without its bound the rest would not do.
    stride = arithmetic.stride
    elsewhere = sum(abs(c) for (n, j), c in exact.items() if n > arithmetic.degree or j >= stride)
    assert Fraction(lost) - missing < 40 * elsewhere


def test_what_runs_into_a_wrong_power_is_missing_in_one_place_and_too_much_in_another() -> None:
    """The square of a single term, as large as its bound: s^28 is found at theta s^5 instead."""
    arithmetic = WideArithmetic(Grading((1,), 1), 8, 0, 1, width=14)
    assert arithmetic.stride == 23
    largest = 2**40 - 1
    factor = [fmpz_poly([0] * 14 + [largest]), fmpz_poly([])]
    value, lost = arithmetic.product_slice(factor, factor, 0)
    assert [index for index, c in enumerate(value.coeffs()) if c] == [28]
    assert Fraction(lost) >= Fraction(2 * largest**2, 2**16) - Fraction(1, 2**8)


@pytest.mark.parametrize("seed", range(10))
def test_a_product_is_enclosed_where_the_highest_powers_matter(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 2, width=source.choice((12, 16)))
    one = int(arithmetic.one)

    def factor() -> Series:
        row = [[source.randint(-one, one) for _ in range(arithmetic.width + 1)] for _ in range(3)]
        return Series(arithmetic, [packed_from(arithmetic, row), fmpz_poly([])], arithmetic.zero_errors())

    left, right = factor(), factor()
    result = left * right
    for s, theta in product((Fraction(-1), Fraction(3, 7), Fraction(1)), (Fraction(0), Fraction(2, 3), Fraction(1))):
        values = [_value(arithmetic, element, s, theta) for element in (left, right, result)]
        assert abs(values[0] * values[1] - values[2]) <= Fraction(result.errors[0])


def _value(arithmetic: WideArithmetic, element: Series, s: Fraction, theta: Fraction) -> Fraction:
    rows = rows_of(arithmetic, element.coefs[0])
    terms = (
        Fraction(c, int(arithmetic.one)) * theta**n * s**j for n, row in enumerate(rows) for j, c in enumerate(row)
    )
    return sum(terms, Fraction(0))


@pytest.mark.parametrize("seed", range(10))
def test_derivatives_in_time_are_exact(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    slopes = [arithmetic.derivative(p) for p in element.series.coefs]
    for polynomial, slope in zip(element.series.coefs, slopes, strict=True):
        rows = rows_of(arithmetic, polynomial)
        expected = [[n * c for c in row] for n, row in enumerate(rows)][1:]
        assert slope == packed_from(arithmetic, expected)


@pytest.mark.parametrize("seed", range(10))
def test_sizes_bound_the_norm(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    for polynomial, scale in zip(random_element(source, arithmetic).series.coefs, arithmetic.scales, strict=True):
        norm = Fraction(sum(abs(int(c)) for c in polynomial.coeffs()), 2**scale)
        assert (
            norm
            <= Fraction(arithmetic.size(polynomial, scale))
            <= norm * (1 + Fraction(1, 2**39)) + Fraction(1, 2**900)
        )


@pytest.mark.parametrize("seed", range(5))
def test_floats_and_packed_polynomials_correspond(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((), 0), 45, 0, 6, width=4)
    values = np.array([[source.uniform(-2, 2) for _ in range(5)] for _ in range(7)])
    packed = arithmetic.pack(values, 45)
    assert np.abs(arithmetic.unpack(packed, 45, 7) - values).max() <= 2.0**-45
    assert [len(row) for row in rows_of(arithmetic, packed)] == [5] * 7


@pytest.mark.parametrize("seed", range(4))
def test_programs_enclose(seed: int) -> None:
    """All operations together, with higher grades found monomial by monomial; s also in a coefficient."""
    source = random.Random(seed)
    system = SYSTEMS["cr3bp"]
    arithmetic = WideArithmetic(Grading((1, 1), 1), source.choice((48, 80)), 12, 5, width=source.choice((3, 8)))
    centres = [0.8, 0.3, 0.4, 0.2, 0.3, 0.1, 0.2]
    elements = [random_element(source, arithmetic, centre=value) for value in centres]
    small = [shrunk(x, 0.05) for x in elements]
    for index, result in enumerate(evaluate(prepare(system.program), [x.series for x in small])):
        check(
            source, arithmetic, result, lambda theta, x, index=index: field(system.program, small, theta, x)[index], 3
        )


def field(program: Any, elements: list[Element], theta: Any, point: Any) -> Any:
    return values_of(program, [x.at(theta, point) for x in elements])


def test_powers_with_a_wide_variable_are_sharp() -> None:
    """1 / (2 + s/4 + theta/4): what is beyond the kept degrees, and not more, is unknown."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 16, width=16)
    one = int(arithmetic.one)
    base = Series(arithmetic, [packed_from(arithmetic, [[2 * one, one // 4], [one // 4, 0]]), fmpz_poly([])], [0.0] * 3)
    approximate = arithmetic.power(base.coefs[0], Fraction(-1))
    from_nearby = arithmetic.power(base.coefs[0], Fraction(-1), approximate + fmpz_poly([1 << 30, -(1 << 29)]))
    result = correct_power(Series(arithmetic, [approximate, fmpz_poly([])], [0.0] * 3), base, Fraction(-1))
    assert result is not None
    assert result.errors[0] < 20 * 4.0**-17
    assert Fraction(sum(abs(int(c)) for c in (approximate - from_nearby).coeffs()), one) < Fraction(1, 2**40)


def test_the_other_square_root_is_refused() -> None:
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 2, width=2)
    base = arithmetic.polynomial({(0,): [Fraction(4), Fraction(1, 2**20)]})
    for value, accepted in ((Fraction(1, 2), True), (Fraction(-1, 2), False)):
        assert (correct_power(arithmetic.constant(value), base, Fraction(-1, 2)) is not None) == accepted


def test_powers_of_elements_that_may_vanish_are_refused() -> None:
    """1 + s vanishes at s = -1."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 2, width=8)
    base = arithmetic.polynomial({(0,): [Fraction(1), Fraction(1)]})
    approximate = arithmetic.polynomial({(0,): [Fraction((-1) ** n) for n in range(9)]})
    assert correct_power(approximate, base, Fraction(-1)) is None


@pytest.mark.parametrize("seed", range(30))
def test_polynomials_in_the_wide_variable_enclose(seed: int) -> None:
    """Monomials above the top grade are charged to the last slot, powers of s beyond the width to their grade."""
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    grading = arithmetic.grading
    monomials = [e for grade in range(grading.top + 3) for e in exponents_of_grade(grading, grade)]
    coefficients: dict[tuple[int, ...], Fraction | list[Fraction]] = {}
    for exponents in source.sample(monomials, min(5, len(monomials))):
        values = [
            Fraction(source.randint(-(10**9), 10**9), 3 ** source.randint(0, 20))
            * Fraction(10) ** source.choice((0, 0, -3, -400))
            for _ in range(source.randint(1, arithmetic.width + 4))
        ]
        coefficients[exponents] = values[0] if source.random() < 0.2 else values
    result = arithmetic.polynomial(coefficients)

    def exact(theta: Any, point: Any) -> Any:
        *xi, s = point
        total = mpmath.mpc(0)
        for exponents, given in coefficients.items():
            values = [given] if isinstance(given, Fraction) else given
            term = sum(number(value) * s**power for power, value in enumerate(values))
            for base, exponent in zip(xi, exponents, strict=True):
                term = term * base**exponent
            total += term
        return total

    check(source, arithmetic, result, exact)


def test_the_error_of_a_product_is_attained() -> None:
    """With all signs alike the bound is the exact distance: smaller errors would fail the tests above."""
    arithmetic = WideArithmetic(Grading((1, 2), 2), 60, 0, 3, width=2)
    one = int(arithmetic.one)
    half = packed_from(arithmetic, [[one >> 1, one >> 3, one >> 2], [one >> 2, one >> 4, one >> 3]])
    coefs = [half if i < 3 else fmpz_poly([]) for i in range(len(arithmetic.scales))]
    unknown = tuple(Unknown(2.0**-20, (*exponents_of_grade(arithmetic.grading, grade)[0], 7), 0) for grade in range(4))
    element = Element(Series(arithmetic, coefs, [2.0**-20] * 4), unknown)
    result = element.series * element.series
    theta, point = mpmath.mpf(1), [mpmath.mpf(1)] * 3
    distance = abs(element.at(theta, point) ** 2 - known_value(result, theta, point))
    assert distance <= allowed(result, mpmath.mpf(1)) <= distance * (1 + mpmath.mpf(2) ** -30)


@pytest.mark.parametrize("place", [(3, 0), (0, 4)], ids=["time", "wide variable"])
def test_what_a_product_lacks_counts_where_a_factor_underflows(place: tuple[int, int]) -> None:
    """2^-1500 times 2^900, of which nothing is kept: the first is 0 in a double, the product is 2^-600."""
    arithmetic = WideArithmetic(Grading((1,), 1), 1500, 0, 3, width=4)
    row, power = place
    highest = fmpz_poly([0] * (row * arithmetic.stride + power) + [1])
    factors = [[fmpz_poly([0] * (3 * arithmetic.stride + 4) + [c]), fmpz_poly([])] for c in (1, 2**2400)]
    value, lost = arithmetic.product_slice(*factors, 0)
    assert not value.length()
    assert Fraction(lost) >= Fraction(1, 2**600)
    # Both of them too small: less than any double, and not nothing.
    _, lost = arithmetic.product_slice([highest, fmpz_poly([])], factors[0], 0)
    assert lost > 0


def test_what_rounding_changes_counts() -> None:
    """The product of one unit and of almost 1 is rounded to nothing."""
    arithmetic = WideArithmetic(Grading((1,), 1), 30, 0, 3, width=4)
    one = int(arithmetic.one)
    value, lost = arithmetic.product_slice(*([fmpz_poly([c]), fmpz_poly([])] for c in (1, one - 1)), 0)
    assert not value.length()
    assert Fraction(lost) >= Fraction(one - 1, one * one)


def test_sizes_of_numbers_larger_than_all_floats_bound_them() -> None:
    arithmetic = WideArithmetic(Grading((1,), 1), 1500, 0, 3, width=4)
    norm = 3 * 2**1600 + 5
    assert norm <= Fraction(arithmetic.size(fmpz_poly([3 * 2**1600, 0, -5]), 1500)) * 2**1500 <= 2 * norm


def test_values_at_the_end_hold_all_powers_of_the_wide_variable() -> None:
    """Also those that no operation leaves there: what follows refuses them, and nothing is dropped in silence."""
    arithmetic = WideArithmetic(Grading((1,), 1), 30, 0, 3, width=4)
    stray = packed_from(arithmetic, [[1, 0, 0, 0, 2, 3, 0], [0, 0, 0, 0, 0, 4, 5]])
    assert arithmetic.at_end(stray) == fmpz_poly([1, 0, 0, 0, 2, 7, 5])
    assert sum(arithmetic.balls_in_time(stray, None), arb(0)).contains(21 / arb(2) ** 30)
