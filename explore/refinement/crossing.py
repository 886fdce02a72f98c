"""Jets of the iterates of the Poincare map between successive crossings of a system's section.

Not rigorous. Each crossing, in either direction, is one application of the map. At a crossing the
time tau that a neighbouring solution needs is expanded as a jet from y(t_0 + tau) = 0, with y the
section coordinate and t_0 the crossing time of the centre, and substituted into the solution.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from math import comb
from typing import Any

import mpmath

from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement.floats import FLOAT_BITS, FloatWalk
from orbitproof.explore.refinement.jets import Jet, JetBasis, operations
from orbitproof.explore.refinement.tape import Tape
from orbitproof.explore.refinement.taylor import IntegrationFailure, JetStepper, Series, StepResult
from orbitproof.shared.systems import (
    REGULARISATIONS,
    Program,
    Regularisation,
    ReversibleSystem,
    level_root,
    with_functions,
    with_slope,
)

MAXIMAL_STEPS = 500
"""Steps after which a return to the section is given up."""

_SMALLEST_EXPONENT = -40

_SAMPLES = 16

_REGULARISED_STEP = 3.5
"""A step in regularised coordinates was found to take so many times as long as one in the system's own."""


@dataclass(frozen=True)
class Crossing:
    """The i-th crossing of the section.

    Attributes:
        jets: one jet for each state coordinate, as a function of the variables of the start.
        time: elapsed time of the centre.
        steps: Taylor steps since the start.
        duration: the elapsed time as a function of the variables of the start.
    """

    jets: tuple[Jet, ...]
    time: float
    steps: int
    duration: Jet


def section_crossings(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    parameter_jet: Jet | None,
    context: mpmath.MPContext,
    progress: Callable[[float], None] | None = None,
    order: int | None = None,
    tolerance_bits: int | None = None,
    regularisation: Regularisation | None = None,
    maximal_steps: int = MAXIMAL_STEPS,
    every: int = 1,
) -> Iterator[Crossing]:
    """Crossings of the section by the solution through `start`, one after another; of `every` m only the m-th.

    `start` holds a jet of mpmath numbers for each state coordinate, zero in the section coordinate;
    `parameter_jet` is that of the family parameter, if the system has one. The working precision is
    that of `context`; `order` and `tolerance_bits` are those of `JetStepper`. With a `regularisation` of the
    system the orbit is followed in its coordinates, and the crossings are those of the same orbit.
    Raises `IntegrationFailure` if the orbit does not return or meets a singularity.
    """
    bits = context.prec
    basis = start[0].basis
    start = completed_jets(system, parameters, start, parameter_jet, context)
    jets, constant = list(start), parameter_jet
    program, section = system.program, system.section_index
    if regularisation is not None:
        branch = regularisation.branch(
            [float(jet.coefficients[0]) for jet in start], [*map(float, parameters.values())]
        )
        constant = level_jet(system, parameters, start, None, context)
        jets = _evaluate_program(regularisation.embedding_program(branch), start, system, parameters, context)
        program, section = regularisation.program, regularisation.section_index
    tape, walk = Tape(program, parameters), None
    if bits <= FLOAT_BITS and order is None and tolerance_bits is None:
        walk = FloatWalk(tape, len(jets), basis, context)
    else:
        walk = _IntegerWalk(JetStepper(tape, len(jets), basis, bits, order, tolerance_bits), context)
    steps = 0
    for number in count(1):
        walk.load(jets, constant)
        for _ in range(maximal_steps):
            steps += 1
            if walk.step(section):
                break
            if progress is not None:
                progress(float(walk.time))
        else:
            raise IntegrationFailure(f"no return to the section within time {float(walk.time):.3g}")
        jets, tau = _project(walk.expansions(), section, basis, context)
        if number % every:
            continue
        if regularisation is None:
            yield Crossing(tuple(jets), float(walk.time), steps, walk.in_time(tau) + mpf(walk.time, context))
        else:
            image = _evaluate_program(regularisation.projection_program, jets, system, parameters, context)
            duration = jets[regularisation.time_index]
            yield Crossing(tuple(image), float(duration.coefficients[0]), steps, duration)


