"""The half orbits of a box and of the points beside it that are not in Fix(R), with derivatives (section 27.4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.evidence import Briefs, DerivativeTable, guarded
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
class BreakingEnclosures:
    """What one integration proves; all functions are of p and then q, on the box and for small q, about q = 0.

    Attributes:
        iterates: derivatives of q_1, .., q_n of P, .., P^m, one tuple each, m the crossings of a half orbit.
        image: derivatives of p', the n coordinates of the claim that are no parameter, of P^m.
        half_period: derivatives of the time of P^m.
        sheet: the level coordinate of P^m, at all points; none where none is used.
        order, precision, steps, coordinates: as in `poincare.Enclosures`.
    """

    iterates: tuple[tuple[DerivativeTable, ...], ...]
    image: Annotated[tuple[DerivativeTable, ...], rules(maxItems=32)]
    half_period: DerivativeTable
    sheet: Briefs
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default=PHYSICAL)

    @property
    def tables(self) -> list[DerivativeTable]:
        """All of them."""
        return [*(table for components in self.iterates for table in components), *self.image, self.half_period]


def variables_of(candidate: Candidate) -> int:
    """How many variables the functions among the enclosures of a claim have: p_0, .., p_n and q_1, .., q_n."""
    return len(candidate.radii) + len(candidate.kernel_frame)


def across(candidate: Candidate) -> Fraction:
    """Half-width of the interval of each q. Near the birth p varies like the square of q; any number will do."""
    largest = max(candidate.radii)
    power = (largest.denominator.bit_length() - largest.numerator.bit_length()) // 2
    return Fraction(2) ** -power


def enclose_breaking(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
    alike: bool = False,
) -> BreakingEnclosures:
    """Follow the box of a candidate, and points beside it, to the other point on Fix(R).

    With `alike` all variables have the weight 1, for all derivatives up to order 3 (section 31.2); else those that
    section 27.4 asks for are enclosed well.
    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        order = settings.order if settings.order is not None else default_order(settings.precision)
        width = None if alike else across(candidate)
        box = box_of(candidate, settings.precision, order, True, width)
        scales, system = box.scales, candidate.system
        check_size(box.arithmetic.grading, (min(candidate.radii) / BOX_RATIO, scales[-1]))
        returns = HalfOrbits(system, box.arithmetic, box.point, oracle, settings.coordinates, box.level)
        iterates = []
        for number in range(candidate.crossings):
            done = number / candidate.crossings
            state, _ = returns.next_crossing(lambda _steps, done=done: progress and progress(done))  # type: ignore[misc]
            kernel = kernel_components(system, candidate.kernel_frame, state)
            iterates.append(tuple(derivative_table(element, scales, BOX_RATIO) for element in kernel))
        named = dict(zip(system.state, state, strict=True))
        image = tuple(derivative_table(named[name], scales, BOX_RATIO) for name in candidate.coordinates[1:])
        time = derivative_table(returns.return_time, scales, BOX_RATIO)
        on_level = [named[str(system.level_coordinate)]] if candidate.uses_level else []
        tables = [derivative_table(element, scales, BOX_RATIO) for element in on_level]
        sheet = tuple(table.box[(0,) * len(scales)] for table in tables)
        coordinates = returns.coordinates.name
        return BreakingEnclosures(
            tuple(iterates), image, time, sheet, order, settings.precision, returns.steps, coordinates
        )
