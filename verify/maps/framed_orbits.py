"""Orbits of any system whose errors are carried in a frame (sections 4.4 and 23.1)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Protocol

from orbitproof.verify.algebra import Arithmetic, Series
from orbitproof.verify.flow import Expansion, FlowStep, FrameOracle, InFrame
from orbitproof.verify.poincare import MOST_STEPS, Coordinates, Oracle, Orbits

MOST_EXPECTED = 20_000
"""Further steps that orbits are followed to a crossing, if an approximation comes back: some stiff ones need them."""


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
        *more: int,
    ) -> None:
        """As for `Orbits`; `more` is what follows there."""
        super().__init__(coordinates, arithmetic, state, constants, oracle, *more)
        self._carried = InFrame(oracle)
        self._framing = oracle
        self._most: dict[int, int] = {}

    def may_step(self, number: int, crossings: int) -> bool:
        """Whether steps are left to crossing `number`, of which so many are in the direction (section 23.3)."""
        if self.steps < crossings * 2 * MOST_STEPS:
            return True
        if number not in self._most:
            left = number - min(counter.crossings for counter in self.counters)
            further = self._framing.further_steps
            expected = 2 * further(self.coordinates, self.arithmetic, self.state, self.constants, left)
            self._most[number] = self.steps + min(max(expected, 0), crossings * MOST_EXPECTED)
        return self.steps < self._most[number]

    def _advance(self, expansion: Expansion, step: Fraction) -> FlowStep:
        return self._carried.advance(self.program, self.state, self.fixed, expansion, step)
