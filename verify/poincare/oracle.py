"""What a chapter may ask an oracle (section 3.2): whatever it answers, nothing false follows."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Protocol

from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series
from orbitproof.verify.flow import Expansion
from orbitproof.verify.poincare.coordinates import Coordinates


class Oracle(Protocol):
    """Finds approximations; who asks checks what it gets, or nothing rests on it. `verify.oracle` has one."""

    def expand(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> Expansion:
        """The solutions of x' = f(x, parameters) from a state, expanded in time."""

    def return_times(
        self,
        program: PreparedProgram,
        arithmetic: Arithmetic,
        section: int,
        state: Sequence[Series],
        constants: Sequence[Series],
    ) -> list[Fraction] | None:
        """Coefficients of 1, s, s^2, .. of the time of the first return divided by that at s = 0; `None` if not found.

        Args:
            section: index of the section coordinate, which vanishes at the start.
        """

    def regularised_steps(
        self,
        own: Coordinates,
        other: Coordinates,
        point: Sequence[float],
        parameters: Sequence[float],
        level: float,
        arithmetic: Arithmetic,
    ) -> int:
        """About as many steps as a half return takes in `other`, regularised coordinates; 0 if it takes less time in
        the system's own.

        Args:
            point: the state on Fix(R), in the system's own coordinates.
        """
