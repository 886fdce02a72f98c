"""Systems in units of the orbit: a point of an orbit in the units of that point (section 18.9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import ReversibleSystem, record
from orbitproof.verify.algebra import Series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.poincare import at_start


@dataclass(frozen=True)
class _Degree:
    """The power of lambda by which a value is multiplied; `None` if it is not one power."""

    value: Fraction | None

    def __add__(self, other: _Degree) -> _Degree:
        return self if self == other else _Degree(None)

    __sub__ = __add__

    def __mul__(self, other: _Degree) -> _Degree:
        return _Degree(None if self.value is None or other.value is None else self.value + other.value)

    def __truediv__(self, other: _Degree) -> _Degree:
        return self * other.power(Fraction(-1))

    def power(self, exponent: Fraction) -> _Degree:
        # A root of something that is multiplied by a negative number is another function.
        whole = exponent.denominator == 1 or self.value == 0
        return _Degree(self.value * exponent if whole and self.value is not None else None)


def scales(system: ReversibleSystem) -> bool:
    """Whether f(lambda x, nu/lambda) = lambda f(x, nu) for lambda != 0, from the program; nu the family parameter."""
    degrees = {name: Fraction(1) for name in system.state} | {str(system.family_parameter): Fraction(-1)}
    arguments = [_Degree(degrees.get(name, Fraction(0))) for name in system.program.inputs]
    values = system.program.evaluate(arguments, lambda _: _Degree(Fraction(0)), _Degree.power)
    return all(value == _Degree(Fraction(1)) for value in values)


def in_own_units(system: ReversibleSystem, point: Mapping[str, Series]) -> dict[str, Series]:
    """The coordinates of a centre for a point of Fix(R) that is not normalised: (nu x, y/x) for each other y (18.7).

    Raises `IntegrationFailure` if the system does not allow that, or x may be zero.
    """
    unit = next(iter(system.normalised))
    own = [name for name in system.centre_coordinates if name in system.state]
    if dict(system.normalised) != {unit: 1} or system.family_parameter is None or not scales(system):
        message = f"the other point of an orbit of {system.name} is not known in its own units"
        raise IntegrationFailure("stability", message, "ask for the list of another curve")

    def units(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        size, *others = state
        (parameter,) = parameters
        return (parameter * size, *(value / size for value in others))

    program = record(units, (unit, *own), (system.family_parameter,))
    values = at_start(program, [point[name] for name in program.inputs])
    return dict(zip((system.family_parameter, *own), values, strict=True))
