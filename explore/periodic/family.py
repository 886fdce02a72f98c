"""The equations of a family of periodic orbits: in a parameter, or over the levels of a first integral, in float64.

The unknowns are the point, the period and the parameter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import ALONG
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem, multipliers
from orbitproof.explore.periodic.flow import Matrix, Vector, arc_of
from orbitproof.explore.periodic.symmetries import Symmetry, keeps_volume


@dataclass(frozen=True)
class FamilyMember:
    """One orbit of a family: the orbit, the value of the parameter or level, and the tangent of the family there."""

    orbit: ClosedOrbit
    value: float
    tangent: Vector


@dataclass(frozen=True)
class FamilyEquations:
    """The equations of a family.

    Attributes:
        name: of the parameter; `None` for the level of the first integral.
        scale: shape of the unknowns (N, 1 and, with a parameter, 1 more), in which steps are measured.
        level: of the first integral, if a parameter varies on it; exact.
        symmetries: of the vector field, that orbits may have.
        symmetry, parts: of its orbits, if only such are meant: S phi_(T/parts)(x) = x is solved, which is regular
            where other orbits branch off.
    """

    problem: PeriodicProblem
    name: str | None
    scale: Vector
    level: Fraction | None
    symmetries: tuple[Symmetry, ...]
    symmetry: Symmetry | None = None
    parts: int = 1

    @property
    def place(self) -> int | None:
        """Number of the parameter among all; `None` if the level varies."""
        return None if self.name is None else list(self.problem.system.parameters).index(self.name)

    @cached_property
    def conservative(self) -> bool:
        """Whether multipliers are taken to come in pairs mu, 1/mu: with an integral, or without divergence in R^3."""
        system = self.problem.system
        return system.first_integral_program is not None or (
            len(system.given_state) == 3 and keeps_volume(self.problem)
        )

    def values(self, z: Vector) -> Vector:
        """All parameters at the unknowns z."""
        values = self.problem.values
        if self.place is not None:
            values[self.place] = z[-1]
        return values

    def equations(self, z: Vector, phase: tuple[Vector, Vector]) -> tuple[Vector, Matrix, ClosedOrbit]:
        """What is zero on the family, its derivatives by z / scale, and the orbit, for what it is worth."""
        normal, origin = phase
        n = len(normal)
        x, time, values = z[:n], float(z[n]), self.values(z)
        arc = arc_of(self.problem.system, x, time, values)
        part = arc if self.parts == 1 else arc_of(self.problem.system, x, time / self.parts, values)
        image = np.eye(n) if self.symmetry is None else self.symmetry.matrix
        columns = [image @ part.by_state - np.eye(n), image @ part.velocity[:, None] / self.parts]
        if self.place is not None:
            columns.append(image @ part.by_parameters[:, [self.place]])
        rows = [np.hstack(columns), np.append(normal, np.zeros(len(z) - n))[None]]
        residual = [image @ part.end - x, [normal @ (x - origin)]]
        if self.level is not None:
            by_state, by_values = self.problem.level_slopes(x, values)
            assert self.place is not None
            rows.append(np.concatenate([by_state, [0.0], [by_values[self.place]]])[None])
            residual.append([(self.problem.level(x, values) or 0.0) - float(self.level)])
        found = multipliers(self.problem, x, arc, values)
        orbit = ClosedOrbit(x, time, values, arc, self.problem.level(x, values), found, 0.0)
        size = np.concatenate([self.scale[:n] ** -1, [1.0] * (len(np.concatenate(residual)) - n)])
        return size * np.concatenate(residual), size[:, None] * np.vstack(rows) * self.scale, orbit

    def phase(self, orbit: ClosedOrbit) -> tuple[Vector, Vector]:
        """The plane across the flow at the orbit's point."""
        velocity = orbit.arc.velocity
        return velocity / (np.linalg.norm(velocity) * self.scale[0]), orbit.point

    def member(self, z: Vector, orbit: ClosedOrbit, matrix: Matrix, along: Vector | None) -> FamilyMember:
        """With the tangent in the direction of `along`."""
        tangent = np.linalg.svd(matrix)[2][-1]
        if along is not None and tangent @ along < 0:
            tangent = -tangent
        value = float(z[-1]) if self.place is not None else float(orbit.level or 0.0)
        return FamilyMember(orbit, value, tangent)

    def member_of(self, orbit: ClosedOrbit) -> FamilyMember:
        """A periodic orbit as a member."""
        z = np.append(orbit.point, orbit.period)
        z = z if self.place is None else np.append(z, orbit.values[self.place])
        _, matrix, again = self.equations(z, self.phase(orbit))
        return self.member(z, again, matrix, None)

    def rate(self, member: FamilyMember) -> float:
        """The derivative of the parameter or level along the family, in the length of its steps."""
        if self.place is not None:
            return float(member.tangent[-1])
        slopes, _ = self.problem.level_slopes(member.orbit.point, member.orbit.values)
        n = len(slopes)
        return float(slopes @ (member.tangent * self.scale)[:n])

    def corrected(self, before: FamilyMember, length: float, least: float | None = None) -> FamilyMember:
        """The orbit so far along the family.

        Arguments:
            least: singular values below this part of the largest count as 0, as where families cross: there rounding
                would be magnified. `None`: below the precision of numbers.

        Raises `PeriodicFailure`.
        """
        start = self.unknowns(before)
        phase, predicted = self.phase(before.orbit), start + length * before.tangent * self.scale
        z, last = predicted.copy(), np.inf
        try:
            for _ in range(ALONG.steps):
                residual, matrix, orbit = self.equations(z, phase)
                here = before.tangent @ ((z - predicted) / self.scale)
                bordered = np.vstack([matrix, before.tangent])
                step = -np.linalg.lstsq(bordered, np.append(residual, here), rcond=least)[0]
                z = z + step * self.scale
                size = float(np.max(np.abs(step)))
                if not np.isfinite(size) or size > 10 * abs(length) + 1e-3 or not z[len(phase[0])] > 0:
                    break
                if ALONG.judge(size, last)[0]:
                    # The tangent lies in the plane across the flow at the new point, from where the next step goes on.
                    residual, matrix, orbit = self.equations(z, self.phase(orbit))
                    return self.member(z, replace(orbit, error=size), matrix, before.tangent)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")

    def unknowns(self, member: FamilyMember) -> Vector:
        """z of an orbit."""
        z = np.append(member.orbit.point, member.orbit.period)
        return z if self.place is None else np.append(z, member.orbit.values[self.place])
