"""Straight-line programs as formulas, and names, numbers and the formulas of statements as LaTeX."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction

from orbitproof.figures.report.document import Math, Run, Runs
from orbitproof.shared.systems import Program

_GREEK = ("alpha", "beta", "zeta", "eta", "xi", "mu", "nu", "rho")
_LONG = 7
"""A subexpression of more operations that is used more than once gets a name."""
_MANY = 50
"""In a program of more instructions every power and sum that is used more than once gets one."""

_SUM, _PRODUCT, _POWER, _ATOM = range(4)
"""How tightly a formula holds together."""

Equations = tuple[tuple[str, str], ...]


def name_to_latex(name: str) -> str:
    """The name of a coordinate or parameter: ``vx`` is a velocity, Greek names are letters."""
    if name in _GREEK:
        return rf"\{name}"
    if name == "eps":
        return r"\varepsilon"
    if len(name) > 1 and name[0] == "v":
        return f"v_{{{name_to_latex(name[1:])}}}"
    stem, separator, index = name.partition("_")
    if separator and stem and index:
        return f"{name_to_latex(stem)}_{{{name_to_latex(index)}}}"
    return name if len(name) == 1 else rf"\mathrm{{{name}}}"


def program_to_latex(program: Program, left_sides: Sequence[str]) -> Equations:
    """The outputs of a program as equations ``left side = formula``; before them what it abbreviates as u_1, u_2, ..

    Every formula says exactly what the program computes: operations are only written down, never rearranged, but for
    products of equal factors (powers), quotients of integers and factors -1 (signs).
    """
    return _Printer(program).equations(left_sides)


class _Printer:
    def __init__(self, program: Program) -> None:
        self.program = program
        steps = program.instructions
        self.uses = [0] * len(steps)
        self.sizes: list[int] = []
        for step in steps:
            self.sizes.append(1 + sum(self.sizes[i] for i in step.operands) if step.operands else 0)
            for operand in set(step.operands):
                self.uses[operand] += 1
        self.names: dict[int, str] = {}
        self.definitions: list[tuple[str, str]] = []
        for index in range(len(steps)):
            if self._wants_name(index):
                formula = self._formula(index)[0]
                self.names[index] = f"u_{{{len(self.names) + 1}}}"
                self.definitions.append((self.names[index], formula))

    def equations(self, left_sides: Sequence[str]) -> Equations:
        outputs = zip(left_sides, self.program.outputs, strict=True)
        return (*self.definitions, *((left, self._formula(index)[0]) for left, index in outputs))

    def _wants_name(self, index: int) -> bool:
        """Bases of fractional powers that are sums, and long subexpressions that are used again."""
        if self.sizes[index] == 0 or index in self.program.outputs:
            return False
        base = any(
            step.operation == "pow" and step.operands[0] == index and step.value is not None
            and step.value.denominator != 1
            for step in self.program.instructions
        )  # fmt: skip
        if base and self.sizes[index] > 1:
            return True
        is_long = len(self.program.instructions) > _MANY
        operation = self.program.instructions[index].operation
        shared = self.uses[index] > 1 and operation != "mul"
        return (self.uses[index] > 1 and self._length(index) > _LONG) or (is_long and shared and self.sizes[index] > 1)

    def _length(self, index: int) -> int:
        """Operations of the formula as it would be written, with the names that there are."""
        if index in self.names:
            return 0
        operands = self.program.instructions[index].operands
        return 1 + sum(self._length(i) for i in operands) if operands else 0

    def _formula(self, index: int) -> tuple[str, int]:
        """LaTeX, and how tightly it holds together."""
        if index in self.names:
            return self.names[index], _ATOM
        step = self.program.instructions[index]
        match step.operation:
            case "input":
                return name_to_latex(step.name or ""), _ATOM
            case "constant":
                return number_to_latex(step.value or Fraction(0))
            case "add":
                left, right = (self._formula(i)[0] for i in step.operands)
                return (f"{left} - {right[1:]}" if self._is_negative(step.operands[1]) else f"{left} + {right}"), _SUM
            case "sub":
                return f"{self._formula(step.operands[0])[0]} - {self._at_least(step.operands[1], _PRODUCT)}", _SUM
            case "mul":
                return self._product(*step.operands)
            case "div":
                left, right = (self._formula(i)[0] for i in step.operands)
                return rf"\frac{{{left}}}{{{right}}}", _ATOM
            case _:
                return f"{self._at_least(step.operands[0], _ATOM)}^{{{step.value}}}", _POWER

    def _product(self, left: int, right: int) -> tuple[str, int]:
        if self._constant(left) == -1:
            return f"-{self._at_least(right, _PRODUCT)}", _SUM
        base, power = self._power_of(left)
        if left == right:
            return f"{self._at_least(left, _ATOM)}^{{2}}", _POWER
        if base == right and self.sizes[right] == 0:
            return f"{self._at_least(right, _ATOM)}^{{{power + 1}}}", _POWER
        return rf"{self._at_least(left, _PRODUCT)} \, {self._at_least(right, _PRODUCT)}", _PRODUCT

    def _power_of(self, index: int) -> tuple[int, int]:
        """Base and exponent of x x ... x."""
        step = self.program.instructions[index]
        if step.operation != "mul" or index in self.names:
            return index, 1
        left, right = step.operands
        base, power = self._power_of(left)
        return (base, power + 1) if base == right else (index, 1)

    def _at_least(self, index: int, level: int) -> str:
        formula, holds = self._formula(index)
        return formula if holds >= level else f"({formula})"

    def _constant(self, index: int) -> Fraction | None:
        return self.program.instructions[index].value if not self.program.instructions[index].operands else None

    def _is_negative(self, index: int) -> bool:
        """Whether the formula is minus something that holds together."""
        step = self.program.instructions[index]
        if index in self.names or step.operation != "mul":
            return False
        return self._constant(step.operands[0]) == -1


def number_to_latex(value: Fraction) -> tuple[str, int]:
    """An exact number."""
    if value.denominator == 1:
        return str(value.numerator), _ATOM if value >= 0 else _SUM
    sign = "-" if value < 0 else ""
    return rf"{sign}\frac{{{abs(value.numerator)}}}{{{value.denominator}}}", _ATOM if value > 0 else _SUM


_IN_WORDS: tuple[tuple[str, Callable[[re.Match[str]], str]], ...] = (
    (r"P\^\((\w+)\)\(([xX])\) = \2", lambda m: rf"P^{{{m[1]}}}({m[2]}) = {m[2]}"),
    (r"P\^(\d+)\(([xX])\) = \2", lambda m: rf"P^{{{m[1]}}}({m[2]}) = {m[2]}"),
    (r"P\^(\d+)\b", lambda m: rf"P^{{{m[1]}}}"),
    (r"Fix\((\w)\)", lambda m: rf"\mathrm{{Fix}}({m[1]})"),
    (r"\{(\w+) = 0\}", lambda m: rf"\{{{name_to_latex(m[1])} = 0\}}"),
    (r"\|(\w+)\| <= ([0-9.e-]*[0-9])(?: mu\^\(1/3\))?",
     lambda m: rf"|{name_to_latex(m[1])}| \le {m[2]}" + (r"\, \mu^{1/3}" if "mu^" in m[0] else "")),
)  # fmt: skip


def typeset(text: str) -> Runs:
    """The words of a statement, with the formulas in them that have a form known here; the others stay as written."""
    runs: list[Run] = [text]
    for pattern, latex in _IN_WORDS:
        runs = [piece for run in runs for piece in _split(run, re.compile(pattern), latex)]
    return tuple(runs)


def _split(run: Run, pattern: re.Pattern[str], latex: Callable[[re.Match[str]], str]) -> list[Run]:
    if not isinstance(run, str):
        return [run]
    pieces: list[Run] = []
    end = 0
    for found in pattern.finditer(run):
        pieces += [run[end : found.start()], Math(latex(found))]
        end = found.end()
    return [piece for piece in (*pieces, run[end:]) if piece != ""]
