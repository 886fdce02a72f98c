"""The map of a section that belongs to a periodic orbit, of many points side by side: for drawing only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853

from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.shared.formats import PeriodicBifurcation, PeriodicOrbit

_ON_SECTION = 1e-12
_STEPS = 5_000
_SUBSTEPS = 4
_MOST_CORRECTIONS = 8
_FARTHEST = 0.2
"""How far from the section points may be at the end, relative to the time."""


@dataclass(frozen=True)
class ReturnMap:
    """From points of a claim's section that are near an orbit to the crossing that is near a time.

    Attributes:
        claim: with the section and the frame of its coordinates p.
        values: the parameters in the vector field's order.
        time: of the return; negative for the inverse map.
        tolerance: of the steps.
    """

    claim: PeriodicBifurcation | PeriodicOrbit
    values: Sequence[float]
    time: float
    tolerance: float = 1e-12

    def coordinates(self, states: Array) -> Array:
        """p of states of the section, shape (M, N) to (M, N - 1)."""
        return np.asarray(np.linalg.lstsq(self._frame, (states - self._centre).T, rcond=None)[0].T)

    def states(self, points: Array) -> Array:
        """The states with coordinates p, shape (M, N - 1) to (M, N)."""
        return np.asarray(self._centre + points @ self._frame.T)

    def images(self, states: Array, varied: Array | None = None) -> Array:
        """Where M states of the section come to, shape (M, N).

        Arguments:
            varied: shape (M,), for each of them the value of the parameter that the claim varies.

        Raises `OrbitNotClosed`.
        """
        count = len(states)
        values: list[Array | float] = list(self.values)
        if varied is not None:
            values[list(self.claim.system.parameters).index(str(self.claim.parameter))] = varied

        def field(x: Array) -> Array:
            components = self.claim.system.program.evaluate([*x, *values])
            return np.array([np.broadcast_to(each, (count,)) for each in components], dtype=float)

        def flat(_time: float, rows: Array) -> Array:
            return np.asarray(self.time * field(rows.reshape(-1, count)).ravel())

        with np.errstate(all="ignore"):
            try:
                solver = DOP853(flat, 0.0, states.T.ravel(), 1.0, rtol=self.tolerance, atol=self.tolerance)
                for _ in range(_STEPS):
                    solver.step()
                    if solver.status != "running":
                        break
                ends = solver.y.reshape(-1, count)
                if solver.status == "finished" and np.all(np.isfinite(ends)):
                    return self._onto_section(field, ends).T
            except (ArithmeticError, ValueError):
                pass
        raise OrbitNotClosed("orbits near it cannot be followed in double precision")

    @property
    def _centre(self) -> Array:
        return np.array([float(value) for value in self.claim.centre])

    @property
    def _frame(self) -> Array:
        return np.array([[float(value) for value in row] for row in self.claim.frame])

    def _onto_section(self, field: object, states: Array) -> Array:
        """Along the flow, by Newton's method for the time, shape (N, M)."""
        assert callable(field)
        normal, offset = np.array([float(value) for value in self.claim.normal]), float(self.claim.offset)
        gone = np.zeros(states.shape[1])
        for _ in range(_MOST_CORRECTIONS):
            times = (offset - normal @ states) / (normal @ field(states))
            gone += times
            if not np.all(np.abs(gone) < _FARTHEST * abs(self.time)):
                break
            step = times / _SUBSTEPS
            for _ in range(_SUBSTEPS):
                # The classical Runge-Kutta method; the times are short and end at a rounding error.
                first = field(states)
                second = field(states + step / 2 * first)
                third = field(states + step / 2 * second)
                fourth = field(states + step * third)
                states = states + step / 6 * (first + 2 * second + 2 * third + fourth)
            if np.max(np.abs(times)) < _ON_SECTION * abs(self.time):
                return states
        raise OrbitNotClosed("orbits near it do not come back to the section in time")
