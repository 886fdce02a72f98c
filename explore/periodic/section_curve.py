"""The curve of a periodic orbit in the coordinates of a section, by its equations in float64."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import ALONG
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.flow import Arc, Matrix, Vector, arc_of
from orbitproof.explore.periodic.section import AffineSection


@dataclass(frozen=True)
class CurvePoint:
    """An orbit on the curve.

    Attributes:
        place: shape (1 + n,), the coordinates of the atlas.
        period: in the system's time.
        tangent: shape (1 + n,), along the curve, of length 1 in units of the scales.
        error: length of the last Newton step, in the same units.
    """

    place: Vector
    period: float
    tangent: Vector
    error: float


class NewtonCurve:
    """A curve by its equations: `scales` of its coordinates, and `linearised`, what is zero on it, with derivatives."""

    scales: Vector

    def linearised(self, place: Vector, period: float) -> tuple[Vector, Matrix]:
        """What is zero on the curve, and its derivatives by coordinates in units of their scales and log T."""
        raise NotImplementedError

    def tangent(self, place: Vector, period: float) -> Vector:
        """Along the curve, in units of the scales."""
        along = np.linalg.svd(self.linearised(place, period)[1])[2][-1][:-1]
        return np.asarray(along / np.linalg.norm(along))

    def solved(self, guess: Vector, period: float, along: Vector, origin: Vector, length: float) -> CurvePoint:
        """The orbit at which along . (place - origin)/scales is `length`. Raises `PeriodicFailure`."""
        place, time, last = guess.copy(), period, np.inf
        try:
            for _ in range(ALONG.steps):
                residual, matrix = self.linearised(place, time)
                here = along @ ((place - origin) / self.scales) - length
                rows = np.vstack([matrix, np.append(along, 0.0)])
                step = -np.linalg.lstsq(rows, np.append(residual, here), rcond=None)[0]
                size = float(np.max(np.abs(step)))
                if not size < 1.0:
                    break
                place, time = place + step[:-1] * self.scales, time * float(np.exp(step[-1]))
                if ALONG.judge(size, last)[0]:
                    tangent = np.linalg.svd(matrix)[2][-1][:-1]
                    tangent = tangent / np.linalg.norm(tangent)
                    return CurvePoint(place, time, tangent if tangent @ along >= 0 else -tangent, size)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")


@dataclass(frozen=True)
class SectionCurve(NewtonCurve):
    """The equations of a curve: phi_T(x) = x on a section, on a level if there is one.

    Attributes:
        place: of the parameter that varies, among all; `None` for the level of the first integral.
        scales: shape (1 + n,), in which lengths are measured.
        level: of the first integral, where another parameter varies.
    """

    problem: PeriodicProblem
    section: AffineSection
    place: int | None
    scales: Vector
    level: float | None

    @property
    def others(self) -> list[int]:
        """Indices of the state coordinates that are coordinates of the section."""
        return [i for i in range(len(self.section.normal)) if i != self.section.pivot]

    def state(self, place: Vector) -> tuple[Vector, Vector]:
        """The state and all parameters at coordinates of the atlas."""
        values = self.problem.values
        own = place
        if self.place is not None:
            values[self.place], own = place[0], place[1:]
        normal = np.array(list(map(float, self.section.normal)))
        x = np.zeros(len(normal))
        x[self.others] = own
        x[self.section.pivot] = (float(self.section.offset) - normal @ x) / normal[self.section.pivot]
        return x, values

    def arc(self, place: Vector, period: float) -> tuple[Arc, Vector, Vector]:
        """The orbit over its period. Raises `FlowFailure`."""
        x, values = self.state(place)
        return arc_of(self.problem.system, x, period, values), x, values

    def linearised(self, place: Vector, period: float) -> tuple[Vector, Matrix]:
        """What is zero on the curve, and its derivatives by coordinates in units of their scales and log T."""
        arc, x, values = self.arc(place, period)
        frame = np.array([[float(value) for value in row] for row in self.section.frame()])
        columns = [(arc.by_state - np.eye(len(x))) @ frame]
        if self.place is not None:
            columns.insert(0, arc.by_parameters[:, [self.place]])
        columns.append(arc.velocity[:, None] * period)
        matrix, residual = np.hstack(columns), arc.end - x
        if self.level is not None:
            by_state, by_values = self.problem.level_slopes(x, values)
            assert self.place is not None
            row = np.concatenate([[by_values[self.place]], by_state @ frame, [0.0]])
            matrix = np.vstack([matrix, row])
            residual = np.append(residual, (self.problem.level(x, values) or 0.0) - self.level)
        return residual, matrix * np.append(self.scales, 1.0)
