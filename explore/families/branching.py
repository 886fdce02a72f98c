"""Branches: families that leave a family of orbits in Fix(S) where its symmetry S breaks.

At a symmetry breaking the S-odd block of D_p pi_q P is singular, and its kernel, a direction in the
S-odd coordinates of Fix(R), is tangent to the branch. S maps the branch to itself and exchanges its sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from orbitproof.explore.families.continuation import Family, Stop, crossings
from orbitproof.explore.families.detection import LocatedResonance
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import Correction, CorrectionFailure, ShootingProblem, SymmetricOrbit

Sign = Literal[1, -1]

SAME_ORBIT = 1e-6
"""Distance in scaled unknowns below which two located orbits are the same one."""


def branch_seed(problem: ShootingProblem, breaking: LocatedResonance, sign: Sign) -> Family:
    """The branch at a symmetry breaking, not traced yet: its first orbit and its tangent there.

    Arguments:
        problem: of the family in Fix(S).
        sign: of the S-odd coordinate of Fix(R) on the branch.
    """
    outer = replace(problem, symmetry=None)
    assert breaking.symmetry is not None
    tangent = np.zeros(outer.size)
    tangent[list(outer.odd_unknowns(breaking.symmetry))] = sign
    tangent /= np.linalg.norm(tangent)
    return Family(outer, (replace(breaking.orbit, arclength=0.0),), (tangent,), "limit", "started")


def doubling_seed(problem: ShootingProblem, resonance: LocatedResonance) -> Family:
    """The branch of doubled period at a 1:2 resonance, not traced yet: its first orbit and its tangent there.

    Over two half returns the shooting equations have two solution curves through the resonant orbit, so that their
    derivative has a kernel of dimension two. The tangent of the branch is the direction in it in which the first
    integral does not change: the orbits on both sides of the branch are the same, half a period apart, and the side
    is that on which the first coordinate becomes smaller. Raises `CorrectionFailure` for a system without first
    integral and where the kernel is not found.
    """
    orbit, system = resonance.orbit, problem.system
    doubled = np.append(orbit.centre(resonance.side), 2 * orbit.half_period)
    if system.family_parameter is not None:
        raise CorrectionFailure("a doubled family needs a first integral")
    try:
        _, jacobian, flow = problem.evaluate(doubled)
    except FlowFailure as error:
        raise CorrectionFailure(str(error)) from None
    _, _, rows = np.linalg.svd(jacobian * problem.scales)
    kernel = rows[-2:]
    slopes = [_integral_slope(problem, doubled, row) for row in kernel]
    tangent = kernel[0] * slopes[1] - kernel[1] * slopes[0]
    tangent /= -np.copysign(np.linalg.norm(tangent), tangent[0])
    first = problem.orbit(Correction(doubled, jacobian, flow, 0), 0.0, crossings(problem, problem.samples(doubled)))
    return Family(problem, (first,), (tangent,), "limit", "started")


def _integral_slope(problem: ShootingProblem, unknowns: Vector, direction: Vector) -> float:
    """Derivative of the first integral along a direction in scaled unknowns, by central differences."""
    assert problem.system.first_integral is not None
    step = 1e-6 * direction * problem.scales
    values = problem.parameter_values(unknowns)
    ends = [problem.system.first_integral(problem.initial_state(unknowns + sign * step), values)[0] for sign in (1, -1)]
    return float(ends[0] - ends[1]) / 2e-6


def after_breakings(problem: ShootingProblem, count: int, stop: Stop) -> Stop:
    """Stops a family in Fix(S) after `count` sign changes of its S-odd block, or where `stop` does."""
    last, left = 0.0, count

    def stop_after(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        nonlocal last, left
        value = problem.symmetry_breaking_function(orbit)
        left -= value * last < 0
        last = value
        return "the symmetry breaks" if left <= 0 else stop(orbit, states)

    return stop_after


def breaking_at_end(branch: Family, breakings: Sequence[LocatedResonance]) -> int | None:
    """Which of the symmetry breakings of its parent family a branch returns to at its end; counted from 0."""
    if len(branch.orbits) < 2:
        return None
    scales, end = branch.problem.scales, branch.orbits[-1]
    for index, breaking in enumerate(breakings):
        orbit = breaking.orbit
        for point in (orbit.centre("first"), orbit.centre("second")):
            ends = (end.centre("first") - point, orbit.half_period - end.half_period)
            if float(np.linalg.norm(np.append(*ends) / scales)) < SAME_ORBIT:
                return index
    return None
