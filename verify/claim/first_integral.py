"""That H is a first integral: grad H . f = 0, as an identity of functions (section 1.4).

The programs of f and H are evaluated in a ring of polynomials over Q in state, parameters and one symbol
s = u^(-1/q) for every divisor and every base u of a power; the derivative of H along f is then zero or it is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import ceil

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from orbitproof.shared.systems import Program


@cache
def is_first_integral(field: Program, integral: Program) -> bool:
    """Whether the derivative of H along x' = f(x) is shown to vanish, and H to be defined wherever f is.

    False also where that takes a relation between the bases of different powers.

    Args:
        field: f; inputs are the state, then the parameters.
        integral: H, of the same inputs.
    """
    ring = _Ring(field, integral)
    inputs = ring.inputs
    try:
        velocity = [output.value for output in field.evaluate(inputs, ring.constant, _AlongFlow.power)]
        ring.is_closed = True
        inputs = [_AlongFlow(ring, x.value, rate) for x, rate in zip(inputs, velocity, strict=False)]
        inputs += ring.inputs[len(velocity) :]
        (value,) = integral.evaluate(inputs, ring.constant, _AlongFlow.power)
    except _NotDefinedError:
        return False
    return ring.vanishes(value.rate)


def derivative_terms(function: Program, name: str) -> dict[tuple[int, ...], Fraction] | None:
    """The derivative of a function of one value in the input `name`, as a coefficient for each tuple of exponents.

    `None` if that input is in a divisor or in a base of a power, or if the derivative is no polynomial of the inputs.
    """
    ring = _Ring(function, function)
    unit, zero = ring.polynomials.constant(1), ring.polynomials.constant(0)
    inputs = [
        _AlongFlow(ring, x.value, unit if argument == name else zero)
        for x, argument in zip(ring.inputs, function.inputs, strict=True)
    ]
    try:
        (value,) = function.evaluate(inputs, ring.constant, _AlongFlow.power)
    except _NotDefinedError:
        return None
    terms, place = value.rate.to_dict(), function.inputs.index(name)
    if any(base.degrees()[place] for base, _ in ring.symbols) or any(any(e[ring.first :]) for e in terms):
        return None
    return {tuple(map(int, exponents[: ring.first])): Fraction(int(c.p), int(c.q)) for exponents, c in terms.items()}


class _NotDefinedError(Exception):
    """A divisor is zero, or H divides by or takes a power of something that f does not."""


class _Ring:
    """Polynomials in the inputs of two programs and the symbols s = u^(-1/q) that were needed so far.

    Attributes:
        symbols: u and q of each symbol.
        is_closed: whether only what was divided by before may be divided by again.
    """

    def __init__(self, field: Program, integral: Program) -> None:
        steps = [step for program in (field, integral) for step in program.instructions]
        number = sum(step.operation in ("div", "pow") for step in steps)
        names = field.inputs
        self.polynomials = fmpq_mpoly_ctx.get((*names, *(f"s{i}" for i in range(number))), Ordering.lex)
        generators = self.polynomials.gens()
        zero = self.polynomials.constant(0)
        self.inputs = [_AlongFlow(self, x, zero) for x in generators[: len(names)]]
        self.unused = list(generators[len(names) :])
        self.first = len(names)
        self.symbols: list[tuple[fmpq_mpoly, int]] = []
        self.is_closed = False

    def constant(self, value: Fraction) -> _AlongFlow:
        """A constant function."""
        number = self.polynomials.constant(fmpq(value.numerator, value.denominator))
        return _AlongFlow(self, number, self.polynomials.constant(0))

    def power(self, base: fmpq_mpoly, exponent: Fraction) -> fmpq_mpoly:
        """The power; a base of a fraction is positive and one of a negative number is not zero where f is defined.

        Whole powers of a number are numbers: they need no symbol.
        """
        if base.is_constant() and exponent.denominator == 1 and not base.is_zero():
            number = base.leading_coefficient() ** abs(exponent.numerator)
            return self.polynomials.constant(number if exponent >= 0 else 1 / number)
        whole = max(0, ceil(exponent))
        rest = whole - exponent
        result = base**whole
        return result * self._symbol(base, rest.denominator) ** rest.numerator if rest else result

    def _symbol(self, base: fmpq_mpoly, order: int) -> fmpq_mpoly:
        if (base, order) not in self.symbols:
            defined = any(known == base and (order == 1 or other > 1) for known, other in self.symbols)
            if self.vanishes(base) or (self.is_closed and not defined):
                raise _NotDefinedError
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
            polynomial = sum(
                (self.polynomials.from_dict(part) * base ** (most - whole) for whole, part in parts.items()),
                self.polynomials.constant(0),
            )
        return bool(polynomial.is_zero())


@dataclass(frozen=True)
class _AlongFlow:
    """A function on an orbit and its derivative in time."""

    ring: _Ring
    value: fmpq_mpoly
    rate: fmpq_mpoly

    def __add__(self, other: _AlongFlow) -> _AlongFlow:
        return _AlongFlow(self.ring, self.value + other.value, self.rate + other.rate)

    def __sub__(self, other: _AlongFlow) -> _AlongFlow:
        return _AlongFlow(self.ring, self.value - other.value, self.rate - other.rate)

    def __mul__(self, other: _AlongFlow) -> _AlongFlow:
        return _AlongFlow(self.ring, self.value * other.value, self.rate * other.value + self.value * other.rate)

    def __truediv__(self, other: _AlongFlow) -> _AlongFlow:
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> _AlongFlow:
        """By d(u^a) = a u^(a - 1) du."""
        value = self.ring.power(self.value, exponent)
        if exponent == 0:
            return self.ring.constant(Fraction(1))
        slope = self.ring.power(self.value, exponent - 1) * fmpq(exponent.numerator, exponent.denominator)
        return _AlongFlow(self.ring, value, slope * self.rate)
