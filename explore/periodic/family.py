"""The equations of a family of periodic orbits: in a parameter, or over the levels of a first integral, in float64.

The unknowns are the first states of all segments, the first of them the point, the period and the parameter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import ALONG
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem, closed_orbit
from orbitproof.explore.periodic.flow import Matrix, Vector
from orbitproof.explore.periodic.segments import nodes_of, segments_for, shot
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
        scale: shape of the unknowns (N for each segment, 1 and, with a parameter, 1 more), in which steps are measured.
        level: of the first integral, if a parameter varies on it; exact.
        symmetries: of the vector field, that orbits may have.
        symmetry, parts: of its orbits, if only such are meant: S phi_(T/parts)(x) = x is solved, which is regular
            where other orbits branch off.
        segments: in how many orbits are shot; several only if all orbits are meant.
    """

    problem: PeriodicProblem
    name: str | None
    scale: Vector
    level: Fraction | None
    symmetries: tuple[Symmetry, ...]
    symmetry: Symmetry | None = None
    parts: int = 1
    segments: int = 1

    @property
    def place(self) -> int | None:
        """Number of the parameter among all; `None` if the level varies."""
        return None if self.name is None else list(self.problem.system.parameters).index(self.name)

    @property
    def size(self) -> float:
        """Size of the orbit by which steps are measured: many states that move make no step longer than one does."""
        return float(self.scale[0]) / self.segments**0.5

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
        m, n = self.segments, len(normal)
        nodes, time, values = z[: m * n].reshape(m, n), float(z[m * n]), self.values(z)
        whole = shot(self.problem.system, nodes, time, values)
        image = None if self.symmetry is None else self.symmetry.matrix
        part = whole
        if image is not None or self.parts > 1:
            part = shot(self.problem.system, nodes, time / self.parts, values, image)
        columns = [part.by_nodes, part.by_time[:, None] / self.parts]
        if self.place is not None:
            columns.append(part.by_parameters[:, [self.place]])
        rows = [np.hstack(columns), np.append(normal, np.zeros(len(z) - n))[None]]
        x = nodes[0]
        residual = [part.gaps, [normal @ (x - origin)]]
        if self.level is not None:
            by_state, by_values = self.problem.level_slopes(x, values)
            assert self.place is not None
            rows.append(np.concatenate([by_state, np.zeros(len(z) - n - 1), [by_values[self.place]]])[None])
            residual.append([(self.problem.level(x, values) or 0.0) - float(self.level)])
        orbit = closed_orbit(self.problem, nodes, time, values, whole, 0.0)
        size = np.concatenate([self.scale[: m * n] ** -1, [1.0] * (len(np.concatenate(residual)) - m * n)])
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
        _, matrix, again = self.equations(z := self.unknowns(orbit), self.phase(orbit))
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
        start = self.unknowns(before.orbit)
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
                if not np.isfinite(size) or size > 10 * abs(length) + 1e-3 or not z[self.segments * len(phase[0])] > 0:
                    break
                if ALONG.judge(size, last)[0]:
                    # The tangent lies in the plane across the flow at the new point, from where the next step goes on.
                    residual, matrix, orbit = self.equations(z, self.phase(orbit))
                    return self.member(z, replace(orbit, error=size), matrix, before.tangent)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")

    def unknowns(self, orbit: ClosedOrbit) -> Vector:
        """z of an orbit; where it was shot in another number of segments, about."""
        nodes = orbit.point if self.segments == 1 else orbit.nodes
        if nodes is None or orbit.segments != self.segments != 1:
            nodes = nodes_of(orbit.loop, self.segments)
        z = np.append(nodes, orbit.period)
        return z if self.place is None else np.append(z, orbit.values[self.place])

    def segments_for(self, orbit: ClosedOrbit) -> int:
        """In how many segments an orbit is to be shot."""
        return segments_for(self.problem.system, orbit.loop, orbit.period, orbit.values)

    def in_segments(self, member: FamilyMember) -> tuple[FamilyEquations, FamilyMember] | None:
        """The equations in as many segments as errors along an orbit ask for, and that orbit; `None` if in no more.

        Symmetries of orbits are not looked for then. Raises `PeriodicFailure`.
        """
        orbit, n, old = member.orbit, len(member.orbit.point), self.segments
        number = self.segments_for(orbit)
        if number <= old:
            return None
        scale = np.append(np.full(number * n, self.size * number**0.5), self.scale[old * n :])
        finer = replace(self, segments=number, scale=scale, symmetries=())
        try:
            there = finer.corrected(finer.member_of(orbit), 0.0)
        except FlowFailure as failure:
            raise PeriodicFailure(str(failure)) from None
        shared = [*range(n), *range(-len(self.scale) + old * n, 0)]
        ahead = (there.tangent * finer.scale)[shared] / self.scale[shared] @ member.tangent[shared] > 0
        return finer, there if ahead else replace(there, tangent=-there.tangent)
