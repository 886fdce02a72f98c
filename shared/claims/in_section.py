"""Boxes in a section: what claims about periodic orbits of which no symmetry is used have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Numbers, Rows, Vector
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry, check_numbers, check_positive, refuse
from orbitproof.shared.stored import Rational
from orbitproof.shared.systems import System


@dataclass(frozen=True, repr=False)
class BoxInSection(WithoutSymmetry):
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
        size = len(self.system.given_state)
        self.check_setting()
        if type(self.direction) is not int or self.direction not in (1, -1):
            refuse("direction", f"{self.direction!r} is no direction", "give 1 or -1")
        if type(self.crossings) is not int or self.crossings < 1:
            refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        self.check_lengths({"normal": size, "centre": size, "radii": size - 1})
        if len(self.frame) != size or any(len(row) != size - 1 for row in self.frame):
            refuse("frame", "wrong shape", f"give {size} rows of {size - 1} numbers")
        check_numbers({
            "normal": [self.normal],
            "offset": [(self.offset,)],
            "centre": [self.centre],
            "frame": self.frame,
            "radii": [self.radii],
        })  # fmt: skip
        check_positive("radii", self.radii)

    def check_level(self, level: Fraction | None) -> None:
        """Raises `InputError` for the level of a first integral that the system does not have."""
        if level is None:
            return
        if self.system.first_integral_program is None:
            refuse("level", f"{self.system.name} has no first integral", "leave it out")
        check_numbers({"level": [(level,)]}, rational=True)

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box, and then of what varies, if anything does."""
        return self.radii
