"""A periodic orbit as a function of time, with what is known about its stability."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.names import Contradiction, NoOrbit
from orbitproof.explore.orbits import (
    REMEDY,
    Correction,
    CorrectionFailure,
    Numbers,
    PeriodicSolution,
    ShootingProblem,
    SymmetricOrbit,
    contradictions,
    fallen,
    multipliers,
    stability_index,
)
from orbitproof.explore.three_body.families import branch_at
from orbitproof.explore.three_body.names import Branch
from orbitproof.explore.three_body.trajectories.source import Legs, SourceOrbit
from orbitproof.shared.systems import CR3BP, ReversibleSystem

CLOSED = 1e-6
"""Largest gap of a solution at which it counts as periodic."""

NEAR = 1e-5
"""So far, relative to its size, an orbit of a file may be from the periodic one."""

_EXACT = 1e-11
"""A gap that no correction makes smaller."""

_PLACES = 501
"""So many places of half an orbit show where it is farthest from the smaller primary."""


@dataclass(frozen=True)
class Trajectory:
    """A periodic orbit, or a homoclinic one and back; nondimensional units, in double precision.

    Attributes:
        source: what it was made from.
        solution: its states at any time, 0 at the first point.
        parameters: all parameters of the vector field, by name.
        stability: its stability parameters, or `None`: not known.
        moved: by how much what the file says was corrected, or 0.
    """

    source: SourceOrbit
    solution: PeriodicSolution
    parameters: dict[str, float]
    stability: tuple[complex, ...] | None
    moved: float = 0.0

    @property
    def period(self) -> float:
        """In the system's time units; of a homoclinic orbit the time from its start to its end."""
        return self.solution.period

    @property
    def start(self) -> Vector:
        """Shape (m,), the state at time 0."""
        return self.solution.starts[0]

    @property
    def defect(self) -> float:
        """The largest gap of the solution."""
        return self.solution.defect

    def states(self, times: ArrayLike) -> Matrix:
        """The states at N times, shape (N, m), in the order of `system.state`."""
        return self.solution.states(times)

    @cached_property
    def orbit(self) -> SymmetricOrbit:
        """The orbit with the derivative of its half return. Raises `NoOrbit` for what is not symmetric."""
        source = self.source
        if source.unknowns is None or not isinstance(source.system, ReversibleSystem):
            raise NoOrbit(f"{source.title}: R does not map this orbit to itself")
        return _orbit(ShootingProblem(source.system, source.parameters), source)

    @property
    def crossings(self) -> int:
        """How often half the orbit meets the section after its start, as far as 2000 states show it. Raises `NoOrbit`
        for an orbit that is not symmetric.
        """
        system = self.source.system
        if self.source.unknowns is None or not isinstance(system, ReversibleSystem):
            raise NoOrbit(f"{self.source.title}: R does not map this orbit to itself")
        heights = self.states(np.linspace(0.0, self.period / 2, 2001)[1:-1])[:, system.section_index]
        return 1 + int(np.count_nonzero(heights[1:] * heights[:-1] < 0))

    @property
    def first_integral(self) -> float | None:
        """The value of the first integral on the orbit; `None` for a system without one."""
        values = self._levels(self.start[None, :])
        return None if values is None else float(values[0])

    @property
    def multipliers(self) -> tuple[complex, ...] | None:
        """The eigenvalues of the return map's derivative, without the trivial pair."""
        return None if self.stability is None else multipliers(self.stability)

    @property
    def stability_index(self) -> float | None:
        """(|lambda| + 1/|lambda|)/2 of the largest multiplier."""
        return None if self.stability is None else stability_index(self.stability)

    @property
    def drift(self) -> float | None:
        """Largest change of the first integral along a period; `None` for a system without one."""
        values = self._levels(self.states(np.linspace(0.0, self.period, 201)))
        return None if values is None else float(np.abs(values - values[0]).max())

    def _levels(self, states: Matrix) -> Vector | None:
        integral = self.source.system.first_integral
        if integral is None:
            return None
        values = [integral(state, list(self.parameters.values()))[0] for state in states.tolist()]
        return np.array(values, dtype=float)


