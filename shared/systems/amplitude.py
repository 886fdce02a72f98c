"""A vector field about an equilibrium, in units of the distance from it (section 38.2).

With x = c + eps y the field is F(y) = (f(c + eps y) - f(c))/eps. It is formed without dividing by eps, so that it has
values at eps = 0 too, where it is the derivative of f at c along y.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import prod
from typing import Any

from orbitproof.shared.systems.names import own_name
from orbitproof.shared.systems.program import Program, record
from orbitproof.shared.systems.system import System, VectorField

AMPLITUDE = own_name("amplitude")
"""eps, as an input of a program and as a coordinate of a claim."""


def blown_up(system: System) -> VectorField:
    """F in plain arithmetic, called with y and with the parameters of the system, then eps, then c; all coordinates."""
    return _in_units(system.program, len(system.state))


def blown_up_program(program: Program, size: int) -> Program:
    """(e(c + eps y) - e(c))/eps for a program e of a state of so many coordinates, and of parameters.

    Inputs: y, the parameters, eps, c.
    """
    state, parameters = program.inputs[:size], program.inputs[size:]
    rest = [own_name(f"{name} at rest") for name in state]
    return record(_in_units(program, size), state, (*parameters, AMPLITUDE, *rest))


def _in_units(program: Program, size: int) -> VectorField:
    given = len(program.inputs) - size

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        known, eps, rest = parameters[:given], parameters[given], parameters[given + 1 :]
        arguments = [_Pair(c, y, eps) for c, y in zip(rest, state, strict=True)]
        arguments += [_Pair(value, None, eps) for value in known]
        values = program.evaluate(arguments, lambda value: _Pair(value, None, eps), _Pair.power)
        # A component that does not depend on the state is constant in c + eps y.
        return [Fraction(0) if each.slope is None else each.slope for each in values]

    return field


@dataclass(frozen=True)
class _Pair:
    """The value base + eps slope of a function at c + eps y; base is its value at c. No slope: it is the same there."""

    base: Any
    slope: Any | None
    eps: Any

    @property
    def value(self) -> Any:
        return self.base if self.slope is None else self.base + self.eps * self.slope

    def __add__(self, other: _Pair) -> _Pair:
        if self.slope is None or other.slope is None:
            slope = other.slope if self.slope is None else self.slope
        else:
            slope = self.slope + other.slope
        return _Pair(self.base + other.base, slope, self.eps)

    def __sub__(self, other: _Pair) -> _Pair:
        if other.slope is None:
            slope = self.slope
        else:
            slope = -other.slope if self.slope is None else self.slope - other.slope
        return _Pair(self.base - other.base, slope, self.eps)

    def __mul__(self, other: _Pair) -> _Pair:
        # u v - u_0 v_0 = (u - u_0) v + u_0 (v - v_0)
        if self.slope is None:
            slope = None if other.slope is None else self.base * other.slope
        else:
            slope = self.slope * other.value
            if other.slope is not None:
                slope = slope + self.base * other.slope
        return _Pair(self.base * other.base, slope, self.eps)

    def __truediv__(self, other: _Pair) -> _Pair:
        # u/v - q = ((u - u_0) - q (v - v_0))/v with q = u_0/v_0
        quotient = self.base / other.base
        if other.slope is None:
            return _Pair(quotient, None if self.slope is None else self.slope / other.base, self.eps)
        slope = -(quotient * other.slope) if self.slope is None else self.slope - quotient * other.slope
        return _Pair(quotient, slope / other.value, self.eps)

    def power(self, exponent: Fraction) -> _Pair:
        """To a rational power: that of a root, and its inverse."""
        if self.slope is None:
            if isinstance(self.base, Fraction) and exponent.denominator != 1:
                raise ValueError(f"a root of the constant {self.base} is not exact; write its value")
            return _Pair(self.base**exponent, None, self.eps)
        if exponent < 0:
            return _Pair(Fraction(1), None, self.eps) / self.power(-exponent)
        if exponent == 0:
            return _Pair(self.base**exponent, 0 * self.slope, self.eps)
        root = self if exponent.denominator == 1 else self._root(exponent.denominator)
        return prod([root] * (exponent.numerator - 1), start=root)

    def _root(self, degree: int) -> _Pair:
        # u - u_0 = (w - w_0) (w^(k-1) + w^(k-2) w_0 + ..) for roots w, w_0 of degree k
        share = Fraction(1, degree)
        before, after = self.base**share, self.value**share
        terms = []
        for power in range(degree):
            first, *others = [after] * power + [before] * (degree - 1 - power)
            terms.append(prod(others, start=first))
        return _Pair(before, self.slope / sum(terms[1:], terms[0]), self.eps)
