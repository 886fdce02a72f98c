"""Iterates of the Poincare map on a box of Fix(R), with derivatives (sections 5 and 6).

`enclose_iterates` takes a candidate's box to its first m k crossings of the section, m those of a half orbit,
and returns, for each, enclosures of the derivatives up to order 3 of the coordinates that vanish on Fix(R).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, log2, log10

from flint import arb

from orbitproof.shared.formats import ORBIT, Candidate
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.claim import level_program, quadratic_coefficient
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure, guarded
from orbitproof.verify.flow import LEAST_ERROR
from orbitproof.verify.poincare.coordinates import PHYSICAL
from orbitproof.verify.poincare.derivatives import derivative_table
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.returns import (
    AUTO,
    REGULARISED,
    Returns,
    at_start,
    first_integral,
    initial_values,
    kernel_components,
)

BOX_RATIO = Fraction(1, 4)
"""The box is this fraction of the polydisc on which the orbits are enclosed (section 6)."""

_LOSS_DIVISOR = 6


@dataclass(frozen=True)
class IntegratorSettings:
    """How to integrate.

    Attributes:
        precision: fractional bits of the fixed-point format.
        order: degree of the time expansions; `None` chooses it from the precision.
        coordinates: "physical", "regularised" (where the system has such coordinates), or "auto" for
            those in which the orbit takes less time.
        accuracy: bits that the errors of the last crossing and of its derivative should have; if the
            first returns show that they will not, the integration is given up early. `None` goes on
            in any case.
    """

    precision: int
    order: int | None = None
    accuracy: tuple[int, int] | None = None
    coordinates: str = AUTO

    def __post_init__(self) -> None:
        if self.precision < 1 or (self.order is not None and self.order < 1):
            raise ValueError(f"precision {self.precision} and order {self.order} have to be positive")
        if self.accuracy is not None and min(self.accuracy) < 0:
            raise ValueError(f"accuracy {self.accuracy} is negative")
        if self.coordinates not in (AUTO, PHYSICAL, REGULARISED):
            raise ValueError(f"coordinates {self.coordinates!r} are none of {AUTO}, {PHYSICAL}, {REGULARISED}")


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
    return_times: tuple[arb, ...]
    order: int
    precision: int
    steps: int
    coordinates: str = PHYSICAL


@dataclass(frozen=True)
class HalfReturns:
    """What is known of a candidate's box after some half returns, P the map of one.

    Attributes:
        before: derivatives of the kernel coordinates at the crossings before the end of the first one.
        kernels: those of the components of pi_q P, pi_q P^2, ..
        image: after two of them, those of the candidate's coordinates at P^2, by name; a parameter is not among them.
    """

    before: tuple[tuple[DerivativeTable, ...], ...]
    kernels: tuple[tuple[DerivativeTable, ...], ...]
    image: Mapping[str, DerivativeTable]


Decide = Callable[[Candidate, HalfReturns], None]
"""Looks at half returns; raises `NotEstablishedError` if there is no point in going on."""


def grading_for(kind: str, k: int, dimension: int) -> Grading:
    """The weights of section 2.1: along the bifurcating branch p_0 and p_2 vary like p_1^2.

    For a touch-and-go bifurcation the branch has a slope in p_0, and grade 2 is enough. For an orbit all
    coordinates count alike, and their first derivatives are enough.
    """
    if kind == ORBIT:
        return Grading((1,) * dimension, 1)
    across = (2,) * (dimension - 2)
    if kind == "touch_and_go":
        return Grading((1, 1, *across), 2)
    return Grading((2, 1, *across), 3)


def enclose_iterates(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: Oracle,
    progress: Callable[[float], None] | None = None,
    decide: Decide | None = None,
) -> Enclosures:
    """Enclose P, P^2, .., P^(m k) and their derivatives on the candidate's box.

    `progress` is called after every step with a rough fraction of the work done, `decide` after every half
    return but the last if the integration may be given up early; what they raise passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        return _Integration(candidate, settings, oracle, progress, decide).run()


def enclose_first_integral(candidate: Candidate, precision: int) -> DerivativeTable | None:
    """Derivatives of the first integral on the candidate's box in Fix(R), without integrating."""
    with guarded(precision):
        box = box_of(candidate, precision, 1)
        return None if box.level is None else derivative_table(box.level, box.scales, BOX_RATIO)


@dataclass(frozen=True)
class Box:
    """The points centre + frame * diag(scales) * xi of Fix(R), and the parameters, by name, and the level of H."""

    arithmetic: Arithmetic
    scales: tuple[Fraction, ...]
    point: dict[str, Series]
    level: Series | None


def box_of(candidate: Candidate, bits: int, order: int) -> Box:
    """The points of a candidate's box as elements of the algebra. Raises `IntegrationFailure`."""
    system, variables = candidate.system, len(candidate.radii)
    scales = tuple(radius / BOX_RATIO for radius in candidate.radii)
    grading = grading_for(candidate.kind, candidate.k, variables)
    further, loss = grade_bits(grading, scales, bits)
    arithmetic = Arithmetic(grading, bits, further, order, loss)
    point = {name: arithmetic.constant(value) for name, value in candidate.parameters.items()}
    for name, middle, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True):
        terms = {(0,) * variables: middle}
        for j, (direction, scale) in enumerate(zip(row, scales, strict=True)):
            terms[tuple(int(i == j) for i in range(variables))] = direction * scale
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


