"""Motion of a spacecraft among point masses, relative to one of them, with derivatives in its initial state.

With r_j the place of body j relative to the origin, which is the body c,

    r'' = -GM_c r / |r|^3 + sum_j GM_j ((r_j - r) / |r_j - r|^3 - r_j / |r_j|^3):

what the others do to the spacecraft, less what they do to the origin. The bodies move as the kernels say.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.three_body.ephemeris_model.kernels import Bodies

TOLERANCE = 1e-12


@dataclass(frozen=True)
class PointMasses:
    """The equations of motion.

    Attributes:
        bodies: what attracts.
        origin: index of the body at the origin.
        start: TDB seconds past J2000, of time 0.
        length, time: units in which errors of the integration are measured, km and s.
    """

    bodies: Bodies
    origin: int
    start: float
    length: float
    time: float

    def leg(self, state: Vector, begin: float, end: float) -> tuple[Any, Vector, Matrix]:
        """From one time to another, s: the places in between as a function of time, the last state, and its derivative.

        States are in km and km/s. Raises `FlowFailure`.
        """
        # Only now: scipy takes a moment to load.
        from scipy.integrate import solve_ivp

        sizes = np.array([self.length] * 3 + [self.length / self.time] * 3)
        extended = np.concatenate([state / sizes, np.eye(6).ravel()])
        solution = solve_ivp(
            lambda t, y: self._rates(t, y, sizes), (begin / self.time, end / self.time), extended, method="DOP853",
            rtol=TOLERANCE, atol=TOLERANCE, dense_output=True,
        )  # fmt: skip
        if not solution.success or not np.all(np.isfinite(solution.y[:, -1])):
            raise FlowFailure("the orbit could not be integrated (near a body)")
        dense = solution.sol

        def states_at(times: Vector) -> Matrix:
            return np.asarray(dense(times / self.time)[:6].T) * sizes

        last = solution.y[:, -1]
        return states_at, last[:6] * sizes, last[6:].reshape(6, 6) * np.outer(sizes, 1 / sizes)

    def _rates(self, turns: float, extended: Vector, sizes: Vector) -> Vector:
        """In units of length and time."""
        pull, gradient = self._gravity(turns * self.time, extended[:3] * self.length)
        transition = extended[6:].reshape(6, 6)
        result = np.empty_like(extended)
        result[:3] = extended[3:6]
        result[3:6] = pull * (self.time**2 / self.length)
        rates = np.vstack([transition[3:], gradient @ transition[:3] * self.time**2])
        result[6:] = rates.ravel()
        return result

    def _gravity(self, seconds: float, place: Vector) -> tuple[Vector, Matrix]:
        """Acceleration at a place relative to the origin, km/s^2, and its derivative in the place."""
        pull, gradient = np.zeros(3), np.zeros((3, 3))
        for index, gravity in enumerate(self.bodies.gravity):
            where = np.zeros(3)
            if index != self.origin:
                where = np.asarray(self.bodies.place(index, self.origin, self.start + seconds))
                pull -= gravity * where / (where @ where) ** 1.5
            gap = where - place
            square = gap @ gap
            cube = square**1.5
            pull += gravity * gap / cube
            gradient += gravity / cube * (3 * np.outer(gap, gap) / square - np.eye(3))
        return pull, gradient
