"""Half orbits of all points of a set, over a wide variable too, and their times (sections 5.3, 8.8 and 15).

With a wide variable, crossings are counted separately on parts of its interval, and the vector field is multiplied
by a function of it, the *rate*, so that all orbits return about together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol

from flint import arb

from orbitproof.shared.systems import Program, own_name, record
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, evaluate, prepare
from orbitproof.verify.evidence import IntegrationFailure, exact_value, excludes_zero, is_positive
from orbitproof.verify.flow import FlowStep
from orbitproof.verify.poincare.coordinates import Coordinates
from orbitproof.verify.poincare.crossing import CrossingCounter, range_of, wide_parts
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.returns import Orbits, Returns

if TYPE_CHECKING:
    from orbitproof.shared.systems import Regularisation

_NEGLIGIBLE_CHANGE = 2.0**-6
WIDE_PARTS = 8
"""On so many parts of the wide variable's interval crossings are counted."""


class WideOracle(Oracle, Protocol):
    """What may be asked besides about orbits over a wide variable (section 5.3)."""

    def return_times(
        self,
        program: PreparedProgram,
        arithmetic: Arithmetic,
        section: int,
        state: Sequence[Series],
        constants: Sequence[Series],
        crossing: int = 1,
    ) -> list[Fraction] | None:
        """Coefficients of 1, s, s^2, .. of the time of a crossing divided by that at s = 0; `None` if not found.

        Args:
            section: index of the section coordinate, which vanishes at the start.
            crossing: its number, in either direction.
        """


class WideOrbits(Orbits):
    """As `Orbits`, the wide variable in parts.

    Attributes:
        rate: with a wide variable, what the vector field is multiplied by, if not 1: the system's time by that of
            the integration. The delay is not multiplied by it.
    """

    def __init__(
        self,
        coordinates: Coordinates,
        arithmetic: Arithmetic,
        state: Sequence[Series],
        constants: Sequence[Series],
        oracle: WideOracle,
        side: int = 0,
        wanted: int = 1,
    ) -> None:
        """As for `Orbits`; `wanted` is the number of the crossing that wide orbits shall reach about together."""
        super().__init__(coordinates, arithmetic, state, constants, oracle, side)
        self.wide_oracle = oracle
        self.rate: Series | None = None
        if arithmetic.width:
            self.counters = [CrossingCounter(part, side) for part in wide_parts(WIDE_PARTS)]
            self.rate = self._rate(wanted)
        if self.rate is not None:
            self.program = prepare(at_rate(self.coordinates.field))
            self.fixed = [*self.constants, self.rate]

    def _rate(self, wanted: int) -> Series | None:
        """A positive element by which the vector field is multiplied so that wide orbits return about together."""
        arithmetic, coordinates = self.arithmetic, self.coordinates
        program, section = coordinates.program, coordinates.section
        powers = self.wide_oracle.return_times(program, arithmetic, section, self.state, self.constants, wanted)
        if powers is None or sum(map(abs, powers[1:])) < _NEGLIGIBLE_CHANGE:
            return None
        rate = arithmetic.polynomial({arithmetic.grading.monomials[0]: powers})
        return rate if all(is_positive(range_of(rate, counter.wide)) for counter in self.counters) else None

    def rate_on(self, part: arb | None) -> arb:
        """See `Orbits`."""
        return arb(1) if self.rate is None else range_of(self.rate, part)

    @property
    def return_time(self) -> Series:
        """The system's time at the crossing that was found last, for all orbits."""
        regularisation = self.coordinates.regularisation
        if regularisation is not None:
            return self.image[regularisation.time_index]
        rate = self.arithmetic.constant(Fraction(1)) if self.rate is None else self.rate
        middle, radius = exact_value(self.time.mid()), exact_value(self.time.rad())
        return rate * self.arithmetic.constant(middle).widened(radius) + self.delay


class HalfOrbits(Returns, WideOrbits):
    """As `Returns`, the wide variable in parts: see `WideOrbits`."""

    def clock_rate(self, flow: FlowStep, regularisation: Regularisation) -> Series:
        """See `Returns`; over a wide piece the bounds of the tube are too coarse for a passage close to the primary."""
        if not self.arithmetic.width:
            return super().clock_rate(flow, regularisation)
        field = self.coordinates.field
        only = prepare(replace(field, outputs=(field.outputs[regularisation.time_index],)))
        return evaluate(only, [*flow.solution, *self.constants])[0]

    def half_orbit(self, crossings: int, progress: Callable[[int], None] | None = None) -> tuple[Sequence[Series], arb]:
        """As `next_crossing`, at crossing number `crossings`, at none before which an orbit is in Fix(R) (section 8.8).

        Raises `IntegrationFailure` also if that is not shown.
        """
        parts = [counter.wide for counter in self.counters]
        for number in range(1, crossings):
            state, _ = self.next_crossing(progress)
            kernel = [state[index] for index in self.system.kernel_coordinates]
            if not all(any(excludes_zero(range_of(value, part)) for value in kernel) for part in parts):
                raise IntegrationFailure(
                    "half-orbit",
                    f"orbits may be in Fix(R) at crossing {number} already",
                    "claim fewer crossings, or give a narrower piece",
                    needs_precision=True,
                )
        return self.next_crossing(progress)


def at_rate(field: Program) -> Program:
    """The vector field times a constant, which becomes the last input: the same orbits in another time."""

    def scaled(arguments: Sequence[Any], rate: Sequence[Any]) -> Sequence[Any]:
        velocity = field.evaluate(arguments, lambda value: value, lambda base, exponent: base**exponent)
        return [rate[0] * component for component in velocity]

    return record(scaled, field.inputs, (own_name("rate"),))
