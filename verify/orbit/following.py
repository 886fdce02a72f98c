"""An orbit from one point of Fix(R) to the other and back, with derivatives and distances (sections 19.2 to 19.4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import rules, stored
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.algebra import Series, evaluate, prepare
from orbitproof.verify.evidence import Briefs, DerivativeTable, enclose, exact_value, guarded, is_below
from orbitproof.verify.flow import FlowStep, advance
from orbitproof.verify.orbit.distance import Approach, DistanceAlong, Kind, Step
from orbitproof.verify.orbit.rates import distance_rates
from orbitproof.verify.poincare import (
    BOX_RATIO,
    PHYSICAL,
    Box,
    HalfOrbits,
    IntegratorSettings,
    InTime,
    WideOracle,
    at_start,
    box_of,
    check_size,
    default_order,
    derivative_table,
    initial_values,
    kernel_components,
)

_BEYOND = tuple(Fraction(1, 2**bits) for bits in (40, 32, 24, 16))
"""Lengths of the step that leads beyond the other point on Fix(R); the first that does for the whole box is taken."""


@dataclass(frozen=True)
class Distance:
    """The square of the distance from a body along the half orbits of a box.

    Attributes:
        start, end: on Fix(R), at the first and at the other point, with derivatives.
        start_kind, end_kind: of these extrema, 1 for a minimum, -1 for a maximum.
        between: the other extrema, in order of time.
    """

    start: DerivativeTable
    end: DerivativeTable
    start_kind: Kind
    end_kind: Kind
    between: Annotated[tuple[Approach, ...], rules(maxItems=1000)]


@dataclass(frozen=True)
class OrbitEnclosures:
    """What two integrations prove about the orbits of a box.

    Attributes:
        iterates: derivatives of q_1, .., q_n of P, .., P^m, one tuple each, m the crossings of a half orbit.
        image: derivatives of the coordinates on Fix(R) of P^m, in the order of `centre_coordinates`.
        half_period: derivatives of the time of P^m.
        first_integral: derivatives of the first integral on Fix(R); `None` without one.
        back: rows; derivatives of the coordinates on Fix(R) of P^m by the same at all points P^m(x) on Fix(R).
        distance: `None` if the system names none.
        order, precision, steps, coordinates: as in `poincare.Enclosures`; of the first half, all steps.
    """

    iterates: tuple[tuple[DerivativeTable, ...], ...]
    image: Annotated[tuple[DerivativeTable, ...], rules(maxItems=32)]
    half_period: DerivativeTable
    first_integral: DerivativeTable | None
    back: Annotated[tuple[Briefs, ...], rules(maxItems=32)]
    distance: Distance | None
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default=PHYSICAL)


def enclose_orbit(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> OrbitEnclosures:
    """Follow the box of a candidate to the other point on Fix(R) and on to the first one again.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        order = settings.order if settings.order is not None else default_order(settings.precision)
        box = box_of(candidate, settings.precision, order)
        check_size(box.arithmetic.grading, box.scales)
        return _HalfOrbits(candidate, box, settings.coordinates, oracle, progress).run()