class _Integration:
    def __init__(
        self,
        candidate: Candidate,
        settings: IntegratorSettings,
        oracle: Oracle,
        progress: Callable[[float], None] | None,
        decide: Decide | None = None,
    ) -> None:
        order = settings.order if settings.order is not None else default_order(settings.precision)
        box = box_of(candidate, settings.precision, order)
        check_size(box.arithmetic.grading, box.scales)
        self.candidate = candidate
        self.crossings = candidate.crossings * candidate.k
        self.progress = progress
        self.scales = box.scales
        self.arithmetic = box.arithmetic
        self.first_integral = None
        if box.level is not None and not candidate.is_family_of_maps:
            self.first_integral = derivative_table(box.level, box.scales, BOX_RATIO)
        self.returns = Returns(candidate.system, box.arithmetic, box.point, oracle, settings.coordinates, box.level)
        self.accuracy = settings.accuracy
        self.decide = decide if settings.accuracy is not None else None
        self.first_error_bits = (0.0, 0.0)
        self.return_times: list[arb] = []

    def run(self) -> Enclosures:
        iterates: list[tuple[DerivativeTable, ...]] = []
        for number in range(1, self.crossings + 1):
            state = self._crossing()
            iterates.append(self._tables(kernel_components(self.candidate.system, self.candidate.kernel_frame, state)))
            if number < self.crossings:
                self._decide(number, iterates, state)
                self._check_accuracy(number)
        return Enclosures(
            tuple(iterates),
            self.first_integral,
            tuple(self.return_times),
            self.arithmetic.degree,
            self.arithmetic.bits,
            self.returns.steps,
            self.returns.coordinates.name,
        )

    def _after_step(self, steps: int) -> None:
        if steps == 1:
            self.first_error_bits = self._error_bits()
        if self.progress is not None:
            self.progress((len(self.return_times) + 0.5) / self.crossings)

    def _crossing(self) -> Sequence[Series]:
        """The state at the next crossing."""
        state, time = self.returns.next_crossing(self._after_step)
        self.return_times.append(time)
        if self.progress is not None:
            self.progress(len(self.return_times) / self.crossings)
        return state

    def _tables(self, elements: Sequence[Series]) -> tuple[DerivativeTable, ...]:
        return tuple(derivative_table(element, self.scales, BOX_RATIO) for element in elements)

    def _decide(self, number: int, iterates: Sequence[tuple[DerivativeTable, ...]], state: Sequence[Series]) -> None:
        half, coordinates = self.candidate.crossings, self.candidate.system.state
        if self.decide is None or number % half:
            return
        names = [name for name in self.candidate.coordinates if name in coordinates] if number == 2 * half else []
        image = dict(zip(names, self._tables([state[coordinates.index(name)] for name in names]), strict=True))
        self.decide(self.candidate, HalfReturns(tuple(iterates[: half - 1]), tuple(iterates[half - 1 :: half]), image))

    def _error_bits(self) -> tuple[float, float]:
        """Bits of the worst error of the state and of its derivative in the variable of weight 1."""
        linear = min(
            _log2(scale)
            for scale, weight in zip(self.scales, self.arithmetic.grading.weights, strict=True)
            if weight == 1
        )
        value = max(log2(x.errors[0]) for x in self.returns.state)
        return -value, -max(value, max(log2(x.errors[1]) for x in self.returns.state) - linear)

    def _check_accuracy(self, number: int) -> None:
        """Give up if the errors, growing as they did so far, would exceed what the last crossing needs.

        Errors differ between the two ends of a half return; after two returns they compare best.
        """
        last = self.crossings
        if self.accuracy is None or number != min(2, last - 1):
            return
        missing = 0
        for begin, now, wanted in zip(self.first_error_bits, self._error_bits(), self.accuracy, strict=True):
            missing = max(missing, ceil(wanted - begin + (begin - now) * last / number))
        if missing > 0:
            raise IntegrationFailure(
                "precision",
                f"{self.arithmetic.bits} bits are too few: at the last crossing {missing} would be missing",
                "give `max_precision` more",
                needs_precision=True,
                enough_precision=self.arithmetic.bits + 8 + missing * _LOSS_DIVISOR // (_LOSS_DIVISOR - 1),
            )


def _log2(value: Fraction) -> float:
    return log2(value.numerator) - log2(value.denominator)


def default_order(precision: int) -> int:
    """Degree of the time expansions that was found fast for a precision in bits."""
    return max(16, precision // 2)


def check_size(grading: Grading, scales: Sequence[Fraction]) -> None:
    """Refuse boxes on which the least error of a step (2.3) exceeds what a derivative adds to the top grade."""
    smallest = min(scales[1] ** grading.top, scales[0] * scales[1])
    if smallest < Fraction(LEAST_ERROR):
        raise IntegrationFailure(
            "radii",
            f"errors are bounded by floats of at least 2^{round(log2(LEAST_ERROR))}, more than the derivatives that "
            f"count add up to on a box with R_1 = 10^{_log2(scales[1] * BOX_RATIO) * log10(2):.0f}",
            "give larger radii: no precision helps",
        )


def grade_bits(grading: Grading, scales: Sequence[Fraction], bits: int) -> tuple[int, int]:
    """Further fractional bits per grade, and the significant bits that a coefficient loses per grade.

    Scaled initial values of a variable of weight w are about 2^-(w s); with s - d further bits per
    grade, grade g keeps about bits - g d significant bits.
    """
    logs = [-_log2(scale) / weight for scale, weight in zip(scales, grading.weights, strict=True)]
    spare = bits // _LOSS_DIVISOR
    size = max(0, floor(max(logs)))
    loss = min(size, spare)
    return size - loss, loss
