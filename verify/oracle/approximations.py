"""The oracle that all commands use (section 3.2)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from orbitproof.verify import oracle
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series
from orbitproof.verify.flow import Expansion
from orbitproof.verify.oracle.frames import Frames
from orbitproof.verify.oracle.steps import further_steps, regularised_steps
from orbitproof.verify.oracle.wide_solution import expand
from orbitproof.verify.poincare import Coordinates


class Approximations(Frames):
    """See `poincare.Oracle`, and `flow.FrameOracle`."""

    def expand(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> Expansion:
        """See `poincare.Oracle`."""
        return expand(program, arithmetic, state, parameters)

    def return_times(
        self,
        program: PreparedProgram,
        arithmetic: Arithmetic,
        section: int,
        state: Sequence[Series],
        constants: Sequence[Series],
        crossing: int = 1,
    ) -> list[Fraction] | None:
        """See `poincare.Oracle`."""
        try:
            # Loaded when a wide piece asks for them.
            return oracle.relative_return_times(program, arithmetic, section, state, constants, crossing)
        except (ArithmeticError, ValueError):
            return None

    def regularised_steps(
        self,
        own: Coordinates,
        other: Coordinates,
        point: Sequence[float],
        parameters: Sequence[float],
        level: float,
        arithmetic: Arithmetic,
    ) -> int:
        """See `poincare.Oracle`."""
        try:
            return regularised_steps(own, other, point, parameters, level, arithmetic.bits, arithmetic.degree)
        except (ArithmeticError, TypeError, ValueError):
            return 0

    def further_steps(
        self,
        coordinates: Coordinates,
        arithmetic: Arithmetic,
        state: Sequence[Series],
        constants: Sequence[Series],
        crossings: int,
    ) -> int:
        """See `maps.FramingOracle`."""
        try:
            return further_steps(coordinates, arithmetic, state, constants, crossings)
        except (ArithmeticError, ValueError):
            return 0


class _InFrames(Approximations):
    everywhere = True


ORACLE = Approximations()
IN_FRAMES = _InFrames()
"""The same, with frames for flows that preserve volume too."""
