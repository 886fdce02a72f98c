"""Successive returns to the section of a set of orbits (sections 3 to 5 and 14).

`Orbits` follows the orbits of elements of the algebra from one crossing of the section to the next, with the proof that
it is that crossing; `Returns` those that start on the section.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from typing import TYPE_CHECKING

from flint import arb

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Series, at_start
from orbitproof.verify.evidence import IntegrationFailure, enclose, is_positive
from orbitproof.verify.flow import Expansion, FlowStep, advance, planned_step, rough
from orbitproof.verify.poincare.coordinates import Coordinates, physical
from orbitproof.verify.poincare.crossing import CrossingCounter, may_touch, range_of, stays_positive
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.section import onto_section
from orbitproof.verify.poincare.settings import AUTO, PHYSICAL, REGULARISED

if TYPE_CHECKING:
    from orbitproof.shared.systems import Regularisation

_LEAST_SHARE = 1 / 8
MOST_STEPS = 400
"""From one crossing to the next."""


def default_order(precision: int) -> int:
    """Degree of the time expansions that was found fast for a precision in bits."""
    return max(16, precision // 2)


class Orbits:
    """The orbits of a set of points, and their crossings of the section so far.

    Attributes:
        state: the orbits now, in the coordinates that are integrated.
        constants: the constants of motion.
        program, fixed: the vector field that is followed, and its inputs after the state.
        coordinates: which coordinates these are.
        steps: number of integration steps so far.
        step_taken: the enclosure of the last of them, the time of the integration at its beginning, its length.
        crossings: number of crossings that `next_crossing` has found.
        image: the orbits at the last of them.
        delay: time from the last step to there.
    """

    def __init__(
        self,
        coordinates: Coordinates,
        arithmetic: Arithmetic,
        state: Sequence[Series],
        constants: Sequence[Series],
        oracle: Oracle,
        side: int = 0,
    ) -> None:
        """Start on the section exactly, or on one side of it.

        Args:
            oracle: finds approximations; nothing is believed of it.
            side: the sign of the section coordinate at all points; 0 on the section.
        """
        self.coordinates, self.arithmetic, self.oracle = coordinates, arithmetic, oracle
        self.state, self.constants = list(state), list(constants)
        self.counters = [CrossingCounter(side=side)]
        self.program, self.fixed = coordinates.program, self.constants
        self.time = arb(0)
        self.steps = 0
        self.crossings = 0
        self.share = 1.0
        self.at_section = side == 0
        self.image, self.delay = list(self.state), arithmetic.constant(Fraction(0))
        self.step_taken: tuple[FlowStep, arb, Fraction] | None = None

    def _advance(self, expansion: Expansion, step: Fraction) -> FlowStep:
        return advance(self.program, self.state, self.fixed, expansion, step)

    def _leave(self, image: Sequence[Series]) -> Sequence[Series]:
        """The system's own state."""
        return image

    def next_crossing(self, progress: Callable[[int], None] | None = None) -> tuple[Sequence[Series], arb]:
        """The system's own state at the next crossing, and its time, with the proof that it is that crossing.

        `progress` is called after every step with the number of steps; what it raises passes through. Raises
        `IntegrationFailure`, also if there is no crossing within `MOST_STEPS` steps.
        """
        for _ in range(MOST_STEPS):
            try:
                arrived = self.step()
                if arrived:
                    self.crossings += 1
                    found = self.crossing(self.crossings)
            except IntegrationFailure as failure:
                raise failure.at(self._clock()) from None
            if progress is not None:
                progress(self.steps)
            if arrived:
                return found
        raise IntegrationFailure(
            "steps", f"no crossing number {self.crossings + 1} within {MOST_STEPS} steps", "give another centre"
        )

    def step(self) -> bool:
        """Advance by one step; true if it ends, at the centre, at the next crossing."""
        section = self.coordinates.section
        expansion = self.oracle.expand(self.program, self.arithmetic, self.state, self.fixed)
        while True:
            step = expansion.shortened(planned_step(expansion.step_size, self.share, self._clock()))
            root = expansion.crossing(section, step, self.at_section)
            step = step if root is None else step * root
            try:
                flow = self._advance(expansion, step)
                break
            except IntegrationFailure:
                if self.share <= _LEAST_SHARE:
                    raise
                self.share /= 2
        self._check_time(flow)
        for counter in self.counters:
            counter.cover(flow.solution[section], flow.slopes[section], self.time, enclose(step))
        self.state = list(flow.end)
        self.step_taken = flow, self.time, step
        self.time = self.time + enclose(step)
        self.steps += 1
        self.at_section = root is not None
        return self.at_section

    def crossing(self, number: int) -> tuple[Sequence[Series], arb]:
        """The system's own state at crossing `number`, and its time, with the proof that it is that crossing."""
        arrivals = [counter.arrival(number) for counter in self.counters]
        if any(arrival is None for arrival in arrivals):
            raise may_touch(f"the orbit at time {self._clock():.6g} was not proved to be at crossing {number}")
        coordinates = self.coordinates
        self.image, self.delay = onto_section(
            coordinates.section_program,
            coordinates.section,
            self.arithmetic,
            self._close_to_section(),
            self.constants,
            self.oracle,
        )
        for counter, arrival in zip(self.counters, arrivals, strict=True):
            delay = range_of(self.delay, counter.wide)
            if (
                arrival is None
                or not is_positive(self.rate_on(counter.wide) * (self.time - arrival.since) + delay)
                or (arrival.behind and not is_positive(-delay))
            ):
                raise IntegrationFailure(
                    "crossing count",
                    f"the time of crossing {number} is not separated from the crossing before it",
                    "the box is too large: give smaller radii",
                )
        if coordinates.regularisation is None:
            time = self.rate_on(None) * self.time + range_of(self.delay)
        else:
            time = range_of(self.image[coordinates.regularisation.time_index])
        return self._leave(self.image), time

    def _close_to_section(self) -> Sequence[Series]:
        """The state now, its section coordinate from the others if that is known better (section 14.3)."""
        regularisation, section = self.coordinates.regularisation, self.coordinates.section
        if regularisation is None:
            return self.state
        (found,) = at_start(regularisation.section_program, self.state)
        better = found if found.errors[0] < self.state[section].errors[0] else self.state[section]
        return [*self.state[:section], better, *self.state[section + 1 :]]

    def rate_on(self, part: arb | None) -> arb:
        """The system's time by that of the integration, on a part of the wide variable's interval."""
        return arb(1)

    def _check_time(self, flow: FlowStep) -> None:
        """Regularised coordinates describe an orbit as long as their time runs forwards (section 14)."""
        regularisation = self.coordinates.regularisation
        if regularisation is None:
            return
        rate = self.clock_rate(flow, regularisation)
        if not all(stays_positive(rate, counter.wide) for counter in self.counters):
            raise IntegrationFailure(
                "collision",
                f"the orbits are not shown to stay away from a collision at time {self._clock():.6g}",
                "give smaller radii or another centre",
                needs_precision=True,
            )

    def clock_rate(self, flow: FlowStep, regularisation: Regularisation) -> Series:
        """The derivative of the system's time over a step, for all orbits."""
        return flow.slopes[regularisation.time_index]

    def _clock(self) -> float:
        """About the system's time, for messages."""
        regularisation = self.coordinates.regularisation
        if regularisation is None:
            return float(self.time)
        return rough([int(self.state[regularisation.time_index].coefs[0][0])], self.arithmetic.bits)[0]


