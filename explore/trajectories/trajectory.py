"""The states of a symmetric periodic orbit over time, with what is known about its stability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import (
    Correction,
    PeriodicSolution,
    ShootingProblem,
    SymmetricOrbit,
    multipliers,
    stability_index,
)
from orbitproof.explore.trajectories.source import NoOrbit, SourceOrbit

CLOSED = 1e-6
"""Largest distance from Fix(R) after half a period at which a solution counts as periodic."""


@dataclass(frozen=True)
class Trajectory:
    """An orbit at N times, nondimensional units, in double precision.

    Attributes:
        source: what it was made from.
        orbit: the same with its stability.
        times: shape (N,), 0 at the point on Fix(R).
        states: shape (N, m), in the order of `system.state`.
        defect: how far the state after half a period is from Fix(R).
    """

    source: SourceOrbit
    orbit: SymmetricOrbit
    times: Vector
    states: Matrix
    defect: float

    @property
    def multipliers(self) -> tuple[complex, ...]:
        """The eigenvalues of the return map's derivative, without the trivial pair."""
        return multipliers(self.orbit.stability)

    @property
    def stability_index(self) -> float:
        """(|lambda| + 1/|lambda|)/2 of the largest multiplier."""
        return stability_index(self.orbit.stability)

    @property
    def drift(self) -> float | None:
        """Largest change of the first integral along the states; `None` for a system without one."""
        system = self.source.system
        if system.first_integral is None:
            return None
        parameters = [float(self.source.parameters[name]) for name in system.parameters]
        values = np.asarray(system.first_integral(self.states.T, parameters)[0])
        return float(np.abs(values - values[0]).max())


def trajectory_of(source: SourceOrbit, count: int, periods: float) -> Trajectory:
    """`count` states at equal intervals over `periods` periods, both ends included.

    Raises `NoOrbit` if what the file says is no periodic orbit.
    """
    problem = ShootingProblem(source.system, source.parameters)
    try:
        _, jacobian, flow = problem.evaluate(source.unknowns)
        orbit = problem.orbit(Correction(source.unknowns, jacobian, flow, 0))
    except (FlowFailure, ZeroDivisionError) as failure:
        raise NoOrbit(f"{source.title}: {failure}") from None
    solution = PeriodicSolution(
        source.system,
        problem.parameter_values(source.unknowns).tolist(),
        problem.initial_state(source.unknowns),
        orbit.period,
    )
    if not solution.defect < CLOSED:
        raise NoOrbit(f"{source.title}: no periodic orbit: {solution.defect:.1e} away from Fix(R) after half a period")
    times = np.linspace(0.0, periods * orbit.period, count)
    return Trajectory(source, orbit, times, solution.states(times), solution.defect)
