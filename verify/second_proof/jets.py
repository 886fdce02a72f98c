"""Jets: truncated power series in several variables with coefficients in balls. README, section 2."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, product
from typing import Any

from flint import acb, arb, arb_mat, arb_series, ctx, fmpq

Monomial = tuple[int, ...]
"""The variables of a product in ascending order, each as often as it occurs: () is 1, (0, 0, 2) is v_0^2 v_2."""


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
def joined(a: Monomial, b: Monomial) -> Monomial:
    """The product of two monomials."""
    return tuple(sorted(a + b))


class Jet(dict[Monomial, Any]):
    """Coefficients of a power series truncated after order `degree`; one that is absent is an exact zero.

    Coefficients are arb, acb, or arb_series for functions of time.
    """

    __slots__ = ("degree",)

    def __init__(self, terms: Mapping[Monomial, Any], degree: int) -> None:
        super().__init__(terms)
        self.degree = degree

    def __missing__(self, key: Monomial) -> arb:
        return arb(0)

    def map(self, change: Callable[[Any], Any]) -> Jet:
        """Every coefficient changed."""
        return Jet({a: change(c) for a, c in self.items()}, self.degree)

    def varying(self) -> Jet:
        """The jet without its constant."""
        return Jet({a: c for a, c in self.items() if a}, self.degree)

    def __add__(self, other: Jet) -> Jet:
        return Jet({**self, **{a: self[a] + c if a in self else c for a, c in other.items()}}, self.degree)

    def __sub__(self, other: Jet) -> Jet:
        return self + other * -1

    def __mul__(self, other: Any) -> Jet:
        if not isinstance(other, Jet):
            return self.map(lambda c: c * other)
        if not self.degree:
            return Jet({(): self[()] * other[()]}, 0)
        square, result = other is self, Jet({}, self.degree)
        pairs = combinations_with_replacement(self.items(), 2) if square else product(self.items(), other.items())
        for (a, x), (b, y) in pairs:
            if len(a) + len(b) <= self.degree:
                key, term = joined(a, b), x * y
                term = term + term if square and a != b else term
                result[key] = result[key] + term if key in result else term
        return result

    def __truediv__(self, other: Jet) -> Jet:
        return self * other ** Fraction(-1)

    def __pow__(self, exponent: Fraction) -> Jet:
        """A power with denominator 1 or 2. README, Lemma 1."""
        result, rest = Jet({(): arb(1)}, self.degree), self.varying()
        if exponent >= 0 and exponent.denominator == 1:
            for _ in range(int(exponent)):
                result = result * self
            return result
        value, inverse = _power_and_reciprocal(self[()], exponent)
        result, ascent = Jet({(): value}, self.degree), rest
        for j in range(self.degree):
            value = value * inverse * ball((exponent - j) / (j + 1))
            ascent = ascent * rest if j else rest
            result = result + ascent * value
        return result


def _power_and_reciprocal(head: Any, exponent: Fraction) -> tuple[Any, Any]:
    """A negative power of a number or of a function of time, or one with denominator 2, and the reciprocal."""
    half, first = exponent.denominator == 2, head[0] if isinstance(head, arb_series) else head
    if half and not (first.real if isinstance(first, acb) else first) > 0:
        # The principal root is analytic on the right half plane.
        raise CannotFollow("the root of an enclosure that is not certainly positive")
    if first.contains(0):
        raise CannotFollow("division by an enclosure that contains zero")
    root = head.rsqrt() if half else 1 / head
    value = factor = root if exponent < 0 else head * root
    for _ in range(int(abs(exponent) * exponent.denominator) - 1):
        value = value * factor
    return value, root * root if half else root


def power(number: Any, exponent: Fraction) -> Any:
    """A power of a number, as of jets of degree 0."""
    whole = exponent >= 0 and exponent.denominator == 1
    return number ** int(exponent) if whole else _power_and_reciprocal(number, exponent)[0]


def constant(kind: Any, value: Fraction) -> Any:
    """An exact rational as a jet like this one, or as a number among numbers."""
    return Jet({(): ball(value)} if value else {}, kind.degree) if isinstance(kind, Jet) else ball(value)


def combine(jets: Sequence[Jet], factors: Sequence[Any], degree: int) -> Jet:
    """A linear combination."""
    return sum((jet * factor for jet, factor in zip(jets, factors, strict=True)), Jet({}, degree))


def substitute(jets: Sequence[Jet], inner: Mapping[int, Jet]) -> list[Jet]:
    """The jets with some variables replaced by jets without constant; the others stay."""
    degree = jets[0].degree
    known: dict[Monomial, Jet] = {(): Jet({(): arb(1)}, degree)}

    def monomial(a: Monomial) -> Jet:
        if a not in known:
            last = a[-1]
            known[a] = monomial(a[:-1]) * (inner[last] if last in inner else Jet({(last,): arb(1)}, degree))
        return known[a]

    return [combine([monomial(a) for a in jet], list(jet.values()), degree) for jet in jets]


def implicit(equations: Sequence[Jet], unknowns: Sequence[int]) -> dict[int, Jet]:
    """The jets, without constant, of the functions u of the other variables with E = 0. README, section 2.

    Constants of the equations are not used: they are zero at the points that the jets are about.
    """
    degree, units = equations[0].degree, [(u,) for u in unknowns]
    # The inverse of a matrix of balls contains the inverses of all its matrices, or there is an exception.
    inverse = arb_mat([[e[u] for u in units] for e in equations]).inv().tolist()
    rest = [Jet({a: -c for a, c in e.items() if a and a not in units}, degree) for e in equations]
    found = {u: Jet({}, degree) for u in unknowns}
    for _ in range(degree):
        values = substitute(rest, found)
        found = {u: combine(values, row, degree) for u, row in zip(unknowns, inverse, strict=True)}
    return found
