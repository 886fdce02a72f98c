"""Functions of s on a proved interval of a piece, as polynomials with a bound of the rest (section 22).

tau is the variable in which they are written: s = middle + radius tau, and |tau| <= 1/REACH is the interval.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import ceil, log2
from typing import Annotated, Protocol, TypeVar

from flint import arb, arb_poly

from orbitproof.shared.stored import rules
from orbitproof.verify.algebra import Series, WideArithmetic, ball_polynomial, correct_power, values_around
from orbitproof.verify.evidence import IntegrationFailure, exact_value, is_below, symmetric, total

REACH = Fraction(33, 32)
"""|tau| <= 1 exceeds the interval by this factor."""

_BITS, _BITS_LEFT_OUT = 64, 96
"""Significant bits of stored coefficients: at least so many, and with more precision more of them."""
_ERROR_BITS = 8
"""Significant bits of stored bounds."""
_SPARE = 2
"""A stored bound is so many times the one that was found: another integration has to find one inside of it."""
_MOST = 2**200
"""Bounds beyond it say nothing."""


def known_part(element: Series, monomial: int) -> list[Fraction]:
    """The coefficients in sigma of a monomial of an element that does not depend on theta."""
    coefficients = element.coefs[monomial].coeffs()
    if len(coefficients) > element.arithmetic.width + 1:
        raise ValueError("the element depends on theta")
    scale = Fraction(1, 2 ** element.arithmetic.scales[monomial])
    return [int(value) * scale for value in coefficients]


def function(arithmetic: WideArithmetic, coefficients: Sequence[Fraction], error: Fraction) -> Series:
    """The functions of sigma with this known part and an unknown one of at most this norm."""
    return arithmetic.polynomial({(0,): list(coefficients) or [Fraction(0)]}).widened(error)


def error_of(element: Series) -> Fraction:
    """A bound of the norm of the unknown part. Raises `IntegrationFailure` if there is none."""
    return finite(element.errors, "a function along the curve was not enclosed")


def norm_of(element: Series) -> Fraction:
    """A bound of the norm."""
    return finite(element.norm(), "a function along the curve was not enclosed")


def finite(bounds: Sequence[float], message: str) -> Fraction:
    """The sum of finite bounds, exactly. Raises `IntegrationFailure` for others."""
    if not all(0 <= bound < _MOST for bound in bounds):
        raise IntegrationFailure("stability", message, "give a narrower piece")
    return sum((Fraction(bound) for bound in bounds), Fraction(0))


def restricted(element: Series, share: Fraction) -> Series:
    """The function on |sigma| <= share, written in tau = sigma/share."""
    coefficients = [value * share**j for j, value in enumerate(known_part(element, 0))]
    return function(_same(element), coefficients, error_of(element))


def slope(element: Series, share: Fraction) -> Series:
    """The derivative in sigma on |sigma| <= share < 1, written in tau = sigma/share."""
    coefficients = [j * value * share ** (j - 1) for j, value in enumerate(known_part(element, 0)) if j]
    return function(_same(element), coefficients, error_of(element) / (1 - share))


def inverse(element: Series) -> Series:
    """1/f. Raises `IntegrationFailure` if f is not shown to have no zero for |sigma| <= 1."""
    arithmetic = _same(element)
    approximate = Series(arithmetic, [arithmetic.power(element.coefs[0], Fraction(-1))], arithmetic.zero_errors())
    result = correct_power(approximate, element, Fraction(-1))
    if result is None:
        message = "the derivative across the curve may be singular at a complex s close to the interval"
        raise IntegrationFailure("stability", message, "give a narrower piece")
    return result


def _same(element: Series) -> WideArithmetic:
    assert isinstance(element.arithmetic, WideArithmetic)
    return element.arithmetic


class _RingElement(Protocol):
    """What sums and products are formed of."""

    def __add__(self: T, other: T, /) -> T: ...

    def __sub__(self: T, other: T, /) -> T: ...

    def __mul__(self: T, other: T, /) -> T: ...


T = TypeVar("T", bound=_RingElement)


def determinant(rows: Sequence[Sequence[T]]) -> T:
    """The determinant of a square matrix of functions, at least 1 x 1, by its first row."""
    if len(rows) == 1:
        return rows[0][0]
    first, *others = rows
    result: T | None = None
    for column, entry in enumerate(first):
        minor = determinant([[*row[:column], *row[column + 1 :]] for row in others])
        term = entry * minor
        result = term if result is None else result - term if column % 2 else result + term
    assert result is not None
    return result


@dataclass(frozen=True)
class BoundedFunction:
    """A function of tau: a polynomial, and an unknown power series with a bound of the sum of its coefficients' sizes.

    Attributes:
        polynomial: coefficients of 1, tau, tau^2, ..
        error: bound of the l1 norm of the rest.
    """

    polynomial: arb_poly
    error: arb

    @cached_property
    def _slopes(self) -> tuple[arb_poly, arb_poly]:
        first = self.polynomial.derivative()
        return first, first.derivative()

    def value(self, part: arb) -> arb:
        """Values on a part of the interval."""
        return _over(self.polynomial, part) + arb(0, 1) * self.error

    def slope(self, part: arb) -> arb:
        """Derivatives on a part of the interval."""
        return _over(self._slopes[0], part) + arb(0, 1) * (self.error / _gap(part))

    def curvature(self, part: arb) -> arb:
        """Second derivatives on a part of the interval."""
        gap = _gap(part)
        return _over(self._slopes[1], part) + arb(0, 2) * (self.error / (gap * gap * gap))

    @cached_property
    def size(self) -> arb:
        """A bound of the norm."""
        return self._known_size + self.error

    @cached_property
    def _known_size(self) -> arb:
        return total(abs(c) for c in self.polynomial.coeffs())

    @property
    def known_share(self) -> arb:
        """A bound of the norm of the polynomial over that of the rest: at most 1 if 0 is among what is enclosed."""
        size = self._known_size.upper()
        return (size / self.error).upper() if size > 0 else size

    def __add__(self, other: BoundedFunction) -> BoundedFunction:
        return BoundedFunction(self.polynomial + other.polynomial, (self.error + other.error).upper())

    def __sub__(self, other: BoundedFunction) -> BoundedFunction:
        return self + other.scaled(arb(-1))

    def __mul__(self, other: BoundedFunction) -> BoundedFunction:
        error = self.size * other.error + self.error * other._known_size
        return BoundedFunction(self.polynomial * other.polynomial, error.upper())

    def scaled(self, factor: arb) -> BoundedFunction:
        """The product with a number."""
        return BoundedFunction(self.polynomial * arb_poly([factor]), (self.error * abs(factor)).upper())

    def shifted(self, value: arb) -> BoundedFunction:
        """The sum with a number."""
        return BoundedFunction(self.polynomial + arb_poly([value]), self.error)

    def mirrored(self) -> BoundedFunction:
        """The function of -tau."""
        return BoundedFunction(self.polynomial(arb_poly([0, -1])), self.error)

    @property
    def as_found(self) -> BoundedFunction:
        """The function with the bound that was found, if this is what `StoredFunction.of` has made of it."""
        return BoundedFunction(self.polynomial, self.error / _SPARE)

    def contains(self, other: BoundedFunction) -> bool:
        """Whether what the other one encloses certainly is enclosed by this one."""
        difference = total(abs(c) for c in (self.polynomial - other.polynomial).coeffs())
        return is_below(difference + other.error, self.error)


def _over(polynomial: arb_poly, part: arb) -> arb:
    return values_around(polynomial, part.mid(), part.rad())


def _gap(part: arb) -> arb:
    """1 - |tau| at the points of a part of the interval that are farthest out."""
    return 1 - part.abs_upper()


def bounded(element: Series) -> BoundedFunction:
    """A function of tau that is enclosed in the algebra."""
    return BoundedFunction(ball_polynomial(known_part(element, 0)), symmetric(error_of(element)).rad())


@dataclass(frozen=True)
class StoredFunction:
    """A function of tau as it is stored: dyadic coefficients, and a bound of the rest.

    Attributes:
        coefficients: of 1, tau, tau^2, ..
        error: bound of the l1 norm of the rest.
    """

    coefficients: Annotated[tuple[Fraction, ...], rules(maxItems=1000)]
    error: Fraction

    @classmethod
    def of(cls, element: Series) -> StoredFunction:
        """A function that is enclosed in the algebra, with fewer bits."""
        return cls._rounded(known_part(element, 0), error_of(element), element.arithmetic.bits - _BITS_LEFT_OUT)

    @classmethod
    def near(cls, coefficients: Sequence[arb], error: arb) -> StoredFunction:
        """The functions with coefficients in finite balls, and a rest of at most `error`."""
        middles = [exact_value(ball.mid()) for ball in coefficients]
        unknown = [error, *(ball.rad() for ball in coefficients)]
        return cls._rounded(middles, sum((exact_value(bound.abs_upper()) for bound in unknown), Fraction(0)))

    @classmethod
    def _rounded(cls, coefficients: Sequence[Fraction], error: Fraction, bits: int = 0) -> StoredFunction:
        """With so many significant bits, or `_BITS` if that is more."""
        largest = max((abs(value) for value in coefficients), default=Fraction(0))
        unit = Fraction(2) ** (_exponent(largest) - max(_BITS, bits))
        rounded = [round(value / unit) * unit for value in coefficients]
        while rounded and not rounded[-1]:
            rounded.pop()
        lost = unit * len(coefficients)
        bound = (error + lost) * _SPARE
        step = Fraction(2) ** (_exponent(bound) - _ERROR_BITS)
        return cls(tuple(rounded), -(-bound // step) * step)

    @cached_property
    def enclosed(self) -> BoundedFunction:
        """The functions that it stands for. Raises `ValueError` if it is none that is stored."""
        if self.error < 0:
            raise ValueError("a bound is negative")
        if any(abs(value) >= _MOST**2 for value in (self.error, *self.coefficients)):
            raise ValueError("a function is larger than any that is stored")
        return BoundedFunction(ball_polynomial(list(self.coefficients)), symmetric(self.error).rad())


def _exponent(value: Fraction) -> int:
    """The least e, up to rounding upwards, with value <= 2^e; small for zero."""
    if value <= Fraction(1, 2**400):
        return -400
    return ceil(log2(value.numerator) - log2(value.denominator) + 1e-9)
