"""Jets: truncated power series in a few variables, coefficients in any ring of balls. README, section 2."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from functools import cache
from itertools import product
from typing import Any

from flint import acb, arb, arb_mat, arb_series, ctx, fmpq

from .statement import Program

Exponents = tuple[int, ...]
Jet = dict[Exponents, Any]
"""Coefficients by exponents; one that is absent is an exact zero."""


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


@cache
def monomials(variables: int, degree: int) -> tuple[Exponents, ...]:
    """Exponents of all monomials of exactly this degree."""
    return tuple(a for a in product(range(degree + 1), repeat=variables) if sum(a) == degree)


@cache
def unit(variables: int, place: int) -> Exponents:
    """Exponents of one variable."""
    return tuple(int(i == place) for i in range(variables))


@cache
def _joined(a: Exponents, b: Exponents) -> tuple[Exponents, int]:
    joined = tuple(i + j for i, j in zip(a, b, strict=True))
    return joined, sum(joined)


def add(left: Jet, right: Jet) -> Jet:
    """left + right."""
    return {**left, **{a: left[a] + c if a in left else c for a, c in right.items()}}


def scale(factor: Any, jet: Jet) -> Jet:
    """A number times a jet."""
    return {a: factor * c for a, c in jet.items()}


def varying(jet: Jet) -> Jet:
    """The jet without its constant."""
    return {a: c for a, c in jet.items() if any(a)}


def combine(factors: Sequence[Any], jets: Sequence[Jet]) -> Jet:
    """A linear combination."""
    total: Jet = {}
    for factor, jet in zip(factors, jets, strict=True):
        total = add(total, scale(factor, jet))
    return total


def multiply(left: Jet, right: Jet, degree: int) -> Jet:
    """The product, truncated after `degree`."""
    result: Jet = {}
    for i, (a, x) in enumerate(left.items()):
        for j, (b, y) in enumerate(right.items()):
            joined, order = _joined(a, b)
            if order > degree or (left is right and j < i):
                continue
            term = x * y
            if left is right and j > i:
                term = term + term
            result[joined] = result[joined] + term if joined in result else term
    return result


def power(base: Jet, exponent: Fraction, degree: int) -> Jet:
    """base to an exponent with denominator 1 or 2. README, Lemma 1."""
    zero = next(iter(base))
    zero = tuple(0 for _ in zero)
    if exponent.denominator == 1 and exponent >= 0:
        result: Jet = {zero: arb(1)}
        for _ in range(int(exponent)):
            result = multiply(result, base, degree)
        return result
    head = base.get(zero, arb(0))
    if exponent.denominator == 2:
        # The principal root is analytic on the right half plane.
        first = head[0] if isinstance(head, arb_series) else head.real if isinstance(head, acb) else head
        if not first > 0:
            raise CannotFollow("the root of an enclosure that is not certainly positive")
        root = head.rsqrt()
        inverse, base_root = root * root, root if exponent < 0 else head * root
        value, times = base_root, int(2 * abs(exponent))
    else:
        first = head[0] if isinstance(head, arb_series) else head
        if first.contains(0):
            raise CannotFollow("division by an enclosure that contains zero")
        base_root = value = inverse = 1 / head
        times = int(-exponent)
    for _ in range(times - 1):
        value = value * base_root
    small, result, ascent = varying(base), {zero: value}, {zero: arb(1)}
    for j in range(degree):
        value = value * inverse * ball((exponent - j) / (j + 1))
        ascent = multiply(ascent, small, degree)
        result = add(result, scale(value, ascent))
    return result


def evaluate(text: Program, inputs: Mapping[str, Jet], zero: Exponents, degree: int) -> list[Jet]:
    """The outputs of a program on jets: by induction over its lines each encloses the jet of that line."""
    values: list[Jet] = []
    for operation, operands, value, name in text.lines:
        sides = [values[i] for i in operands]
        match operation:
            case "name":
                values.append(inputs[name])
            case "constant":
                values.append({zero: ball(value)})
            case "+":
                values.append(add(sides[0], sides[1]))
            case "-":
                values.append(add(sides[0], scale(-1, sides[1])))
            case "*":
                values.append(multiply(sides[0], sides[1], degree))
            case "/":
                values.append(multiply(sides[0], power(sides[1], Fraction(-1), degree), degree))
            case _:
                values.append(power(sides[0], value, degree))
    return [{} if i is None else values[i] for i in text.outputs]


def substitute(jet: Jet, inner: Sequence[Jet], zero: Exponents, degree: int) -> Jet:
    """A jet whose variables are replaced by jets without constant."""
    powers = [[{zero: arb(1)}] for _ in inner]
    for ladder, value in zip(powers, inner, strict=True):
        for _ in range(degree):
            ladder.append(multiply(ladder[-1], value, degree))
    result: Jet = {}
    for a, c in jet.items():
        term: Jet = {zero: c}
        for ladder, e in zip(powers, a, strict=True):
            if e:
                term = multiply(ladder[e], term, degree)
        result = add(result, term)
    return result


def implicit(equations: Sequence[Jet], size: int, degree: int) -> list[Jet]:
    """The jets, without constant, of u(v) with E(v, u) = 0, `size` variables v. README, section 2.

    Constants of the equations are not used: they are zero at the points that the jets are about.
    """
    count = len(equations)
    units = [unit(size + count, size + i) for i in range(count)]
    # The inverse of a matrix of balls contains the inverses of all its matrices, or there is an exception.
    inverse = arb_mat([[e.get(a, arb(0)) for a in units] for e in equations]).inv().tolist()
    rest = [{a: -c for a, c in varying(e).items() if a not in units} for e in equations]
    zero = tuple(0 for _ in range(size))
    variables: list[Jet] = [{unit(size, i): arb(1)} for i in range(size)]
    found: list[Jet] = [{} for _ in range(count)]
    for _ in range(degree):
        values = [substitute(e, [*variables, *found], zero, degree) for e in rest]
        found = [combine(row, values) for row in inverse]
    return found
