"""Graded Taylor models in fixed point (docs/method.md, section 2).

A `Series` encloses a function of time theta in [0, 1] with values in the algebra A of power series in
xi that are absolutely summable on the closed unit polydisc. For every kept monomial it holds a
polynomial in theta with integer coefficients (the value is the integer times 2^-(bits + grade *
grade_bits)), and for every grade a float that bounds the l1 norm, for all theta in [0, 1], of what is
unknown. Integer arithmetic is exact; every rounding and every truncation is added to the errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from flint import fmpz, fmpz_poly

from verify.grading import Grading
from verify.norms import GradedNorm, add, convolve, float_above, geometric, inflate

_ZERO = fmpz_poly([])
_HEAD = 8


@dataclass(frozen=True)
class Arithmetic:
    """Fixed-point formats shared by the series of one computation.

    Attributes:
        grading: the kept monomials.
        bits: fractional bits of grade 0.
        grade_bits: further fractional bits per grade.
        degree: largest degree in theta that is kept, N.
        grade_loss: significant bits that a coefficient is expected to lose per grade.
    """

    grading: Grading
    bits: int
    grade_bits: int
    degree: int
    grade_loss: int = 0

    @cached_property
    def one(self) -> fmpz:
        """The integer that stands for 1."""
        return fmpz(1 << self.bits)

    @cached_property
    def scales(self) -> tuple[int, ...]:
        """Fractional bits of each kept monomial."""
        return tuple(self.bits + grade * self.grade_bits for grade in self.grading.grades)

    @cached_property
    def rounding(self) -> tuple[float, ...]:
        """For each grade, a bound for the rounding of one polynomial: degree + 1 units."""
        top = self.grading.top
        return tuple(float_above(self.degree + 1, -self.bits - grade * self.grade_bits) for grade in range(top + 1))

    def spare_bits(self, grade: int) -> int:
        """Bits by which the significant part of a coefficient of this grade is shorter than grade 0."""
        return min(max(0, self.bits - 64), grade * self.grade_loss)

    def zero_errors(self) -> GradedNorm:
        """Errors of an exact element."""
        return [0.0] * (self.grading.top + 2)

    def constant(self, value: Fraction) -> Series:
        """A real constant, rounded to the format."""
        return self.polynomial({self.grading.monomials[0]: value})

    def polynomial(self, coefficients: dict[tuple[int, ...], Fraction]) -> Series:
        """A polynomial in xi, constant in theta. Monomials above the top grade become errors."""
        grading = self.grading
        coefs = [_ZERO] * len(grading.monomials)
        errors = self.zero_errors()
        for exponents, value in coefficients.items():
            position = grading.index.get(exponents)
            if position is None:
                size = abs(value)
                errors[-1] = inflate(errors[-1] + float_above(-(-size.numerator * 2**1000 // size.denominator), -1000))
                continue
            scaled = value * 2 ** self.scales[position]
            rounded = scaled.numerator // scaled.denominator
            coefs[position] = fmpz_poly([rounded])
            if rounded != scaled:
                grade = grading.grades[position]
                errors[grade] = inflate(errors[grade] + float_above(1, -self.scales[position]))
        return Series(self, coefs, errors)

    def size(self, polynomial: fmpz_poly, scale: int) -> float:
        """A bound for ``sum_n |c_n|`` times 2^-scale, hence for the supremum over theta in [0, 1]."""
        length = polynomial.length()
        if length == 0:
            return 0.0
        head = sum(abs(int(polynomial[n])) for n in range(min(length, _HEAD)))
        if length > _HEAD:
            head += (length - _HEAD) << int(polynomial.right_shift(_HEAD).height_bits())
        return float_above(head, -scale)

    def round_product(self, exact: fmpz_poly, position: int) -> tuple[fmpz_poly, float]:
        """Bring an exact sum of products (2 * bits fractional bits at grade 0) back to the format.

        Returns the polynomial, truncated at `degree` and rounded down, and a bound for what was lost.
        """
        grade = self.grading.grades[position]
        lost = self.rounding[grade]
        excess = exact.length() - self.degree - 1
        if excess > 0:
            tail = exact.right_shift(self.degree + 1)
            lost += float_above(excess << int(tail.height_bits()), -self.scales[position] - self.bits)
            exact = exact.truncate(self.degree + 1)
        return exact // self.one, inflate(lost)

    def product_slice(
        self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int
    ) -> tuple[fmpz_poly, float]:
        """The known part of one monomial of a product and a bound for what rounding and truncation lost."""
        exact: fmpz_poly | None = None
        square = left is right
        for i, j in self.grading.factors[position]:
            a, b = left[i], right[j]
            if a.length() and b.length() and (i <= j or not square):
                term = a * b if i == j or not square else (a * b) * 2
                exact = term if exact is None else exact + term
        if exact is None:
            return _ZERO, 0.0
        return self.round_product(exact, position)


class Series:
    """An enclosure of a function [0, 1] -> A; immutable by convention.

    Attributes:
        arithmetic: the format.
        coefs: one integer polynomial in theta per kept monomial.
        errors: bounds for the unknown part, grades 0 .. G and above.
    """

    __slots__ = ("_known", "arithmetic", "coefs", "errors")

    def __init__(self, arithmetic: Arithmetic, coefs: Sequence[fmpz_poly], errors: GradedNorm) -> None:
        self.arithmetic = arithmetic
        self.coefs = list(coefs)
        self.errors = errors
        self._known: GradedNorm | None = None

    @property
    def known(self) -> GradedNorm:
        """Graded norm of the known part, supremum over theta; the last slot is 0."""
        if self._known is None:
            arithmetic = self.arithmetic
            norm = arithmetic.zero_errors()
            for polynomial, grade, scale in zip(self.coefs, arithmetic.grading.grades, arithmetic.scales, strict=True):
                if polynomial.length():
                    norm[grade] += arithmetic.size(polynomial, scale)
            self._known = [inflate(value) if value else 0.0 for value in norm]
        return self._known

    def norm(self) -> GradedNorm:
        """Graded norm of the enclosed function, supremum over theta."""
        return add(self.known, self.errors)

    def __add__(self, other: Series) -> Series:
        coefs = [a + b for a, b in zip(self.coefs, other.coefs, strict=True)]
        return Series(self.arithmetic, coefs, add(self.errors, other.errors))

    def __sub__(self, other: Series) -> Series:
        coefs = [a - b for a, b in zip(self.coefs, other.coefs, strict=True)]
        return Series(self.arithmetic, coefs, add(self.errors, other.errors))

    def __mul__(self, other: Series) -> Series:
        arithmetic = self.arithmetic
        coefs = []
        lost = arithmetic.zero_errors()
        for position, grade in enumerate(arithmetic.grading.grades):
            polynomial, loss = arithmetic.product_slice(self.coefs, other.coefs, position)
            coefs.append(polynomial)
            lost[grade] += loss
        return Series(arithmetic, coefs, product_errors(self, other, lost))

    def scaled(self, factor: Fraction) -> Series:
        """The product with an exact constant."""
        arithmetic = self.arithmetic
        coefs, lost = scale_coefficients(arithmetic, self.coefs, factor)
        size = float_above(-((-abs(factor.numerator) << 60) // factor.denominator), -60)
        return Series(arithmetic, coefs, [inflate(size * e + loss) for e, loss in zip(self.errors, lost, strict=True)])

    def at_end(self) -> Series:
        """The value at theta = 1: constant in theta, exact sums of the coefficients."""
        one = fmpz(1)
        return Series(self.arithmetic, [fmpz_poly([p(one)]) if p.length() else p for p in self.coefs], self.errors)

    def with_errors(self, errors: GradedNorm) -> Series:
        """The same known part with other errors."""
        result = Series(self.arithmetic, self.coefs, errors)
        result._known = self._known
        return result


def product_errors(left: Series, right: Series, lost: Sequence[float]) -> GradedNorm:
    """Errors of a product: ``|a| e_b + e_a |b| + e_a e_b``, overflowing known products, and `lost`."""
    top = left.arithmetic.grading.top
    a, b = left.known, right.known
    p, q = left.errors, right.errors
    result = list(lost)
    for i in range(top + 2):
        ai, pi = a[i], p[i]
        whole = ai + pi
        for j in range(top + 2):
            grade = i + j
            if grade <= top:
                result[grade] += whole * q[j] + pi * b[j]
            else:
                result[top + 1] += whole * (b[j] + q[j])
    return [inflate(value) for value in result]


def scale_coefficients(
    arithmetic: Arithmetic, coefs: Sequence[fmpz_poly], factor: Fraction
) -> tuple[list[fmpz_poly], GradedNorm]:
    """Known part times an exact constant, and bounds for the rounding by grade."""
    lost = arithmetic.zero_errors()
    numerator, denominator = fmpz(factor.numerator), fmpz(factor.denominator)
    if factor.denominator == 1:
        return [p * numerator for p in coefs], lost
    result = []
    for polynomial, grade in zip(coefs, arithmetic.grading.grades, strict=True):
        if polynomial.length():
            lost[grade] += arithmetic.rounding[grade]
            polynomial = (polynomial * numerator) // denominator
        result.append(polynomial)
    return result, lost


def correct_power(approximate: Series, base: Series, exponent: Fraction) -> Series | None:
    """Turn an approximation of ``base ** exponent``, exponent < 0, into an enclosure.

    With exponent = -p/q, all of E = 1 - approximate^q base^p is bounded; then base^exponent equals
    approximate * (1 - E)^(-1/q) (docs/method.md, section 3.3). `None` if the bound of E is not below
    1/2, or if q is even and the approximation is not positive at the centre at theta = 0.
    """
    p, q = -exponent.numerator, exponent.denominator
    if q % 2 == 0 and not approximate.coefs[0][0] > 0:
        return None
    shared = min(p, q)
    mixed = approximate * base
    value = mixed
    for _ in range(shared - 1):
        value = value * mixed
    for _ in range(p - shared):
        value = value * base
    for _ in range(q - shared):
        value = value * approximate
    defect = list(value.coefs)
    defect[0] = defect[0] - fmpz_poly([base.arithmetic.one])
    series = geometric(Series(base.arithmetic, defect, value.errors).norm())
    if series is None:
        return None
    relative = [inflate(term / q) for term in series]
    return approximate.with_errors(add(approximate.errors, convolve(approximate.norm(), relative)))
