"""Functions of plain arithmetic that are made at random, and their exact derivatives."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction as F
from typing import Any

from orbitproof.shared.systems import Program, record

Function = Callable[[Sequence[Any]], list[Any]]


@dataclass(frozen=True)
class Dual:
    """A number with its derivative in one input, for the same arithmetic."""

    value: F
    slope: F

    def __add__(self, other: Any) -> Dual:
        right = dual(other)
        return Dual(self.value + right.value, self.slope + right.slope)

    def __sub__(self, other: Any) -> Dual:
        right = dual(other)
        return Dual(self.value - right.value, self.slope - right.slope)

    def __mul__(self, other: Any) -> Dual:
        right = dual(other)
        return Dual(self.value * right.value, self.slope * right.value + self.value * right.slope)

    def __truediv__(self, other: Any) -> Dual:
        right = dual(other)
        slope = (self.slope * right.value - self.value * right.slope) / right.value**2
        return Dual(self.value / right.value, slope)

    def __pow__(self, exponent: F) -> Dual:
        return Dual(self.value**exponent, exponent * self.value ** (exponent - 1) * self.slope if exponent else F(0))


def dual(value: Any) -> Dual:
    """A constant, or what is one already."""
    return value if isinstance(value, Dual) else Dual(F(value), F(0))


def function_of(seed: int, inputs: int, outputs: int = 1) -> Function:
    """A function of whole powers, quotients by 1 + squares, constants on either side of an operation."""

    def function(arguments: Sequence[Any]) -> list[Any]:
        chance = random.Random(seed)
        known = list(arguments[:inputs])
        for _ in range(9):
            a, b = chance.choice(known), chance.choice(known)
            c = F(chance.choice((-1, 1)) * chance.randint(1, 9), chance.randint(1, 4))
            known.append(
                chance.choice(
                    [
                        lambda a=a, b=b: a + b, lambda a=a, b=b: a - b, lambda a=a, b=b: a * b, lambda a=a, c=c: a * c,
                        lambda a=a, c=c: a - c, lambda a=a, b=b: a / (b * b + 1), lambda a=a: a ** F(2),
                        lambda a=a: (a * a + 1) ** F(-2), lambda a=a: a ** F(3), lambda a=a, c=c: a + c,
                        lambda a=a: a ** F(1), lambda a=a: a ** F(0),
                    ]
                )()
            )  # fmt: skip
        return known[-outputs:]

    return function


def whole_power(base: F, exponent: F) -> F:
    """A power of a fraction."""
    return base ** int(exponent)


def recorded(seed: int, inputs: int, outputs: int = 1) -> Program:
    """Such a function as a program, its inputs in no order of their names."""
    names = [f"x{i}" for i in reversed(range(inputs))]
    return record(function_of(seed, inputs, outputs), names)


def place(chance: random.Random, count: int) -> list[F]:
    """A point with small fractions as coordinates, none of them 0."""
    return [F(chance.choice((-1, 1)) * chance.randint(1, 9), chance.randint(1, 5)) for _ in range(count)]
