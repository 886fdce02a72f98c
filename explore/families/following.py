"""Following a family up to limits: from its start, or from where it was left off, to one side or to both."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.families.continuation import (
    RETURNED,
    Course,
    Family,
    Start,
    Stop,
    describe,
    extend,
    in_fixed_space,
    trace,
)
from orbitproof.explore.families.detection import symmetry_breaking_near
from orbitproof.explore.families.failures import FamilyFailure
from orbitproof.explore.families.limits import Limits
from orbitproof.explore.families.step_control import CONTROL, StepControl
from orbitproof.explore.flow import FlowFailure, Matrix
from orbitproof.explore.numerics import bracketed_zero
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.shared.systems import ReversibleSystem


@dataclass(frozen=True)
class Following:
    """How the families of a system are followed, and how far.

    Attributes:
        parameters: exact fixed parameters of the system.
        progress: told of the way to the limits, if given.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    limits: Limits
    control: StepControl = CONTROL
    progress: Progress | None = None

    def problem(self, scale: tuple[float, ...], symmetry: str | None) -> ShootingProblem:
        """What the orbits of a family solve, its unknowns in units of `scale`."""
        return ShootingProblem(self.system, self.parameters, symmetry, scale, self.control.tolerance)

    def course(self, problem: ShootingProblem, bounds: Limits, orbits: tuple[SymmetricOrbit, ...] = ()) -> Course:
        """Up to `bounds` after `orbits`, with progress towards the limits asked for."""
        report = _report(problem, self.limits, self.progress, len(orbits))
        return Course(stop_at(problem, bounds, orbits), self.control, bounds.max_orbits, report)

    def grown(self, problem: ShootingProblem, start: Start) -> Family:
        """The family from its start up to the limits."""
        return _with_symmetric_end(trace(problem, start, self.course(problem, self.limits)))


def continue_family(
    family: Family, limits: Limits, *, control: StepControl = CONTROL, progress: Progress | None = None
) -> Family:
    """Continue a traced family, for example one read from a file, up to further limits."""
    problem = replace(family.problem, tolerance=control.tolerance)
    last = family.orbits[-1]
    try:
        states = problem.samples(last.unknowns)
    except FlowFailure as error:
        raise FamilyFailure(f"the last orbit cannot be integrated: {error}") from None
    reached = limits.reached(problem, last, states)
    if reached is not None and len(family.orbits) == 1:
        return replace(family, reason=f"{reached}, which its first orbit has passed ({describe(problem, last)})")
    if family.outcome == "closed" or family.retraces or reached is not None:
        return family
    if len(family.orbits) > 1 and in_fixed_space(problem, last):
        return family
    course = Following(problem.system, problem.parameters, limits, control, progress).course(
        problem, limits, family.orbits
    )
    more = extend(replace(family, problem=problem), course)
    return _with_symmetric_end(more)


def continue_both_ways(
    seed: Family, limits: Limits, *, control: StepControl = CONTROL, progress: Progress | None = None
) -> Family:
    """Continue a family backwards from its first orbit and then forwards from its last, up to `limits`.

    Backwards at most half of the orbits that the limits allow. Raises `FamilyFailure`.
    """
    half = replace(limits, max_orbits=max(len(seed.orbits) + 1, (limits.max_orbits + len(seed.orbits)) // 2))
    backwards = continue_family(seed.turned(), half, control=control, progress=progress)
    family = backwards.turned()
    if backwards.outcome in ("closed", "interrupted"):
        return replace(family, outcome=backwards.outcome, reason=backwards.reason, beginning=None)
    return continue_family(family, limits, control=control, progress=progress)


def _report(
    problem: ShootingProblem, limits: Limits, progress: Progress | None, done: int = 0
) -> Callable[[SymmetricOrbit], None] | None:
    if progress is None:
        return None
    count = done

    def report(orbit: SymmetricOrbit) -> None:
        nonlocal count
        count += 1
        progress(f"tracing, {count} orbits", limits.fraction(problem, orbit, count))

    return report


def stop_at(problem: ShootingProblem, limits: Limits, orbits: tuple[SymmetricOrbit, ...]) -> Stop:
    """Stops at the limits and where an S-odd coordinate of a family outside Fix(S) changes sign."""
    odd = {name: problem.odd_unknowns(name) for name in problem.system.symmetries} if problem.symmetry is None else {}
    previous = [orbits[-1].unknowns] if len(orbits) > 1 else []

    def stop(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        last, previous[:] = list(previous), [orbit.unknowns]
        for indices in odd.values():
            if last and len(indices) == 1 and last[0][indices[0]] * orbit.unknowns[indices[0]] <= 0:
                return RETURNED
        return limits.reached(problem, orbit, states)

    return stop


def _with_symmetric_end(family: Family) -> Family:
    """A family that has just crossed Fix(S), ended exactly at the symmetry breaking there."""
    if not family.returned:
        return family
    problem, before, beyond = family.problem, family.orbits[-2], family.orbits[-1]
    name, (index,) = next(
        (name, odd) for name in problem.system.symmetries if len(odd := problem.odd_unknowns(name)) == 1
    )
    ends = (before.arclength, beyond.arclength)
    heights = (float(before.unknowns[index]), float(beyond.unknowns[index]))

    def height(arclength: float) -> float:
        return float(family.orbit_at(arclength).unknowns[index])

    try:
        place = bracketed_zero(height, ends, heights, 1e-6 * (ends[1] - ends[0]))
        end = symmetry_breaking_near(problem, name, family.orbit_at(place).unknowns, 2.0)
    except (CorrectionFailure, ZeroDivisionError) as error:
        reason = f"{family.reason}; the symmetry breaking there is not located: {error}"
        return replace(family, orbits=family.orbits[:-1], tangents=family.tangents[:-1], reason=reason)
    length = float(np.linalg.norm((end.unknowns - before.unknowns) / problem.scales))
    end = replace(end, arclength=before.arclength + length)
    tangent = np.zeros(problem.size)
    tangent[index] = np.sign(beyond.unknowns[index] - before.unknowns[index])
    return replace(
        family,
        orbits=(*family.orbits[:-1], end),
        tangents=(*family.tangents[:-1], tangent),
        reason=f"{RETURNED} ({describe(problem, end)})",
    )
