"""Newton refinement of one symmetric orbit, singled out by an equation, up to the box for the verifier."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, isfinite, log2
from operator import attrgetter
from typing import Any, Literal

import mpmath
import numpy as np

from orbitproof.explore.engines import Job, Lost, Progress, run_all
from orbitproof.explore.numerics import (
    GrowingDigits,
    Linearised,
    Solution,
    bits_of,
    mpf,
    newton_with_digits,
    working_context,
)
from orbitproof.explore.orbits import fallen
from orbitproof.explore.refinement.crossing import level_jet, section_crossings, shorter_coordinates
from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import section_jets, start_jets
from orbitproof.explore.refinement.jets import JetBasis
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, ORBIT, Candidate, Equation
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import Regularisation, ReversibleSystem

_RULE = GrowingDigits(RefinementFailure, farthest=1e-2, guard_bits=24)
_BOX_DIGITS = 5
"""The box is so many digits wider than the centre is asked to be accurate."""


@dataclass(frozen=True)
class OrbitTask:
    """One orbit to refine; the fields are those of a candidate.

    Attributes:
        equation: `None` for the coordinate that changes most along the family, at its value in the guess.
        guess: float64 point, in the order of `ReversibleSystem.centre_coordinates`.
        digits: decimal digits of the centre.
        crossings: of the section in a half orbit, m; P^m stands for P.
        kind: what is claimed, one of `shared.formats.ORBIT_KINDS`.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    equation: Equation | None
    guess: tuple[float, ...]
    digits: int
    provenance: Mapping[str, Any]
    crossings: int = 1
    kind: Literal["orbit", "stable_orbit", "invariant_tori"] = ORBIT


@dataclass(frozen=True)
class RefinedOrbit:
    """The result of a task: a candidate, or a reason."""

    task: OrbitTask
    candidate: Candidate | None
    failure: str | None


def refine_orbit_task(task: OrbitTask, progress: Progress) -> RefinedOrbit:
    """Refine one orbit; a failure is a result, not an exception."""
    try:
        return RefinedOrbit(task, refine_orbit(task, progress), None)
    except RefinementFailure as error:
        return RefinedOrbit(task, None, str(error))
    except (ArithmeticError, ValueError) as error:
        return RefinedOrbit(task, None, f"the arithmetic broke down ({type(error).__name__}: {error})")


def refine_orbits(tasks: Sequence[OrbitTask], jobs: int, progress: Progress) -> Iterator[tuple[int, RefinedOrbit]]:
    """Refine all orbits with `jobs` processes; yields (index, result) in the order of completion."""
    for index, result in run_all(Job(refine_orbit_task, attrgetter("id")), tasks, jobs, progress):
        yield index, RefinedOrbit(tasks[index], None, result.reason) if isinstance(result, Lost) else result


def refine_orbit(task: OrbitTask, progress: Progress | None = None) -> Candidate:
    """The orbit to many digits, with the box in which it is to be proved.

    Raises `RefinementFailure`, one line, if Newton's method does not converge near the guess.
    """
    report = progress or (lambda _message, _fraction: None)
    if not all(map(isfinite, task.guess)):
        raise RefinementFailure("the guess is not finite")
    try:
        regularisation = shorter_coordinates(task.system, task.parameters, task.guess, task.crossings)
        if task.equation is None:
            task = replace(task, equation=_along_family(task, regularisation))
        return _refined(task, regularisation, report)
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise RefinementFailure(str(failure)) from None


def _refined(task: OrbitTask, regularisation: Regularisation | None, report: Progress) -> Candidate:
    found = newton_with_digits(
        lambda point, context: _linearised(task, point, context, regularisation),
        [Fraction(value) for value in task.guess],
        bits_of(task.digits),
        _RULE,
        report,
        residual=lambda point, context: _linearised(task, point, context, regularisation, degree=0).residual,
    )
    why = fallen(task.system, task.parameters, task.guess, [float(value) for value in found.unknowns])
    if why is not None:
        raise RefinementFailure(why)
    return _candidate(task, found)


def _along_family(task: OrbitTask, regularisation: Regularisation | None) -> Equation:
    """The coordinate with the largest component in the tangent of the family, at its value in the guess."""
    names = task.system.centre_coordinates
    about = replace(task, equation=Equation(COORDINATE, Fraction(0), names[0]))
    point = [Fraction(value) for value in task.guess]
    matrix = _linearised(about, point, working_context(_RULE.first_bits), regularisation).matrix
    rows = np.array([[float(matrix[i, j]) for j in range(len(names))] for i in range(len(names) - 1)])
    tangent = np.linalg.svd(rows)[2][-1]
    index = int(np.argmax(np.abs(tangent)))
    return Equation(COORDINATE, Fraction(repr(float(task.guess[index]))), names[index])


def _linearised(
    task: OrbitTask,
    point: Sequence[Fraction],
    context: mpmath.MPContext,
    regularisation: Regularisation | None,
    degree: int = 1,
) -> Linearised:
    """q o P and quantity - value at a point; the spread is the largest derivative of P. Of degree 0: these alone."""
    system = task.system
    n = len(system.kernel_coordinates)
    size = 1 + n
    basis = JetBasis.graded((1,) * size, degree)
    directions = [[int(i == j) for i in range(1 + 2 * n)] for j in range(size)]
    values = [mpf(u, context) for u in point]
    start, parameter = start_jets(system, values, directions, basis)
    crossing = next(
        section_crossings(
            system, task.parameters, start, parameter, context, regularisation=regularisation, every=task.crossings
        )
    )
    image = section_jets(system, crossing, parameter)
    equation = task.equation
    assert equation is not None
    if equation.quantity == HALF_PERIOD:
        quantity = crossing.duration
    elif equation.quantity == COORDINATE:
        index = system.centre_coordinates.index(str(equation.coordinate))
        quantity = basis.constant(values[index])
        if degree:
            quantity.coefficients[basis.variable(index)] = context.mpf(1)
    else:
        quantity = level_jet(system, task.parameters, start, parameter, context)
    functions = [*image[size:], quantity - mpf(equation.value, context)]
    values = context.matrix([jet.coefficients[0] for jet in functions])
    if not degree:
        return Linearised(values, None, 1.0)
    slopes = [[jet.coefficients[basis.variable(j)] for j in range(size)] for jet in functions]
    spread = max(float(abs(jet.coefficients[basis.variable(j)])) for jet in image for j in range(size))
    return Linearised(values, context.matrix(slopes), spread)


def _candidate(task: OrbitTask, found: Solution) -> Candidate:
    size, bits = len(found.unknowns), found.bits
    equation = task.equation
    assert equation is not None
    exponent = ceil((task.digits - _BOX_DIGITS) * log2(10) + log2(max(1.0, found.last.spread)))
    centre = [round_dyadic(value, bits) for value in found.unknowns]
    if equation.quantity == COORDINATE:
        centre[task.system.centre_coordinates.index(str(equation.coordinate))] = round_dyadic(equation.value, bits)
    return Candidate(
        id=task.id,
        system=task.system,
        parameters=dict(task.parameters),
        kind=task.kind,
        k=1,
        centre=tuple(centre),
        frame=_unit(size),
        kernel_frame=_unit(size - 1),
        radii=(Fraction(1, 2**exponent),) * size,
        crossings=task.crossings,
        equation=equation,
        provenance={"digits": task.digits, "newton_steps": found.steps, **task.provenance},
    )


def _unit(size: int) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(Fraction(int(i == j)) for j in range(size)) for i in range(size))
