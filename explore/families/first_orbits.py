"""A family from an approximate symmetric orbit: the corrected first orbit and its tangent."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.families.continuation import Family, crossings
from orbitproof.explore.families.following import FamilyFailure
from orbitproof.explore.families.step_control import StepControl
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import Correction, CorrectionFailure, ShootingProblem, fallen
from orbitproof.explore.seeds import FirstOrbit
from orbitproof.shared.systems import ReversibleSystem

LONGEST_TIME = 1e4
MOST_CROSSINGS = 12
"""So many crossings of the section are looked at for the half period."""

_AT_START = 1e-6
_NEAR = 0.2
"""An orbit with the value of the parameter that was given may lie so far from the guess, relative to its size."""

_RESTING = 1e-9
"""So little, relative to the size of a state, an equilibrium moves in double precision."""

_REPEATS = 1e-7
"""So near Fix(R), relative to its size, a part of the half period leads an orbit that goes round more often in it."""

_MOST_TIMES = 12

_CLOSE = 0.05
"""Distance from Fix(R), relative to the size of the orbit, at which a crossing is taken for its other point there."""


def first_family(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    first: FirstOrbit,
    control: StepControl,
    held: tuple[str, float] | None = None,
) -> Family:
    """The family of one orbit that starts from `first`, in Fix(S) if that lies there.

    With `held` the orbit with this value of one of `centre_coordinates`. Raises `FamilyFailure`, also for an orbit in
    Fix(S) that is found from a start outside.
    """
    problem = ShootingProblem(system, dict(parameters), tolerance=control.tolerance)
    half_period = first.half_period
    try:
        if half_period is None:
            half_period = _half_period(problem, first.point)
        unknowns = np.array([*first.point, half_period])
        given = None if first.direction is None else np.array([*first.direction, 0.0])
        if held is not None:
            index = system.centre_coordinates.index(held[0])
            given, unknowns[index] = np.eye(problem.size)[index], held[1]
        direction, start = given, unknowns[:-1].tolist()
        for name in system.symmetries:
            odd = list(problem.odd_unknowns(name))
            along = direction is None or not np.any(direction[odd])
            if problem.symmetry is None and odd and not np.any(unknowns[odd]) and along:
                problem = ShootingProblem(system, problem.parameters, name, tolerance=control.tolerance)
        correction, direction = _corrected(problem, unknowns, direction)
        times = _repetitions(problem, correction.unknowns)
        if times > 1:
            unknowns = np.append(correction.unknowns[:-1], correction.unknowns[-1] / times)
            correction, direction = _corrected(problem, unknowns, given)
        if (why := fallen(system, parameters, start, correction.unknowns[:-1].tolist())) is not None:
            remedy = "keep that coordinate (explore orbit --at), or give a closer start"
            raise FamilyFailure(f"no first orbit: {why} and so another one; {remedy}")
        tangent = problem.tangent(correction.jacobian, direction)
        states = problem.samples(correction.unknowns)
        if _rests(states):
            raise FamilyFailure(_equilibrium(problem, correction.unknowns))
        orbit = problem.orbit(correction, crossings=crossings(problem, states))
    except (CorrectionFailure, FlowFailure, ZeroDivisionError) as error:
        start = np.array([*first.point, 1.0])
        if _field_vanishes(problem, start):
            raise FamilyFailure(_equilibrium(problem, start)) from None
        raise FamilyFailure(f"no first orbit: {error}; give a point closer to one, and its half period") from None
    return Family(problem, (orbit,), (tangent,), "limit", "started")


def _repetitions(problem: ShootingProblem, unknowns: Vector) -> int:
    """How often the orbit goes round in its period: its half period is so many times that of the orbit."""
    number = crossings(problem, problem.samples(unknowns))
    size = 1.0 + float(np.abs(unknowns[:-1]).max())
    # It crosses equally often each time round; few times are tried even where the samples miss a crossing.
    for times in (each for each in range(number, 1, -1) if number % each == 0 or each <= _MOST_TIMES):
        residual = problem.evaluate(np.append(unknowns[:-1], unknowns[-1] / times))[0]
        if float(np.max(np.abs(residual))) < _REPEATS * size:
            return times
    return 1


def _corrected(problem: ShootingProblem, unknowns: Vector, direction: Vector | None) -> tuple[Correction, Vector]:
    """The orbit near the guess, and a direction along the family: with the value of the family parameter that was given
    if there is one, and otherwise the shortest way to the family.
    """
    if direction is not None:
        return problem.correct(unknowns, direction), direction
    direction = problem.tangent(problem.evaluate(unknowns)[1], np.ones(problem.size))
    if problem.system.family_parameter is not None:
        with suppress(CorrectionFailure):
            correction = problem.correct(unknowns, np.eye(problem.size)[0])
            if float(np.linalg.norm(correction.unknowns - unknowns)) <= _NEAR * (1 + float(np.linalg.norm(unknowns))):
                exact = correction.unknowns.copy()
                exact[0] = unknowns[0]
                return replace(correction, unknowns=exact), direction
    return problem.correct(unknowns, direction), direction


def _rests(states: Matrix) -> bool:
    """Whether what the samples of an orbit move by is the error of their integration."""
    return bool(np.max(np.abs(states - states[0])) <= _RESTING * (1 + np.max(np.abs(states[0]))))


def _field_vanishes(problem: ShootingProblem, unknowns: Vector) -> bool:
    state = problem.initial_state(unknowns).tolist()
    try:
        speed = np.abs(problem.system.vector_field(state, problem.parameter_values(unknowns).tolist()))
    except (ArithmeticError, ValueError, TypeError):
        return False
    return bool(np.max(speed) <= _RESTING * (1 + np.max(np.abs(state))))


def _equilibrium(problem: ShootingProblem, unknowns: Vector) -> str:
    place = zip(problem.system.centre_coordinates, unknowns[:-1], strict=True)
    there = ", ".join(f"{name} = {value:.8g}" for name, value in place)
    born = problem.system.family_parameter is None
    remedy = "--start equilibrium finds the families of small orbits about it" if born else "give a point away from it"
    return f"no first orbit: {there} is an equilibrium, not an orbit; {remedy}"


def _half_period(problem: ShootingProblem, point: tuple[float, ...]) -> float:
    """The time of the first crossing of the section close to Fix(R), or of the closest of the first ones."""
    # Only now: scipy takes a moment to load.
    from scipy.integrate import solve_ivp

    system, unknowns = problem.system, np.array([*point, 1.0])
    values = problem.parameter_values(unknowns).tolist()
    section, kernel = system.section_index, list(system.kernel_coordinates)

    def field(time: float, state: Vector) -> list[float]:
        return [float(value) for value in system.vector_field(state.tolist(), values)]

    def height(time: float, state: Vector) -> float:
        return float(state[section])

    height.terminal = MOST_CROSSINGS + 1  # type: ignore[attr-defined]
    initial = problem.initial_state(unknowns)
    try:
        solution = solve_ivp(
            field, (0.0, LONGEST_TIME), initial, method="DOP853", rtol=1e-9, atol=1e-9, events=height, max_step=1.0
        )
    except (ArithmeticError, ValueError, TypeError):
        raise FlowFailure("the orbit of the point cannot be followed") from None
    found = [
        (float(time), float(np.linalg.norm(state[kernel])))
        for time, state in zip(solution.t_events[0], solution.y_events[0], strict=True)
        if time > _AT_START
    ]
    if not found:
        raise FlowFailure("the orbit of the point does not come back to the section")
    size = float(np.max(np.abs(solution.y - initial[:, None])))
    close = (time for time, distance in found if distance <= _CLOSE * size)
    return next(close, min(found, key=lambda pair: pair[1])[0])