class Returns(Orbits):
    """The orbits of a set of points of the section, mostly of Fix(R), and their crossings so far: see `Orbits`."""

    def __init__(
        self,
        system: ReversibleSystem,
        arithmetic: Arithmetic,
        point: Mapping[str, Series],
        oracle: Oracle,
        coordinates: str = AUTO,
        level: Series | None = None,
    ) -> None:
        """Start from points of the section.

        Args:
            point: by name, as in `initial_values`.
            oracle: finds approximations; nothing is believed of it.
            coordinates: "physical", "regularised" or "auto".
            level: the first integral of the points, if it is known already.
        """
        self.system, self.arithmetic, self.oracle = system, arithmetic, oracle
        initial = initial_values(system, arithmetic, point)
        initial, self.parameters = initial[: len(system.state)], initial[len(system.state) :]
        level = first_integral(system, arithmetic, point) if level is None else level
        self.coordinates = self._choose(coordinates, initial, level)
        super().__init__(self.coordinates, arithmetic, *self._enter(initial, level), oracle)

    def _choose(self, wanted: str, initial: Sequence[Series], level: Series | None) -> Coordinates:
        own, bits = physical(self.system), self.arithmetic.bits
        if wanted == PHYSICAL or level is None:
            return own
        from orbitproof.verify.poincare.regularised import regularised

        state, parameters, (value,) = (
            rough([int(x.coefs[0][0]) for x in values], bits) for values in (initial, self.parameters, [level])
        )
        other = regularised(self.system, state, parameters)
        if other is None or wanted == REGULARISED:
            return other or own
        steps = self.oracle.regularised_steps(own, other, state, parameters, value, self.arithmetic)
        return replace(other, steps=steps) if steps else own

    def _enter(self, initial: list[Series], level: Series | None) -> tuple[list[Series], list[Series]]:
        """The initial state in the coordinates that are integrated, and the constants of motion."""
        embedding = self.coordinates.embedding
        if embedding is None or level is None:
            return initial, self.parameters
        return at_start(embedding, (*initial, *self.parameters)), [*self.parameters, level]

    def _leave(self, image: Sequence[Series]) -> Sequence[Series]:
        """The system's own state."""
        regularisation = self.coordinates.regularisation
        if regularisation is None:
            return image
        return at_start(regularisation.projection_program, (*image, *self.parameters))


def initial_values(system: ReversibleSystem, arithmetic: Arithmetic, point: Mapping[str, Series]) -> list[Series]:
    """State and parameters at points of the section, in the order of the system.

    Args:
        point: by name, all parameters and those coordinates that are neither zero nor follow from others.
    """
    names = (*system.state, *system.parameters)
    rest = {name: system.normalised.get(name, Fraction(0)) for name in system.state}
    values = [point[name] if name in point else arithmetic.constant(rest[name]) for name in names]
    if system.defined:
        from orbitproof.verify.poincare.functions import with_functions

        values = with_functions(system, values)
    if system.fixed_level is not None:
        from orbitproof.verify.poincare.level_set import on_fixed_level

        values = on_fixed_level(system, values)
    return values


def first_integral(system: ReversibleSystem, arithmetic: Arithmetic, point: Mapping[str, Series]) -> Series | None:
    """The first integral at points of the section, as in `initial_values`; `None` if the system has none."""
    program = system.first_integral_program
    return None if program is None else at_start(program, initial_values(system, arithmetic, point))[0]


def kernel_components(
    system: ReversibleSystem, kernel_frame: Sequence[Sequence[Fraction]], state: Sequence[Series]
) -> list[Series]:
    """The coordinates q of a state that vanish on Fix(R), in a frame: kernel_frame times pi_q state."""
    return [
        reduce(
            operator.add,
            (state[index].scaled(factor) for index, factor in zip(system.kernel_coordinates, row, strict=True)),
        )
        for row in kernel_frame
    ]
