"""Graded Taylor models with a wide variable: every operation encloses the exact result, grade by grade."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise, product
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
    random_arithmetic,
    random_element,
    random_point,
    rows_of,
)

from orbitproof.shared.systems.libration import AROUND
from orbitproof.shared.systems.system import SYSTEMS
from orbitproof.verify.algebra.grading import Grading
from orbitproof.verify.algebra.programs import evaluate, prepare
from orbitproof.verify.algebra.series import Arithmetic, Series, correct_power
from orbitproof.verify.algebra.wide import WideArithmetic
from orbitproof.verify.flow.gronwall import (
    PARTS,
    centre_and_norms,
    comparison_matrices,
    derivative_bounds,
    norm_arithmetic,
)
from orbitproof.verify.poincare.crossing import range_of, stays_positive, wide_parts

EXPONENTS = [Fraction(-1), Fraction(-1, 2), Fraction(-3, 2), Fraction(-2, 3), Fraction(-3)]
POINTS = 6


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(PRECISION):
        yield


def wide_arithmetic(source: random.Random) -> Arithmetic:
    return random_arithmetic(source, wide=True)


def points(source: random.Random, arithmetic: Arithmetic, count: int = POINTS) -> list[tuple[Any, Any, Any]]:
    return [random_point(source, arithmetic.grading, wide=True) for _ in range(count)]


def check(
    source: random.Random, arithmetic: Arithmetic, result: Series, exact: Callable[[Any, Any], Any], count: int = POINTS
) -> None:
    for theta, t, point in points(source, arithmetic, count):
        assert is_enclosed(result, exact(theta, point), theta, t, point)


# Packed polynomials


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
            <= norm * (1 + Fraction(1, 2**40)) + Fraction(1, 2**900)
        )


@pytest.mark.parametrize("seed", range(5))
def test_floats_and_packed_polynomials_correspond(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = WideArithmetic(Grading((), 0), 45, 0, 6, width=4)
    values = np.array([[source.uniform(-2, 2) for _ in range(5)] for _ in range(7)])
    packed = arithmetic.pack(values, 45)
    assert np.abs(arithmetic.unpack(packed, 45, 7) - values).max() <= 2.0**-45
    assert [len(row) for row in rows_of(arithmetic, packed)] == [5] * 7


# Operations


BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: a - b,
    "product": lambda a, b: a * b,
}


@pytest.mark.parametrize("name", BINARY)
@pytest.mark.parametrize("seed", range(16))
def test_binary_operations_enclose(name: str, seed: int) -> None:
    source = random.Random(f"{name} {seed}")
    arithmetic = wide_arithmetic(source)
    left, right = random_element(source, arithmetic), random_element(source, arithmetic)
    result = BINARY[name](left.series, right.series)
    check(source, arithmetic, result, lambda theta, x: BINARY[name](left.at(theta, x), right.at(theta, x)))


@pytest.mark.parametrize("seed", range(15))
def test_squares_enclose(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    check(source, arithmetic, element.series * element.series, lambda theta, x: element.at(theta, x) ** 2)


@pytest.mark.parametrize("seed", range(20))
def test_multiples_enclose(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    factor = Fraction(source.randint(-100, 100) or 1, source.randint(1, 50)) * Fraction(10) ** source.randint(-40, 5)
    check(source, arithmetic, element.series.scaled(factor), lambda theta, x: number(factor) * element.at(theta, x))


@pytest.mark.parametrize("seed", range(15))
def test_the_value_at_the_end_encloses(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    result = element.series.at_end()
    assert all(polynomial.length() <= arithmetic.width + 1 for polynomial in result.coefs)
    for theta, t, point in points(source, arithmetic):
        assert is_enclosed(result, element.at(mpmath.mpf(1), point), theta, t, point)


@pytest.mark.parametrize("exponent", EXPONENTS, ids=str)
@pytest.mark.parametrize("seed", range(5))
def test_powers_enclose(exponent: Fraction, seed: int) -> None:
    source = random.Random(f"{exponent} {seed}")
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic, centre=source.uniform(0.5, 3))
    approximate, _ = arithmetic.power(element.series.coefs[0], exponent)
    coefs = [approximate] + [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)
    result = correct_power(Series(arithmetic, coefs, arithmetic.zero_errors()), element.series, exponent)
    assert result is not None
    check(source, arithmetic, result, lambda theta, x: mpmath.power(element.at(theta, x), number(exponent)))


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


def shrunk(element: Element, factor: float) -> Element:
    """The same element with a smaller unknown part."""
    unknown = tuple(Unknown(factor * u.size, u.exponents, u.shape) for u in element.unknown)
    return Element(element.series.with_errors([factor * e for e in element.series.errors]), unknown)


def field(program: Any, elements: list[Element], theta: Any, point: Any) -> Any:
    return values_of(program, [x.at(theta, point) for x in elements])


def values_of(program: Any, arguments: list[Any]) -> Any:
    return program.evaluate(arguments, number, lambda base, e: mpmath.power(base, number(e)))


def test_powers_with_a_wide_variable_are_sharp() -> None:
    """1 / (2 + s/4 + theta/4): what is beyond the kept degrees, and not more, is unknown."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 16, width=16)
    one = int(arithmetic.one)
    base = Series(arithmetic, [packed_from(arithmetic, [[2 * one, one // 4], [one // 4, 0]]), fmpz_poly([])], [0.0] * 3)
    approximate, inverse = arithmetic.power(base.coefs[0], Fraction(-1))
    result = correct_power(Series(arithmetic, [approximate, fmpz_poly([])], [0.0] * 3), base, Fraction(-1))
    assert result is not None
    assert result.errors[0] < 20 * 4.0**-17
    assert Fraction(sum(abs(int(c)) for c in (approximate - inverse).coeffs()), one) < Fraction(1, 2**40)


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


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(400))
def test_random_expressions_enclose(seed: int) -> None:
    """Several operations in a row, whose unknown parts are correlated."""
    source = random.Random(f"expression {seed}")
    arithmetic = wide_arithmetic(source)
    first, second = (random_element(source, arithmetic, centre=source.uniform(0.5, 2)) for _ in range(2))
    third = random_element(source, arithmetic)
    factor = Fraction(source.randint(-9, 9) or 1, source.randint(1, 9))

    def expression(a: Any, b: Any, c: Any, scale: Callable[[Any], Any]) -> Any:
        return (a * b - scale(c)) * (a + c) - b * b

    def exact(theta: Any, x: Any) -> Any:
        values = (element.at(theta, x) for element in (first, second, third))
        return expression(*values, lambda value: number(factor) * value)

    result = expression(first.series, second.series, third.series, lambda x: x.scaled(factor))
    check(source, arithmetic, result, exact, 12)


# Norms


def moved(source: random.Random, element: Element, tube: list[float]) -> Element:
    """An exact element within `tube` of a given one."""
    arithmetic = element.series.arithmetic
    grading = arithmetic.grading
    extra = []
    for slot, size in enumerate(tube):
        grades = [slot] if slot <= grading.top else range(grading.top + 1, grading.top + 3)
        monomials = [exponents for grade in grades for exponents in exponents_of_grade(grading, grade)]
        if monomials:
            exponents = (*source.choice(monomials), source.choice((0, 1, 2 * arithmetic.width + 9)))
            extra.append(Unknown(size, exponents, source.randrange(3)))
    return Element(element.series, (*element.unknown, *extra))


@pytest.mark.parametrize("seed", range(20))
def test_the_tube_holds_every_element_near_the_solution(seed: int) -> None:
    """Also where degrees and precision of the norm computation are below those of the solution."""
    source = random.Random(seed)
    fine = wide_arithmetic(source)
    if seed % 2:
        fine = WideArithmetic(fine.grading, 150, fine.grade_bits, 28, width=source.choice((5, 12)))
    element = random_element(source, fine)
    tube = [10.0 ** source.uniform(-20, -1) for _ in element.series.errors]
    neighbour = moved(source, element, tube)
    coarse = norm_arithmetic(fine)
    assert 0 < coarse.width <= fine.width
    result = centre_and_norms(coarse, element.series, tube)
    for theta, t, point in points(source, fine):
        assert is_enclosed(result, neighbour.at(theta, point), theta, t, point[-1:])


@pytest.mark.parametrize("seed", range(3))
def test_the_rounding_of_the_norm_computation_counts(seed: int) -> None:
    """An exact element of 150 bits, all of whose powers are kept."""
    source = random.Random(seed)
    fine = WideArithmetic(Grading((1,), 1), 150, 0, 3, width=2)
    rows = [[source.randint(-(2**150), 2**150) for _ in range(3)] for _ in range(4)]
    element = Series(fine, [packed_from(fine, rows), fmpz_poly([])], [0.0] * 3)
    result = centre_and_norms(norm_arithmetic(fine), element, [0.0] * 3)
    for theta, t, point in points(source, fine):
        assert is_enclosed(result, known_value(element, theta, point), theta, t, point[-1:])


@pytest.mark.parametrize("name", ["falkner-skan", "cr3bp", "cr3bp-l1"])
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_derivatives_of_the_field_are_bounded_on_the_tube(name: str, seed: int) -> None:
    """Partial derivatives by central differences, and the values of the field."""
    source = random.Random(f"{name} {seed}")
    system = {**SYSTEMS, "cr3bp-l1": AROUND["L1"]}[name]
    size = len(system.state)
    fine = WideArithmetic(Grading((1, 1), 1), 80, 5, 6, width=source.choice((3, 10)))
    centres = [source.uniform(0.3, 0.6) for _ in range(size + len(system.parameters))]
    if name == "cr3bp-l1":
        centres[size:] = [0.3, 0.2, 0.02]
    small = [shrunk(random_element(source, fine, centre=value), 0.02) for value in centres]
    tube = [1e-5, 1e-6, 1e-7]
    neighbours = [moved(source, x, tube) for x in small]
    coarse = norm_arithmetic(fine)
    inputs = [centre_and_norms(coarse, x.series, tube) for x in small]
    derivatives, slopes = derivative_bounds(prepare(system.program), size, inputs)
    shift = mpmath.mpf(2) ** -150
    for theta, t, point in points(source, fine, 2):
        s = point[-1:]
        values = [x.at(theta, point) for x in neighbours]
        for slope, value in zip(slopes, values_of(system.program, values), strict=True):
            assert is_enclosed(slope, value, theta, t, s)
        for j in range(size):
            ahead, behind = ([v + sign * shift * (i == j) for i, v in enumerate(values)] for sign in (1, -1))
            pairs = zip(values_of(system.program, ahead), values_of(system.program, behind), strict=True)
            for i, (high, low) in enumerate(pairs):
                partial = (high - low) / (2 * shift)
                if j in derivatives[i]:
                    slack = derivatives[i][j].with_errors([e + 1e-60 for e in derivatives[i][j].errors])
                    assert is_enclosed(slack, partial, theta, t, s)
                else:
                    assert partial == 0


@pytest.mark.parametrize("seed", range(12))
def test_the_comparison_matrix_bounds_products_on_each_part(seed: int) -> None:
    """For all s on the unit circle, with random elements that belong to the derivatives."""
    source = random.Random(seed)
    coarse = WideArithmetic(Grading((), 1), 96, 0, source.choice((4, 24)), width=source.choice((1, 8)))
    rows = [[int(source.uniform(-1, 1) * 2.0**96) for _ in range(coarse.width + 1)] for _ in range(coarse.degree + 1)]
    derivative = Series(coarse, [packed_from(coarse, rows)], [source.random(), source.random(), source.random()])
    error = np.array([10.0 ** source.uniform(-9, 0) for _ in range(3)])
    for part, matrix in enumerate(comparison_matrices([{0: derivative}], 3)):
        for _ in range(4):
            theta = (part + mpmath.mpf(source.choice((0, 1, source.random())))) / PARTS
            s = mpmath.expjpi(source.choice((0, 1, 2 * source.random())))
            value = abs(known_value(derivative, theta, [s]))
            norm = [value + derivative.errors[0], *map(mpmath.mpf, derivative.errors[1:])]
            wanted = [mpmath.mpf(0)] * 3
            for i, bound in enumerate(norm):
                for j in range(3):
                    wanted[min(i + j, 2)] += bound * float(error[j])
            assert all(found >= least for found, least in zip(matrix @ error, wanted, strict=True))


def test_a_polynomial_in_s_is_bounded_by_the_sum_of_its_coefficients() -> None:
    """1 + s - s^2 has the norm 3 on the unit circle's algebra, not its largest value."""
    coarse = WideArithmetic(Grading((), 0), 96, 0, 4, width=2)
    one = int(coarse.one)
    derivative = Series(coarse, [packed_from(coarse, [[one, one, -one]])], [0.0, 0.0])
    for matrix in comparison_matrices([{0: derivative}], 2):
        assert np.allclose(matrix, [[3, 0], [0, 3]], rtol=1e-8, atol=1e-200)


# Real points


@pytest.mark.parametrize("seed", range(15))
def test_ranges_hold_all_real_values(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = wide_arithmetic(source)
    element = random_element(source, arithmetic)
    result = element.series.at_end()
    parts = wide_parts(8)
    for _ in range(POINTS):
        _, _, point = random_point(source, arithmetic.grading, wide=True)
        index = source.randrange(8)
        s = Fraction(2 * index - 8 + source.choice((0, 1, 2)), 8)
        xi = [source.choice((-1, 1, Fraction(source.randint(-64, 64), 64))) for _ in point[:-1]]
        exact = element.at(mpmath.mpf(1), [*(number(Fraction(x)) for x in xi), number(s)]).real
        for part in (None, parts[index]):
            ball = range_of(result, part)
            assert abs(exact - mpf_of(ball.mid())) <= mpf_of(ball.rad()) + mpmath.mpf(2) ** -400


def mpf_of(value: arb) -> mpmath.mpf:
    mantissa, exponent = value.mid().man_exp()
    return mpmath.ldexp(int(mantissa), int(exponent))


def test_signs_depend_on_the_part_of_the_wide_interval() -> None:
    """s + 1/2 + theta/4 is positive for s > -1/2 only."""
    arithmetic = WideArithmetic(Grading((1,), 1), 60, 0, 3, width=2)
    one = int(arithmetic.one)
    series = Series(
        arithmetic, [packed_from(arithmetic, [[one // 2, one, 0], [one // 4, 0, 0]]), fmpz_poly([])], [2.0**-50] * 3
    )
    signs = [stays_positive(series, part) for part in wide_parts(8)]
    # The third part, [-1/2, -1/4], touches -1/2.
    assert signs == [False] * 3 + [True] * 5
    assert not stays_positive(series)
    assert not stays_positive(series.with_errors([0.5, 0.2, 0.0]), wide_parts(8)[4])
    assert stays_positive(series.with_errors([0.1, 0.1, 0.1]), wide_parts(8)[4])


def test_parts_cover_the_wide_interval() -> None:
    parts = wide_parts(8)
    assert (parts[0].lower() <= -1) is True
    assert (parts[-1].upper() >= 1) is True
    assert all(a.overlaps(b) for a, b in pairwise(parts))
