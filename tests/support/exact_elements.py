"""Exact elements of the graded algebra together with an enclosure, for tests.

The exact elements are known parts plus explicit unknown parts, whose monomials lie in their grade and whose
l1 norm is the error bound of that grade. They are evaluated with 600 bits at complex points of the polydisc with
|xi_i| = t^(weight of i): there an unknown part of grade g is at most e_g t^g, so that a small t shows whether an
error is charged to the right grade.

With a wide variable s, of weight 0, points and exponents have one more entry, the last.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
from flint import fmpz_poly

from orbitproof.verify.algebra import Arithmetic, Exponents, Grading, Series, WideArithmetic

PRECISION = 600
GRADINGS = (
    Grading((1, 1, 2), 2),
    Grading((2, 1, 2), 3),
    Grading((1, 1), 3),
    Grading((1,), 1),
    Grading((3, 1), 2),
    Grading((1, 2), 0),
)


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
    wide: Sequence[Any] = ()
    if arithmetic.width:
        *point, s = point
        wide = [s**power for power in range(arithmetic.width + 1)]
    for exponents, polynomial in zip(grading.monomials, series.coefs, strict=True):
        value = mpmath.mpf(0)
        for row in reversed(rows_of(arithmetic, polynomial)):
            value = value * theta + (sum(c * power for c, power in zip(row, wide, strict=True)) if wide else row[0])
        value *= mpmath.ldexp(1, -arithmetic.bits - arithmetic.grade_bits * grading.grade(exponents))
        for base, exponent in zip(point, exponents, strict=True):
            value = value * base**exponent
        result += value
    return result


def rows_of(arithmetic: Arithmetic, packed: fmpz_poly) -> list[list[int]]:
    """The coefficients by powers of theta, and in each row by powers of s: theta^n s^j has index n stride + j."""
    width, stride = arithmetic.width, arithmetic.stride
    values = [int(c) for c in packed.coeffs()]
    values += [0] * (-len(values) % stride)
    rows = [values[start : start + stride] for start in range(0, len(values), stride)]
    assert not any(any(row[width + 1 :]) for row in rows)
    return [row[: width + 1] for row in rows]


def packed_from(arithmetic: Arithmetic, rows: Sequence[Sequence[int]]) -> fmpz_poly:
    """The packed polynomial with these rows."""
    return fmpz_poly([value for row in rows for value in [*row, *[0] * (arithmetic.stride - len(row))]])


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


def random_arithmetic(source: random.Random, wide: bool = False) -> Arithmetic:
    """A format: coarse ones show roundings, low degrees show truncations."""
    grading, bits, grade_bits = source.choice(GRADINGS), source.choice((30, 64, 120)), source.choice((0, 7, 40))
    if not wide:
        return Arithmetic(grading, bits, grade_bits, source.choice((0, 2, 5, 12, 20)))
    return WideArithmetic(grading, bits, grade_bits, source.choice((0, 2, 5, 10)), width=source.choice((1, 2, 5, 9)))


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
        rows = [
            [value, *(int(value * source.uniform(-1, 1) * 4.0**-j) for j in range(1, arithmetic.width + 1))]
            for value in values
        ]
        coefs.append(packed_from(arithmetic, rows))
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
        if arithmetic.width:
            powers = (0, 1, arithmetic.width, arithmetic.width + 1, 3 * arithmetic.width)
            monomials = [(*exponents, power) for exponents in monomials for power in powers]
        shares = [2.0 ** -(i + 1) for i in range(source.randint(1, 4))]
        unknown += [Unknown(size * share, source.choice(monomials), source.randrange(4)) for share in shares]
        errors[slot] = size
    return Element(Series(arithmetic, coefs, errors), tuple(unknown))


def random_point(
    source: random.Random, grading: Grading, wide: bool = False
) -> tuple[mpmath.mpf, mpmath.mpf, list[Any]]:
    """theta, t and xi with |xi_i| = t^weight, and s with |s| <= 1: real, complex or a corner of the polydisc."""
    theta = mpmath.mpf(source.choice((0.0, 1.0, source.random())))
    t = mpmath.mpf(source.choice((1.0, 0.9, 2.0**-10, 2.0**-40)))
    phases = {"real": (1, -1), "imaginary": (mpmath.mpc(0, 1), 1)}.get(source.choice(("real", "imaginary", "complex")))
    point = []
    for weight in grading.weights:
        phase = mpmath.expjpi(2 * source.random()) if phases is None else source.choice(phases)
        point.append(phase * t**weight)
    if wide:
        s = mpmath.expjpi(2 * source.random()) if phases is None else source.choice(phases)
        point.append(s * mpmath.mpf(source.choice((1, 1, source.random()))))
    return theta, t, point


def allowed(series: Series, t: mpmath.mpf) -> mpmath.mpf:
    """A bound for the unknown part where every monomial of grade g is at most t^g."""
    return sum((mpmath.mpf(error) * t**grade for grade, error in enumerate(series.errors)), mpmath.mpf(0))


def is_enclosed(result: Series, exact: Any, theta: mpmath.mpf, t: mpmath.mpf, point: Sequence[Any]) -> bool:
    """Whether the exact value lies in the enclosure."""
    distance = abs(exact - known_value(result, theta, point))
    return bool(distance <= allowed(result, t) + mpmath.ldexp(1, -PRECISION + 60))
