"""Jets: truncated power series in a few variables, coefficients in any ring of balls. README, section 2."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

from flint import acb, arb, arb_series, ctx, fmpq

from .statement import Program

Jet = list[Any]
"""Coefficients by monomial, in the order of `Monomials.exponents`; None is an exact zero."""


class CannotFollow(Exception):
    """A step of the proof cannot be made; the message says which and why."""


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Work with `bits` bits, and with power series of any length, and restore what was set before."""
    before, cap = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = bits, 1 << 20
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before, cap


def ball(value: Fraction) -> arb:
    """The ball of an exact rational in the working precision."""
    return arb(fmpq(value.numerator, value.denominator))


@dataclass(frozen=True)
class Monomials:
    """The monomials of degree <= `degree` in `variables` variables, by degree, the constant first."""

    variables: int
    degree: int

    @cached_property
    def exponents(self) -> tuple[tuple[int, ...], ...]:
        """Exponents of each monomial."""
        every = product(range(self.degree + 1), repeat=self.variables)
        return tuple(sorted((a for a in every if sum(a) <= self.degree), key=lambda a: (sum(a), a[::-1])))

    @cached_property
    def index(self) -> Mapping[tuple[int, ...], int]:
        """Place of each monomial."""
        return {a: i for i, a in enumerate(self.exponents)}

    @cached_property
    def factors(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """For each monomial all ordered pairs of monomials whose product it is."""
        pairs: list[list[tuple[int, int]]] = [[] for _ in self.exponents]
        for (i, a), (j, b) in product(enumerate(self.exponents), repeat=2):
            if sum(a) + sum(b) <= self.degree:
                pairs[self.index[tuple(map(sum, zip(a, b, strict=True)))]].append((i, j))
        return tuple(map(tuple, pairs))

    def constant(self, value: Any) -> Jet:
        """A constant."""
        return [value] + [None] * (len(self.exponents) - 1)

    def linear(self, value: Any, slopes: Sequence[Any]) -> Jet:
        """value + sum of slopes times variables; a slope None is zero."""
        jet = self.constant(value)
        jet[1 : 1 + self.variables] = slopes
        return jet

    def multiply(self, left: Jet, right: Jet) -> Jet:
        """The truncated product."""
        result: Jet = []
        for pairs in self.factors:
            total = None
            for i, j in pairs:
                if left is right and i > j:
                    continue
                if left[i] is not None and right[j] is not None:
                    term = left[i] * right[j]
                    if left is right and i < j:
                        term = term + term
                    total = term if total is None else total + term
            result.append(total)
        return result

    def compose(self, derivatives: Sequence[Any], inner: Jet) -> Jet:
        """The sum over j of derivatives[j] times (inner without its constant) to the power j."""
        small = [None, *inner[1:]]
        result, power = self.constant(derivatives[0]), self.constant(arb(1))
        for factor in derivatives[1 : self.degree + 1]:
            power = self.multiply(power, small)
            result = add(result, [None if c is None else factor * c for c in power])
        return result

    def power(self, base: Jet, exponent: Fraction) -> Jet:
        """base to an exponent with denominator 1 or 2."""
        head = base[0]
        if exponent.denominator == 2 or exponent < 0:
            root = _inverse_root(head) if exponent.denominator == 2 else None
            inverse = 1 / head if root is None else root * root
            if not _finite(inverse):
                raise CannotFollow("division by an enclosure that contains zero")
        steps: list[Any] = []
        weight = Fraction(1)
        for j in range(self.degree + 1):
            order = exponent - j
            if order.denominator == 2:
                value = _whole_power(root, -2 * order) if order < 0 else _whole_power(head * root, 2 * order)
            else:
                value = _whole_power(inverse, -order) if order < 0 else _whole_power(head, order)
            steps.append(ball(weight) * value)
            weight *= order / (j + 1)
            if weight == 0:
                break
        return self.compose(steps, base)


monomials = lru_cache(maxsize=None)(Monomials)


def _whole_power(base: Any, exponent: Fraction) -> Any:
    result = base
    for _ in range(int(exponent) - 1):
        result = result * base
    return result if exponent else arb(1)


def _finite(value: Any) -> bool:
    return all(c.is_finite() for c in value.coeffs()) if isinstance(value, arb_series) else bool(value.is_finite())


def _inverse_root(value: Any) -> Any:
    """1/sqrt on the right half plane, where the principal root is analytic; elsewhere it is refused."""
    first = value[0] if isinstance(value, arb_series) else value.real if isinstance(value, acb) else value
    if not first > 0:
        raise CannotFollow("the root of an enclosure that is not certainly positive")
    return value.rsqrt()


def add(left: Jet, right: Jet, sign: int = 1) -> Jet:
    """left + right, or left - right for `sign` -1."""
    result: Jet = []
    for a, b in zip(left, right, strict=True):
        if b is None:
            result.append(a)
        elif a is None:
            result.append(b if sign > 0 else -b)
        else:
            result.append(a + b if sign > 0 else a - b)
    return result


def evaluate(text: Program, table: Monomials, inputs: Mapping[str, Jet]) -> list[Jet]:
    """The outputs of a program on jets: by induction over its lines each encloses the jet of that line."""
    values: list[Jet] = []
    for line in text.lines:
        sides = [values[i] for i in line.operands]
        match line.operation:
            case "name":
                values.append(inputs[line.name])
            case "constant":
                values.append(table.constant(ball(line.value)))
            case "+":
                values.append(add(sides[0], sides[1]))
            case "-":
                values.append(add(sides[0], sides[1], -1))
            case "*":
                values.append(table.multiply(sides[0], sides[1]))
            case "/":
                values.append(table.multiply(sides[0], table.power(sides[1], Fraction(-1))))
            case _:
                values.append(table.power(sides[0], line.value))
    return [table.constant(None) if i is None else values[i] for i in text.outputs]


def eliminate(table: Monomials, equation: Jet, functions: Sequence[Jet]) -> list[Jet]:
    """Functions of the first variables once the last one follows from equation = 0. README, section 5.

    The constant coefficient of the equation is not used: it is zero at the points that the jets are about.
    """
    smaller = monomials(table.variables - 1, table.degree)
    unit = table.index[(*[0] * (table.variables - 1), 1)]
    if equation[unit] is None or not (equation[unit] < 0 or equation[unit] > 0):
        raise CannotFollow("the derivative in an implicit equation is not certainly different from zero")
    last: Jet = smaller.constant(None)
    for _ in range(table.degree):
        rest = substitute(table, [None if i in (0, unit) else c for i, c in enumerate(equation)], last)
        last = [None if c is None else -c / equation[unit] for c in rest]
    return [substitute(table, function, last) for function in functions]


def substitute(table: Monomials, function: Jet, last: Jet) -> Jet:
    """A jet whose last variable is replaced by a jet, without constant coefficient, in the others."""
    smaller = monomials(table.variables - 1, table.degree)
    result: Jet = smaller.constant(None)
    power = smaller.constant(arb(1))
    for order in range(table.degree + 1):
        part: Jet = smaller.constant(None)
        for i, a in enumerate(table.exponents):
            if a[-1] == order:
                part[smaller.index[a[:-1]]] = function[i]
        result = add(result, smaller.multiply(part, power))
        power = smaller.multiply(power, last)
    return result