class _IntegerWalk:
    """An orbit with its jets in fixed-point numbers, step by step to the next crossing of a section.

    Attributes:
        time: elapsed, of the centre.
    """

    def __init__(self, stepper: JetStepper, context: mpmath.MPContext) -> None:
        self.time = Fraction(0)
        self._stepper, self._context, self._exponent, self._side, self._end = stepper, context, -3, 0, 0
        self._state: list[list[int]] = []
        self._fixed: list[list[int]] = []
        self._result: StepResult | None = None

    def load(self, jets: Sequence[Jet], constant: Jet | None) -> None:
        """Begin at a crossing; `constant` is the jet of the parameter."""
        self._state = [_to_fixed(jet, self._context) for jet in jets]
        self._fixed = [] if constant is None else [_to_fixed(constant, self._context)]
        self._side = 0

    def step(self, section: int) -> bool:
        """A step, or the part of it up to the section; whether that was reached."""
        bits = self._context.prec
        self._result = result = self._stepper.step(self._state + self._fixed, self._exponent)
        self._exponent = result.proposal
        if self._exponent < _SMALLEST_EXPONENT:
            raise IntegrationFailure("the orbit runs into a singularity")
        height = result.series[section][0]
        if self._side == 0:
            self._side = 1 if height[1] > 0 else -1
            if abs(height[1]) >> (bits - 20) == 0:
                raise IntegrationFailure("the flow is tangent to the section at the start")
        end = round(result.length * 2**_SAMPLES)
        crossing = _first_crossing(height, self._side, Fraction(end, 2**_SAMPLES), bits)
        self._end = end << (bits - _SAMPLES) if crossing is None else crossing
        self.time += Fraction(self._end, 1 << bits) * Fraction(2) ** result.exponent
        if crossing is None:
            self._state = _advance(result, self._end, bits)
        return crossing is not None

    def expansions(self) -> list[list[Jet]]:
        """The jets at the end of the step, and their derivatives in scaled time over factorials, up to the degree."""
        assert self._result is not None
        series, context, basis = self._result.series, self._context, self._stepper.basis
        length, bits = len(series[0][0]), context.prec
        powers = _powers(self._end, length, bits)
        found: list[list[Jet]] = []
        for j in range(basis.degree + 1):
            weights = [0] * j + [comb(n, j) * powers[n - j] for n in range(j, length)]
            rows = ([context.ldexp(context.mpf(_dot(each, weights, bits)), -bits) for each in jets] for jets in series)
            found.append([Jet(basis, row) for row in rows])
        return found

    def in_time(self, tau: Jet) -> Jet:
        """A jet in scaled time as one in time."""
        assert self._result is not None
        return tau * self._context.ldexp(1, self._result.exponent)


def shorter_coordinates(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float], every: int = 1
) -> Regularisation | None:
    """The regularisation of the system, if the half return of a point of Fix(R) is sooner followed in it.
    The half return crosses the section `every` so many times.

    `point` is in the order of `centre_coordinates`. Raises `IntegrationFailure` if the orbit does not return.
    """
    regularisation = REGULARISATIONS.get(system.name)
    if regularisation is None or regularisation.system is not system:
        return None
    context = working_context(FLOAT_BITS)
    basis = JetBasis.graded([1], 0)
    start = [basis.constant(context.mpf(0)) for _ in system.state]
    for index, value in zip(system.fixed_coordinates, point, strict=True):
        start[index] = basis.constant(context.mpf(value))

    def steps(coordinates: Regularisation | None, most: int) -> int:
        crossings = section_crossings(
            system, parameters, start, None, context, regularisation=coordinates, maximal_steps=most, every=every
        )
        return next(crossings).steps

    few = steps(regularisation, MAXIMAL_STEPS)
    try:
        steps(None, int(_REGULARISED_STEP * few))
    except IntegrationFailure:
        return regularisation
    return None


def completed_jets(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    parameter: Jet | None,
    context: mpmath.MPContext,
) -> list[Jet]:
    """`start` with the coordinates that follow from the others: that of a fixed level, and functions."""
    jets = _with_functions(system, parameters, start, parameter, context)
    if system.fixed_level is None:
        return jets
    return _with_functions(
        system, parameters, _on_level(system, parameters, jets, parameter, context), parameter, context
    )


def _with_functions(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    parameter: Jet | None,
    context: mpmath.MPContext,
) -> list[Jet]:
    """`start` with the values of the coordinates that are functions of others."""
    if not system.defined:
        return list(start)
    basis = start[0].basis
    constant, power = operations(context)

    def function(name: str) -> Callable[[Any], Jet]:
        return lambda value: (value if isinstance(value, Jet) else basis.constant(value)).function(name, context)

    given = [constant(parameters[name]) if name in parameters else parameter for name in system.parameters]
    functions = {each.function: function(each.function) for each in system.defined}
    return with_functions(system, start, given, functions, constant, power)


