"""Iterates of the Poincare map on a box of Fix(R), with derivatives (sections 5 and 6).

`enclose_iterates` takes a candidate's box to its first k crossings of the section and returns, for
each, enclosures of the derivatives up to order 3 of the coordinates that vanish on Fix(R).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, log2

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.algebra import Arithmetic, Grading, Series
from orbitproof.verify.claim import level_program, quadratic_coefficient
from orbitproof.verify.evidence import IntegrationFailure, guarded
from orbitproof.verify.poincare.coordinates import PHYSICAL
from orbitproof.verify.poincare.derivatives import DerivativeTable, derivative_table
from orbitproof.verify.poincare.returns import AUTO, REGULARISED, Returns, evaluate

BOX_RATIO = Fraction(1, 4)
"""The box is this fraction of the polydisc on which the orbits are enclosed (section 6)."""

_MAX_STEPS = 4000
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
        iterates: ``iterates[i - 1][j]`` holds the derivatives of the component q_{j+1} of P^i.
        first_integral: derivatives of the first integral on Fix(R); `None` without one.
        return_times: the times of the crossings 1 .. k, over the box.
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


def grading_for(kind: str, k: int, dimension: int) -> Grading:
    """The weights of section 2.1: along the bifurcating branch p_0 and p_2 vary like p_1^2.

    For a touch-and-go bifurcation the branch has a slope in p_0, and grade 2 is enough.
    """
    across = (2,) * (dimension - 2)
    if kind == "touch_and_go":
        return Grading((1, 1, *across), 2)
    return Grading((2, 1, *across), 3)


def enclose_iterates(
    candidate: Candidate, settings: IntegratorSettings, progress: Callable[[float], None] | None = None
) -> Enclosures:
    """Enclose P, P^2, .., P^k and their derivatives on the candidate's box.

    `progress` is called after every step with a rough fraction of the work done; what it raises
    passes through. Raises `IntegrationFailure` if something could not be enclosed.
    """
    with guarded(settings.precision):
        return _Integration(candidate, settings, progress).run()


def enclose_first_integral(candidate: Candidate, precision: int) -> DerivativeTable | None:
    """Derivatives of the first integral on the candidate's box in Fix(R), without integrating."""
    with guarded(precision):
        return _Integration(candidate, IntegratorSettings(precision, 1, coordinates=PHYSICAL), None).first_integral


