"""Switching onto orbits that R does not map to themselves, where it is lost along a family of symmetric ones.

They start in the section beside Fix(R), along the kernel w of B = D_q P_p; the amplitude is the part of the start along
w in the coordinates that R negates, which is 0 on the family. The other side has the mirror images.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import cast

import numpy as np

from orbitproof.explore.branches.file import BranchOrbit
from orbitproof.explore.branches.start import BranchPoint, NoBranch
from orbitproof.explore.branches.switching import BranchTracer, inner_tangent
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.orbits import LoopShooting, MultipleShooting, SegmentedOrbit


@dataclass(frozen=True)
class LoopTracer(BranchTracer):
    """`BranchTracer` for orbits without the symmetry R."""

    @property
    def loop(self) -> LoopShooting:
        """The equations."""
        return cast(LoopShooting, self.problem)

    @property
    def scale(self) -> Vector:
        """Units of arclength."""
        return np.maximum(1.0, np.abs(self.origin[: self.problem.point_size]))

    @property
    def amplitude_form(self) -> Vector:
        """The row of w: the tangent has no other part."""
        return self.tangent[: self.problem.point_size]

    def level_difference(self, point: Vector) -> tuple[float, float]:
        """Level at a point of the section minus that of the bifurcation, and its rounding."""
        return self.start.level_difference_in_section(point)

    def separations(self, orbit: SegmentedOrbit) -> Matrix:
        """The coordinates of the start that R negates: an orbit that meets Fix(R) there is symmetric."""
        return self.loop.states(orbit.unknowns)[:1, list(self.start.system.kernel_coordinates)]

    def branch_orbit(self, orbit: SegmentedOrbit, arclength: float) -> BranchOrbit:
        """What is recorded of an orbit."""
        loop, unknowns = self.loop, orbit.unknowns
        difference, _ = self.level_difference(unknowns[: loop.point_size])
        return BranchOrbit(
            arclength=arclength,
            point=loop.on_fixed_set(orbit, 0),
            second_point=loop.end(orbit),
            crossings=loop.states(unknowns),
            times=loop.times(unknowns),
            half_period=float(loop.times(unknowns).sum()) / 2,
            level=float(self.start.level) + difference,
            level_difference=difference,
            stability=loop.stability(orbit),
        )


def loop_tracer(start: BranchPoint) -> tuple[LoopTracer, Vector]:
    """What following the new orbits needs, and the symmetric orbit's other point on Fix(R).

    Raises `NoBranch` if that orbit cannot be integrated.
    """
    system, m = start.system, len(start.times)
    half, loop = MultipleShooting(system, start.parameters, 1), LoopShooting(system, start.parameters, 2 * m)
    first, values = half.initial_state(start.point), half.parameter_values(start.point)
    signs = np.array(system.reversing_symmetry, dtype=float)
    try:
        ends = [flow_of(system).derivative(first, time, values).state for time in accumulate(start.times)]
        # The second half is the first one under R.
        states = np.array([*ends[:-1], np.where(signs == 1, ends[-1], 0.0), *(signs * end for end in ends[-2::-1])])
        times = np.array([*start.times, *reversed(start.times)])
        own = list(loop.section_coordinates)
        origin = loop.assemble(np.concatenate([start.point[: loop.lead], first[own]]), states, times)
        evaluation = loop.evaluate(origin)
    except FlowFailure as error:
        raise NoBranch(f"the symmetric orbit: {error}") from None
    # The kernel is a plane: the family's direction, in which the start stays on Fix(R), and that of the new orbits.
    norms = np.maximum(np.linalg.norm(evaluation.jacobian, axis=0), 1e-300)
    plane = np.linalg.svd(evaluation.jacobian / norms)[2][-2:] / norms
    negated = [loop.lead + own.index(i) for i in system.kernel_coordinates]
    w = np.linalg.svd(plane[:, negated])[2][0]
    direction = np.zeros(loop.point_size)
    direction[negated] = w * np.sign(w[np.argmax(np.abs(w))])
    tangent = np.concatenate([direction, inner_tangent(evaluation.jacobian, direction)])
    tracer = LoopTracer(start, loop, origin, tangent, float(np.abs(evaluation.residual).max()))
    fixed = states[m - 1][list(system.fixed_coordinates)]
    return tracer, np.concatenate([start.point[: loop.lead], fixed])
