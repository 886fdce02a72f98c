"""A periodic orbit to many digits, and the claim about it for the verifier: Newton's method with Taylor jets.

The unknowns are the point and the period; the equations are those of `correction`, the point on the section.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, floor, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import GrowingDigits, Linearised, Solution, bits_of, mpf, newton_with_digits
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.explore.refinement import (
    IntegrationFailure,
    Jet,
    JetBasis,
    JetStepper,
    RefinementFailure,
    Tape,
    operations,
)
from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import Program, System, with_functions

RULE = GrowingDigits(RefinementFailure, farthest=1e-3, guard_bits=24)
_BOX_SHARE, _BOX_DIGITS = 0.7, 5
"""The half-widths of the box have this part of the digits of the centre, and so many more: over a narrower box the
derivatives are known to fewer digits, over a wider one they vary more."""
_KNOWN_DIGITS, _MOST_DIGITS = 9, 200
"""So many digits narrower is the box than the growth of bounds asks for; the centre has no more than the second."""
GROWTH_ALLOWED = int(_MOST_DIGITS * _BOX_SHARE) + _BOX_DIGITS - _KNOWN_DIGITS
"""Bounds may grow by so many digits over a box about the centre with the most of them."""
_MOST_BITS = 900
"""The verifier bounds no error below 2^-960: derivatives over a box as narrow as that are not known."""
_MOST_STEPS = 20_000
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


def digits_of_centre(growth: float) -> int:
    """How many digits the centre needs for a box over which bounds may grow by so many."""
    return min(_MOST_DIGITS, ceil((growth + _KNOWN_DIGITS - _BOX_DIGITS) / _BOX_SHARE))


def refine_periodic(task: PeriodicTask, progress: Progress | None = None) -> PeriodicOrbit:
    """The orbit to many digits, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not converge near the guess.
    """
    unknowns = [Fraction(value) for value in (*task.point, task.period)]
    found = solved(lambda each, context: _linearised(task, each, context), unknowns, task.digits, RULE, progress)
    return _claim(task, found)


def solved(
    equations: Callable[[Sequence[Fraction], mpmath.MPContext], Linearised],
    guess: Sequence[Fraction],
    digits: int,
    rule: GrowingDigits,
    progress: Progress | None,
) -> Solution:
    """The solution to so many digits, rounded to them and some more. Raises `RefinementFailure`."""
    try:
        found = newton_with_digits(equations, guess, bits_of(digits), rule, progress)
    except (IntegrationFailure, ZeroDivisionError, ValueError) as failure:
        raise RefinementFailure(" ".join(str(failure).split()) or "the arithmetic broke down") from None
    return replace(found, unknowns=[round_dyadic(value, found.bits) for value in found.unknowns])


def _linearised(task: PeriodicTask, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> Linearised:
    """phi_T(x) - x, the section and, with a first integral, its level; the spread is the largest entry of D phi."""
    *x, time = unknowns
    size = len(x)
    basis = JetBasis.graded((1,) * size, 1)
    start = []
    for i, value in enumerate(x):
        start.append(basis.constant(value))
        start[i].coefficients[basis.variable(i)] = Fraction(1)
    end = flow_jets(task.system, task.parameters, start, time, context)
    derivative = [[jet.coefficients[basis.variable(j)] for j in range(size)] for jet in end[:size]]
    given = [mpf(task.parameters[name], context) for name in task.system.parameters]
    velocity = evaluated(task.system.program, [*(jet.coefficients[0] for jet in end), *given], context)
    rows = [[*(derivative[i][j] - int(i == j) for j in range(size)), velocity[i]] for i in range(size)]
    values = [end[i].coefficients[0] - mpf(x[i], context) for i in range(size)]
    normal = task.section.normal
    rows.append([*(mpf(a, context) for a in normal), 0])
    values.append(mpf(sum(a * u for a, u in zip(normal, x, strict=True)) - task.section.offset, context))
    if task.level is not None:
        assert task.system.first_integral_program is not None
        here = whole_jets(task.system, start, given, context)
        (integral,) = evaluated(task.system.first_integral_program, [*here, *given], context)
        rows.append([*(integral.coefficients[basis.variable(j)] for j in range(size)), 0])
        values.append(integral.coefficients[0] - mpf(task.level, context))
    spread = max(float(abs(entry)) for row in derivative for entry in row)
    return Linearised(context.matrix(values), context.matrix(rows), spread)


def flow_jets(
    system: System,
    parameters: Mapping[str, Fraction],
    start: Sequence[Jet],
    time: Fraction,
    context: mpmath.MPContext,
) -> list[Jet]:
    """The jets of phi_T of all coordinates, those that are functions of others last, with the precision of `context`.

    Arguments:
        parameters: those that are numbers.
        start: jets of the given state, then of the other parameters, with exact coefficients.

    Raises `IntegrationFailure` if the orbit cannot be followed.
    """
    bits, size, basis = context.prec, len(system.state), start[0].basis
    start = _with_functions(system, parameters, start, context)
    stepper = JetStepper(Tape(system.program, parameters), size, basis, bits)
    unit = 1 << bits
    state = [[_nearest(value * unit, context) for value in jet.coefficients] for jet in start]
    given = state[size:]
    left, exponent = Fraction(time), -3
    for _ in range(_MOST_STEPS):
        result = stepper.step([*state[:size], *given], exponent)
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
            return [Jet(basis, [context.ldexp(context.mpf(value), -bits) for value in jets]) for jets in state]
    raise IntegrationFailure(f"the period takes more than {_MOST_STEPS} steps")


def _with_functions(
    system: System, parameters: Mapping[str, Fraction], start: Sequence[Jet], context: mpmath.MPContext
) -> list[Jet]:
    """The jets of the whole state, then of the other parameters."""
    size = len(system.given_state)
    state, others = start[:size], iter(start[size:])
    if not system.defined:
        return list(start)
    given = [
        mpf(parameters[name], context) if name in parameters else _rounded(next(others), context)
        for name in system.parameters
    ]
    return [*state, *whole_jets(system, state, given, context)[size:], *start[size:]]


def whole_jets(system: System, state: Sequence[Jet], parameters: Sequence[Any], context: mpmath.MPContext) -> list[Jet]:
    """The whole state, from jets of the coordinates that are given, with the precision of `context`."""
    basis, given = state[0].basis, [_rounded(jet, context) for jet in state]
    zero = basis.constant(context.mpf(0))
    functions = {each.function: _function(each.function, basis, context) for each in system.defined}
    places = [*given, *[zero] * len(system.defined)]
    return with_functions(system, places, parameters, functions, *operations(context))


def _function(name: str, basis: JetBasis, context: mpmath.MPContext) -> Callable[[Any], Jet]:
    return lambda value: (value if isinstance(value, Jet) else basis.constant(value)).function(name, context)


def _rounded(jet: Jet, context: mpmath.MPContext) -> Jet:
    return Jet(jet.basis, [mpf(value, context) for value in jet.coefficients])


def _nearest(value: Any, context: mpmath.MPContext) -> int:
    """An exact number or one of `context`, rounded."""
    return round(value) if isinstance(value, (int, Fraction)) else int(context.nint(value))


def evaluated(program: Program, inputs: Sequence[Any], context: mpmath.MPContext) -> list[Any]:
    """A program at numbers of `context` and jets of them."""
    return list(program.evaluate(list(inputs), *operations(context)))


def box_exponent(digits: int, spread: float) -> int:
    """-log2 of the half-widths of a box about a point that is known to so many digits, as far as floats bound errors.

    Arguments:
        spread: how much the map magnifies.
    """
    return min(_MOST_BITS, ceil((_BOX_SHARE * digits + _BOX_DIGITS) * log2(10) + log2(max(1.0, spread))))


def _claim(task: PeriodicTask, found: Solution) -> PeriodicOrbit:
    point = found.unknowns[: len(task.point)]
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
        radii=(Fraction(1, 2 ** box_exponent(task.digits, found.last.spread)),) * (len(point) - 1),
        level=task.level,
        provenance={"digits": task.digits, "newton_steps": found.steps, **task.provenance},
    )
