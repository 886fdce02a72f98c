"""Extrema of a stability parameter along a family to many digits, and orbits on both sides of them for the verifier."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from operator import attrgetter
from typing import Any

import mpmath

from orbitproof.explore.engines import Job, Lost, Progress, run_all
from orbitproof.explore.numerics import working_context
from orbitproof.explore.refinement.crossing import shorter_coordinates
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import half_return
from orbitproof.explore.refinement.orbit import OrbitTask, refine_orbit
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import COORDINATE, Candidate, Equation
from orbitproof.shared.numbers import round_dyadic

SIDES = ("before", "at", "after")
"""What the ids of the three orbits end with."""

_STEPS = (Fraction(1, 2**16), Fraction(1, 2**22))
"""Distances of the orbits through which a parabola is laid, of the coordinate that singles them out."""
_APART = Fraction(1, 2**30)
"""Distance of the orbits that are left: the value at the extremum differs from that of the middle one by its square."""
_FARTHEST = 1000 * _STEPS[0]


@dataclass(frozen=True)
class RefinedTurn:
    """The result for an extremum: three orbits beside each other, or a reason."""

    task: OrbitTask
    candidates: tuple[Candidate, ...]
    failure: str | None


def refine_turns(tasks: Sequence[OrbitTask], jobs: int, progress: Progress) -> Iterator[RefinedTurn]:
    """Three orbits for each extremum, with `jobs` processes, in the order of completion.

    The provenance of a task has a `stability_parameter`, the value at the extremum in float64.
    """
    for index, result in run_all(Job(_refined_or_not, attrgetter("id")), tasks, jobs, progress):
        yield RefinedTurn(tasks[index], (), result.reason) if isinstance(result, Lost) else result


def _refined_or_not(task: OrbitTask, progress: Progress) -> RefinedTurn:
    try:
        return RefinedTurn(task, refine_turn(task, progress), None)
    except RefinementFailure as error:
        return RefinedTurn(task, (), str(error))
    except (ArithmeticError, ValueError) as error:
        return RefinedTurn(task, (), f"the arithmetic broke down ({type(error).__name__}: {error})")


def refine_turn(task: OrbitTask, progress: Progress) -> tuple[Candidate, ...]:
    """The orbit at an extremum and one on each side, singled out by the coordinate that changes most along the family.

    Raises `RefinementFailure`.
    """
    near = float(task.provenance["stability_parameter"])
    equation = refine_orbit(replace(task, digits=15)).equation
    assert equation is not None
    place = equation.value
    for number, step in enumerate(_STEPS):
        progress(f"parabola {number + 1}", number / 3)
        low, middle, high = (_stability_at(task, equation, place + side * step, near) for side in (-1, 0, 1))
        bend = high - 2 * middle + low
        if not bend:
            raise RefinementFailure("the stability parameter does not turn near the guess")
        shift = Fraction(float((low - high) / (2 * bend))) * step
        if abs(shift) > _FARTHEST:
            raise RefinementFailure("the stability parameter does not turn near the guess")
        place = round_dyadic(place + shift, 64)
    progress("orbits", 2 / 3)
    return tuple(
        refine_orbit(replace(_at(task, equation, place + side * _APART), id=f"{task.id}-{word}"))
        for side, word in zip((-1, 0, 1), SIDES, strict=True)
    )


def _at(task: OrbitTask, equation: Equation, value: Fraction) -> OrbitTask:
    return replace(task, equation=Equation(COORDINATE, value, equation.coordinate))


def _stability_at(task: OrbitTask, equation: Equation, value: Fraction, near: float) -> Any:
    """The stability parameter next to a number, of the orbit with a value of the coordinate."""
    orbit = refine_orbit(_at(task, equation, value))
    context = working_context(int((task.digits + 10) * 3.33))
    try:
        regularisation = shorter_coordinates(task.system, task.parameters, task.guess, task.crossings)
        half = half_return(task.system, task.parameters, orbit.centre, context, regularisation, task.crossings)
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None
    values = stability_parameters(half.derivative, context)
    return min((context.re(entry) for entry in values), key=lambda entry: abs(float(entry) - near))


def stability_parameters(derivative: Any, context: mpmath.MPContext) -> list[Any]:
    """From DP at a point of a symmetric orbit, (u, q) coordinates: the eigenvalues of 2 A' A - 1 but the one that is 1.

    A and A' are the blocks of DP and of its inverse along Fix(R).
    """
    size = (derivative.rows + 1) // 2
    there, back = derivative[:size, :size], context.inverse(derivative)[:size, :size]
    values = list(context.eig(2 * back * there - context.eye(size), right=False))
    values.remove(min(values, key=lambda entry: abs(entry - 1)))
    return values
