"""Iterates of the Poincare map on a box of Fix(R), with derivatives (docs/method.md, sections 5 and 6).

`enclose_iterates` takes a candidate's box to its first k crossings of the section and returns, for
each, enclosures of the derivatives up to order 3 of the coordinates that vanish on Fix(R).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, isfinite, log2

from flint import arb, ctx

from shared.formats import Candidate
from shared.program import Program
from verify.algebra import Arithmetic, Series
from verify.balls import enclose
from verify.centre import (
    dyadic_below,
    fixed_coefficients,
    float_coefficients,
    next_crossing,
    rough,
    step_size,
)
from verify.coordinates import PHYSICAL, Coordinates, choose, physical, regularised
from verify.crossing import CrossingCounter, stays_positive
from verify.derivatives import DerivativeTable, derivative_table
from verify.evaluation import Evaluation, prepare
from verify.failure import IntegrationFailure
from verify.grading import Grading
from verify.level import level_program, quadratic_coefficient
from verify.norms import total
from verify.section import onto_section
from verify.step import FlowStep, advance

BOX_RATIO = Fraction(1, 4)
"""The box is this fraction of the polydisc on which the orbits are enclosed (section 6)."""

AUTO, REGULARISED = "auto", "regularised"

_MAX_STEPS = 4000
_LEAST_STEP = 1e-8
_LEAST_SHARE = 1 / 8
_LOSS_DIVISOR = 6
_ROUGH_DEGREE = 24


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
    """The weights of method.md, section 2.2: along the bifurcating branch p_0 and p_2 vary like p_1^2.

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
    previous = ctx.prec
    ctx.prec = settings.precision + 64
    try:
        return _Integration(candidate, settings, progress).run()
    finally:
        ctx.prec = previous


