"""Two half orbits of the points of a box in Fix(R) and a parameter, with derivatives (section 34.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import stored
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, guarded
from orbitproof.verify.poincare import (
    BOX_RATIO,
    PHYSICAL,
    HalfOrbits,
    IntegratorSettings,
    WideOracle,
    box_of,
    check_size,
    default_order,
    derivative_table,
    kernel_components,
)


@dataclass(frozen=True)
class ResonanceEnclosures:
    """What one integration proves; all functions are of p = (p_0, .., p_(n+1)), on the box.

    Attributes:
        iterates: derivatives of q_1, .., q_n of P, .., P^m, one tuple each, m the crossings of a half orbit.
        image: derivatives of the coordinates of Fix(R) of P^(2m).
        half_period: derivatives of the time of P^m.
        first_integral: derivatives of H.
        order, precision, steps, coordinates: as in `poincare.Enclosures`.
    """

    iterates: tuple[tuple[DerivativeTable, ...], ...]
    image: tuple[DerivativeTable, ...]
    half_period: DerivativeTable
    first_integral: DerivativeTable
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default=PHYSICAL)

    @property
    def tables(self) -> list[DerivativeTable]:
        """All of them."""
        kernel = [table for components in self.iterates for table in components]
        return [*kernel, *self.image, self.half_period, self.first_integral]


def enclose_resonance(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> ResonanceEnclosures:
    """Follow the box of a candidate to the other point on Fix(R) and back.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        order = settings.order if settings.order is not None else default_order(settings.precision)
        box = box_of(candidate, settings.precision, order)
        scales, system = box.scales, candidate.system
        check_size(box.arithmetic.grading, scales)
        if box.level is None:
            raise IntegrationFailure("system", f"{system.name} has no first integral", "claim it of another system")
        returns = HalfOrbits(system, box.arithmetic, box.point, oracle, settings.coordinates, box.level)
        last = 2 * candidate.crossings
        iterates = []
        for number in range(1, last + 1):
            done = (number - 1) / last
            state, _ = returns.next_crossing(lambda _steps, done=done: progress and progress(done))  # type: ignore[misc]
            if number <= candidate.crossings:
                kernel = kernel_components(system, candidate.kernel_frame, state)
                iterates.append(tuple(derivative_table(element, scales, BOX_RATIO) for element in kernel))
            if number == candidate.crossings:
                time = derivative_table(returns.return_time, scales, BOX_RATIO)
        image = tuple(derivative_table(state[index], scales, BOX_RATIO) for index in system.fixed_coordinates)
        level = derivative_table(box.level, scales, BOX_RATIO)
        coordinates = returns.coordinates.name
        return ResonanceEnclosures(
            tuple(iterates), image, time, level, order, settings.precision, returns.steps, coordinates
        )
