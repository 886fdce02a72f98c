"""Iterates of the Poincare map on a box of Fix(R), with derivatives (sections 5 and 6).

`enclose_iterates` takes a candidate's box to its first m k crossings of the section, m those of a half orbit,
and returns, for each, enclosures of the derivatives up to order 3 of the coordinates that vanish on Fix(R).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import stored
from orbitproof.verify.algebra import Arithmetic, Grading, Series, at_start
from orbitproof.verify.claim import inverse, level_program, quadratic_coefficient
from orbitproof.verify.evidence import Briefs, DerivativeTable, IntegrationFailure, guarded
from orbitproof.verify.poincare.box_format import BOX_RATIO, check_size, grade_bits
from orbitproof.verify.poincare.derivatives import derivative_table
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.returns import (
    Returns,
    default_order,
    first_integral,
    initial_values,
    kernel_components,
)
from orbitproof.verify.poincare.settings import PHYSICAL, IntegratorSettings


@dataclass(frozen=True)
class Enclosures:
    """What one integration proves about a candidate's box.

    Attributes:
        iterates: ``iterates[i - 1][j]`` holds the derivatives of the component q_{j+1} of P^i, i = 1 .. m k.
        first_integral: derivatives of the first integral on Fix(R); `None` without one.
        return_times: the times of the crossings 1 .. m k, over the box.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    iterates: tuple[tuple[DerivativeTable, ...], ...]
    first_integral: DerivativeTable | None
    return_times: Briefs
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default=PHYSICAL)


class Watch(Protocol):
    """Looks on while orbits are followed. What it raises passes through; whatever it does, nothing is proved by it."""

    def after_step(self, integration: Integration) -> None:
        """After every step."""

    def after_return(self, integration: Integration) -> None:
        """After every crossing but the last."""


def grading_for(candidate: Candidate, dimension: int) -> Grading:
    """The weights of section 2.1: along the bifurcating branch p_0 and p_2 vary like p_1^2.

    For a touch-and-go bifurcation the branch has a slope in p_0, and grade 2 is enough. For an orbit all
    coordinates count alike, and their first derivatives are enough; where resonances meet, those to order 3.
    """
    if candidate.resonances_meet or candidate.is_of_orbit:
        return Grading((1,) * dimension, 1 if candidate.is_of_orbit else 3)
    across = (2,) * (dimension - 2)
    return Grading((2, 1, *across), 3) if candidate.is_tangential else Grading((1, 1, *across), 2)


