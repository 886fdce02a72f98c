"""Derivatives of a quantity along the orbits of a vector field, as straight-line programs (section 19.4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import Program, ReversibleSystem, record
from orbitproof.verify.poincare import Coordinates

Quantity = Callable[[Sequence[Any], Sequence[Any]], Any]


@dataclass(frozen=True)
class _Dual:
    """A value and its derivative; both may be duals themselves."""

    value: Any
    slope: Any

    def __add__(self, other: Any) -> _Dual:
        right = _lifted(other)
        return _Dual(self.value + right.value, self.slope + right.slope)

    __radd__ = __add__

    def __neg__(self) -> _Dual:
        return _Dual(-1 * self.value, -1 * self.slope)

    def __sub__(self, other: Any) -> _Dual:
        return self + -_lifted(other)

    def __rsub__(self, other: Any) -> _Dual:
        return _lifted(other) + -self

    def __mul__(self, other: Any) -> _Dual:
        right = _lifted(other)
        return _Dual(self.value * right.value, self.value * right.slope + self.slope * right.value)

    __rmul__ = __mul__

    def __pow__(self, exponent: Any) -> _Dual:
        power = Fraction(exponent)
        return _Dual(self.value**power, power * self.value ** (power - 1) * self.slope)

    def __truediv__(self, other: Any) -> _Dual:
        return self * _lifted(other) ** -1

    def __rtruediv__(self, other: Any) -> _Dual:
        return _lifted(other) * self**-1


def _lifted(value: Any) -> _Dual:
    return value if isinstance(value, _Dual) else _Dual(value, 0)


def rates_along(field: Program, size: int, quantity: Quantity) -> Program:
    """A quantity D, dD/dt and d^2 D/dt^2 along the orbits of a vector field; inputs: those of the field.

    Args:
        size: the number of state coordinates, the first inputs; the others are constants of motion.
        quantity: plain arithmetic, called with (state, constants).
    """

    def velocity(state: Sequence[Any], constants: Sequence[Any]) -> list[Any]:
        return field.evaluate([*state, *constants], lambda value: value, lambda base, exponent: base**exponent)

    def rates(arguments: Sequence[Any]) -> Sequence[Any]:
        state, constants = arguments[:size], arguments[size:]
        first = velocity(state, constants)
        moving = [_Dual(x, slope) for x, slope in zip(state, first, strict=True)]
        still = [_Dual(value, 0) for value in constants]
        second = [_lifted(value).slope for value in velocity(moving, still)]
        twice = [_Dual(x, _Dual(a, b)) for x, a, b in zip(moving, first, second, strict=True)]
        found = _lifted(quantity(twice, [_Dual(value, 0) for value in still]))
        value, rate = _lifted(found.value), _lifted(found.slope)
        return value.value, rate.value, rate.slope

    return record(rates, field.inputs)


def distance_rates(system: ReversibleSystem, coordinates: Coordinates) -> Program:
    """The square D of the distance that a system names, D' and D'' along the orbits of the field that is followed.

    Inputs are those of the field. In regularised coordinates D is that of the projection.
    """
    regularisation, quantity = coordinates.regularisation, system.squared_distance
    if quantity is None:
        raise ValueError(f"{system.name} names no distance")
    size = len(system.state) if regularisation is None else len(regularisation.state)

    def of_state(state: Sequence[Any], constants: Sequence[Any]) -> Any:
        parameters = constants[: len(system.parameters)]
        own = state if regularisation is None else regularisation.projection(state, parameters)
        return quantity(own, parameters)[0]

    return rates_along(coordinates.field, size, of_state)
