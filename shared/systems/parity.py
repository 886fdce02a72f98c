"""Parities of straight-line programs under sign changes of the state (section 1.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.shared.systems.program import Program


@dataclass(frozen=True)
class _Parity:
    """1 for even, -1 for odd, 0 for neither."""

    sign: int

    def __add__(self, other: _Parity) -> _Parity:
        return self if self == other else _Parity(0)

    __sub__ = __add__

    def __mul__(self, other: _Parity) -> _Parity:
        return _Parity(self.sign * other.sign)

    __truediv__ = __mul__

    def power(self, exponent: Fraction) -> _Parity:
        if self.sign != -1:
            return self
        return _Parity(0 if exponent.denominator > 1 else -1 if exponent.numerator % 2 else 1)


def parities(program: Program, signs: Sequence[int]) -> list[int]:
    """For each output 1 (even), -1 (odd) or 0 (not decided) under the signs of the inputs.

    `signs` covers the first inputs; the further inputs (parameters) are unchanged. A constant zero is
    not treated as odd.
    """
    even = _Parity(1)
    arguments = [_Parity(sign) for sign in signs] + [even] * (len(program.inputs) - len(signs))
    return [value.sign for value in program.evaluate(arguments, lambda _: even, _Parity.power)]


def has_parities(program: Program, signs: Sequence[int], wanted: Sequence[int]) -> bool:
    """Whether every output is even or odd as wanted, for 1 and -1, under the signs of the inputs; 0 is both."""
    found, steps = parities(program, signs), [program.instructions[index] for index in program.outputs]
    is_zero = [step.operation == "constant" and not step.value for step in steps]
    return len(found) == len(wanted) and all(
        zero or sign == other for sign, other, zero in zip(found, wanted, is_zero, strict=True)
    )