class _Integration:
    def __init__(
        self, candidate: Candidate, settings: IntegratorSettings, progress: Callable[[float], None] | None
    ) -> None:
        system = candidate.system
        dimension = len(candidate.radii)
        grading = grading_for(candidate.kind, candidate.k, dimension)
        self.candidate = candidate
        self.system = system
        self.progress = progress
        self.scales = [radius / BOX_RATIO for radius in candidate.radii]
        bits = settings.precision
        order = settings.order if settings.order is not None else default_order(bits)
        further, loss = _grade_bits(grading, self.scales, bits)
        self.arithmetic = Arithmetic(grading, bits, further, order, loss)
        point = self._box()
        initial = [point.get(name, self._zero()) for name in system.state]
        self.parameters = [
            point[name] if name in point else self.arithmetic.constant(candidate.parameters[name])
            for name in system.parameters
        ]
        level = None if candidate.level_sign is None else point[candidate.coordinates[0]]
        if candidate.level_sign is not None and level is not None:
            self._complete(candidate.level_sign, initial, level)
        else:
            level = self._first_integral(initial)
        self.first_integral = (
            None
            if level is None or candidate.level_sign is not None
            else derivative_table(level, self.scales, BOX_RATIO)
        )
        self.returns = Returns(system, self.arithmetic, initial, self.parameters, level, settings.coordinates)
        self.accuracy = settings.accuracy
        self.first_error_bits = (0.0, 0.0)
        self.return_times: list[arb] = []

    def _zero(self) -> Series:
        return self.arithmetic.constant(Fraction(0))

    def _box(self) -> dict[str, Series]:
        """The point centre + frame * diag(scales) * xi of Fix(R) (and the parameter), by name."""
        variables = len(self.scales)
        result = {}
        for name, middle, row in zip(
            self.candidate.coordinates, self.candidate.centre, self.candidate.frame, strict=True
        ):
            terms = {(0,) * variables: middle}
            for j, (direction, scale) in enumerate(zip(row, self.scales, strict=True)):
                terms[tuple(int(i == j) for i in range(variables))] = direction * scale
            result[name] = self.arithmetic.polynomial(terms)
        return result

    def _complete(self, sign: int, initial: list[Series], level: Series) -> None:
        """Set the coordinate that follows from the level of the first integral."""
        name = self.system.level_coordinate
        if name is None or not quadratic_coefficient(self.system):
            raise IntegrationFailure(
                "level", f"no coordinate of {self.system.name} follows from the first integral", "leave parameter out"
            )
        (value,) = evaluate(self.arithmetic, level_program(self.system, sign), (*initial, *self.parameters, level))
        initial[self.system.state.index(name)] = value

    def _first_integral(self, initial: Sequence[Series]) -> Series | None:
        program = self.system.first_integral_program
        return None if program is None else evaluate(self.arithmetic, program, (*initial, *self.parameters))[0]

    def run(self) -> Enclosures:
        k = self.candidate.k
        iterates: list[tuple[DerivativeTable, ...]] = []
        while len(iterates) < k:
            if self.returns.steps >= _MAX_STEPS:
                raise IntegrationFailure(
                    "steps", f"no crossing number {len(iterates) + 1} within {_MAX_STEPS} steps", "give another centre"
                )
            at_section = self.returns.step()
            if self.returns.steps == 1:
                self.first_error_bits = self._error_bits()
            if at_section:
                iterates.append(self._crossing(len(iterates) + 1))
            if self.progress is not None:
                self.progress((len(iterates) + (0.0 if at_section else 0.5)) / k)
        return Enclosures(
            tuple(iterates), self.first_integral, tuple(self.return_times),
            self.arithmetic.degree, self.arithmetic.bits, self.returns.steps, self.returns.coordinates.name,
        )  # fmt: skip

    def _crossing(self, number: int) -> tuple[DerivativeTable, ...]:
        """Derivatives of the kernel coordinates at crossing `number`."""
        state, time = self.returns.crossing(number)
        self.return_times.append(time)
        if number < self.candidate.k:
            self._check_accuracy(number)
        return tuple(
            derivative_table(self._combine(state, row), self.scales, BOX_RATIO) for row in self.candidate.kernel_frame
        )

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
        k = self.candidate.k
        if self.accuracy is None or number != min(2, k - 1):
            return
        missing = 0
        for begin, now, wanted in zip(self.first_error_bits, self._error_bits(), self.accuracy, strict=True):
            missing = max(missing, ceil(wanted - begin + (begin - now) * k / number))
        if missing > 0:
            raise IntegrationFailure(
                "precision",
                f"{self.arithmetic.bits} bits are too few: at the last crossing {missing} would be missing",
                "give --max-precision more",
                needs_precision=True,
                enough_precision=self.arithmetic.bits + 8 + missing * _LOSS_DIVISOR // (_LOSS_DIVISOR - 1),
            )

    def _combine(self, image: Sequence[Series], row: Sequence[Fraction]) -> Series:
        result = self._zero()
        for index, factor in zip(self.system.kernel_coordinates, row, strict=True):
            result = result + image[index].scaled(factor)
        return result


def _log2(value: Fraction) -> float:
    return log2(value.numerator) - log2(value.denominator)


def default_order(precision: int) -> int:
    """Degree of the time expansions that was found fast for a precision in bits."""
    return max(16, precision // 2)


def _grade_bits(grading: Grading, scales: Sequence[Fraction], bits: int) -> tuple[int, int]:
    """Further fractional bits per grade, and the significant bits that a coefficient loses per grade.

    Scaled initial values of a variable of weight w are about 2^-(w s); with s - d further bits per
    grade, grade g keeps about bits - g d significant bits.
    """
    logs = [-_log2(scale) / weight for scale, weight in zip(scales, grading.weights, strict=True)]
    spare = bits // _LOSS_DIVISOR
    size = max(0, floor(max(logs)))
    loss = min(size, spare)
    return size - loss, loss
