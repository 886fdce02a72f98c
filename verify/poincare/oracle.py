"""What a chapter may ask an oracle (section 3.2): whatever it answers, nothing false follows."""

from __future__ import annotations

from collections.abc import Sequence
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