def enclose_iterates(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: Oracle,
    progress: Callable[[float], None] | None = None,
    watch: Watch | None = None,
) -> Enclosures:
    """Enclose P, P^2, .., P^(m k) and their derivatives on the candidate's box.

    `progress` is called after every step with a rough fraction of the work done, `watch` looks on; what they raise
    passes through. Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        return Integration(candidate, settings, oracle, progress, watch).run()


@dataclass(frozen=True)
class Box:
    """The points centre + frame * diag(scales) * xi of Fix(R), and the parameters, by name, and the level of H.

    About Fix(R) the last variables are the coordinates that R negates, divided by their scales.
    """

    arithmetic: Arithmetic
    scales: tuple[Fraction, ...]
    point: dict[str, Series]
    level: Series | None


def box_of(candidate: Candidate, bits: int, order: int, across: bool = False, width: Fraction | None = None) -> Box:
    """The points of a candidate's box as elements of the algebra. Raises `IntegrationFailure`.

    Args:
        across: points of the section about the box: its coordinates that vanish on Fix(R) are further variables, with
            half-widths as large as the largest of the box, and all variables have weight 1.
        width: the half-width of these variables if it is another one: they are coordinates in the frame of the
            candidate then, of weight 1, and the others have weight 2 (section 27.4).
    """
    system, size = candidate.system, len(candidate.radii)
    kernel = [system.state[index] for index in system.kernel_coordinates] if across else []
    radii = (*candidate.radii, *[width or max(candidate.radii)] * len(kernel))
    variables = len(radii)
    scales = tuple(radius / BOX_RATIO for radius in radii)
    along = 1 if width is None else 2
    weights = (*(along,) * size, *(1,) * len(kernel))
    grading = Grading(weights, 3) if across else grading_for(candidate, variables)
    further, loss = grade_bits(grading, scales, bits)
    arithmetic = Arithmetic(grading, bits, further, order, loss)
    point = {name: arithmetic.constant(value) for name, value in candidate.parameters.items()}
    rows = dict(zip(candidate.coordinates, zip(candidate.centre, candidate.frame, strict=True), strict=True))
    directions = unit_rows(len(kernel)) if width is None else inverse(candidate.kernel_frame) or ()
    rows |= {name: (Fraction(0), (*(Fraction(0),) * size, *row)) for name, row in zip(kernel, directions, strict=True)}
    for name, (middle, row) in rows.items():
        terms = {(0,) * variables: middle}
        for j, direction in enumerate(row):
            terms[tuple(int(i == j) for i in range(variables))] = direction * scales[j]
        point[name] = arithmetic.polynomial(terms)
    if candidate.level_sign is None:
        return Box(arithmetic, scales, point, first_integral(system, arithmetic, point))
    level, coordinate = point[candidate.coordinates[0]], system.level_coordinate
    if coordinate is None or not quadratic_coefficient(system):
        raise IntegrationFailure(
            "level", f"no coordinate of {system.name} follows from the first integral", "leave parameter out"
        )
    program = level_program(system, candidate.level_sign)
    point[coordinate] = at_start(program, (*initial_values(system, arithmetic, point), level))[0]
    return Box(arithmetic, scales, point, level)


def unit_rows(size: int) -> list[list[Fraction]]:
    """The unit matrix."""
    return [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]


class Integration:
    """The orbits of a candidate's box, followed from crossing to crossing.

    Attributes:
        returns: the orbits now.
        crossings: how many are to be found.
        state: the system's own state at the last of those that were.
        iterates, return_times: of all of those, as in `Enclosures`.
    """

    def __init__(
        self,
        candidate: Candidate,
        settings: IntegratorSettings,
        oracle: Oracle,
        progress: Callable[[float], None] | None = None,
        watch: Watch | None = None,
    ) -> None:
        order = settings.order if settings.order is not None else default_order(settings.precision)
        self.candidate, self.progress, self.watch = candidate, progress, watch
        self.box = box_of(candidate, settings.precision, order)
        check_size(self.box.arithmetic.grading, self.box.scales)
        box, self.crossings = self.box, candidate.crossings * candidate.k
        self.returns = Returns(candidate.system, box.arithmetic, box.point, oracle, settings.coordinates, box.level)
        self.state: Sequence[Series] = ()
        self.iterates: list[tuple[DerivativeTable, ...]] = []
        self.return_times: list[arb] = []

    def run(self) -> Enclosures:
        """Follow them to the last crossing."""
        box, candidate = self.box, self.candidate
        for number in range(1, self.crossings + 1):
            self.state, time = self.returns.next_crossing(self._after_step)
            self.return_times.append(time)
            self._tell(number)
            self.iterates.append(self.tables(kernel_components(candidate.system, candidate.kernel_frame, self.state)))
            if number < self.crossings and self.watch is not None:
                self.watch.after_return(self)
        level = None if candidate.is_family_of_maps else box.level
        return Enclosures(
            tuple(self.iterates),
            None if level is None else self.tables([level])[0],
            tuple(self.return_times),
            box.arithmetic.degree,
            box.arithmetic.bits,
            self.returns.steps,
            self.returns.coordinates.name,
        )

    def tables(self, elements: Sequence[Series]) -> tuple[DerivativeTable, ...]:
        """Their derivatives on the box."""
        return tuple(derivative_table(element, self.box.scales, BOX_RATIO) for element in elements)

    def _after_step(self, _steps: int) -> None:
        if self.watch is not None:
            self.watch.after_step(self)
        self._tell(len(self.return_times) + 0.5)

    def _tell(self, crossings: float) -> None:
        if self.progress is not None:
            self.progress(crossings / self.crossings)
