"""Claims about periodic orbits of vector fields of which no symmetry is used."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal, NoReturn

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Matrix, Numbers, Rows, Vector
from orbitproof.shared.errors import InputError, short
from orbitproof.shared.numbers import NUMBER, RATIONAL, format_exact, format_rational
from orbitproof.shared.stored import Rational, stored
from orbitproof.shared.systems import ID, ID_IN_WORDS, System, fits

PERIODIC = "periodic"
"""What a claim about a periodic orbit without symmetry says as its kind."""


@dataclass(frozen=True, repr=False)
class PeriodicOrbit:
    """A claim: the box ``centre + frame p`` in a section contains exactly one point of a periodic orbit as described.

    The section is the set of the x with normal . x = offset. A crossing is a point of an orbit on it where normal . x
    grows (direction 1) or falls (direction -1) in time. The orbit of the point meets the section so in as many points
    as `crossings` says, itself included, and returns to itself at the last of them.

    Attributes:
        id: unique name within a file.
        system: the vector field; if the system has a symmetry, it is not used.
        parameters: exact values of all parameters of the vector field, by name.
        normal: shape (N,), not zero; of the section.
        offset: of the section.
        direction: 1 or -1.
        crossings: m, the number of points in which the orbit crosses the section in the direction.
        centre: shape (N,), a point of the section, in the order of the state.
        frame: shape (N, N - 1), rows; its columns span the section; column j is the direction of p_j.
        radii: shape (N - 1,), half-widths of the box in p, all positive.
        level: of the first integral, on which the orbit is claimed to lie, exactly; `None` where the system has no
            first integral, or where none is used.
        provenance: free-form, ignored by the verifier.
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
    level: Rational | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = PERIODIC

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        names = self.system.state
        size, wanted = len(names), ", ".join(names)
        if not fits(ID, self.id):
            _refuse("id", f"{self.id!r} is no id", ID_IN_WORDS)
        if self.system.defined:
            functions = ", ".join(each.name for each in self.system.defined)
            _refuse("system", f"{functions} are functions of other coordinates", "write it in plain arithmetic")
        if type(self.direction) is not int or self.direction not in (1, -1):
            _refuse("direction", f"{self.direction!r} is no direction", "give 1 or -1")
        if type(self.crossings) is not int or self.crossings < 1:
            _refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        if set(self.parameters) != set(self.system.parameters):
            known = ", ".join(self.system.parameters) or "none"
            _refuse("parameters", f"{self.system.name} takes the parameters: {known}", "give exactly these")
        for name, values, length in (("normal", self.normal, size), ("centre", self.centre, size),
                                     ("radii", self.radii, size - 1)):  # fmt: skip
            if len(values) != length:
                _refuse(name, f"{len(values)} numbers", f"give {length}; the state is {wanted}")
        if len(self.frame) != size or any(len(row) != size - 1 for row in self.frame):
            _refuse("frame", "wrong shape", f"give {size} rows of {size - 1} numbers")
        _check_numbers(self)
        for position, radius in enumerate(self.radii):
            if radius <= 0:
                _refuse(f"radii[{position}]", "not positive", "give positive half-widths")
        for name, value in self.parameters.items():
            interval = self.system.parameters[name]
            if not interval.contains(value):
                _refuse(f"parameters.{name}", f"{short(str(value))} lies outside {interval}", "choose a value inside")
        if self.level is not None and self.system.first_integral_program is None:
            _refuse("level", f"{self.system.name} has no first integral", "leave it out")

    def __repr__(self) -> str:
        return f"<PeriodicOrbit {self.id!r}: {self.crossings} crossings, of {self.system.name}>"

    @property
    def k(self) -> int:
        """As of other claims about boxes: no multiplicity."""
        return 1

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre, N of them."""
        return self.system.state

    @property
    def values(self) -> Vector:
        """The parameters in the vector field's order."""
        return tuple(self.parameters[name] for name in self.system.parameters)


def _refuse(name: str, why: str, remedy: str) -> NoReturn:
    raise InputError(f"{name}: {why}; {remedy}")


def _check_numbers(claim: PeriodicOrbit) -> None:
    """All numbers are exact, and can be written."""
    groups: dict[str, Matrix | Sequence[Vector]] = {
        **{f"parameters.{name}": [(value,)] for name, value in claim.parameters.items()},
        "normal": [claim.normal],
        "offset": [(claim.offset,)],
        "centre": [claim.centre],
        "frame": claim.frame,
        "radii": [claim.radii],
        "level": [] if claim.level is None else [(claim.level,)],
    }
    for name, rows in groups.items():
        rational = name.startswith("parameters") or name == "level"
        for value in (value for row in rows for value in row):
            if isinstance(value, bool) or not isinstance(value, (int, Fraction)):
                _refuse(name, f"{value!r} is no exact number", "give Fractions, shared.parse_exact reads them")
            try:
                text = format_rational(Fraction(value)) if rational else format_exact(Fraction(value))
            except ValueError:
                _refuse(name, f"{short(str(value))} is neither dyadic nor decimal", "round it to a decimal number")
            if re.fullmatch(RATIONAL if rational else NUMBER, text) is None:
                why = "a number is too long to be written exactly"
                _refuse(name, why, "give fewer digits or an exponent closer to 0")
