"""A point of Fix(R) that two functions single out: Newton's method, up to the box for the verifier.

The unknowns are the coordinates u of a point of Fix(R); the equations are pi_q P(u) = 0 and one more, which says that
R is lost or that multipliers collide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, isfinite, log2
from typing import Any

import mpmath

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement.crossing import level_jet, shorter_coordinates
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import HalfReturn, start_jets
from orbitproof.explore.refinement.jets import JetBasis
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import Regularisation, ReversibleSystem

_FIRST_BITS = 90
_GUARD_BITS = 40
_MARGIN_DIGITS = 6
_BOX_DIGITS = 24
"""Of the box: small enough for third derivatives, however many digits the centre has."""
FRAME_BITS = 40
_MOST_STEPS = 20
_FARTHEST = 3e-2
"""Largest distance from the guess, relative where a coordinate exceeds 1."""


@dataclass(frozen=True)
class Defect:
    """What is looked at near the point.

    Attributes:
        value: of the further function.
        slope: its derivatives in u.
        half: P and DP there.
        kernel_frame: for a claim at this point.
    """

    value: Any
    slope: Sequence[Any]
    half: HalfReturn
    kernel_frame: tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Place:
    """Where a function is evaluated.

    Attributes:
        system, parameters: of the orbits.
        crossings: m.
        regularisation: in which they are followed.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    crossings: int
    regularisation: Regularisation | None


Evaluate = Callable[[Place, Sequence[Fraction], mpmath.MPContext], Defect]


def refine_defect(
    kind: str,
    evaluate: Evaluate,
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
    """The claim of a kind near a point, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not come to a point.
    """
    names = system.centre_coordinates
    if len(guess) != len(names) or not all(map(isfinite, guess)):
        raise RefinementFailure(f"the guess needs finite numbers for {', '.join(names)}")
    if system.family_parameter is None and system.level_coordinate not in names:
        raise RefinementFailure(f"{system.name} names no level coordinate: the level cannot be the parameter")
    report = progress or (lambda _message, _fraction: None)
    try:
        place = Place(system, parameters, crossings, shorter_coordinates(system, parameters, guess, crossings))
        point, found, bits = _newton(place, evaluate, guess, digits, report)
        return _candidate(kind, place, point, found, bits, digits, id, provenance)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None


def _newton(
    place: Place, evaluate: Evaluate, guess: Sequence[float], digits: int, report: Progress
) -> tuple[list[Fraction], Defect, int]:
    goal = ceil((digits + _MARGIN_DIGITS) * log2(10))
    point, bits = [Fraction(value) for value in guess], _FIRST_BITS
    for number in range(_MOST_STEPS):
        report(f"Newton step {number + 1} with {bits} bits", min(0.9, bits / (goal + 60)))
        context = working_context(bits)
        found = evaluate(place, point, context)
        n = len(point) - 1
        matrix = [[found.half.derivative[n + 1 + i, j] for j in range(n + 1)] for i in range(n)]
        residual = [*found.half.kernel_values, found.value]
        correction = context.lu_solve(context.matrix([*matrix, list(found.slope)]), -context.matrix(residual))
        size = max(float(abs(value)) for value in correction)
        point = [value + round_dyadic(fraction(change), bits) for value, change in zip(point, correction, strict=True)]
        far = max(abs(float(p) - g) / max(1.0, abs(g)) for p, g in zip(point, guess, strict=True))
        if far > _FARTHEST:
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        spread = max(float(abs(value)) for value in found.half.derivative)
        guard = _GUARD_BITS + 2 * ceil(log2(max(spread, 1.0)))
        if bits >= goal + guard and size < 2.0**-goal:
            return point, found, bits
        # What is known doubles; the working precision follows it.
        known = -2 * log2(max(size, 2.0**-bits))
        bits = min(max(bits, ceil(known) + guard), goal + guard)
    raise RefinementFailure(f"Newton's method did not converge in {_MOST_STEPS} steps")


def _candidate(
    kind: str,
    place: Place,
    point: Sequence[Fraction],
    found: Defect,
    bits: int,
    digits: int,
    id: str,
    provenance: Mapping[str, Any],
) -> Candidate:
    system, size = place.system, len(point)
    spread = max(float(abs(value)) for value in found.half.derivative)
    exponent = ceil(min(_BOX_DIGITS, digits - _MARGIN_DIGITS) * log2(10) + log2(max(1.0, spread)))
    names, centre, sign = system.centre_coordinates, list(point), None
    if system.family_parameter is None:
        context, basis = working_context(bits), JetBasis.graded((1,), 0)
        values = [mpf(value, context) for value in point]
        start, _ = start_jets(system, values, [], basis)
        level = level_jet(system, place.parameters, start, None, context).coefficients[0]
        position = names.index(str(system.level_coordinate))
        sign = 1 if point[position] > 0 else -1
        centre = [fraction(level), *point[:position], *point[position + 1 :]]
    return Candidate(
        id=id,
        system=system,
        parameters=dict(place.parameters),
        kind=kind,  # type: ignore[arg-type]
        k=1,
        centre=tuple(round_dyadic(value, bits) for value in centre),
        frame=tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size)),
        kernel_frame=found.kernel_frame,
        radii=(Fraction(1, 2**exponent),) * size,
        level_sign=sign,
        crossings=place.crossings,
        provenance={"digits": digits, **provenance},
    )
