"""A periodic orbit to many digits, and the claim about it for the verifier: Newton's method with Taylor jets.

The unknowns are the point and the period; the equations are those of `correction`, the point on the section.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.explore.refinement import (
    IntegrationFailure,
    JetBasis,
    JetStepper,
    RefinementFailure,
    Tape,
    working_context,
)
from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import System

_FIRST_BITS = 90
_GUARD_BITS = 24
_MARGIN_DIGITS = 6
_BOX_SHARE, _BOX_DIGITS = 0.7, 5
"""The half-widths of the box have this part of the digits of the centre, and so many more: over a narrower box the
derivatives are known to fewer digits, over a wider one they vary more."""
_MOST_NEWTON_STEPS = 24
_MOST_STEPS = 4000
_FARTHEST = 1e-3
"""Largest distance from the guess, relative where a coordinate exceeds 1."""
_SMALLEST_EXPONENT = -60


@dataclass(frozen=True)
class PeriodicTask:
    """One orbit to refine; the fields are those of a claim.

    Attributes:
        parameters: all of the system's, exact.
        point: float64, on the orbit near the section.
        period: float64.
        crossings: of the section in its direction within a period.
        level: of the first integral, exact; `None` for a system without one.
        digits: decimal digits of the centre.
    """

    id: str
    system: System
    parameters: Mapping[str, Fraction]
    section: AffineSection
    crossings: int
    point: tuple[float, ...]
    period: float
    level: Fraction | None
    digits: int
    provenance: Mapping[str, Any]


def refine_periodic(task: PeriodicTask, progress: Progress | None = None) -> PeriodicOrbit:
    """The orbit to many digits, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not converge near the guess.
    """
    report = progress or (lambda _message, _fraction: None)
    goal = ceil((task.digits + _MARGIN_DIGITS) * log2(10))
    size = len(task.point)
    unknowns = [Fraction(value) for value in (*task.point, task.period)]
    bits, guard = _FIRST_BITS, _GUARD_BITS
    try:
        for number in range(_MOST_NEWTON_STEPS):
            report(f"Newton step {number + 1} with {bits} bits", min(0.9, bits / (goal + 60)))
            context = working_context(bits)
            residual, matrix, spread = _linearised(task, unknowns, context)
            correction, _ = context.qr_solve(matrix, -residual)
            length = max(float(abs(value)) for value in correction)
            unknowns = [
                value + round_dyadic(_fraction(change), bits)
                for value, change in zip(unknowns, correction, strict=True)
            ]
            guess = (*task.point, task.period)
            far = max(abs(float(u) - g) / max(1.0, abs(g)) for u, g in zip(unknowns, guess, strict=True))
            if not far <= _FARTHEST:
                raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
            guard = max(_GUARD_BITS, ceil(log2(max(spread, 1.0))) + 16)
            wanted = goal + guard
            if bits >= wanted and length < 2.0**-goal:
                return _claim(task, [round_dyadic(value, bits) for value in unknowns[:size]], spread, number + 1)
            known = -2 * log2(max(length, 2.0**-bits))
            bits = min(max(bits, ceil(known) + guard), wanted)
    except (IntegrationFailure, ZeroDivisionError, ValueError) as failure:
        raise RefinementFailure(" ".join(str(failure).split()) or "the arithmetic broke down") from None
    raise RefinementFailure(f"Newton's method did not converge in {_MOST_NEWTON_STEPS} steps")


def _linearised(task: PeriodicTask, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> tuple[Any, Any, float]:
    """phi_T(x) - x, the section and, with a first integral, its level; derivatives; the largest entry of D phi."""
    *x, time = unknowns
    size = len(x)
    end, derivative = flow_jets(task.system, task.parameters, x, time, context)
    velocity = task.system.program.evaluate(
        [*end, *(_number(task.parameters[name], context) for name in task.system.parameters)],
        lambda value: _number(value, context),
        lambda base, exponent: base ** _number(exponent, context),
    )
    rows = [[*(derivative[i][j] - int(i == j) for j in range(size)), velocity[i]] for i in range(size)]
    values = [end[i] - _number(x[i], context) for i in range(size)]
    normal = task.section.normal
    rows.append([*(_number(a, context) for a in normal), 0])
    values.append(_number(sum(a * u for a, u in zip(normal, x, strict=True)) - task.section.offset, context))
    if task.level is not None:
        value, slopes = _level(task, x, context)
        rows.append([*slopes, 0])
        values.append(value - _number(task.level, context))
    spread = max(float(abs(entry)) for row in derivative for entry in row)
    return context.matrix(values), context.matrix(rows), spread


def _level(task: PeriodicTask, x: Sequence[Fraction], context: mpmath.MPContext) -> tuple[Any, list[Any]]:
    """The first integral and its derivatives at a point."""
    basis = JetBasis.graded((1,) * len(x), 1)
    jets = []
    for i, value in enumerate(x):
        jet = basis.constant(_number(value, context))
        jet.coefficients[basis.variable(i)] = context.mpf(1)
        jets.append(jet)

    def power(base: Any, exponent: Fraction) -> Any:
        if hasattr(base, "power"):
            return base.power(exponent, power)
        return base ** _number(exponent, context)

    given = [_number(task.parameters[name], context) for name in task.system.parameters]
    program = task.system.first_integral_program
    (jet,) = program.evaluate([*jets, *given], lambda value: _number(value, context), power)
    return jet.coefficients[0], [jet.coefficients[basis.variable(i)] for i in range(len(x))]


def flow_jets(
    system: System,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    time: Fraction,
    context: mpmath.MPContext,
) -> tuple[list[Any], list[list[Any]]]:
    """phi_T(x), shape (N,), and its derivative, shape (N, N), with the precision of `context`.

    Raises `IntegrationFailure` if the orbit cannot be followed.
    """
    bits, size = context.prec, len(point)
    basis = JetBasis.graded((1,) * size, 1)
    stepper = JetStepper(Tape(system.program, parameters), size, basis, bits)
    unit = 1 << bits
    places = [basis.variable(j) for j in range(size)]
    state = [
        [round(value * unit), *(unit * (m == place) for m in range(1, len(basis.monomials)))]
        for value, place in zip(point, places, strict=True)
    ]
    left, exponent = Fraction(time), -3
    for _ in range(_MOST_STEPS):
        result = stepper.step(state, exponent)
        exponent = result.proposal
        if exponent < _SMALLEST_EXPONENT:
            raise IntegrationFailure("the orbit runs into a singularity")
        scale = Fraction(2) ** result.exponent
        length = min(left, Fraction(floor(result.length * 2**16), 2**16) * scale)
        theta = round(length / scale * unit)
        powers = [unit]
        for _ in range(len(result.series[0][0]) - 1):
            powers.append((powers[-1] * theta) >> bits)
        state = [
            [sum(a * b for a, b in zip(series, powers, strict=True)) >> bits for series in jets]
            for jets in result.series
        ]
        left -= length
        if left <= 0:
            numbers = [[context.ldexp(context.mpf(value), -bits) for value in jets] for jets in state]
            return [row[0] for row in numbers], [[row[place] for place in places] for row in numbers]
    raise IntegrationFailure(f"the period takes more than {_MOST_STEPS} steps")


def _number(value: Any, context: mpmath.MPContext) -> Any:
    exact = Fraction(value)
    return context.mpf(exact.numerator) / exact.denominator


def _fraction(value: Any) -> Fraction:
    sign, mantissa, exponent, _ = mpmath.mpf(value)._mpf_ if isinstance(value, int) else value._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent


def _claim(task: PeriodicTask, point: Sequence[Fraction], spread: float, steps: int) -> PeriodicOrbit:
    exponent = ceil((_BOX_SHARE * task.digits + _BOX_DIGITS) * log2(10) + log2(max(1.0, spread)))
    return PeriodicOrbit(
        id=task.id,
        system=task.system,
        parameters=dict(task.parameters),
        normal=task.section.normal,
        offset=task.section.offset,
        direction=task.section.direction,
        crossings=task.crossings,
        centre=task.section.onto(point),
        frame=task.section.frame(),
        radii=(Fraction(1, 2**exponent),) * (len(point) - 1),
        level=task.level,
        provenance={"digits": task.digits, "newton_steps": steps, **task.provenance},
    )
