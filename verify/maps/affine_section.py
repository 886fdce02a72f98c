"""Affine sections, and coordinates in which such a section is a coordinate plane (section 23.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import Program, record
from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.maps.starting_set import StartingSet
from orbitproof.verify.poincare import Coordinates, at_start, coordinates_of

NAME = "with the section coordinate"


@dataclass(frozen=True)
class AffineSection:
    """The points of the state space with normal . x = offset, exactly; normal is not zero.

    Attributes:
        normal: one number for each state coordinate, 0 for those that are functions of others.
        offset: the value of normal . x on the section.
    """

    normal: tuple[Fraction, ...]
    offset: Fraction

    @property
    def pivot(self) -> int:
        """The state coordinate that follows from the others on the section: the normal has no larger entry."""
        return max(range(len(self.normal)), key=lambda index: abs(self.normal[index]))

    def holds(self, start: StartingSet) -> bool:
        """Whether all points of a set lie on the section."""
        rows = list(zip(self.normal[: start.size], start.centre, start.frame, strict=False))
        value = sum((a * c for a, c, _ in rows), Fraction(0))
        directions = (sum((a * row[j] for a, _, row in rows), Fraction(0)) for j in range(len(start.radii)))
        return value == self.offset and not any(directions)

    def coordinates(self, program: Program) -> Coordinates:
        """The vector field with y = normal . x - offset in place of the state coordinate `pivot`."""
        size = len(self.normal)

        def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
            own = self._own(state)
            slopes = program.evaluate([*own, *parameters], lambda value: value, lambda base, power: base**power)
            return [*slopes[: self.pivot], self._along(slopes), *slopes[self.pivot + 1 :]]

        recorded = record(field, program.inputs[:size], program.inputs[size:])
        return coordinates_of(NAME, recorded, size, self.pivot)

    def section_coordinate(self, start: StartingSet, arithmetic: Arithmetic) -> Series:
        """y on a set: exactly zero if it lies on the section."""
        factors = [*self.normal[: start.size], *[Fraction(0)] * (len(start.centre) - start.size)]
        return start.element(arithmetic, factors, -self.offset)

    def own_state(self, state: Sequence[Series]) -> list[Series]:
        """The system's state at elements of the other coordinates that do not depend on time."""
        names = [f"x{index}" for index in range(len(state))]
        return at_start(record(self._own, names), state)

    def _along(self, slopes: Sequence[Any]) -> Any:
        terms = [a * slope for a, slope in zip(self.normal, slopes, strict=True) if a]
        return sum(terms[1:], terms[0])

    def _own(self, state: Sequence[Any]) -> list[Any]:
        value = state[self.pivot] + self.offset if self.offset else state[self.pivot]
        for index, a in enumerate(self.normal):
            if a and index != self.pivot:
                value = value - a * state[index]
        factor = 1 / self.normal[self.pivot]
        return [*state[: self.pivot], value if factor == 1 else factor * value, *state[self.pivot + 1 :]]
