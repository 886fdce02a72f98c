"""Orbits of any system whose errors are carried in a frame (sections 4.4 and 23.1)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Protocol

from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.flow import Expansion, FlowStep, FrameOracle, InFrame
from orbitproof.verify.poincare import Coordinates, Oracle, Orbits


class FramingOracle(Oracle, FrameOracle, Protocol):
    """What may be asked about orbits without symmetry."""

    def further_steps(
        self,
        coordinates: Coordinates,
        arithmetic: Arithmetic,
        state: Sequence[Series],
        constants: Sequence[Series],
        crossings: int,
    ) -> int:
        """About as many steps as the orbits take to so many further crossings; 0 if they are not found to come back."""


class FramedOrbits(Orbits):
    """As `Orbits`, their errors in a frame that the steps hand on."""

    def __init__(
        self,
        coordinates: Coordinates,
        arithmetic: Arithmetic,
        state: Sequence[Series],
        constants: Sequence[Series],
        oracle: FramingOracle,
        side: int = 0,
    ) -> None:
        """As for `Orbits`."""
        super().__init__(coordinates, arithmetic, state, constants, oracle, side)
        self._carried = InFrame(oracle)
        self._framing = oracle

    def further_steps(self, crossings: int) -> int:
        """See `FramingOracle`."""
        return self._framing.further_steps(self.coordinates, self.arithmetic, self.state, self.fixed, crossings)

    def _advance(self, expansion: Expansion, step: Fraction) -> FlowStep:
        return self._carried.advance(self.program, self.state, self.fixed, expansion, step)
