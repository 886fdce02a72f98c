"""The derivative of a straight-line program in one of its inputs, as a program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.program import Program, Variable, record


def with_slope(program: Program, name: str) -> Program:
    """The program of one output with a second one: its derivative in the input `name`."""

    def both(arguments: Sequence[Variable]) -> Sequence[Any]:
        # Constants are recorded as such: a root of one is no number that Python could have exactly.
        lift = arguments[0].recorder.lift
        inputs = [
            _Sloped(value, 1 if called == name else 0) for called, value in zip(program.inputs, arguments, strict=True)
        ]
        (found,) = program.evaluate(inputs, lambda value: _Sloped(lift(value), 0), _Sloped.power)
        return found.value, found.slope

    return record(both, program.inputs)


@dataclass(frozen=True)
class _Sloped:
    """A value and its derivative; the number 0 is a derivative that vanishes for certain."""

    value: Any
    slope: Any

    def __add__(self, other: _Sloped) -> _Sloped:
        return _Sloped(self.value + other.value, _sum(self.slope, other.slope))

    def __sub__(self, other: _Sloped) -> _Sloped:
        return _Sloped(self.value - other.value, _sum(self.slope, _product(-1, other.slope)))

    def __mul__(self, other: _Sloped) -> _Sloped:
        slope = _sum(_product(self.slope, other.value), _product(self.value, other.slope))
        return _Sloped(self.value * other.value, slope)

    def __truediv__(self, other: _Sloped) -> _Sloped:
        if _is_zero(other.slope):
            return _Sloped(self.value / other.value, self.slope if _is_zero(self.slope) else self.slope / other.value)
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> _Sloped:
        """By d(u^a) = a u^(a - 1) du."""
        value = self.value**exponent
        if _is_zero(self.slope) or not exponent:
            return _Sloped(value, 0)
        return _Sloped(value, _product(1 if exponent == 1 else exponent * self.value ** (exponent - 1), self.slope))


def _is_zero(value: Any) -> bool:
    return isinstance(value, (int, Fraction)) and value == 0


def _sum(left: Any, right: Any) -> Any:
    return right if _is_zero(left) else left if _is_zero(right) else left + right


def _product(left: Any, right: Any) -> Any:
    if _is_zero(left) or _is_zero(right):
        return 0
    return right if _is_one(left) else left if _is_one(right) else left * right


def _is_one(value: Any) -> bool:
    return isinstance(value, int) and value == 1
