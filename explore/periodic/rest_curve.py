"""The curve of an equilibrium in a parameter, by its equations in float64, as `SectionCurve` has those of an orbit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import AT_REST
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.equilibria import field_slopes
from orbitproof.explore.periodic.flow import Matrix, Vector, velocity_at
from orbitproof.explore.periodic.section_curve import CurvePoint, NewtonCurve


@dataclass(frozen=True)
class RestCurve(NewtonCurve):
    """The equations of a curve: f(x, a) = 0; the coordinates are a and those of the state. Periods are not used.

    Attributes:
        place: of the parameter that varies, among all.
        scales: shape (1 + N,), in which lengths are measured.
    """

    problem: PeriodicProblem
    place: int
    scales: Vector

    def state(self, place: Vector) -> tuple[Vector, Vector]:
        """The state and all parameters at coordinates of the atlas."""
        values = self.problem.values
        values[self.place] = place[0]
        return place[1:], values

    def linearised(self, place: Vector, _period: float = 0.0) -> tuple[Vector, Matrix]:
        """What is zero on the curve, and its derivatives by coordinates in units of their scales."""
        x, values = self.state(place)
        slopes, n = field_slopes(self.problem.system, x, values), len(x)
        matrix = np.column_stack([slopes[:, n + self.place], slopes[:, :n]])
        return velocity_at(self.problem.system, x, values), matrix * self.scales

    def tangent(self, place: Vector, _period: float) -> Vector:
        """Along the curve, in units of the scales."""
        return np.asarray(np.linalg.svd(self.linearised(place)[1])[2][-1])

    def solved(self, guess: Vector, period: float, along: Vector, origin: Vector, length: float) -> CurvePoint:
        """The equilibrium at which along . (place - origin)/scales is `length`. Raises `PeriodicFailure`."""
        place, last = guess.copy(), np.inf
        try:
            for _ in range(AT_REST.steps):
                residual, matrix = self.linearised(place)
                here = along @ ((place - origin) / self.scales) - length
                step = -np.linalg.lstsq(np.vstack([matrix, along]), np.append(residual, here), rcond=None)[0]
                size = float(np.max(np.abs(step)))
                if not size < 1.0:
                    break
                place = place + step * self.scales
                if AT_REST.judge(size, last)[0]:
                    tangent = np.linalg.svd(matrix)[2][-1]
                    return CurvePoint(place, period, tangent if tangent @ along >= 0 else -tangent, size)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")
