"""Points at which the reversor R is lost: Newton's method, up to the box for the verifier.

The unknowns are the coordinates u of a point of Fix(R), the equations pi_q P(u) = 0 and g(u) = 0, g from the bordered
system [[B, e], [r, 0]] (w, g) = (0, 1). B is D_q P in the coordinates of Fix(R) without the parameter, or without the
coordinate that follows from the level, and dg = - l dB w with the left solution l.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, isfinite, log2
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.refinement.crossing import level_jet, shorter_coordinates
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import HalfReturn, half_return, second_derivatives, start_jets
from orbitproof.explore.refinement.jets import JetBasis
from orbitproof.explore.refinement.resonance import working_context
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import REVERSOR_BREAKING, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import Regularisation, ReversibleSystem

_FIRST_BITS = 90
_GUARD_BITS = 40
_MARGIN_DIGITS = 6
_BOX_DIGITS = 24
"""Of the box: small enough for third derivatives, however many digits the centre has."""
_FRAME_BITS = 40
_MOST_STEPS = 20
_FARTHEST = 3e-2
"""Largest distance from the guess, relative where a coordinate exceeds 1."""


@dataclass(frozen=True)
class Loss:
    """A point near one at which R is lost.

    Attributes:
        defect: g.
        right, left: w and l, n numbers each.
        slope: derivatives of g in u.
        half: P and DP there.
    """

    defect: Any
    right: list[Any]
    left: list[Any]
    slope: list[Any]
    half: HalfReturn


def crossing_matrix(system: ReversibleSystem, half: HalfReturn) -> tuple[list[int], np.ndarray[Any, Any]]:
    """Rows of DP for the coordinates of Fix(R) without the parameter or the level coordinate, and B in floats."""
    rows = _rows(system)
    n = len(rows)
    return rows, np.array([[float(half.derivative[row, n + 1 + j]) for j in range(n)] for row in rows])


def refine_breaking(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    guess: Sequence[float],
    *,
    digits: int,
    crossings: int = 1,
    id: str,
    provenance: Mapping[str, Any],
    progress: Progress | None = None,
) -> Candidate:
    """The claim that R is lost near a point, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not come to a point.
    """
    names = system.centre_coordinates
    if len(guess) != len(names) or not all(map(isfinite, guess)):
        raise RefinementFailure(f"the guess needs finite numbers for {', '.join(names)}")
    if system.family_parameter is None and system.level_coordinate not in names:
        raise RefinementFailure(f"{system.name} names no level coordinate: the level cannot be the parameter")
    report = progress or (lambda _message, _fraction: None)
    try:
        regularisation = shorter_coordinates(system, parameters, guess, crossings)
        point, loss, bits = _newton(system, parameters, guess, digits, crossings, regularisation, report)
        return _candidate(system, parameters, point, loss, bits, digits, crossings, id, provenance)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None


def _newton(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    guess: Sequence[float],
    digits: int,
    crossings: int,
    regularisation: Regularisation | None,
    report: Progress,
) -> tuple[list[Fraction], Loss, int]:
    goal = ceil((digits + _MARGIN_DIGITS) * log2(10))
    point, bits = [Fraction(value) for value in guess], _FIRST_BITS
    for number in range(_MOST_STEPS):
        report(f"Newton step {number + 1} with {bits} bits", min(0.9, bits / (goal + 60)))
        context = working_context(bits)
        loss = _loss_at(system, parameters, point, context, regularisation, crossings)
        n = len(loss.right)
        matrix = [[loss.half.derivative[n + 1 + i, j] for j in range(n + 1)] for i in range(n)]
        residual = [*loss.half.kernel_values, loss.defect]
        correction = context.lu_solve(context.matrix([*matrix, loss.slope]), -context.matrix(residual))
        size = max(float(abs(value)) for value in correction)
        point = [value + round_dyadic(_fraction(change), bits) for value, change in zip(point, correction, strict=True)]
        far = max(abs(float(p) - g) / max(1.0, abs(g)) for p, g in zip(point, guess, strict=True))
        if far > _FARTHEST:
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        spread = max(float(abs(value)) for value in loss.half.derivative)
        guard = _GUARD_BITS + 2 * ceil(log2(max(spread, 1.0)))
        if bits >= goal + guard and size < 2.0**-goal:
            return point, loss, bits
        # What is known doubles; the working precision follows it.
        known = -2 * log2(max(size, 2.0**-bits))
        bits = min(max(bits, ceil(known) + guard), goal + guard)
    raise RefinementFailure(f"Newton's method did not converge in {_MOST_STEPS} steps")


def _rows(system: ReversibleSystem) -> list[int]:
    names = system.centre_coordinates
    dropped = system.family_parameter or system.level_coordinate
    return [place for place, name in enumerate(names) if name != dropped]


def _loss_at(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    context: mpmath.MPContext,
    regularisation: Regularisation | None,
    crossings: int,
) -> Loss:
    half = half_return(system, parameters, point, context, regularisation, crossings)
    rows, floats = crossing_matrix(system, half)
    n = len(rows)
    left, _, right = np.linalg.svd(floats)
    e, r = ([context.mpf(float(value)) for value in vector] for vector in (left[:, -1], right[-1]))
    whole = context.matrix(n + 1, n + 1)
    for i in range(n):
        for j in range(n):
            whole[i, j] = half.derivative[rows[i], n + 1 + j]
        whole[i, n], whole[n, i] = e[i], r[i]
    last = context.matrix([0] * n + [1])
    solution, other = context.lu_solve(whole, last), context.lu_solve(whole.T, last)
    w, covector = list(solution[:n]), list(other[:n])
    units = [[int(i == j) for i in range(2 * n + 1)] for j in range(n + 1)]
    (bent,) = second_derivatives(
        system, parameters, point, [[0] * (n + 1) + w], units, context, regularisation, crossings
    )
    slope = [-sum(covector[i] * column[row] for i, row in enumerate(rows)) for column in bent]
    return Loss(solution[n], w, covector, slope, half)


def _candidate(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    loss: Loss,
    bits: int,
    digits: int,
    crossings: int,
    id: str,
    provenance: Mapping[str, Any],
) -> Candidate:
    size = len(point)
    spread = max(float(abs(value)) for value in loss.half.derivative)
    exponent = ceil(min(_BOX_DIGITS, digits - _MARGIN_DIGITS) * log2(10) + log2(max(1.0, spread)))
    names, centre, sign = system.centre_coordinates, list(point), None
    if system.family_parameter is None:
        context, basis = working_context(bits), JetBasis.graded((1,), 0)
        values = [context.mpf(value.numerator) / value.denominator for value in point]
        start, _ = start_jets(system, values, [], basis)
        level = level_jet(system, parameters, start, None, context).coefficients[0]
        place = names.index(str(system.level_coordinate))
        sign = 1 if point[place] > 0 else -1
        centre = [_fraction(level), *point[:place], *point[place + 1 :]]
    return Candidate(
        id=id,
        system=system,
        parameters=dict(parameters),
        kind=REVERSOR_BREAKING,
        k=1,
        centre=tuple(round_dyadic(value, bits) for value in centre),
        frame=tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size)),
        kernel_frame=_kernel_frame([float(value) for value in loss.right]),
        radii=(Fraction(1, 2**exponent),) * size,
        level_sign=sign,
        crossings=crossings,
        provenance={"digits": digits, **provenance},
    )


def _kernel_frame(right: Sequence[float]) -> tuple[tuple[Fraction, ...], ...]:
    """A row along w, and unit rows but that of its largest component."""
    largest = max(range(len(right)), key=lambda i: abs(right[i]))
    rest = [i for i in range(len(right)) if i != largest]
    first = tuple(round_dyadic(Fraction(value), _FRAME_BITS) for value in right)
    return (first, *(tuple(Fraction(int(i == j)) for j in range(len(right))) for i in rest))


def _fraction(value: Any) -> Fraction:
    sign, mantissa, exponent, _ = mpmath.mpf(value)._mpf_ if isinstance(value, int) else value._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent
