"""Straight-line programs recorded from plain arithmetic.

A vector field or a first integral is written once, as a Python function that uses only
``+ - * /`` and powers with an exact constant exponent. Called on JAX arrays or floats it computes;
called on recording variables (`record`) it leaves behind a `Program`, the list of its operations,
from which a verifier can build Taylor recurrences, enclosures or derivatives.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

LARGEST_EXPONENT = 100
"""Largest numerator and denominator of an exponent: a power is evaluated as that many products."""

Operation = Literal["input", "constant", "add", "sub", "mul", "div", "pow"]
SYMBOLS: Mapping[Operation, str] = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
_ARITHMETIC: Mapping[Operation, Callable[[Any, Any], Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv,
}  # fmt: skip


@dataclass(frozen=True)
class Instruction:
    """One operation of a `Program`.

    `operands` are indices of earlier instructions. `value` is the exact constant of a
    ``constant``, the exact exponent of a ``pow`` and ``None`` otherwise. `name` is set for inputs.
    """

    operation: Operation
    operands: tuple[int, ...] = ()
    value: Fraction | None = None
    name: str | None = None


@dataclass(frozen=True)
class Program:
    """A straight-line program: instructions in order, the first `len(inputs)` being the inputs.

    `outputs` are indices into `instructions`. Equal subexpressions share one instruction.
    """

    inputs: tuple[str, ...]
    instructions: tuple[Instruction, ...]
    outputs: tuple[int, ...]

    def evaluate(
        self,
        arguments: Sequence[Any],
        constant: Callable[[Fraction], Any] | None = None,
        power: Callable[[Any, Fraction], Any] | None = None,
    ) -> list[Any]:
        """Run the program on `arguments` (one per input) with their own arithmetic.

        `constant` converts exact constants and `power` raises to an exact exponent; by default
        floats and ``**`` are used.
        """
        if len(arguments) != len(self.inputs):
            raise ValueError(f"program takes {len(self.inputs)} arguments, got {len(arguments)}")
        to_value = constant if constant is not None else float
        to_power = power if power is not None else (lambda base, exponent: base ** float(exponent))
        values: list[Any] = []
        for step in self.instructions:
            operands = [values[index] for index in step.operands]
            if step.operation == "input":
                values.append(arguments[len(values)])
            elif step.operation in _ARITHMETIC:
                values.append(_ARITHMETIC[step.operation](*operands))
            else:
                assert step.value is not None
                values.append(to_power(operands[0], step.value) if operands else to_value(step.value))
        return [values[index] for index in self.outputs]

    @property
    def used_inputs(self) -> set[str]:
        """The names of the inputs on which an output depends."""
        pending, found = list(self.outputs), set[int]()
        while pending:
            if (index := pending.pop()) not in found:
                found.add(index)
                pending += self.instructions[index].operands
        return {str(self.instructions[index].name) for index in found if self.instructions[index].name is not None}

    def text(self) -> str:
        """The program in words, one instruction a line: the statement that a certificate carries."""
        lines = []
        for index, step in enumerate(self.instructions):
            operands = [f"v{operand}" for operand in step.operands]
            if step.operation in SYMBOLS:
                value = f" {SYMBOLS[step.operation]} ".join(operands)
            elif step.operation == "pow":
                value = f"{operands[0]} ** ({step.value})"
            else:
                value = str(step.name if step.operation == "input" else step.value)
            lines.append(f"v{index} = {value}")
        lines.append("return " + ", ".join(f"v{index}" for index in self.outputs))
        return "\n".join(lines)


def allowed_exponent(value: Fraction) -> Fraction:
    """The exponent of a power. Raises `ValueError` for one that is too large."""
    if max(abs(value.numerator), value.denominator) > LARGEST_EXPONENT:
        raise ValueError(f"the exponent {value} is too large; write it as products")
    return value


class _Recorder:
    def __init__(self, inputs: Sequence[str]) -> None:
        self.instructions: list[Instruction] = []
        self._seen: dict[Instruction, int] = {}
        if len(set(inputs)) != len(inputs):
            raise ValueError(f"two inputs of a program have one name: {', '.join(inputs)}")
        self.variables = [self.emit(Instruction("input", name=name)) for name in inputs]

    def emit(self, instruction: Instruction) -> Variable:
        index = self._seen.get(instruction)
        if index is None:
            index = len(self.instructions)
            self.instructions.append(instruction)
            self._seen[instruction] = index
        return Variable(self, index)

    def lift(self, operand: object) -> Variable:
        if isinstance(operand, Variable):
            if operand.recorder is not self:
                raise ValueError("operands of one program come from one recording")
            return operand
        return self.emit(Instruction("constant", value=exact_constant(operand)))


def exact_constant(value: object) -> Fraction:
    """The exact value of a constant in a formula: an int, a Fraction or a float that is a half-integer.

    Other floats are refused: ``0.1`` in a formula would not mean one tenth.
    """
    if isinstance(value, bool):
        raise TypeError("a truth value is not a constant")
    if isinstance(value, (int, Fraction)) or (isinstance(value, float) and (2 * value).is_integer()):
        return Fraction(value)
    if isinstance(value, Variable):
        raise TypeError(
            "an exponent is a coordinate or a parameter: write a whole number or a half-integer in its place"
        )
    raise TypeError(f"constant {value!r} is not exact: write an int, a half-integer or a Fraction")


def _both_ways(operation: Operation) -> tuple[Callable[[Variable, object], Variable], ...]:
    """An operation of a variable with another operand, and of an operand with a variable."""

    def emit(recorder: _Recorder, left: object, right: object) -> Variable:
        a, b = recorder.lift(left), recorder.lift(right)
        if operation == "div" and right == 0:
            raise ZeroDivisionError("a quotient by 0")
        return recorder.emit(Instruction(operation, (a.index, b.index)))

    return (lambda self, other: emit(self.recorder, self, other), lambda self, other: emit(self.recorder, other, self))


class Variable:
    """A value of a program under recording."""

    __slots__ = ("index", "recorder")

    def __init__(self, recorder: _Recorder, index: int) -> None:
        self.recorder = recorder
        self.index = index

    __add__, __radd__ = _both_ways("add")
    __sub__, __rsub__ = _both_ways("sub")
    __mul__, __rmul__ = _both_ways("mul")
    __truediv__, __rtruediv__ = _both_ways("div")

    def __neg__(self) -> Variable:
        return -1 * self

    def __pos__(self) -> Variable:
        return self

    def __pow__(self, exponent: object) -> Variable:
        value = allowed_exponent(exact_constant(exponent))
        return self.recorder.emit(Instruction("pow", (self.index,), value=value))


def record(function: Callable[..., Sequence[Any]], *groups: Sequence[str]) -> Program:
    """Record `function`, called with one list of variables per group of names.

    Outputs that are plain constants are allowed. Raises `TypeError` for an inexact constant or an
    unsupported operation, `ValueError` for two inputs of one name, `ZeroDivisionError` for a quotient by 0.
    """
    names = tuple(name for group in groups for name in group)
    recorder = _Recorder(names)
    variables = iter(recorder.variables)
    arguments = [[next(variables) for _ in group] for group in groups]
    outputs = [recorder.lift(value).index for value in function(*arguments)]
    return Program(names, tuple(recorder.instructions), tuple(outputs))
