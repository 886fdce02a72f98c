"""That H is a first integral: grad H . f = 0, as an identity of functions (section 1.4).

The programs of f and H are evaluated in a ring of polynomials over Q in state, parameters and one symbol
s = u^(-1/q) for every divisor and every base u of a power; the derivative of H along f is then zero or it is not.
A few lines of a program can describe polynomials that no memory holds: before each operation its size is bounded, and
what would be too large is not shown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import ceil, lcm

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from orbitproof.shared.systems import Program

_MOST_BITS = 20_000
"""Bits of the coefficients of a polynomial, as of the numbers in a formula (`shared.systems.formulas`)."""
_MOST_DEGREE = 10_000
_MOST_WORDS = 2 * 10**7
"""The largest number of words of 64 bits, in the product of two polynomials before equal terms are collected."""
_MOST_WORK = 10**9
"""Words of all products together."""


@cache
def is_first_integral(field: Program, integral: Program, ring_of: Callable[..., Ring] | None = None) -> bool:
    """Whether the derivative of H along x' = f(x) is shown to vanish, and H to be defined wherever f is.

    False also where that takes a relation between the bases of different powers, or polynomials that are too large.

    Args:
        field: f; inputs are the state, then the parameters.
        integral: H, of the same inputs.
        ring_of: makes the ring of both, with what else is known of the inputs; by default `Ring`.
    """
    try:
        ring = (ring_of or Ring)(field, integral)
        velocity = [output.value for output in field.evaluate(ring.inputs, ring.constant, AlongFlow.power)]
        ring.is_closed = True
        inputs = [AlongFlow(ring, x.value, rate) for x, rate in zip(ring.inputs, velocity, strict=False)]
        inputs += ring.inputs[len(velocity) :]
        (value,) = integral.evaluate(inputs, ring.constant, AlongFlow.power)
        return ring.vanishes(value.rate)
    except NotShownError:
        return False


def derivative_terms(function: Program, name: str) -> dict[tuple[int, ...], Fraction] | None:
    """The derivative of a function of one value in the input `name`, as a coefficient for each tuple of exponents.

    `None` if that input is in a divisor or in a base of a power, or if the derivative is no polynomial of the inputs,
    or one that is too large.
    """
    ring = Ring(function, function)
    unit, zero = ring.polynomials.constant(1), ring.polynomials.constant(0)
    inputs = [
        AlongFlow(ring, x.value, unit if argument == name else zero)
        for x, argument in zip(ring.inputs, function.inputs, strict=True)
    ]
    try:
        (value,) = function.evaluate(inputs, ring.constant, AlongFlow.power)
    except NotShownError:
        return None
    terms, place = value.rate.to_dict(), function.inputs.index(name)
    if any(base.degrees()[place] for base, _ in ring.symbols) or any(any(e[ring.first :]) for e in terms):
        return None
    return {tuple(map(int, exponents[: ring.first])): Fraction(int(c.p), int(c.q)) for exponents, c in terms.items()}


class NotShownError(Exception):
    """A divisor is zero, H divides by or takes a power of something that f does not, or a polynomial is too large."""


class Ring:
    """Polynomials in the inputs of programs and the symbols s = u^(-1/q) that were needed so far.

    Attributes:
        symbols: u and q of each symbol.
        is_closed: whether only what was divided by before may be divided by again.
    """

    def __init__(self, *programs: Program) -> None:
        steps = [step for program in programs for step in program.instructions]
        number = sum(step.operation in ("div", "pow") for step in steps)
        self.first = len(programs[0].inputs)
        self.variables, self.work = self.first + number, 0
        # Generators are told apart by their places; the system's own names are not used.
        self.polynomials = fmpq_mpoly_ctx.get([f"x{i}" for i in range(self.variables)], Ordering.lex)
        zero = self.polynomials.constant(0)
        self.inputs = [AlongFlow(self, x, zero) for x in self.polynomials.gens()[: self.first]]
        self.symbols: list[tuple[fmpq_mpoly, int]] = []
        self.is_closed = False

    def constant(self, value: Fraction) -> AlongFlow:
        """A constant function."""
        number = self.polynomials.constant(fmpq(value.numerator, value.denominator))
        return AlongFlow(self, number, self.polynomials.constant(0))

    def power(self, base: fmpq_mpoly, exponent: Fraction) -> fmpq_mpoly:
        """The power; a base of a fraction is positive and one of a negative number is not zero where f is defined.

        Whole powers of a number are numbers: they need no symbol.
        """
        if base.is_constant() and exponent.denominator == 1 and not base.is_zero():
            number = self._whole_power(base, abs(exponent.numerator))
            return number if exponent >= 0 else self.polynomials.constant(1 / number.leading_coefficient())
        whole = max(0, ceil(exponent))
        rest = whole - exponent
        result = self._whole_power(base, whole)
        if not rest:
            return result
        return self.product(result, self._whole_power(self._symbol(base, rest.denominator), rest.numerator))

    def _whole_power(self, base: fmpq_mpoly, exponent: int) -> fmpq_mpoly:
        result = self.polynomials.constant(1)
        for digit in f"{exponent:b}":
            result = self.product(result, result)
            if digit == "1":
                result = self.product(result, base)
        return result

    def product(self, left: fmpq_mpoly, right: fmpq_mpoly) -> fmpq_mpoly:
        """The product, if it is not too large."""
        if left.is_zero() or right.is_zero():
            return self.polynomials.constant(0)
        bits = _bits(left) + _bits(right)
        words = len(left) * len(right) * (self.variables + bits // 64 + 1)
        self.work += words
        degree = left.total_degree() + right.total_degree()
        if bits > _MOST_BITS or degree > _MOST_DEGREE or words > _MOST_WORDS or self.work > _MOST_WORK:
            raise NotShownError
        return left * right

    def sum(self, left: fmpq_mpoly, right: fmpq_mpoly) -> fmpq_mpoly:
        """The sum, if it is not too large."""
        self.work += (len(left) + len(right)) * self.variables
        if _bits(left) + _bits(right) > _MOST_BITS or self.work > _MOST_WORK:
            raise NotShownError
        return left + right

    def _symbol(self, base: fmpq_mpoly, order: int) -> fmpq_mpoly:
        if (base, order) not in self.symbols:
            defined = any(known == base and (order == 1 or other > 1) for known, other in self.symbols)
            if self.vanishes(base) or (self.is_closed and not defined):
                raise NotShownError
            self.symbols.append((base, order))
        return self.polynomials.gen(self.first + self.symbols.index((base, order)))

    def vanishes(self, polynomial: fmpq_mpoly) -> bool:
        """Whether it is zero by s^q u = 1 alone: multiplied by powers of the u, its degree in each s falls below q."""
        for number in reversed(range(len(self.symbols))):
            base, order = self.symbols[number]
            place = self.first + number
            parts: dict[int, dict[tuple[int, ...], fmpq]] = {}
            for exponents, value in polynomial.to_dict().items():
                whole, rest = divmod(int(exponents[place]), order)
                parts.setdefault(whole, {})[(*exponents[:place], rest, *exponents[place + 1 :])] = value
            most = max(parts, default=0)
            polynomial = self.polynomials.constant(0)
            for whole, part in parts.items():
                lifted = self._whole_power(base, most - whole)
                polynomial = self.sum(polynomial, self.product(self.polynomials.from_dict(part), lifted))
        return self.is_zero(polynomial)

    def is_zero(self, polynomial: fmpq_mpoly) -> bool:
        """Whether a polynomial of the inputs vanishes."""
        return bool(polynomial.is_zero())


@dataclass(frozen=True)
class AlongFlow:
    """A function on an orbit and its derivative in time."""

    ring: Ring
    value: fmpq_mpoly
    rate: fmpq_mpoly

    def __add__(self, other: AlongFlow) -> AlongFlow:
        ring = self.ring
        return AlongFlow(ring, ring.sum(self.value, other.value), ring.sum(self.rate, other.rate))

    def __sub__(self, other: AlongFlow) -> AlongFlow:
        ring = self.ring
        return AlongFlow(ring, ring.sum(self.value, -other.value), ring.sum(self.rate, -other.rate))

    def __mul__(self, other: AlongFlow) -> AlongFlow:
        ring = self.ring
        rate = ring.sum(ring.product(self.rate, other.value), ring.product(self.value, other.rate))
        return AlongFlow(ring, ring.product(self.value, other.value), rate)

    def __truediv__(self, other: AlongFlow) -> AlongFlow:
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> AlongFlow:
        """By d(u^a) = a u^(a - 1) du."""
        value = self.ring.power(self.value, exponent)
        if exponent == 0:
            return self.ring.constant(Fraction(1))
        slope = self.ring.power(self.value, exponent - 1) * fmpq(exponent.numerator, exponent.denominator)
        return AlongFlow(self.ring, value, self.ring.product(slope, self.rate))


def _bits(polynomial: fmpq_mpoly) -> int:
    """Bits of a polynomial's coefficients, written as integers over one denominator."""
    longest, common = 0, 1
    for value in polynomial.coeffs():
        denominator = int(value.q)
        if common % denominator:
            common = lcm(common, denominator)
            if common.bit_length() > _MOST_BITS:
                break
        longest = max(longest, int(value.p).bit_length())
    return longest + common.bit_length()