def trajectory_of(source: SourceOrbit) -> Trajectory:
    """The orbit of a file as a function of time.

    What nearly closes, as numbers of a few digits do, is corrected, and it is said by how much. Raises `NoOrbit` if
    what the file says is no periodic orbit, or one of which something else is so, unless the source accepts that.
    """
    given = source
    moved, legs, stability, error = 0.0, source.legs, source.stability, inf
    parameters = {name: float(value) for name, value in source.parameters.items()}
    if source.unknowns is not None and isinstance(source.system, ReversibleSystem):
        problem = ShootingProblem(source.system, source.parameters)
        if legs is None:
            source, moved = _corrected(problem, source)
            assert source.unknowns is not None
            start = problem.initial_state(source.unknowns)
            legs = Legs(start[None, :], source.unknowns[-1:], True)
        values = problem.parameter_values(source.unknowns)
        parameters = dict(zip(source.system.parameters, values.tolist(), strict=True))
        if stability is None:
            orbit = _orbit(problem, source)
            assert orbit.derivative is not None
            stability, error = orbit.stability, orbit.derivative.error
    assert legs is not None
    ordered = {name: parameters[name] for name in source.system.parameters}
    solution = PeriodicSolution(source.system, list(ordered.values()), legs.starts, legs.durations, legs.mirrored)
    try:
        gap = solution.defect
    except (ArithmeticError, ValueError) as failure:
        raise NoOrbit(f"{source.title}: {failure}") from None
    if not gap < CLOSED * (1 + float(np.abs(legs.starts).max())):
        what = "away from Fix(R) after half a period" if legs.mirrored else "between its end and its start"
        if source.distance is not None:
            raise NoOrbit(f"{source.title}: no homoclinic orbit: {gap:.1e} away from Fix(R)")
        raise NoOrbit(f"{source.title}: no periodic orbit: {gap:.1e} {what}")
    found = Trajectory(source, solution, ordered, stability, moved)
    if not source.accept:
        _check(given, found, error)
    side = _side(found)
    return found if side is None else replace(found, source=replace(source, title=f"{source.title}, {side}ern"))


def _side(found: Trajectory) -> Branch | None:
    """On which side of the plane the orbit is far from the smaller primary, if it is symmetric under R."""
    if found.source.system is not CR3BP or found.source.unknowns is None:
        return None
    return branch_at(found.states(np.linspace(0.0, found.period / 2, _PLACES)), found.parameters["mu"])


def _check(source: SourceOrbit, found: Trajectory, error: float) -> None:
    """Whether the orbit, its stability known up to an error, is as the file says. Raises `NoOrbit`."""
    said, start = source.said, found.start
    if source.unknowns is not None and isinstance(source.system, ReversibleSystem):
        start = ShootingProblem(source.system, source.parameters).initial_state(source.unknowns)
    lines = contradictions(
        source.system,
        list(found.parameters.values()),
        Numbers(start, said.period, said.level, said.stability_index),
        Numbers(found.start, found.period, found.first_integral, found.stability_index, error),
    )
    if lines:
        raise Contradiction(f"{source.title}: another orbit was found: {'; '.join(lines)}; {REMEDY}")


def _orbit(problem: ShootingProblem, source: SourceOrbit) -> SymmetricOrbit:
    assert source.unknowns is not None
    try:
        _, jacobian, flow = problem.evaluate(source.unknowns)
        return problem.orbit(Correction(source.unknowns, jacobian, flow, 0))
    except (FlowFailure, ZeroDivisionError) as failure:
        raise NoOrbit(f"{source.title}: {failure}") from None


def _corrected(problem: ShootingProblem, source: SourceOrbit) -> tuple[SourceOrbit, float]:
    """The source with the periodic orbit next to what it says, if one is that near, and how far that is."""
    assert source.unknowns is not None
    unknowns = source.unknowns
    try:
        residual, jacobian, _ = problem.evaluate(unknowns)
        if np.abs(residual).max() < _EXACT:
            return source, 0.0
        found = problem.correct(unknowns, problem.tangent(jacobian, np.ones(problem.size))).unknowns
    except (CorrectionFailure, FlowFailure, ZeroDivisionError):
        return source, 0.0
    moved = float(np.abs(found - unknowns).max())
    if not moved <= NEAR * (1 + float(np.abs(unknowns).max())):
        return source, 0.0
    if fallen(problem.system, problem.parameters, unknowns[:-1].tolist(), found[:-1].tolist()) is not None:
        return source, 0.0
    return replace(source, unknowns=found), moved
