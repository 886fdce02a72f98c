"""Graded Taylor models in fixed point (section 2).

A `Series` encloses a function of time theta in [0, 1] with values in the algebra A of power series in
xi that are absolutely summable on the closed unit polydisc. For every kept monomial it holds a
polynomial in theta with integer coefficients (the value is the integer times 2^-(bits + grade *
grade_bits)), and for every grade a float that bounds the l1 norm, for all theta in [0, 1], of what is
unknown. Integer arithmetic is exact; every rounding and every truncation is added to the errors.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, reduce
from operator import mul

from flint import arb, arb_series, ctx, fmpz, fmpz_poly

from orbitproof.verify.algebra.grading import Grading, Pairs
from orbitproof.verify.algebra.norms import GradedNorm, add, convolve, float_above, fraction_above, geometric, inflate
from orbitproof.verify.evidence import IntegrationFailure, guarded

Products = tuple[fmpz_poly, float]
"""An exact sum of products, with the fractional bits of both factors, and a bound for what it lacks."""

ZERO = fmpz_poly([])
_NOTHING: Products = (ZERO, 0.0)
_HEAD = 8

_CUTS_IN_A_UNIT = 16
"""What a factor that is cut changes is at most this part of what a product may change by rounding."""

_WORTH_CUTTING = 24
"""Fewer bits than so many are not cut off."""


def integer_part(value: arb) -> fmpz | None:
    """The floor of the midpoint of a ball; `None` if it is not finite."""
    return value.mid().floor().mid().unique_fmpz() if value.is_finite() else None


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

    @property
    def stride(self) -> int:
        """Distance of the powers of theta in a polynomial."""
        return 1

    @property
    def width(self) -> int:
        """Largest degree in the wide variable s that is kept; 0 if there is none."""
        return 0

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
        """For each grade, a bound for the rounding of one polynomial: one unit for every coefficient."""
        top, number = self.grading.top, (self.degree + 1) * (self.width + 1)
        return tuple(float_above(number, -self.bits - grade * self.grade_bits) for grade in range(top + 1))

    def zero_errors(self) -> GradedNorm:
        """Errors of an exact element."""
        return [0.0] * (self.grading.top + 2)

    def constant(self, value: Fraction) -> Series:
        """A real constant, rounded to the format."""
        return self.polynomial({self.grading.monomials[0]: value})

    def polynomial(self, coefficients: Mapping[tuple[int, ...], Fraction | Sequence[Fraction]]) -> Series:
        """A polynomial in xi, constant in theta; a sequence holds the coefficients of 1, s, s^2, ..

        What lies above the top grade or the largest degree in s becomes an error.
        """
        grading = self.grading
        coefs = [ZERO] * len(grading.monomials)
        errors = self.zero_errors()
        for exponents, given in coefficients.items():
            position = grading.index.get(exponents)
            grade = grading.top + 1 if position is None else grading.grades[position]
            integers = []
            for power, value in enumerate([given] if isinstance(given, Fraction) else given):
                if position is None or power > self.width:
                    lost = fraction_above(abs(value))
                else:
                    scaled = value * Fraction(2) ** self.scales[position]
                    integers.append(scaled.numerator // scaled.denominator)
                    lost = 0.0 if integers[-1] == scaled else float_above(1, -self.scales[position])
                if lost:
                    errors[grade] = inflate(errors[grade] + lost)
            if position is not None:
                coefs[position] = fmpz_poly(integers)
        return Series(self, coefs, errors)

    def coarser(self, grading: Grading, bits: int, degree: int, width: int) -> Arithmetic:
        """A format with at most so many bits and so large degrees in theta and s, and no further bits per grade."""
        return replace(self, grading=grading, bits=min(bits, self.bits), grade_bits=0, degree=min(degree, self.degree))

    def size(self, polynomial: fmpz_poly, scale: int) -> float:
        """A bound for ``sum_n |c_n|`` times 2^-scale, hence for the supremum over theta in [0, 1]."""
        length = polynomial.length()
        if length == 0:
            return 0.0
        head = int(sum(map(abs, polynomial.truncate(_HEAD).coeffs()), fmpz(0)))
        if length > _HEAD:
            head += (length - _HEAD) << int(polynomial.right_shift(_HEAD).height_bits())
        return float_above(head, -scale)

    def cut(self, product: fmpz_poly) -> tuple[fmpz_poly, int]:
        """The part of a product of polynomials that is kept, and a bound for the l1 norm of the rest."""
        return self.part_for(self, product)

    def part_for(self, coarse: Arithmetic, polynomial: fmpz_poly) -> tuple[fmpz_poly, int]:
        """What a coarser format keeps of a polynomial, and a bound for the l1 norm of the rest."""
        excess = polynomial.length() - coarse.degree - 1
        if excess <= 0:
            return polynomial, 0
        rest = excess << int(polynomial.right_shift(coarse.degree + 1).height_bits())
        return polynomial.truncate(coarse.degree + 1), rest

    def round_product(self, exact: fmpz_poly, position: int) -> tuple[fmpz_poly, float]:
        """Bring an exact sum of products (2 * bits fractional bits at grade 0) back to the format.

        Returns the part that is kept, rounded by less than one unit, and a bound for what was lost.
        """
        lost = self.rounding[self.grading.grades[position]]
        exact, beyond = self.cut(exact)
        if beyond:
            lost += float_above(beyond, -self.scales[position] - self.bits)
        return exact // self.one, inflate(lost)

    def reduced(self, product: fmpz_poly) -> fmpz_poly:
        """A product brought back to the format; nothing is said of what is lost."""
        return self.cut(product)[0] // self.one

    def derivative(self, polynomial: fmpz_poly) -> fmpz_poly:
        """The derivative in theta."""
        return polynomial.derivative()

    def at_end(self, polynomial: fmpz_poly) -> fmpz_poly:
        """The value at theta = 1."""
        return fmpz_poly([polynomial(fmpz(1))]) if polynomial.length() else polynomial

    def power(self, base: fmpz_poly, exponent: Fraction, near: fmpz_poly = ZERO) -> fmpz_poly:
        """An approximation of ``base ** exponent``, exponent < 0, polynomials of grade 0.

        Nothing is proved by it: `correct_power` bounds how far it is from the power. Raises `IntegrationFailure` if
        there is none. `near`: perhaps the power of a base nearby, or 0.
        """
        length, scale, cap = self.degree + 1, arb(2) ** self.bits, ctx.cap
        ctx.cap = length
        try:
            with guarded(self.bits):
                series = arb_series([arb(value) / scale for value in base.coeffs()], prec=length)
                found = series ** (arb(exponent.numerator) / exponent.denominator)
                power = [c for n in range(length) if (c := integer_part(found[n] * scale)) is not None]
        finally:
            ctx.cap = cap
        if len(power) < length:
            raise IntegrationFailure(
                "singularity",
                "a power or quotient of the vector field has no finite expansion at the centre",
                "the orbit meets a singularity of the vector field: give another centre",
            )
        return fmpz_poly(power)

    def balls_in_time(self, polynomial: fmpz_poly, part: arb | None) -> list[arb]:
        """Enclosures of the coefficients of the powers of theta of a polynomial of grade 0, for s in `part`."""
        scale = arb(2) ** -self.bits
        return [arb(value) * scale for value in polynomial.coeffs()]

    def product_slice(
        self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int, inner: Products | None = None
    ) -> tuple[fmpz_poly, float]:
        """The known part of one monomial of a product and a bound for what rounding and truncation lost.

        `inner`: what `inner_products` gives, where it is known already.
        """
        if inner is None:
            inner = self.inner_products(left, right, position)
        exact, lost = self._products(left, right, position, self.grading.outer_factors[position])
        if inner is not _NOTHING:
            exact, lost = exact + inner[0], lost + inner[1]
        if not exact.length():
            return ZERO, inflate(lost) if lost else 0.0
        value, rounding = self.round_product(exact, position)
        return value, inflate(rounding + lost)

    def approximate_slice(
        self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int, inner: Products
    ) -> fmpz_poly:
        """As `product_slice`, with the same roundings; nothing is said of what is lost."""
        return self.reduced(self._exact(left, right, self.grading.outer_factors[position]) + inner[0])

    def inner_products(self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int) -> Products:
        """The part of one monomial of a product that comes from other monomials than it and the constant."""
        factors = self.grading.inner_factors[position]
        return self._products(left, right, position, factors) if factors else _NOTHING

    def _exact(self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], factors: Pairs) -> fmpz_poly:
        """The sum of products as `_products` gives it."""
        return self._products(left, right, 0, factors)[0]

    def _products(
        self, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly], position: int, factors: Pairs
    ) -> Products:
        exact = ZERO
        square = left is right
        cuts = 0
        for i, j in factors:
            a, b = left[i], right[j]
            if a.length() and b.length() and (i <= j or not square):
                term, number = self._product(a, b)
                times = 1 if i == j or not square else 2
                cuts += times * number
                exact += term if times == 1 else term * times
        lost = cuts * self.rounding[self.grading.grades[position]] / _CUTS_IN_A_UNIT
        return exact, inflate(lost) if cuts else 0.0

    def _product(self, left: fmpz_poly, right: fmpz_poly) -> tuple[fmpz_poly, int]:
        """A product without bits of the factors far below its unit, and how many factors were cut (section 2.2)."""
        left, first = self._cut_for(right, left, 0)
        right, second = self._cut_for(left, right, first)
        product = left * right
        return (product * fmpz(1 << first + second), (first > 0) + (second > 0)) if first or second else (product, 0)

    def _cut_for(self, other: fmpz_poly, factor: fmpz_poly, shift: int) -> tuple[fmpz_poly, int]:
        """A factor without the bits that do not matter in its product with other * 2^shift, and their number."""
        size = int(other.height_bits()) + shift + other.length().bit_length()
        bits = self.bits - size - _CUTS_IN_A_UNIT.bit_length()
        is_cut = bits >= _WORTH_CUTTING and factor.length() <= self.degree + 1
        return (factor // fmpz(1 << bits), bits) if is_cut else (factor, 0)


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
        arithmetic, denominator, lost = self.arithmetic, fmpz(factor.denominator), self.arithmetic.zero_errors()
        coefs = [p * fmpz(factor.numerator) for p in self.coefs]
        if denominator > 1:
            coefs = [p // denominator for p in coefs]
            for polynomial, grade in zip(self.coefs, arithmetic.grading.grades, strict=True):
                if polynomial.length():
                    lost[grade] += arithmetic.rounding[grade]
        size = fraction_above(abs(factor))
        return Series(arithmetic, coefs, [inflate(size * e + loss) for e, loss in zip(self.errors, lost, strict=True)])

    def at_end(self) -> Series:
        """The value at theta = 1: constant in theta, exact sums of the coefficients."""
        arithmetic = self.arithmetic
        return Series(arithmetic, [arithmetic.at_end(p) for p in self.coefs], self.errors)

    def widened(self, radius: Fraction) -> Series:
        """The element with every number of at most this size added."""
        if radius == 0:
            return self
        return self.with_errors([inflate(self.errors[0] + fraction_above(radius)), *self.errors[1:]])

    def with_errors(self, errors: GradedNorm) -> Series:
        """This known part with other errors."""
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


def correct_power(approximate: Series, base: Series, exponent: Fraction) -> Series | None:
    """Turn an approximation of ``base ** exponent``, exponent < 0, into an enclosure.

    With exponent = -p/q, all of E = 1 - approximate^q base^p is bounded; then base^exponent equals
    approximate * (1 - E)^(-1/q) (section 2.4). `None` if the bound of E is not below
    1/2, or if q > 1 and base and approximation are not positive at the centre at theta = 0.
    """
    p, q = -exponent.numerator, exponent.denominator
    if q > 1 and not (base.coefs[0][0] > 0 and approximate.coefs[0][0] > 0):
        return None
    shared = min(p, q)
    mixed = approximate * base
    value = reduce(mul, [*[mixed] * (shared - 1), *[base] * (p - shared), *[approximate] * (q - shared)], mixed)
    defect = list(value.coefs)
    defect[0] = defect[0] - fmpz_poly([base.arithmetic.one])
    series = geometric(Series(base.arithmetic, defect, value.errors).norm())
    if series is None:
        return None
    relative = [inflate(term / q) for term in series]
    return approximate.with_errors(add(approximate.errors, convolve(approximate.norm(), relative)))
