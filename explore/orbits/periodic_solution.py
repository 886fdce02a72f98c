"""A symmetric periodic orbit as a function of time, in double precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.shared.systems import ReversibleSystem

TOLERANCE = 1e-13
"""Relative and absolute, of a step in time."""


@dataclass(frozen=True)
class PeriodicSolution:
    """The solution through a point of Fix(R) that meets Fix(R) again after half a period.

    Half of it is integrated, the other half is its image under R.

    Attributes:
        parameters: all parameters of the vector field, in its order.
        point: shape (m,), the state at time 0, on Fix(R).
        period: in the system's time units.
    """

    system: ReversibleSystem
    parameters: Sequence[float]
    point: Vector
    period: float

    def states(self, times: ArrayLike) -> Matrix:
        """The states at N times of any sign, shape (N, m). Raises `ValueError` for times that are not finite."""
        instants = np.atleast_1d(np.asarray(times, dtype=float))
        if instants.ndim != 1 or not np.all(np.isfinite(instants)):
            raise ValueError("times: give a list of finite numbers")
        half = self.period / 2
        phase = np.mod(instants, self.period)
        mirrored = phase > half
        signs = np.array(self.system.reversing_symmetry, dtype=float)
        found = np.asarray(self._half(np.where(mirrored, self.period - phase, phase)).T, dtype=float)
        return np.where(mirrored[:, None], found * signs, found)

    @property
    def defect(self) -> float:
        """How far the state after half a period is from Fix(R): the largest coordinate that vanishes there."""
        end = self.states(self.period / 2)[0]
        return float(np.abs(end[np.array(self.system.reversing_symmetry) == -1]).max())

    @cached_property
    def _half(self) -> Any:
        def field(time: float, state: Vector) -> Sequence[float]:
            return self.system.vector_field(state.tolist(), self.parameters)

        solution = solve_ivp(
            field, (0.0, self.period / 2), self.point, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE,
            dense_output=True,
        )  # fmt: skip
        return solution.sol