class _HalfOrbits:
    def __init__(
        self,
        candidate: Candidate,
        box: Box,
        coordinates: str,
        oracle: WideOracle,
        progress: Callable[[float], None] | None,
    ) -> None:
        self.candidate = candidate
        self.system = candidate.system
        self.box = box
        self.coordinates = coordinates
        self.oracle = oracle
        self.progress = progress or (lambda _fraction: None)

    def run(self) -> OrbitEnclosures:
        box, system = self.box, self.system
        returns = HalfOrbits(system, box.arithmetic, box.point, self.oracle, self.coordinates, box.level)
        along = None if system.squared_distance is None else _Distances(returns)

        def after_step(_steps: int) -> None:
            if along is not None and returns.step_taken is not None:
                along.cover(*returns.step_taken)
            self.progress(0.25)

        iterates: list[tuple[DerivativeTable, ...]] = []
        for _ in range(self.candidate.crossings):
            state, _ = returns.next_crossing(after_step)
            kernel = kernel_components(system, self.candidate.kernel_frame, state)
            iterates.append(tuple(map(self._table, kernel)))
        self.progress(0.5)
        image = self._on_fixed_set(state)
        half_period = self._table(returns.return_time)
        distance = None
        beyond = system
        if system.fixed_level is not None:
            from orbitproof.verify.poincare import on_sheet

            level_coordinate = state[system.state.index(str(system.level_coordinate))]
            beyond = on_sheet(system, [self._table(level_coordinate).box[(0,) * len(box.scales)]])
        if along is not None:
            kinds = along.end(half_period.box[(0,) * len(box.scales)])
            other = {**box.point, **dict(zip(self.names, image, strict=True))}
            distance = Distance(
                self._distance(system, box.point), self._distance(beyond, other), *kinds, tuple(along.found)
            )
        back, steps = self._back(beyond, image)
        return OrbitEnclosures(
            tuple(iterates),
            tuple(map(self._table, image)),
            half_period,
            None if box.level is None else self._table(box.level),
            back,
            distance,
            box.arithmetic.degree,
            box.arithmetic.bits,
            returns.steps + steps,
            returns.coordinates.name,
        )

    @property
    def names(self) -> tuple[str, ...]:
        return self.system.centre_coordinates

    def _table(self, element: Series) -> DerivativeTable:
        return derivative_table(element, self.box.scales, BOX_RATIO)

    def _on_fixed_set(self, state: Sequence[Series]) -> list[Series]:
        """The coordinates on Fix(R) of a state on the section."""
        named = {**self.box.point, **dict(zip(self.system.state, state, strict=True))}
        return [named[name] for name in self.names]

    def _distance(self, system: ReversibleSystem, point: Mapping[str, Series]) -> DerivativeTable:
        program = system.squared_distance_program
        assert program is not None
        return self._table(at_start(program, initial_values(system, self.box.arithmetic, point))[0])

    def _back(self, system: ReversibleSystem, image: Sequence[Series]) -> tuple[tuple[tuple[arb, ...], ...], int]:
        """Derivatives of P^m on Fix(R) at its points P^m(x), by the coordinates of Fix(R), and the number of steps."""
        arithmetic, scales = self.box.arithmetic, self.box.scales
        size = len(scales)
        units = [tuple(int(i == j) for i in range(size)) for j in range(size)]
        start = dict(self.box.point)
        for row, (name, element) in enumerate(zip(self.names, image, strict=True)):
            where = self._table(element).box[(0,) * size]
            middle, radius = exact_value(where.mid()), exact_value(where.rad())
            terms = {(0,) * size: middle, units[row]: scales[row]}
            start[name] = arithmetic.polynomial(terms).widened(radius)
        returns = HalfOrbits(system, arithmetic, start, self.oracle, self.coordinates)
        state, _ = returns.half_orbit(self.candidate.crossings, lambda _steps: self.progress(0.75))
        tables = [self._table(element) for element in self._on_fixed_set(state)]
        return tuple(tuple(table.centre[unit] for unit in units) for table in tables), returns.steps


class _Distances:
    """The distance over the steps of a half orbit."""

    def __init__(self, returns: HalfOrbits) -> None:
        self.returns = returns
        self.regularisation = returns.coordinates.regularisation
        self.program = prepare(distance_rates(returns.system, returns.coordinates))
        self.along = DistanceAlong()
        self.reached = arb(0)

    @property
    def found(self) -> list[Approach]:
        return self.along.found

    def cover(self, flow: FlowStep, start: arb, length: Fraction) -> None:
        """One step, from the integration's time `start` on."""
        self._take(self._step(flow, start, length))

    def _step(self, flow: FlowStep, start: arb, length: Fraction) -> Step:
        functions = evaluate(self.program, [*flow.solution, *self.returns.constants])
        value, rate, curvature = (InTime(element) for element in functions)
        whole, regularisation = enclose(length), self.regularisation
        return Step(
            value,
            rate,
            curvature,
            whole,
            (lambda theta: start + whole * theta)
            if regularisation is None
            else InTime(flow.solution[regularisation.time_index]).value,
        )

    def _take(self, step: Step) -> None:
        self.along.cover(step)
        self.reached = step.time(arb(1))

    def end(self, half_period: arb) -> tuple[int, int]:
        """The kinds of the extrema on Fix(R), one more step being taken beyond the second of them."""
        returns = self.returns
        program, state, fixed = returns.program, returns.state, returns.fixed
        expansion = returns.oracle.expand(program, returns.arithmetic, state, fixed)
        for length in _BEYOND:
            step = self._step(advance(program, state, fixed, expansion, length), returns.time, length)
            if is_below(half_period, step.time(arb(1))):
                break
        self._take(step)
        return self.along.start_kind, self.along.end_kind(half_period, self.reached)
