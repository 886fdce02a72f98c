"""Every operation on graded Taylor models encloses the exact result, grade by grade.

The exact elements are known parts plus explicit unknown parts, whose monomials lie in their grade and whose
l1 norm is the error bound of that grade. They are evaluated with 600 bits at complex points of the polydisc with
|xi_i| = t^(weight of i): there an unknown part of grade g is at most e_g t^g, so that a small t shows whether an
error is charged to the right grade.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from flint import fmpz, fmpz_poly

from verify.algebra import Arithmetic, Series, correct_power
from verify.evaluation import approximate_power
from verify.grading import Exponents, Grading

PRECISION = 600
GRADINGS = (
    Grading((1, 1, 2), 2),
    Grading((2, 1, 2), 3),
    Grading((1, 1), 3),
    Grading((1,), 1),
    Grading((3, 1), 2),
    Grading((1, 2), 0),
)
EXPONENTS = [Fraction(-1), Fraction(-1, 2), Fraction(-3, 2), Fraction(-2, 3), Fraction(-3), Fraction(-1, 3)]


@pytest.fixture(autouse=True)
def _reference_precision() -> Iterator[None]:
    with mpmath.workprec(PRECISION):
        yield


def number(value: Fraction) -> mpmath.mpf:
    """A fraction as an mpmath number."""
    return mpmath.mpf(value.numerator) / value.denominator


@dataclass(frozen=True)
class Unknown:
    """One term of the unknown part: size * sign(theta) * xi^exponents, with |sign(theta)| <= 1 on [0, 1]."""

    size: float
    exponents: Exponents
    shape: int

    def at(self, theta: mpmath.mpf, point: Sequence[Any]) -> Any:
        """Its value."""
        shape = (mpmath.mpf(1), mpmath.mpf(-1), 1 - 2 * theta, theta**3)[self.shape]
        result = shape * mpmath.mpf(self.size)
        for base, exponent in zip(point, self.exponents, strict=True):
            result *= base**exponent
        return result


@dataclass(frozen=True)
class Element:
    """An exact function of theta and xi together with its enclosure."""

    series: Series
    unknown: tuple[Unknown, ...]

    def at(self, theta: mpmath.mpf, point: Sequence[Any]) -> Any:
        """The exact value."""
        return known_value(self.series, theta, point) + sum(term.at(theta, point) for term in self.unknown)


def known_value(series: Series, theta: mpmath.mpf, point: Sequence[Any]) -> Any:
    """The known part at a point, straight from the definition of the format."""
    arithmetic = series.arithmetic
    grading = arithmetic.grading
    result = mpmath.mpc(0)
    for exponents, polynomial in zip(grading.monomials, series.coefs, strict=True):
        value = mpmath.mpf(0)
        for coefficient in reversed(polynomial.coeffs()):
            value = value * theta + int(coefficient)
        value = mpmath.ldexp(value, -arithmetic.bits - arithmetic.grade_bits * grading.grade(exponents))
        for base, exponent in zip(point, exponents, strict=True):
            value = value * base**exponent
        result += value
    return result


def exponents_of_grade(grading: Grading, grade: int) -> list[Exponents]:
    """All monomials of a grade."""
    found: list[Exponents] = []

    def extend(prefix: Exponents, left: int) -> None:
        if len(prefix) == len(grading.weights):
            if left == 0:
                found.append(prefix)
            return
        for exponent in range(left // grading.weights[len(prefix)] + 1):
            extend((*prefix, exponent), left - exponent * grading.weights[len(prefix)])

    extend((), grade)
    return found


def random_arithmetic(source: random.Random) -> Arithmetic:
    """A format: coarse ones show roundings, low degrees show truncations."""
    return Arithmetic(source.choice(GRADINGS), source.choice((30, 64, 120)), source.choice((0, 7, 40)),
                      source.choice((0, 2, 5, 12, 20)))  # fmt: skip


def random_element(source: random.Random, arithmetic: Arithmetic, centre: float | None = None) -> Element:
    """A random element; with `centre`, one that stays within a third of it in norm."""
    grading = arithmetic.grading
    coefs = []
    for exponents, scale in zip(grading.monomials, arithmetic.scales, strict=True):
        grade = grading.grade(exponents)
        size = 10.0 ** source.uniform(-8, 0.3) if centre is None else 0.1 * centre * 4.0 ** -len(grading.monomials)
        length = source.randint(0, arithmetic.degree + 1)
        values = [int(source.uniform(-1, 1) * size * 2.0**60) << max(0, scale - 60) for _ in range(length)]
        if grade == 0 and centre is not None:
            values = [value // (arithmetic.degree + 1) for value in values] or [0]
            values[0] = int(centre * 2.0**60)
            values[0] <<= max(0, scale - 60)
        if scale < 60:
            values = [value >> (60 - scale) for value in values]
        coefs.append(fmpz_poly(values))
    errors = arithmetic.zero_errors()
    unknown: list[Unknown] = []
    for slot in range(grading.top + 2):
        if source.random() < 0.25:
            continue
        grades = [slot] if slot <= grading.top else range(grading.top + 1, grading.top + 4)
        monomials = [exponents for grade in grades for exponents in exponents_of_grade(grading, grade)]
        if not monomials:
            continue
        size = 10.0 ** source.uniform(-30, -1)
        if centre is not None:
            size *= 0.1 * centre
        shares = [2.0 ** -(i + 1) for i in range(source.randint(1, 4))]
        unknown += [Unknown(size * share, source.choice(monomials), source.randrange(4)) for share in shares]
        errors[slot] = size
    return Element(Series(arithmetic, coefs, errors), tuple(unknown))


def random_point(source: random.Random, grading: Grading) -> tuple[mpmath.mpf, mpmath.mpf, list[Any]]:
    """theta, t and xi with |xi_i| = t^weight: real, complex or a corner of the polydisc."""
    theta = mpmath.mpf(source.choice((0.0, 1.0, source.random())))
    t = mpmath.mpf(source.choice((1.0, 0.9, 2.0**-10, 2.0**-40)))
    phases = {"real": (1, -1), "imaginary": (mpmath.mpc(0, 1), 1)}.get(source.choice(("real", "imaginary", "complex")))
    point = []
    for weight in grading.weights:
        phase = mpmath.expjpi(2 * source.random()) if phases is None else source.choice(phases)
        point.append(phase * t**weight)
    return theta, t, point


def allowed(series: Series, t: mpmath.mpf) -> mpmath.mpf:
    """A bound for the unknown part where every monomial of grade g is at most t^g."""
    return sum((mpmath.mpf(error) * t**grade for grade, error in enumerate(series.errors)), mpmath.mpf(0))


def is_enclosed(result: Series, exact: Any, theta: mpmath.mpf, t: mpmath.mpf, point: Sequence[Any]) -> bool:
    """Whether the exact value lies in the enclosure."""
    distance = abs(exact - known_value(result, theta, point))
    return bool(distance <= allowed(result, t) + mpmath.ldexp(1, -PRECISION + 60))


Operation = Callable[[Any, Any], Any]
BINARY: dict[str, Operation] = {
    "sum": lambda a, b: a + b,
    "difference": lambda a, b: a - b,
    "product": lambda a, b: a * b,
}


@pytest.mark.parametrize("name", BINARY)
@pytest.mark.parametrize("seed", range(40))
def test_binary_operations_enclose(name: str, seed: int) -> None:
    source = random.Random(f"{name} {seed}")
    arithmetic = random_arithmetic(source)
    left, right = random_element(source, arithmetic), random_element(source, arithmetic)
    result = BINARY[name](left.series, right.series)
    for _ in range(12):
        theta, t, point = random_point(source, arithmetic.grading)
        exact = BINARY[name](left.at(theta, point), right.at(theta, point))
        assert is_enclosed(result, exact, theta, t, point)


@pytest.mark.parametrize("seed", range(30))
def test_squares_enclose(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = random_arithmetic(source)
    element = random_element(source, arithmetic)
    result = element.series * element.series
    for _ in range(12):
        theta, t, point = random_point(source, arithmetic.grading)
        assert is_enclosed(result, element.at(theta, point) ** 2, theta, t, point)


@pytest.mark.parametrize("seed", range(60))
def test_multiples_enclose(seed: int) -> None:
    """Also tiny factors, whose size in float64 has to be rounded up."""
    source = random.Random(seed)
    arithmetic = random_arithmetic(source)
    element = random_element(source, arithmetic)
    factor = Fraction(source.randint(-100, 100) or 1, source.randint(1, 50)) * Fraction(10) ** source.randint(-40, 5)
    result = element.series.scaled(factor)
    for _ in range(12):
        theta, t, point = random_point(source, arithmetic.grading)
        assert is_enclosed(result, number(factor) * element.at(theta, point), theta, t, point)


@pytest.mark.parametrize("factor", [Fraction(1, 10**25), Fraction(-1, 3 * 2**62), Fraction(2, 3), Fraction(10**30)])
def test_multiples_keep_their_error(factor: Fraction) -> None:
    arithmetic = Arithmetic(Grading((1,), 1), 200, 0, 0)
    element = Series(arithmetic, [fmpz_poly([])] * 2, [1.0, 0.5, 0.25])
    for bound, error in zip(element.scaled(factor).errors, element.errors, strict=True):
        assert Fraction(bound) >= abs(factor) * Fraction(error)


@pytest.mark.parametrize("exponent", EXPONENTS, ids=str)
@pytest.mark.parametrize("seed", range(20))
def test_powers_enclose(exponent: Fraction, seed: int) -> None:
    source = random.Random(f"{exponent} {seed}")
    arithmetic = random_arithmetic(source)
    element = random_element(source, arithmetic, centre=source.uniform(0.5, 3))
    approximate, _ = approximate_power(arithmetic, element.series.coefs[0], exponent)
    coefs = [approximate] + [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)
    result = correct_power(Series(arithmetic, coefs, arithmetic.zero_errors()), element.series, exponent)
    assert result is not None
    for _ in range(12):
        theta, t, point = random_point(source, arithmetic.grading)
        exact = mpmath.power(element.at(theta, point), number(exponent))
        assert is_enclosed(result, exact, theta, t, point)


def test_reciprocals_of_negative_elements_enclose() -> None:
    source = random.Random(5)
    arithmetic = Arithmetic(Grading((1, 1), 2), 80, 3, 9)
    element = random_element(source, arithmetic, centre=1.25)
    negative = element.series.scaled(Fraction(-1))
    approximate, _ = approximate_power(arithmetic, negative.coefs[0], Fraction(-1))
    coefs = [approximate] + [fmpz_poly([])] * (len(arithmetic.grading.monomials) - 1)
    result = correct_power(Series(arithmetic, coefs, arithmetic.zero_errors()), negative, Fraction(-1))
    assert result is not None
    for _ in range(50):
        theta, t, point = random_point(source, arithmetic.grading)
        assert is_enclosed(result, -1 / element.at(theta, point), theta, t, point)


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


def test_square_roots_of_negative_elements_are_refused() -> None:
    base, approximate = constant_pair(-4.0, 0.5, [0.0, 0.0, 0.0])
    assert correct_power(approximate, base, Fraction(-1, 2)) is None


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


@pytest.mark.parametrize("seed", range(20))
def test_the_value_at_the_end_encloses(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = random_arithmetic(source)
    element = random_element(source, arithmetic)
    result = element.series.at_end()
    assert all(polynomial.length() <= 1 for polynomial in result.coefs)
    for _ in range(12):
        theta, t, point = random_point(source, arithmetic.grading)
        exact = element.at(mpmath.mpf(1), point)
        assert is_enclosed(result, exact, theta, t, point)


@pytest.mark.parametrize("seed", range(30))
def test_norms_bound_the_element(seed: int) -> None:
    source = random.Random(seed)
    arithmetic = random_arithmetic(source)
    element = random_element(source, arithmetic)
    bound = element.series.norm()
    for _ in range(20):
        theta, t, point = random_point(source, arithmetic.grading)
        limit = sum(mpmath.mpf(value) * t**grade for grade, value in enumerate(bound))
        assert abs(element.at(theta, point)) <= limit


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


def test_shifts_and_divisions_round_down() -> None:
    """What the format relies on: coefficientwise floor, and right_shift as division by a power of theta."""
    polynomial = fmpz_poly([5, -5, 7, -9])
    assert polynomial // fmpz(4) == fmpz_poly([1, -2, 1, -3])
    assert polynomial.right_shift(2) == fmpz_poly([7, -9])
    assert polynomial.height_bits() == 4
