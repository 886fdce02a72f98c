"""Straight-line programs on graded Taylor models, one monomial at a time (section 3).

`prepare` rewrites a program so that only additions, products, scalings by constants and negative
powers are left. `Evaluation` computes the known parts of all nodes monomial by monomial, because the
solution of a differential equation is built in the same order; `Evaluation.enclose` then adds the
errors and returns rigorous enclosures of the outputs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from flint import fmpz, fmpz_poly

from orbitproof.shared.systems import Program
from orbitproof.verify.algebra.series import ZERO, Arithmetic, Series, correct_power, product_errors
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
    nodes: list[Node] = []
    seen: dict[Node, int] = {}
    place: list[int] = []

    def emit(node: Node) -> int:
        if node not in seen:
            seen[node] = len(nodes)
            nodes.append(node)
        return seen[node]

    def emit_product(left: int, right: int) -> int:
        for factor, other in ((left, right), (right, left)):
            if nodes[factor].operation == "constant":
                return emit(Node("scale", other, value=nodes[factor].value))
        return emit(Node("mul", min(left, right), max(left, right)))

    def emit_power(base: int, exponent: Fraction) -> int:
        if exponent < 0:
            return emit(Node("pow", base, value=exponent))
        whole, part = int(exponent), exponent - int(exponent)
        if part:
            whole, part = whole + 1, part - 1
        result = emit(Node("pow", base, value=part)) if part else None
        for _ in range(whole):
            result = base if result is None else emit_product(result, base)
        return emit(Node("constant", value=Fraction(1))) if result is None else result

    for index in range(len(program.inputs)):
        nodes.append(Node("input", left=index))
        place.append(index)
    for step in program.instructions[len(program.inputs) :]:
        operands = [place[operand] for operand in step.operands]
        if step.operation == "constant":
            assert step.value is not None
            place.append(emit(Node("constant", value=step.value)))
        elif step.operation == "add":
            place.append(emit(Node("add", operands[0], operands[1])))
        elif step.operation == "sub":
            place.append(emit(Node("sub", operands[0], operands[1])))
        elif step.operation == "mul":
            place.append(emit_product(operands[0], operands[1]))
        elif step.operation == "div":
            place.append(emit_product(operands[0], emit_power(operands[1], Fraction(-1))))
        elif step.operation == "pow":
            assert step.value is not None
            place.append(emit_power(operands[0], step.value))
        else:
            raise ValueError(f"input {step.name!r} after the first operation")
    return _without_unused(
        PreparedProgram(len(program.inputs), tuple(nodes), tuple(place[index] for index in program.outputs))
    )


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


class Evaluation:
    """The known parts of all nodes of a prepared program, filled monomial by monomial."""

    def __init__(self, program: PreparedProgram, arithmetic: Arithmetic) -> None:
        self.program = program
        self.arithmetic = arithmetic
        self.coefs: list[list[fmpz_poly]] = [[ZERO] * len(arithmetic.grading.monomials) for _ in program.nodes]
        self.lost: list[list[float]] = [arithmetic.zero_errors() for _ in program.nodes]
        self._inverse: dict[int, fmpz_poly] = {}

    def fill(self, position: int, inputs: Sequence[fmpz_poly], record: bool = True) -> None:
        """Compute the coefficient of monomial `position` at every node from those of the inputs.

        All monomials of lower grade must have been filled. With `record`, what rounding and
        truncation lose is kept for `enclose`; a monomial is recorded once.
        """
        arithmetic = self.arithmetic
        grade = arithmetic.grading.grades[position]
        for index, node in enumerate(self.program.nodes):
            loss = 0.0
            match node.operation:
                case "input":
                    value = inputs[index]
                case "constant":
                    value = ZERO
                    if position == 0:
                        series = arithmetic.constant(node.value)
                        value, loss = series.coefs[0], series.errors[0]
                case "add":
                    value = self.coefs[node.left][position] + self.coefs[node.right][position]
                case "sub":
                    value = self.coefs[node.left][position] - self.coefs[node.right][position]
                case "mul":
                    value, loss = arithmetic.product_slice(self.coefs[node.left], self.coefs[node.right], position)
                case "scale":
                    value = self.coefs[node.left][position] * fmpz(node.value.numerator)
                    if node.value.denominator != 1:
                        value = value // fmpz(node.value.denominator)
                        loss = arithmetic.rounding[grade]
                case "pow":
                    value = self._power_slice(index, node, position)
            self.coefs[index][position] = value
            if record and loss:
                self.lost[index][grade] += loss

    def reciprocal(self, index: int) -> fmpz_poly:
        """An approximation of 1 / base at the centre, for a node that is a power."""
        return self._inverse[index]

    def _power_slice(self, index: int, node: Node, position: int) -> fmpz_poly:
        """An approximate coefficient of a negative power, from R DS = exponent S DR, D the grade derivation."""
        arithmetic = self.arithmetic
        grades = arithmetic.grading.grades
        base = self.coefs[node.left]
        if position == 0:
            value, self._inverse[index] = arithmetic.power(base[0], node.value)
            return value
        p, q = node.value.numerator, node.value.denominator
        power = self.coefs[index]
        exact = ZERO
        for i, j in arithmetic.grading.factors[position]:
            weight = p * grades[j] - q * grades[i]
            if i != position and weight and power[i].length() and base[j].length():
                exact = exact + power[i] * base[j] * fmpz(weight)
        if not exact.length():
            return ZERO
        quotient, _ = arithmetic.cut(arithmetic.reduced(exact) * self._inverse[index])
        return quotient // (arithmetic.one * fmpz(q * grades[position]))

    def enclose(self, inputs: Sequence[Series]) -> list[Series]:
        """Enclosures of the outputs once all monomials are filled from `inputs` (their errors count here).

        Raises `IntegrationFailure` where a power or quotient cannot be bounded.
        """
        arithmetic = self.arithmetic
        nodes: list[Series] = []
        for index, node in enumerate(self.program.nodes):
            lost = self.lost[index]
            coefs = self.coefs[index]
            match node.operation:
                case "input":
                    nodes.append(inputs[index])
                case "constant":
                    nodes.append(Series(arithmetic, coefs, lost))
                case "add" | "sub":
                    nodes.append(Series(arithmetic, coefs, (nodes[node.left] + nodes[node.right]).errors))
                case "mul":
                    nodes.append(Series(arithmetic, coefs, product_errors(nodes[node.left], nodes[node.right], lost)))
                case "scale":
                    nodes.append(nodes[node.left].scaled(node.value))
                case "pow":
                    approximate = Series(arithmetic, coefs, arithmetic.zero_errors())
                    power = correct_power(approximate, nodes[node.left], node.value)
                    if power is None:
                        raise IntegrationFailure(
                            "singularity",
                            "a power or quotient of the vector field could not be bounded on the box",
                            "the box comes too close to a singularity: give smaller radii or a better centre",
                        )
                    nodes.append(power)
        return [nodes[index] for index in self.program.outputs]


def evaluate(program: PreparedProgram, inputs: Sequence[Series]) -> list[Series]:
    """Enclosures of the values of a program at elements of one arithmetic."""
    arithmetic = inputs[0].arithmetic
    evaluation = Evaluation(program, arithmetic)
    for position in range(len(arithmetic.grading.monomials)):
        evaluation.fill(position, [x.coefs[position] for x in inputs])
    return evaluation.enclose(inputs)
