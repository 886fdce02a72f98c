"""The arithmetic of `theory/Elements.v` and `theory/Programs.v` once more, to the last unit, so that its results can be
written down as claims. Nothing rests on it: Coq computes all of it again and compares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, product

from flint import fmpz_poly

Poly = list[int]
Norm = list[int]


class NotShownError(Exception):
    """A check of Coq would fail."""


def up(x: int, k: int) -> int:
    """x / 2^k, rounded up; exact for k <= 0."""
    return x << -k if k <= 0 else -(-x >> k)


def down(x: int, k: int) -> int:
    """x / 2^k, rounded down."""
    return x << -k if k <= 0 else x >> k


def quotient_up(a: int, b: int) -> int:
    """a / b, rounded up."""
    return -(-a // b)


def l1(p: Sequence[int]) -> int:
    """The sum of the absolute values of coefficients."""
    return sum(map(abs, p))


def padd(p: Poly, q: Poly) -> Poly:
    """A sum of polynomials."""
    if len(p) < len(q):
        p, q = q, p
    return [a + b for a, b in zip(p, q, strict=False)] + p[len(q) :]


def psub(p: Poly, q: Poly) -> Poly:
    """A difference of polynomials."""
    return padd(p, [-c for c in q])


def pderiv(p: Poly) -> Poly:
    """The derivative of a polynomial."""
    return [n * c for n, c in enumerate(p)][1:]


def recentred(c: int, e: int, p: Poly) -> tuple[Poly, int]:
    """p((c + s) / 2^e) in s, times a power of 2, and the exponent of that."""
    degree = max(len(p) - 1, 0)
    whole = fmpz_poly([a << e * (degree - n) for n, a in enumerate(p)])
    moved = [int(a) for a in whole(fmpz_poly([c, 1])).coeffs()] if p else []
    return moved, e * degree


@dataclass(frozen=True)
class Format:
    """As `format` of `theory/Elements.v`."""

    weights: tuple[int, ...]
    top: int
    bits: int
    grade_bits: int
    kept: int
    eps: int

    @cached_property
    def monomials(self) -> list[tuple[int, ...]]:
        """By grade, then in the order of the exponents."""
        every = list(product(*(range(self.top // w + 1) for w in self.weights)))
        return [e for g in range(self.top + 1) for e in every if self.grade(e) == g]

    def grade(self, exponents: Sequence[int]) -> int:
        """The weighted degree."""
        return sum(w * e for w, e in zip(self.weights, exponents, strict=True))

    @cached_property
    def grades(self) -> list[int]:
        """Of the monomials."""
        return [self.grade(e) for e in self.monomials]

    @cached_property
    def pairs(self) -> list[list[tuple[int, int]]]:
        """For each monomial, the pairs whose product it is."""
        place = {e: n for n, e in enumerate(self.monomials)}
        table: list[list[tuple[int, int]]] = [[] for _ in place]
        for a, i in place.items():
            for b, j in place.items():
                found = place.get(tuple(x + y for x, y in zip(a, b, strict=True)))
                if found is not None:
                    table[found].append((i, j))
        return table

    @cached_property
    def coarse(self) -> Format:
        """That of bounds of derivatives."""
        return Format((), self.top, min(96, self.bits), 0, min(25, self.kept), self.eps)

    def of_degree(self, degree: int) -> Format:
        """Another degree."""
        return replace(self, kept=degree + 1)

    def scale(self, grade: int) -> int:
        """Fractional bits of a grade."""
        return self.bits + grade * self.grade_bits

    def bound(self, x: int, scale: int) -> int:
        """A number of a scale as a bound."""
        return up(x, scale - self.eps)

    def rounding(self, grade: int) -> int:
        """What rounding changes of a polynomial."""
        return self.bound(self.kept, self.scale(grade))

    def nothing(self) -> Norm:
        """No errors."""
        return [0] * (self.top + 2)

    def products(self, a: Norm, b: Norm) -> Norm:
        """All products of bounds, of twice the scale."""
        result, last = self.nothing(), self.top + 1
        for i, x in enumerate(a):
            if x:
                for j, y in enumerate(b):
                    result[min(i + j, last)] += x * y
        return result

    def conv(self, a: Norm, b: Norm) -> Norm:
        """Bounds of a product."""
        return [up(x, self.eps) for x in self.products(a, b)]

    def geometric(self, e: Norm) -> Norm:
        """Bounds of the sum of all powers."""
        one, whole = 1 << self.eps, sum(e)
        if not 2 * whole < one:
            raise NotShownError("a power is not bounded")
        low: list[int] = []
        for g in range(self.top + 1):
            mixed = sum(e[i] * low[g - i] for i in range(1, g + 1))
            low.append(quotient_up((e[g] << self.eps) + mixed, one - e[0]))
        above = self.products([0, *e[1:-1], 0], [*low, 0])[-1]
        return [*low, quotient_up(e[-1] * (one + sum(low)) + above, one - whole)]

    def const(self, value: Fraction) -> Element:
        """A number, rounded down."""
        shifted = value.numerator << self.bits
        c = shifted // value.denominator
        errors = self.nothing()
        errors[0] = 0 if c * value.denominator == shifted else self.bound(1, self.bits)
        return Element(self, [[c] if g == 0 else [] for g in self.grades], errors)


def nadd(a: Norm, b: Norm) -> Norm:
    """A sum of bounds."""
    return [x + y for x, y in zip(a, b, strict=True)]


class Element:
    """As `element` of `theory/Elements.v`."""

    def __init__(self, form: Format, known: list[Poly], unknown: Norm) -> None:
        self.form, self.known, self.unknown = form, known, unknown
        self.size = form.nothing()
        for g, p in zip(form.grades, known, strict=True):
            self.size[g] += form.bound(l1(p), form.scale(g))

    def __add__(self, other: Element) -> Element:
        known = [padd(p, q) for p, q in zip(self.known, other.known, strict=True)]
        return Element(self.form, known, nadd(self.unknown, other.unknown))

    def __sub__(self, other: Element) -> Element:
        known = [psub(p, q) for p, q in zip(self.known, other.known, strict=True)]
        return Element(self.form, known, nadd(self.unknown, other.unknown))

    def scaled(self, value: Fraction) -> Element:
        """The product with an exact number."""
        n, d = value.numerator, value.denominator
        errors = [quotient_up(abs(n) * e, d) for e in self.unknown]
        if d == 1:
            return Element(self.form, [[n * c for c in p] for p in self.known], errors)
        for g in self.form.grades:
            errors[g] += self.form.rounding(g)
        return Element(self.form, [[n * c // d for c in p] for p in self.known], errors)

    def __mul__(self, other: Element) -> Element:
        form, n = self.form, self.form.kept
        errors = form.nothing()
        left, right = [fmpz_poly(p) for p in self.known], [fmpz_poly(p) for p in other.known]
        suffixes = [list(accumulate(map(abs, reversed(q)), initial=0))[::-1] for q in other.known]
        known = []
        for g, pairs in zip(form.grades, form.pairs, strict=True):
            exact, rest = fmpz_poly([]), 0
            for i, j in pairs:
                if self.known[i] and other.known[j]:
                    exact += left[i] * right[j]
                    p, suffix = self.known[i], suffixes[j]
                    for m, a in enumerate(p):
                        cut = max(n - m, 0)
                        if cut < len(suffix) - 1:
                            rest += abs(a) * suffix[cut]
            known.append([down(int(c), form.bits) for c in exact.coeffs()[:n]])
            errors[g] += form.rounding(g) + form.bound(rest, form.scale(g) + form.bits)
        errors[-1] += form.conv(self.size, other.size)[-1]
        errors = nadd(errors, form.conv(self.size, other.unknown))
        errors = nadd(errors, form.conv(self.unknown, nadd(other.size, other.unknown)))
        return Element(form, known, errors)

    def power(self, p: int, q: int, guess: list[Poly]) -> Element:
        """base^(-p/q) from a guess."""
        form = self.form
        s = Element(form, guess, form.nothing())
        mixed = s * self
        shared = min(p, q)
        whole = times(q - shared, s, times(p - shared, self, times(shared - 1, mixed, mixed)))
        distance = Element(form, [padd(whole.known[0], [-(1 << form.bits)]), *whole.known[1:]], whole.unknown)
        if q > 1 and not (first_of(s) > 0 and first_of(self) > 0):
            raise NotShownError("a base is not positive")
        series = form.geometric(nadd(distance.size, distance.unknown))
        relative = [quotient_up(x, q) for x in series]
        return Element(form, guess, nadd(s.unknown, form.conv(nadd(s.size, s.unknown), relative)))


def first_of(a: Element) -> int:
    """The constant coefficient."""
    return a.known[0][0] if a.known[0] else 0


def times(n: int, a: Element, b: Element) -> Element:
    """b a^n."""
    for _ in range(n):
        b = b * a
    return b


@dataclass(frozen=True)
class Node:
    """As `node` of `theory/Programs.v`: const, add, sub, mul, scale or power (value: p, q of a power -p/q)."""

    operation: str
    places: tuple[int, ...] = ()
    value: Fraction = Fraction(0)


@dataclass(frozen=True)
class Program:
    """As `program` of `theory/Programs.v`."""

    inputs: int
    nodes: tuple[Node, ...]
    outputs: tuple[int, ...]

    @property
    def number_of_powers(self) -> int:
        """How many guesses are needed."""
        return sum(node.operation == "power" for node in self.nodes)


Slope = Element | int
"""0, 1 or an element."""


def run(
    program: Program,
    form: Format,
    guesses: Sequence[list[Poly]] | Callable[[Element, int, int], list[Poly]],
    given: Sequence[Element],
) -> list[Element]:
    """The values of all nodes. Guesses are those of the powers in order, or a function that finds one."""
    values = list(given)
    number = 0
    for node in program.nodes:
        at = [values[i] for i in node.places]
        match node.operation:
            case "const":
                values.append(form.const(node.value))
            case "add":
                values.append(at[0] + at[1])
            case "sub":
                values.append(at[0] - at[1])
            case "mul":
                values.append(at[0] * at[1])
            case "scale":
                values.append(at[0].scaled(node.value))
            case "power":
                p, q = -node.value.numerator, node.value.denominator
                guess = guesses(at[0], p, q) if callable(guesses) else guesses[number]
                values.append(at[0].power(p, q, guess))
                number += 1
    return values


def values_at(program: Program, values: Sequence[Element]) -> list[Element]:
    """Those of the outputs."""
    return [values[i] for i in program.outputs]


def slopes(program: Program, size: int, values: Sequence[Element], form: Format) -> list[list[Slope]]:
    """The derivatives of the outputs by the first inputs."""

    def element(s: Slope) -> Element:
        return s if isinstance(s, Element) else form.const(Fraction(s))

    def add(a: Slope, b: Slope) -> Slope:
        if isinstance(a, int) and a == 0:
            return b
        if isinstance(b, int) and b == 0:
            return a
        return element(a) + element(b)

    def scaled(a: Slope, value: Fraction) -> Slope:
        if isinstance(a, int) and a == 0:
            return 0
        return a if value == 1 else element(a).scaled(value)

    def mul(a: Slope, x: Element) -> Slope:
        if isinstance(a, int):
            return x if a else 0
        return a * x

    found: list[list[Slope]] = [[int(i == j) for j in range(size)] for i in range(program.inputs)]
    for k, node in enumerate(program.nodes, start=program.inputs):
        d = [found[i] for i in node.places]
        at = [values[i] for i in node.places]
        match node.operation:
            case "const":
                row: list[Slope] = [0] * size
            case "add":
                row = list(map(add, *d))
            case "sub":
                row = list(map(add, d[0], [scaled(s, Fraction(-1)) for s in d[1]]))
            case "mul" if node.places[0] == node.places[1]:
                half = [mul(s, at[0]) for s in d[0]]
                row = list(map(add, half, half))
            case "mul":
                row = list(map(add, [mul(s, at[1]) for s in d[0]], [mul(s, at[0]) for s in d[1]]))
            case "scale":
                row = [scaled(s, node.value) for s in d[0]]
            case _:
                p, q, power = -node.value.numerator, node.value.denominator, values[k]
                if any(isinstance(s, Element) or s for s in d[0]):
                    reciprocal = times(q - 1, power, times(p - 1, at[0], power))
                    outer = (power * reciprocal).scaled(node.value)
                    row = [mul(s, outer) for s in d[0]]
                else:
                    row = [0] * size
        found.append(row)
    return [found[i] for i in program.outputs]
