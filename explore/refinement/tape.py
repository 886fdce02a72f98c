"""Vector fields as tapes: straight-line programs reduced to the operations that have Taylor recurrences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from orbitproof.shared.systems import Program


@dataclass(frozen=True)
class Operation:
    """One operation of a `Tape`; `left` and `right` are positions of earlier operations.

    ``scale`` and ``shift`` multiply by and add the constant `value`; ``power`` raises `left` to the
    exponent `value` and has the inverse of `left` at `right`; an input has its number as `left`.
    """

    code: Literal["input", "constant", "add", "subtract", "scale", "shift", "multiply", "invert", "power"]
    left: int = -1
    right: int = -1
    value: Fraction = Fraction(0)


class Tape:
    """A straight-line program with its constants folded and its powers reduced to a few operations.

    Attributes:
        operations: the first `inputs` of them are the inputs, in the order of the program.
        outputs: for each output the operation that computes it.
    """

    def __init__(self, program: Program, constants: Mapping[str, Fraction]) -> None:
        """Compile `program`; inputs named in `constants` are replaced by these values."""
        self.operations: list[Operation] = []
        self._seen: dict[Operation, int] = {}
        names = [name for name in program.inputs if name not in constants]
        self.inputs = len(names)
        for position in range(self.inputs):
            self.operations.append(Operation("input", left=position))
        free = iter(range(self.inputs))
        arguments = [constants[name] if name in constants else next(free) for name in program.inputs]
        values: list[int | Fraction] = []
        for position, step in enumerate(program.instructions):
            if step.operation == "input":
                values.append(arguments[position])
            elif step.operation == "constant":
                assert step.value is not None
                values.append(step.value)
            elif step.operation == "pow":
                assert step.value is not None
                values.append(self._power(values[step.operands[0]], step.value))
            else:
                values.append(self._binary(step.operation, *(values[i] for i in step.operands)))
        self.outputs = [
            self._emit("constant", value=v) if isinstance(v, Fraction) else v
            for v in (values[i] for i in program.outputs)
        ]

    def _emit(self, code: Any, left: int = -1, right: int = -1, value: Fraction = Fraction(0)) -> int:
        operation = Operation(code, left, right, value)
        if operation not in self._seen:
            self._seen[operation] = len(self.operations)
            self.operations.append(operation)
        return self._seen[operation]

    def _binary(self, operation: str, a: int | Fraction, b: int | Fraction) -> int | Fraction:
        if isinstance(a, Fraction) and isinstance(b, Fraction):
            results = {"add": lambda: a + b, "sub": lambda: a - b, "mul": lambda: a * b, "div": lambda: a / b}
            return results[operation]()
        if operation == "div":
            if isinstance(b, Fraction):
                return self._emit("scale", left=a, value=1 / b)
            return self._binary("mul", a, self._emit("invert", left=b))
        if operation == "sub" and isinstance(b, Fraction):
            return self._binary("add", a, -b)
        if operation == "sub" and isinstance(a, Fraction):
            return self._binary("add", a, self._emit("scale", left=b, value=Fraction(-1)))
        if isinstance(a, Fraction):
            a, b = b, a
        if isinstance(b, Fraction):
            neutral = b == (operation == "mul")
            return a if neutral else self._emit("scale" if operation == "mul" else "shift", left=a, value=b)
        codes = {"add": "add", "sub": "subtract", "mul": "multiply"}
        return self._emit(codes[operation], left=a, right=b)

    def _power(self, a: int | Fraction, exponent: Fraction) -> int | Fraction:
        if isinstance(a, Fraction):
            if exponent.denominator == 1:
                return a**exponent
            raise ValueError("a constant to a fractional power is not exact; write its value")
        if exponent.denominator == 1:
            base: int | Fraction = a if exponent >= 0 else self._emit("invert", left=a)
            result: int | Fraction = Fraction(1)
            for _ in range(abs(int(exponent))):
                result = self._binary("mul", result, base)
            return result
        return self._emit("power", left=a, right=self._emit("invert", left=a), value=exponent)