def enclose_first_integral(candidate: Candidate, precision: int) -> DerivativeTable | None:
    """Derivatives of the first integral on the candidate's box in Fix(R), without integrating."""
    previous = ctx.prec
    ctx.prec = precision + 64
    try:
        return _Integration(candidate, IntegratorSettings(precision, 1, coordinates=PHYSICAL), None).first_integral
    finally:
        ctx.prec = previous


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
        self.coordinates = self._choose(settings.coordinates, initial, level)
        self.state, self.constants = self._enter(initial, level)
        self.accuracy = settings.accuracy
        self.first_error_bits = (0.0, 0.0)
        self.tolerance = float(-bits)
        self.counter = CrossingCounter()
        self.time = arb(0)
        self.steps = 0
        self.at_section = True
        self.share = 1.0
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
        (value,) = self._evaluate(level_program(self.system, sign), (*initial, *self.parameters, level))
        initial[self.system.state.index(name)] = value

    def _first_integral(self, initial: Sequence[Series]) -> Series | None:
        program = self.system.first_integral_program
        return None if program is None else self._evaluate(program, (*initial, *self.parameters))[0]

    def _choose(self, wanted: str, initial: Sequence[Series], level: Series | None) -> Coordinates:
        bits, degree = self.arithmetic.bits, self.arithmetic.degree
        if wanted == PHYSICAL or level is None:
            return physical(self.system)
        state, parameters, (value,) = (
            rough([int(x.coefs[0][0]) for x in values], bits) for values in (initial, self.parameters, [level])
        )
        if wanted == REGULARISED:
            return regularised(self.system, state, parameters) or physical(self.system)
        return choose(self.system, state, parameters, value, bits, degree)

    def _enter(self, initial: list[Series], level: Series | None) -> tuple[list[Series], list[Series]]:
        """The initial state in the coordinates that are integrated, and the constants of motion."""
        embedding = self.coordinates.embedding
        if embedding is None or level is None:
            return initial, self.parameters
        return self._evaluate(embedding, (*initial, *self.parameters)), [*self.parameters, level]

    def _leave(self, image: Sequence[Series]) -> Sequence[Series]:
        """The system's own state."""
        regularisation = self.coordinates.regularisation
        if regularisation is None:
            return image
        return self._evaluate(regularisation.projection_program, (*image, *self.parameters))

    def _evaluate(self, program: Program, arguments: Sequence[Series]) -> list[Series]:
        """Values of a program at states that do not depend on time, so that degree 0 does."""
        flat = Arithmetic(self.arithmetic.grading, self.arithmetic.bits, self.arithmetic.grade_bits, 0)
        inputs = [Series(flat, x.coefs, x.errors) for x in arguments]
        evaluation = Evaluation(prepare(program), flat)
        for position in range(len(flat.grading.monomials)):
            evaluation.fill(position, [x.coefs[position] for x in inputs])
        return [Series(self.arithmetic, x.coefs, x.errors) for x in evaluation.enclose(inputs)]

    def run(self) -> Enclosures:
        k = self.candidate.k
        iterates: list[tuple[DerivativeTable, ...]] = []
        while len(iterates) < k:
            if self.steps >= _MAX_STEPS:
                raise IntegrationFailure(
                    "steps", f"no crossing number {len(iterates) + 1} within {_MAX_STEPS} steps", "give another centre"
                )
            at_section = self._step(len(iterates) + 1)
            if at_section:
                iterates.append(self._crossing(len(iterates) + 1))
            if self.progress is not None:
                self.progress((len(iterates) + (0.0 if at_section else 0.5)) / k)
        return Enclosures(
            tuple(iterates), self.first_integral, tuple(self.return_times),
            self.arithmetic.degree, self.arithmetic.bits, self.steps, self.coordinates.name,
        )  # fmt: skip

    def _step(self, number: int) -> bool:
        """Advance by one step; true if it ends, at the centre, at the next crossing."""
        bits, degree = self.arithmetic.bits, self.arithmetic.degree
        centre = [int(x.coefs[0][0]) for x in self.state]
        constants = [int(p.coefs[0][0]) for p in self.constants]
        section = self.coordinates.section
        series = float_coefficients(
            self.coordinates.program, rough(centre, bits), rough(constants, bits), _ROUGH_DEGREE
        )
        size = step_size(series, self.tolerance, degree)
        if size < _LEAST_STEP:
            raise IntegrationFailure(
                "singularity",
                f"at time {self._clock():.9g} the Taylor expansions allow only a step of {size:.1e}",
                "the orbit comes too close to a singularity of the vector field: give another centre",
            )
        while True:
            step, root, flow = self._try(dyadic_below(size * self.share), centre, constants)
            if flow is not None:
                break
            self.share /= 2
        self._check_time(flow)
        self.counter.cover(flow.solution[section], flow.slopes[section], self.time, enclose(step))
        self.state = list(flow.end)
        self.time = self.time + enclose(step)
        self.steps += 1
        if self.steps == 1:
            self.first_error_bits = self._error_bits()
        self.at_section = root is not None
        return self.at_section

    def _try(
        self, step: Fraction, centre: Sequence[int], constants: Sequence[int]
    ) -> tuple[Fraction, Fraction | None, FlowStep | None]:
        """A step of that length, or to the next crossing if that comes first.

        Returns its length, the crossing as a fraction of the given length, and the flow; no flow if it was not
        enclosed and a shorter step may do.
        """
        program, arithmetic = self.coordinates.program, self.arithmetic
        bits, degree = arithmetic.bits, arithmetic.degree
        coefficients = fixed_coefficients(program, centre, constants, degree, bits, step)
        root = next_crossing(coefficients[self.coordinates.section], bits, self.at_section)
        if root is not None:
            step = step * root
            coefficients = fixed_coefficients(program, centre, constants, degree, bits, step)
        try:
            return step, root, advance(program, arithmetic, coefficients, self.state, self.constants, step)
        except IntegrationFailure:
            if self.share <= _LEAST_SHARE:
                raise
            return step, root, None

    def _crossing(self, number: int) -> tuple[DerivativeTable, ...]:
        """Derivatives of the kernel coordinates at crossing `number`, with the proof that it is that crossing."""
        if not self.counter.arrives(number):
            raise IntegrationFailure(
                "crossing count",
                f"the orbit at time {self._clock():.6g} was not proved to be at crossing {number}",
                "the orbit may touch the section: give smaller radii or another centre",
                needs_precision=True,
            )
        coordinates = self.coordinates
        image, elapsed = onto_section(
            coordinates.section_program, coordinates.section, self.arithmetic, self.state, self.constants
        )
        delay = total(elapsed.norm())
        when = self.time + arb(0, delay)
        clear = self.counter.clear_time
        if clear is None or not isfinite(delay) or (when > clear) is not True:
            raise IntegrationFailure(
                "crossing count",
                f"the time of crossing {number} is not separated from the crossing before it",
                "the box is too large: give smaller radii",
            )
        self.return_times.append(when if coordinates.regularisation is None else self._time(image))
        state = self._leave(image)
        if number < self.candidate.k:
            self._check_accuracy(number)
        return tuple(
            derivative_table(self._combine(state, row), self.scales, BOX_RATIO) for row in self.candidate.kernel_frame
        )

    def _check_time(self, flow: FlowStep) -> None:
        """Regularised coordinates describe an orbit as long as their time runs forwards (section 14)."""
        regularisation = self.coordinates.regularisation
        if regularisation is not None and not stays_positive(flow.slopes[regularisation.time_index]):
            raise IntegrationFailure(
                "collision",
                f"the orbits of the box are not separated from a collision at time {self._clock():.6g}",
                "give smaller radii or another centre",
                needs_precision=True,
            )

    def _clock(self) -> float:
        """About the system's time, for messages."""
        regularisation = self.coordinates.regularisation
        if regularisation is None:
            return float(self.time)
        return rough([int(self.state[regularisation.time_index].coefs[0][0])], self.arithmetic.bits)[0]

    def _time(self, image: Sequence[Series]) -> arb:
        """The system's time at a state that does not depend on the integration's own."""
        regularisation = self.coordinates.regularisation
        assert regularisation is not None
        time = image[regularisation.time_index]
        away = list(time.known)
        away[0] = 0.0
        return arb(time.coefs[0][0]) * arb(2) ** -self.arithmetic.bits + arb(
            0, total([total(away), total(time.errors)])
        )

    def _error_bits(self) -> tuple[float, float]:
        """Bits of the worst error of the state and of its derivative in the variable of weight 1."""
        linear = min(
            _log2(scale)
            for scale, weight in zip(self.scales, self.arithmetic.grading.weights, strict=True)
            if weight == 1
        )
        value = max(log2(x.errors[0]) for x in self.state)
        return -value, -max(value, max(log2(x.errors[1]) for x in self.state) - linear)

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
            failure = IntegrationFailure(
                "precision",
                f"{self.arithmetic.bits} bits are too few: at the last crossing {missing} would be missing",
                "give --max-precision more",
                needs_precision=True,
            )
            failure.enough_precision = self.arithmetic.bits + 8 + missing * _LOSS_DIVISOR // (_LOSS_DIVISOR - 1)
            raise failure

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
