"""Branches: families that leave a family of orbits in Fix(S) where its symmetry S breaks.

At a symmetry breaking the S-odd block of D_p pi_q P is singular, and its kernel, a direction in the
S-odd coordinates of Fix(R), is tangent to the branch. S maps the branch to itself and exchanges its sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from orbitproof.explore.families.continuation import Family, Stop
from orbitproof.explore.families.detection import LocatedResonance
from orbitproof.explore.flow import Matrix
from orbitproof.explore.orbits import ShootingProblem, SymmetricOrbit

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