def _on_level(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    parameter: Jet | None,
    context: mpmath.MPContext,
) -> list[Jet]:
    """`start` with the level coordinate that belongs to the fixed level: H = A + b w^2, or any H in an interval."""
    level = system.fixed_level
    assert level is not None
    place, basis = system.state.index(str(system.level_coordinate)), start[0].basis
    constant, power = operations(context)

    def run(program: Program, w: Jet) -> list[Jet]:
        state = [w if i == place else jet for i, jet in enumerate(start)]
        given = [constant(parameters[name]) if name in parameters else parameter for name in system.parameters]
        found = program.evaluate([*state, *given], constant, power)
        return [value if isinstance(value, Jet) else basis.constant(value) for value in found]

    assert system.first_integral_program is not None
    jets, value = list(start), basis.constant(constant(level.value))
    if level.between is not None:
        both = with_slope(system.first_integral_program, str(system.level_coordinate))

        def height(w: float) -> float:
            (found, _) = run(both, basis.constant(context.mpf(w)))
            return float((found - value).coefficients[0])

        w = basis.constant(context.mpf(level_root(height, *map(float, level.between))))
        if not context.isfinite(w.coefficients[0]):
            raise IntegrationFailure(f"no point of the level {level.value} lies over this point in its interval")
        # Every step doubles the digits, and the order in the variables.
        for _ in range(context.prec.bit_length() + 3):
            found, slope = run(both, w)
            w = w - (found - value) / slope
        jets[place] = w
        return jets
    (rest,), (one,) = (run(system.first_integral_program, basis.constant(context.mpf(w))) for w in (0, 1))
    square = (value - rest) / (one - rest)
    if not square.coefficients[0] > 0:
        raise IntegrationFailure(f"no point of the level {level.value} lies over this point")
    jets[place] = square.power(Fraction(1, 2), power) * int(level.sign or 1)
    return jets


def level_jet(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    parameter: Jet | None,
    context: mpmath.MPContext,
) -> Jet:
    """The bifurcation parameter (first integral, or family parameter) as a jet at the start."""
    if parameter is not None:
        return parameter
    assert system.first_integral_program is not None
    start = _with_functions(system, parameters, start, None, context)
    return _evaluate_program(system.first_integral_program, start, system, parameters, context)[0]


def _evaluate_program(
    program: Program,
    arguments: Sequence[Jet],
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    context: mpmath.MPContext,
) -> list[Jet]:
    """A straight-line program of jets and the parameters, which do not vary."""
    constant, power = operations(context)
    basis = arguments[0].basis
    fixed = [constant(parameters[name]) for name in system.parameters]
    try:
        values = program.evaluate([*arguments, *fixed], constant, power)
    except ZeroDivisionError:
        raise IntegrationFailure("division by zero: the orbit meets a singularity") from None
    return [value if isinstance(value, Jet) else basis.constant(value) for value in values]


def _to_fixed(jet: Jet, context: mpmath.MPContext) -> list[int]:
    return [int(context.ldexp(context.mpf(c), context.prec)) if c else 0 for c in jet.coefficients]


def _powers(theta: int, length: int, bits: int) -> Series:
    powers = [1 << bits]
    for _ in range(length - 1):
        powers.append((powers[-1] * theta) >> bits)
    return powers


def _dot(left: Sequence[int], right: Sequence[int], bits: int) -> int:
    return sum(a * b for a, b in zip(left, right, strict=True)) >> bits


def _advance(result: StepResult, theta: int, bits: int) -> list[list[int]]:
    powers = _powers(theta, len(result.series[0][0]), bits)
    return [[_dot(series, powers, bits) for series in jets] for jets in result.series]


def _first_crossing(height: Series, side: int, end: Fraction, bits: int) -> int | None:
    """The first zero in (0, end] of the polynomial `height`, which starts with sign `side`; fixed point."""
    scale = 2.0**-60
    shift = max(0, bits - 60)
    floats = [side * float(c >> shift) * scale for c in height]
    previous = 0.0
    for sample in range(1, _SAMPLES + 1):
        here = float(end) * sample / _SAMPLES
        if _horner(floats, here) < 0:
            return _polish(height, floats, previous, here, bits)
        previous = here
    return None


def _horner(coefficients: Sequence[float], theta: float) -> float:
    value = 0.0
    for c in reversed(coefficients):
        value = value * theta + c
    return value


def _polish(height: Series, floats: Sequence[float], low: float, high: float, bits: int) -> int:
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if _horner(floats, middle) < 0 else (middle, high)
    theta = int(Fraction((low + high) / 2) * (1 << bits))
    slopes = [n * c for n, c in enumerate(height)][1:]
    accuracy = 30
    while accuracy < 2 * bits:
        powers = _powers(theta, len(height), bits)
        slope = _dot(slopes, powers[:-1], bits)
        if slope == 0:
            raise IntegrationFailure("the flow is tangent to the section at a crossing")
        theta -= (_dot(height, powers, bits) << bits) // slope
        accuracy *= 2
    return theta


def _project(
    expansions: list[list[Jet]], section: int, basis: JetBasis, context: mpmath.MPContext
) -> tuple[list[Jet], Jet]:
    """The jets on the section, and the time jet, from the jets there [derivative order][state]."""
    degree = basis.degree
    heights = [rows[section] for rows in expansions]
    heights[0] = Jet(basis, [0, *heights[0].coefficients[1:]])
    tau = basis.constant(0)
    if degree:
        slope = heights[1].coefficients[0]
        for _ in range(degree):
            tau = tau - _evaluate(heights, tau) / slope
    projected = [_evaluate([rows[i] for rows in expansions], tau) for i in range(len(expansions[0]))]
    projected[section] = basis.constant(context.mpf(0))
    return projected, tau


def _evaluate(coefficients: Sequence[Jet], tau: Jet) -> Jet:
    value = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = value * tau + coefficient
    return value
