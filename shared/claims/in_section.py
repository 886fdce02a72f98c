"""Boxes in a section: what claims about periodic orbits of which no symmetry is used have in common."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, NoReturn

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Matrix, Numbers, Rows, Vector
from orbitproof.shared.errors import InputError, short
from orbitproof.shared.numbers import NUMBER, RATIONAL, format_exact, format_rational
from orbitproof.shared.stored import Rational
from orbitproof.shared.systems import ID, ID_IN_WORDS, System, fits


@dataclass(frozen=True, repr=False)
class BoxInSection:
    """The box ``centre + frame p`` in a section, and how often an orbit crosses the section until it returns.

    The section is the set of the x with normal . x = offset. A crossing is a point of an orbit on it where normal . x
    grows (direction 1) or falls (direction -1) in time.

    Attributes:
        id: unique name within a file.
        system: the vector field; if the system has a symmetry, it is not used.
        parameters: exact values of all parameters of the vector field, by name.
        normal: shape (N,), not zero; of the section.
        offset: of the section.
        direction: 1 or -1.
        crossings: m, the number of points in which the orbit crosses the section in the direction.
        centre: shape (N,), a point of the section, in the order of the state but for functions of other coordinates.
        frame: shape (N, N - 1), rows; its columns span the section; column j is the direction of p_j.
        radii: shape (N - 1,), half-widths of the box in p, all positive.
    """

    id: Id
    system: System
    parameters: Mapping[Identifier, Rational]
    normal: Numbers
    offset: Fraction
    direction: Literal[1, -1]
    crossings: Crossings
    centre: Numbers
    frame: Rows
    radii: Numbers

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        names = self.system.given_state
        size, wanted = len(names), ", ".join(names)
        if not fits(ID, self.id):
            refuse("id", f"{self.id!r} is no id", ID_IN_WORDS)
        if type(self.direction) is not int or self.direction not in (1, -1):
            refuse("direction", f"{self.direction!r} is no direction", "give 1 or -1")
        if type(self.crossings) is not int or self.crossings < 1:
            refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        if set(self.parameters) != set(self.system.parameters):
            known = ", ".join(self.system.parameters) or "none"
            refuse("parameters", f"{self.system.name} takes the parameters: {known}", "give exactly these")
        for name, values, length in (("normal", self.normal, size), ("centre", self.centre, size),
                                     ("radii", self.radii, size - 1)):  # fmt: skip
            if len(values) != length:
                refuse(name, f"{len(values)} numbers", f"give {length}; the state is {wanted}")
        if len(self.frame) != size or any(len(row) != size - 1 for row in self.frame):
            refuse("frame", "wrong shape", f"give {size} rows of {size - 1} numbers")
        check_numbers({
            "normal": [self.normal],
            "offset": [(self.offset,)],
            "centre": [self.centre],
            "frame": self.frame,
            "radii": [self.radii],
        })  # fmt: skip
        check_numbers({f"parameters.{name}": [(value,)] for name, value in self.parameters.items()}, rational=True)
        check_positive("radii", self.radii)
        for name, value in self.parameters.items():
            interval = self.system.parameters[name]
            if not interval.contains(value):
                refuse(f"parameters.{name}", f"{short(str(value))} lies outside {interval}", "choose a value inside")

    def check_level(self, level: Fraction | None) -> None:
        """Raises `InputError` for the level of a first integral that the system does not have."""
        if level is None:
            return
        if self.system.first_integral_program is None:
            refuse("level", f"{self.system.name} has no first integral", "leave it out")
        check_numbers({"level": [(level,)]}, rational=True)

    @property
    def k(self) -> int:
        """As of other claims about boxes: no multiplicity."""
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
