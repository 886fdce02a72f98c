"""Systems in units of the orbit: a point of an orbit in the units of that point (18.9, 18.14, 18.15)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import ReversibleSystem, record
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
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


def degrees_of(system: ReversibleSystem) -> dict[str, int]:
    """By which power of lambda state coordinates and family parameter are multiplied, so that orbits become orbits.

    Of orbits in units of their speed across the plane z and z' are, and eps2 by lambda^-2; else all of the state.
    """
    parameter = str(system.family_parameter)
    if is_of_axial_orbits(system):
        return {name: int(name in ("z", "vz")) for name in system.state} | {parameter: -2}
    return dict.fromkeys(system.state, 1) | {parameter: -1}


def scales(system: ReversibleSystem) -> bool:
    """Whether f, as a program, is multiplied like the state where state and parameter are, lambda != 0."""
    degrees = degrees_of(system)
    arguments = [_Degree(Fraction(degrees.get(name, 0))) for name in system.program.inputs]
    values = system.program.evaluate(arguments, lambda _: _Degree(Fraction(0)), _Degree.power)
    return all(value == _Degree(Fraction(degrees[name])) for name, value in zip(system.state, values, strict=True))


def is_of_vertical_orbits(system: ReversibleSystem) -> bool:
    """Whether points of a system stand for vertical orbits, up to z -> -z (section 18.14)."""
    if not system.normalised:
        return False
    from orbitproof.shared.systems import VERTICAL

    return any(system is known for known in VERTICAL.values())


def units_of(system: ReversibleSystem) -> tuple[str, str]:
    """The coordinates that are 1 in the orbit's own units: at x, and at the other point (18.9, 18.14, 18.15).

    Vertical orbits have w = 1 on the axis, where u = 0, and u = 1 off it, where w = 0. Raises `IntegrationFailure` for
    systems without such units.
    """
    names = tuple(name for name, value in system.normalised.items() if value == 1)
    if len(names) == 1 and system.family_parameter is not None and scales(system):
        if len(system.normalised) == 1:
            return names[0], names[0]
        if is_of_vertical_orbits(system):
            (other,) = set(system.normalised) - set(names)
            return names[0], other
    message = f"the other point of an orbit of {system.name} is not known in its own units"
    raise IntegrationFailure("stability", message, "ask for the list of another curve")


def at_other_point(system: ReversibleSystem) -> ReversibleSystem:
    """The system with the initial values of the other point of an orbit, in its own units."""
    unit = units_of(system)[1]
    return replace(system, normalised={name: Fraction(int(name == unit)) for name in system.normalised})


def in_own_units(system: ReversibleSystem, unit: str, point: Mapping[str, Series]) -> dict[str, Series]:
    """The coordinates of a centre for a point of Fix(R) that is not normalised: (nu x, y/x) for each other y (18.7).

    x, with the name `unit`, is to be 1; powers of it are those of `degrees_of`. Raises `IntegrationFailure` if it may
    be zero, where something is divided by it.
    """
    own = [name for name in system.centre_coordinates if name in system.state]
    degrees, parameter = degrees_of(system), str(system.family_parameter)

    def units(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        size, *others = state
        named = zip((parameter, *own), (*parameters, *others), strict=True)
        return tuple(_over(value, size, degrees[name]) for name, value in named)

    program = record(units, (unit, *own), (parameter,))
    values = at_start(program, [point[name] for name in program.inputs])
    return dict(zip((parameter, *own), values, strict=True))


def _over(value: Any, size: Any, degree: int) -> Any:
    """A value divided by a power of the size."""
    for _ in range(abs(degree)):
        value = value / size if degree > 0 else value * size
    return value
