"""Derivatives of a vector field of the first to the third order, along given directions (section 36.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Any

from flint import acb, arb

from orbitproof.shared.systems import System
from orbitproof.verify.evidence import MultiIndex, enclose, power
from orbitproof.verify.newton.jets import plus, unit

Number = arb | acb
Vector = Sequence[Any]
"""A vector of numbers, real or complex."""


@dataclass(frozen=True)
class Expansion:
    """A polynomial in some variables z, cut off above a degree: Taylor coefficients of a function along directions.

    Attributes:
        variables: how many there are.
        degree: of the cut.
        coefficients: enclosures, by exponents; what is absent is exactly 0. That of degree 0 is real.
    """

    variables: int
    degree: int
    coefficients: Mapping[MultiIndex, Any]

    def __getitem__(self, index: MultiIndex) -> Any:
        return self.coefficients.get(index, arb(0))

    @property
    def value(self) -> arb:
        """The coefficient of degree 0."""
        found: arb = self[(0,) * self.variables]
        return found

    def slope(self, position: int) -> Any:
        """The coefficient of one variable."""
        return self[unit(self.variables, position)]

    def second(self, first: int, other: int) -> Any:
        """The second derivative in two variables."""
        index = plus(unit(self.variables, first), unit(self.variables, other))
        return self[index] * (2 if first == other else 1)

    def _with(self, coefficients: Mapping[MultiIndex, Any]) -> Expansion:
        return Expansion(self.variables, self.degree, coefficients)

    def __add__(self, other: Expansion) -> Expansion:
        keys = {**self.coefficients, **other.coefficients}
        return self._with({index: self[index] + other[index] for index in keys})

    def __sub__(self, other: Expansion) -> Expansion:
        return self + other._with({index: -value for index, value in other.coefficients.items()})

    def __mul__(self, other: Expansion) -> Expansion:
        found: dict[MultiIndex, Any] = {}
        for a, left in self.coefficients.items():
            for b, right in other.coefficients.items():
                if sum(a) + sum(b) <= self.degree:
                    index = plus(a, b)
                    found[index] = found.get(index, arb(0)) + left * right
        return self._with(found)

    def __truediv__(self, other: Expansion) -> Expansion:
        return self * other.power(Fraction(-1))

    def composed(self, factors: Sequence[arb]) -> Expansion:
        """A function of it, from its Taylor coefficients at the value, of degrees 0, 1, .., in this order."""
        zero = (0,) * self.variables
        rest = self._with({index: value for index, value in self.coefficients.items() if index != zero})
        found = self._with({})
        for factor in reversed(factors):
            found = found * rest + self._with({zero: factor})
        return found

    def power(self, exponent: Fraction) -> Expansion:
        """By the binomial series; a power that is a polynomial has no terms of a higher degree."""
        factors, binomial = [power(self.value, exponent)], Fraction(1)
        for place in range(1, self.degree + 1):
            binomial *= (exponent - place + 1) / place
            if not binomial:
                break
            factors.append(enclose(binomial) * power(self.value, exponent - place))
        return self.composed(factors)

    def function(self, name: str) -> Expansion:
        """sin, cos, exp or log of it."""
        derivatives = _DERIVATIVES[name](self.value)[: self.degree + 1]
        return self.composed([value / factorial(place) for place, value in enumerate(derivatives)])


_DERIVATIVES: Mapping[str, Callable[[arb], list[arb]]] = {
    "sin": lambda x: [x.sin(), x.cos(), -x.sin(), -x.cos()],
    "cos": lambda x: [x.cos(), -x.sin(), -x.cos(), x.sin()],
    "exp": lambda x: [x.exp()] * 4,
    "log": lambda x: [x.log(), 1 / x, -1 / x**2, 2 / x**3],
}
"""The function and its derivatives, up to the third."""


def expand(
    system: System, state: Sequence[arb], parameters: Sequence[arb], directions: Sequence[Vector], degree: int
) -> list[Expansion]:
    """The rates of the given coordinates along directions, up to a degree of at most 3.

    Args:
        state: enclosures of the given coordinates, N.
        parameters: enclosures of the parameters, in the vector field's order.
        directions: vectors of N numbers, or more: then the others are those of the parameters.
    """
    variables = len(directions)
    zero = (0,) * variables

    def constant(value: Fraction) -> Expansion:
        return Expansion(variables, degree, {zero: enclose(value)})

    def moving(place: int, value: arb) -> Expansion:
        along = [each[place] if place < len(each) else arb(0) for each in directions]
        slopes = {unit(variables, j): x for j, x in enumerate(along) if not acb(x).is_zero()}
        return Expansion(variables, degree, {zero: value, **slopes})

    inputs = [moving(place, value) for place, value in enumerate([*state, *parameters])]
    given, others = inputs[: len(state)], inputs[len(state) :]
    if system.defined:
        from orbitproof.shared.systems.defined_coordinates import with_functions

        # The functions are those of the state, whatever stands in their places.
        places = [*given, *[constant(Fraction(0))] * len(system.defined)]
        functions = {name: _function(name) for name in _DERIVATIVES}
        given = with_functions(system, places, others, functions, constant, Expansion.power)
    rates = system.program.evaluate([*given, *others], constant, Expansion.power)
    return list(rates[: len(state)])


def _function(name: str) -> Callable[[Expansion], Expansion]:
    return lambda argument: argument.function(name)
