"""What claims about a vector field have in common of which no symmetry is used."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NoReturn

from orbitproof.shared.claims.fields import Matrix, Vector
from orbitproof.shared.errors import InputError, short
from orbitproof.shared.numbers import NUMBER, RATIONAL, format_exact, format_rational
from orbitproof.shared.systems import ID, ID_IN_WORDS, System, fits


class WithoutSymmetry:
    """A claim about a vector field; if the system has a symmetry, it is not used.

    Attributes:
        id: unique name within a file.
        system: the vector field.
        parameters: exact values of all parameters of the vector field, by name.
        kind: what is claimed.
        level: of a first integral; `None` where none is used.
    """

    id: str
    system: System
    parameters: Mapping[str, Fraction]
    kind: str
    level: Fraction | None = None

    is_of_orbit = uses_reversor = False

    def check_setting(self) -> None:
        """Raises `InputError` for an id that is none, and for parameters that are not those of the system."""
        if not fits(ID, self.id):
            refuse("id", f"{self.id!r} is no id", ID_IN_WORDS)
        if set(self.parameters) != set(self.system.parameters):
            known = ", ".join(self.system.parameters) or "none"
            refuse("parameters", f"{self.system.name} takes the parameters: {known}", "give exactly these")
        check_numbers({f"parameters.{name}": [(value,)] for name, value in self.parameters.items()}, rational=True)
        for name, value in self.parameters.items():
            interval = self.system.parameters[name]
            if not interval.contains(value):
                refuse(f"parameters.{name}", f"{short(str(value))} lies outside {interval}", "choose a value inside")

    def check_lengths(self, lengths: Mapping[str, int]) -> None:
        """Raises `InputError` for a field that has not so many numbers."""
        for name, length in lengths.items():
            if (given := len(getattr(self, name))) != length:
                state = ", ".join(self.system.given_state)
                refuse(name, f"{given} numbers", f"give {length}; the state is {state}")

    def check_varying(self, name: str, radius: Fraction) -> None:
        """Raises `InputError` for a parameter that the system does not have, or whose interval leaves its range."""
        if name not in self.parameters:
            known = ", ".join(self.parameters) or "none"
            refuse("parameter", f"{self.system.name} has no {short(name)!r}; it has {known}", "name one of these")
        interval, value = self.system.parameters[name], self.parameters[name]
        if not all(interval.contains(value + side * radius) for side in (-1, 1)):
            refuse("parameter_radius", f"the values leave {interval}", "give a smaller half-width")

    @property
    def k(self) -> int:
        """1: no multiplicity. Other claims about boxes have one."""
        return 1

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre, N of them."""
        return self.system.given_state

    @property
    def values(self) -> Vector:
        """The parameters in the vector field's order."""
        return tuple(self.parameters[name] for name in self.system.parameters)


def refuse(name: str, why: str, remedy: str) -> NoReturn:
    """Raises `InputError`, one line that begins with the field."""
    raise InputError(f"{name}: {why}; {remedy}")


def check_positive(name: str, radii: Sequence[Fraction]) -> None:
    """Raises `InputError` for a half-width that is none."""
    for position, radius in enumerate(radii):
        if radius <= 0:
            refuse(f"{name}[{position}]", "not positive", "give positive half-widths")


def check_numbers(groups: Mapping[str, Matrix | Sequence[Vector]], rational: bool = False) -> None:
    """All numbers are exact, and can be written, as fractions too if they are `rational`. Raises `InputError`."""
    for name, rows in groups.items():
        for value in (value for row in rows for value in row):
            if isinstance(value, bool) or not isinstance(value, (int, Fraction)):
                refuse(name, f"{value!r} is no exact number", "give Fractions, shared.parse_exact reads them")
            try:
                text = format_rational(Fraction(value)) if rational else format_exact(Fraction(value))
            except ValueError:
                refuse(name, f"{short(str(value))} is neither dyadic nor decimal", "round it to a decimal number")
            if re.fullmatch(RATIONAL if rational else NUMBER, text) is None:
                refuse(
                    name, "a number is too long to be written exactly", "give fewer digits or an exponent closer to 0"
                )
