"""Straight-line programs on power series, one coefficient after another (section 3).

`prepare` rewrites a program so that only additions, products, scalings by constants and negative
powers are left. A `Recurrence` finds the coefficients of all nodes in order, because the solution of a
differential equation is built in the same order. `Evaluation` is that of graded Taylor models, with one
coefficient per monomial; `Evaluation.enclose` then adds the errors and returns rigorous enclosures.
`partial_derivatives` is the chain rule, `at_start` gives values where orbits start and end.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from math import ceil
from operator import add, mul
from typing import Any, Generic, Literal, TypeVar

from flint import fmpz, fmpz_poly

from orbitproof.shared.systems import Program
from orbitproof.verify.algebra.norms import add as sum_of_norms
from orbitproof.verify.algebra.series import ZERO, Arithmetic, Products, Series, correct_power, product_errors
from orbitproof.verify.evidence import IntegrationFailure


@dataclass(frozen=True)
class Node:
    """One operation of a prepared program; `left` and `right` are indices of earlier nodes."""

    operation: Literal["input", "constant", "add", "sub", "mul", "scale", "pow"]
    left: int = -1
    right: int = -1
    value: Fraction = Fraction(0)


@dataclass(frozen=True)
class PreparedProgram:
    """Nodes in order, the first `inputs` being the inputs, and the indices of the outputs."""

    inputs: int
    nodes: tuple[Node, ...]
    outputs: tuple[int, ...]


def prepare(program: Program) -> PreparedProgram:
    """Rewrite divisions and powers with negative exponents and products with constants as scalings."""
    places: dict[Node, int] = {}
    inputs = [_traced(places, Node("input", left=index)) for index in range(len(program.inputs))]
    outputs = program.evaluate(inputs, lambda value: _traced(places, Node("constant", value=value)), _Traced.power)
    return _without_unused(PreparedProgram(len(inputs), tuple(places), tuple(output.index for output in outputs)))


def _traced(places: dict[Node, int], node: Node) -> _Traced:
    return _Traced(places, node, places.setdefault(node, len(places)))


@dataclass(frozen=True)
class _Traced:
    """A node and its place among those so far; operations add the nodes that they need."""

    places: dict[Node, int]
    node: Node
    index: int

    def __add__(self, other: _Traced) -> _Traced:
        return _traced(self.places, Node("add", self.index, other.index))

    def __sub__(self, other: _Traced) -> _Traced:
        return _traced(self.places, Node("sub", self.index, other.index))

    def __mul__(self, other: _Traced) -> _Traced:
        for factor, rest in ((self, other), (other, self)):
            if factor.node.operation == "constant":
                return _traced(self.places, Node("scale", rest.index, value=factor.node.value))
        return _traced(self.places, Node("mul", min(self.index, other.index), max(self.index, other.index)))

    def __truediv__(self, other: _Traced) -> _Traced:
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> _Traced:
        """A negative power times an integer power, which is a product."""
        whole = max(0, ceil(exponent))
        factors = [self] * whole
        if exponent != whole:
            factors.insert(0, _traced(self.places, Node("pow", self.index, value=exponent - whole)))
        if not factors:
            return _traced(self.places, Node("constant", value=Fraction(1)))
        return reduce(mul, factors)


def _without_unused(program: PreparedProgram) -> PreparedProgram:
    needed = set(program.outputs) | set(range(program.inputs))
    for index in range(len(program.nodes) - 1, program.inputs - 1, -1):
        node = program.nodes[index]
        if index in needed:
            needed.update(operand for operand in (node.left, node.right) if operand >= 0)
    new = {old: position for position, old in enumerate(sorted(needed))}
    nodes = []
    for old in sorted(needed):
        node = program.nodes[old]
        if old >= program.inputs:
            node = replace(node, left=new.get(node.left, -1), right=new.get(node.right, -1))
        nodes.append(node)
    return PreparedProgram(program.inputs, tuple(nodes), tuple(new[index] for index in program.outputs))


Coefficient = TypeVar("Coefficient")


class Recurrence(ABC, Generic[Coefficient]):
    """The coefficients of all nodes of a program, each found from those before it.

    Attributes:
        program: the program.
        coefs: one row of coefficients per node, zero where they have not been found.
    """

    def __init__(self, program: PreparedProgram, coefs: Sequence[Any]) -> None:
        self.program = program
        self.coefs = coefs

    def extend(self, n: int) -> None:
        """Find coefficient `n` of every node; those of the inputs and all before it are there."""
        rows = self.coefs
        for index, node in enumerate(self.program.nodes):
            row, left, right = rows[index], rows[node.left], rows[node.right]
            match node.operation:
                case "constant":
                    if n == 0:
                        row[0] = self.constant(index, node.value)
                case "add":
                    row[n] = left[n] + right[n]
                case "sub":
                    row[n] = left[n] - right[n]
                case "scale":
                    row[n] = self.scaled(index, n, left[n], node.value)
                case "mul":
                    row[n] = self.product(index, n, left, right)
                case "pow":
                    row[n] = self.power(index, n, left, node.value)

    @abstractmethod
    def constant(self, index: int, value: Fraction) -> Coefficient:
        """The first coefficient of a constant, node `index`."""

    @abstractmethod
    def scaled(self, index: int, n: int, coefficient: Coefficient, factor: Fraction) -> Coefficient:
        """The product of a coefficient with an exact constant."""

    @abstractmethod
    def product(self, index: int, n: int, left: Sequence[Coefficient], right: Sequence[Coefficient]) -> Coefficient:
        """Coefficient n of a product."""

    @abstractmethod
    def power(self, index: int, n: int, base: Sequence[Coefficient], exponent: Fraction) -> Coefficient:
        """Coefficient n of a power with a negative exponent, by R DS = exponent S DR for a derivation D."""


def _singular() -> IntegrationFailure:
    return IntegrationFailure(
        "singularity",
        "a power or quotient of the vector field could not be bounded on all orbits",
        "the box comes too close to a singularity: give smaller radii or a better centre",
    )


class Evaluation(Recurrence[fmpz_poly]):
    """The known parts of all nodes of a prepared program, monomial by monomial, in the order of the grades."""

    def __init__(self, program: PreparedProgram, arithmetic: Arithmetic) -> None:
        super().__init__(program, [[ZERO] * len(arithmetic.grading.monomials) for _ in program.nodes])
        self.arithmetic = arithmetic
        self.lost: list[list[float]] = [arithmetic.zero_errors() for _ in program.nodes]
        self._inverse: dict[int, fmpz_poly] = {}
        self._inner: dict[tuple[int, int], Products] = {}
        self._counts = True

    def fill(self, position: int, inputs: Sequence[fmpz_poly]) -> None:
        """Compute the coefficient of monomial `position` at every node from those of the inputs.

        All monomials of lower grade must have been filled.
        """
        for row, value in zip(self.coefs, inputs, strict=False):
            row[position] = value
        self.extend(position)
        self._inner = {key: value for key, value in self._inner.items() if key[1] != position}

    def try_out(self, position: int, inputs: Sequence[fmpz_poly]) -> None:
        """As `fill`, for a monomial that is filled later: what is lost now does not count.

        The products of monomials of lower grade, which will be the same, are kept.
        """
        lost, self.lost = self.lost, [self.arithmetic.zero_errors() for _ in self.program.nodes]
        inner, self._counts = self._inner, False
        self.fill(position, inputs)
        self.lost, self._inner, self._counts = lost, inner, True

    def reciprocal(self, index: int) -> fmpz_poly:
        """An approximation of 1 / base at the centre, for a node that is a power."""
        if index not in self._inverse:
            base = self.coefs[self.program.nodes[index].left][0]
            self._inverse[index] = self.arithmetic.power(base, Fraction(-1))
        return self._inverse[index]

    def constant(self, index: int, value: Fraction) -> fmpz_poly:
        """See `Recurrence`; what is lost by rounding and truncation, here and below, is kept for `enclose`."""
        series = self.arithmetic.constant(value)
        self.lost[index][0] += series.errors[0]
        return series.coefs[0]

    def scaled(self, index: int, n: int, coefficient: fmpz_poly, factor: Fraction) -> fmpz_poly:
        """See `Recurrence`."""
        return coefficient * fmpz(factor.numerator) // fmpz(factor.denominator)

    def product(self, index: int, n: int, left: Sequence[fmpz_poly], right: Sequence[fmpz_poly]) -> fmpz_poly:
        """See `Recurrence`."""
        if (index, n) not in self._inner:
            self._inner[index, n] = self.arithmetic.inner_products(left, right, n)
        if not self._counts:
            return self.arithmetic.approximate_slice(left, right, n, self._inner[index, n])
        value, loss = self.arithmetic.product_slice(left, right, n, self._inner[index, n])
        self.lost[index][self.arithmetic.grading.grades[n]] += loss
        return value

    def power(self, index: int, n: int, base: Sequence[fmpz_poly], exponent: Fraction) -> fmpz_poly:
        """See `Recurrence`, with the derivation that multiplies a monomial by its grade; `enclose` corrects it."""
        arithmetic = self.arithmetic
        grades = arithmetic.grading.grades
        if n == 0:
            self._inverse.pop(index, None)
            return arithmetic.power(base[0], exponent, self.coefs[index][0])
        p, q = exponent.numerator, exponent.denominator
        power = self.coefs[index]
        if (index, n) not in self._inner:
            exact = ZERO
            for i, j in arithmetic.grading.inner_factors[n]:
                weight = p * grades[j] - q * grades[i]
                if weight and power[i].length() and base[j].length():
                    exact = exact + power[i] * base[j] * fmpz(weight)
            self._inner[index, n] = exact, 0.0
        exact = self._inner[index, n][0] + power[0] * base[n] * fmpz(p * grades[n])
        if not exact.length():
            return ZERO
        quotient, _ = arithmetic.cut(arithmetic.reduced(exact) * self.reciprocal(index))
        return quotient // (arithmetic.one * fmpz(q * grades[n]))

    def enclose(
        self, inputs: Sequence[Series], unbounded: Callable[[], IntegrationFailure] = _singular
    ) -> list[Series]:
        """Enclosures of all nodes once all monomials are filled from `inputs` (their errors count here).

        Raises what `unbounded` says where a power or quotient cannot be bounded.
        """
        arithmetic = self.arithmetic
        nodes: list[Series] = []
        for index, node in enumerate(self.program.nodes):
            known = Series(arithmetic, self.coefs[index], self.lost[index])
            match node.operation:
                case "input":
                    nodes.append(inputs[index])
                case "constant":
                    nodes.append(known)
                case "add" | "sub":
                    nodes.append(known.with_errors(sum_of_norms(nodes[node.left].errors, nodes[node.right].errors)))
                case "mul":
                    nodes.append(known.with_errors(product_errors(nodes[node.left], nodes[node.right], known.errors)))
                case "scale":
                    nodes.append(nodes[node.left].scaled(node.value))
                case "pow":
                    power = correct_power(known.with_errors(arithmetic.zero_errors()), nodes[node.left], node.value)
                    if power is None:
                        raise unbounded()
                    nodes.append(power)
        return nodes


def enclose_nodes(
    program: PreparedProgram, inputs: Sequence[Series], unbounded: Callable[[], IntegrationFailure] = _singular
) -> list[Series]:
    """Enclosures of the values of all nodes of a program at elements of one arithmetic."""
    arithmetic = inputs[0].arithmetic
    evaluation = Evaluation(program, arithmetic)
    for position in range(len(arithmetic.grading.monomials)):
        evaluation.fill(position, [x.coefs[position] for x in inputs])
    return evaluation.enclose(inputs, unbounded)


def evaluate(program: PreparedProgram, inputs: Sequence[Series]) -> list[Series]:
    """Enclosures of the values of a program at elements of one arithmetic."""
    nodes = enclose_nodes(program, inputs)
    return [nodes[output] for output in program.outputs]


def partial_derivatives(
    program: PreparedProgram,
    size: int,
    values: Sequence[Coefficient],
    one: Coefficient,
    scaled: Callable[[Coefficient, Fraction], Coefficient],
    dot: Callable[[Sequence[tuple[Coefficient, Coefficient]]], Coefficient],
    slope_of_power: Callable[[int], Coefficient],
) -> list[dict[int, Coefficient]]:
    """Derivatives of the outputs with respect to the first `size` inputs, by the chain rule.

    Args:
        values: of all nodes, elements of any algebra with addition.
        one: its unit.
        scaled: the product with an exact constant.
        dot: the sum of products of pairs.
        slope_of_power: the derivative of a power, the node of this index, with respect to its base.

    Returns:
        for each output, a map from the number of an input to the derivative (absent: zero).
    """
    slopes: list[dict[int, Coefficient]] = []
    for index, node in enumerate(program.nodes):
        slope: dict[int, Coefficient] = {}
        match node.operation:
            case "input":
                if node.left < size:
                    slope = {node.left: one}
            case "add" | "sub":
                sign = Fraction(1 if node.operation == "add" else -1)
                summands = {j: [x] for j, x in slopes[node.left].items()}
                for j, x in slopes[node.right].items():
                    summands.setdefault(j, []).append(x if sign == 1 else scaled(x, sign))
                slope = {j: reduce(add, terms) for j, terms in summands.items()}
            case "scale":
                slope = {j: scaled(x, node.value) for j, x in slopes[node.left].items()}
            case "mul":
                square = node.left == node.right
                halves = [(slopes[node.left], values[node.right]), (slopes[node.right], values[node.left])]
                pairs: dict[int, list[tuple[Coefficient, Coefficient]]] = {}
                for half, factor in halves[: 1 if square else 2]:
                    for j, x in half.items():
                        pairs.setdefault(j, []).append((x, factor))
                slope = {j: _combination(terms, one, dot) for j, terms in pairs.items()}
                if square:
                    slope = {j: reduce(add, (x, x)) for j, x in slope.items()}
            case "pow":
                if slopes[node.left]:
                    outer = slope_of_power(index)
                    slope = {j: dot([(outer, x)]) for j, x in slopes[node.left].items()}
        slopes.append(slope)
    return [slopes[output] for output in program.outputs]


def _combination(
    pairs: Sequence[tuple[Coefficient, Coefficient]],
    one: Coefficient,
    dot: Callable[[Sequence[tuple[Coefficient, Coefficient]]], Coefficient],
) -> Coefficient:
    """The sum of products of pairs, in which the unit, if it comes first, is not multiplied."""
    terms = [value for x, value in pairs if x is one]
    products = [pair for pair in pairs if pair[0] is not one]
    return reduce(add, [*terms, dot(products)] if products else terms)


def without_time(element: Series) -> Series:
    """An element that does not depend on time, of degree 0 in it. Raises `ValueError` if it does."""
    arithmetic = element.arithmetic
    if any(p.length() > arithmetic.stride for p in element.coefs):
        raise ValueError("an element depends on time")
    return Series(replace(arithmetic, degree=0), element.coefs, element.errors)


def at_start(program: Program, arguments: Sequence[Series]) -> list[Series]:
    """Values of a program at elements that do not depend on time, so that degree 0 does.

    Raises `ValueError` if one does.
    """
    values = evaluate(prepare(program), [without_time(x) for x in arguments])
    return [Series(arguments[0].arithmetic, x.coefs, x.errors) for x in values]
