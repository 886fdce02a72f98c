"""Bifurcating branches: from a bifurcation point onto the new orbits, and along them to both sides.

A new orbit of a 1:k resonance starts on Fix(R) near the point and is on Fix(R) again at the k-th crossing of the
section (k = 1 for symmetry breaking). Near the point its starting points form a curve, the *branch*, along which
the amplitude p_1 of the claim's frame grows or falls; the two signs are its two sides. For even k they
belong to the same orbits, each of which starts once on either side; for k = 1 the symmetry exchanges them;
for odd k >= 3 they are different orbits. Where R is lost, R exchanges them (`loops`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.branches.file import Birth, BranchOrbit, BranchRecord, BranchSide, Outcome
from orbitproof.explore.branches.loops import loop_tracer
from orbitproof.explore.branches.start import BranchPoint, NoBranch
from orbitproof.explore.branches.switching import FIRST_AMPLITUDE, BranchTracer, branch_tracer, switch
from orbitproof.explore.flow import FlowFailure, Vector
from orbitproof.explore.numerics import NoStep, predict, walked
from orbitproof.explore.orbits import CorrectionFailure, SegmentedOrbit

TURNING = 0.15
"""Largest angle between the tangents at both ends of a step."""

SMALLEST_STEP = 1e-9


@dataclass(frozen=True)
class Branch:
    """A branch that was followed, or why there is none.

    Attributes:
        start: the bifurcation point.
        second_point: where the resonant orbit is on Fix(R) half a period after `start.point`.
        birth: how the branch begins; `None` if no new orbit was found.
        failure: why not, or "".
        sides: negative and positive p_1; empty if no new orbit was found.
    """

    start: BranchPoint
    second_point: Vector
    birth: Birth | None
    failure: str
    sides: tuple[BranchSide, ...]

    def record(self, verdict: str | None, certified_side: str | None) -> BranchRecord:
        """What is written about it; verdict and side are those of a certificate, if there is one."""
        start = self.start
        return BranchRecord(
            id=start.id,
            system=start.system,
            parameters=start.parameters,
            kind=start.kind,
            k=start.k,
            symmetry=start.symmetry,
            verdict=verdict,
            certified_side=certified_side,
            point=start.point,
            second_point=self.second_point,
            half_period=start.half_period,
            level=float(start.level),
            scale=start.scale,
            birth=self.birth,
            failure=self.failure,
            sides=self.sides,
        )


def follow(
    start: BranchPoint,
    *,
    length: float = 0.05,
    orbits: int = 40,
    progress: Callable[[float], None] | None = None,
) -> Branch:
    """Switch onto the branch at a bifurcation point and follow it to both sides.

    Arguments:
        length: arclength to follow on each side; lengths as in `BranchPoint.scale`.
        orbits: the largest number of orbits on each side.
        progress: called with the fraction done.

    Raises `NoBranch` if not even the resonant orbit can be integrated.
    """
    report = progress if progress is not None else (lambda _fraction: None)
    tracer, second_point = loop_tracer(start) if start.loses_reversor else branch_tracer(start)
    try:
        tracer, birth, first = switch(tracer, min(FIRST_AMPLITUDE, length))
    except NoBranch as failure:
        return Branch(start, second_point, None, str(failure), ())
    report(0.2)
    sides: list[BranchSide] = []
    for number, sign in enumerate((-1, 1)):
        seeds = [first[sign * part] for part in (0.5, 1.0)]

        def done(fraction: float, number: int = number) -> None:
            report(0.2 + 0.4 * (number + fraction))

        side = BranchSide((), "interrupted", "interrupted")
        if not sides or sides[0].outcome != "interrupted":
            side = _side(tracer, seeds, sign, length, orbits, done)
        sides.append(side)
    return Branch(start, second_point, birth, "", tuple(sides))


def _side(
    tracer: BranchTracer,
    seeds: list[SegmentedOrbit],
    sign: int,
    length: float,
    limit: int,
    progress: Callable[[float], None],
) -> BranchSide:
    problem, scale, size = tracer.problem, tracer.scale, tracer.problem.point_size
    found: list[BranchOrbit] = []
    vectors: list[Vector] = []
    tangents: list[Vector] = []

    def ended(outcome: Outcome, reason: str) -> BranchSide:
        return BranchSide(tuple(found), outcome, reason)

    def distance(left: Vector, right: Vector) -> float:
        return float(np.linalg.norm((left - right)[:size] / scale))

    def accept(orbit: SegmentedOrbit, tangent: Vector) -> None:
        before = vectors[-1] if vectors else tracer.origin
        travelled = (abs(found[-1].arclength) if found else 0.0) + distance(orbit.unknowns, before)
        found.append(tracer.branch_orbit(orbit, sign * travelled))
        vectors.append(orbit.unknowns)
        tangents.append(tangent)
        progress(min(1.0, max(travelled / length, len(found) / limit)))

    try:
        for seed in seeds:
            accept(seed, problem.tangent(seed.evaluation, scale, sign * tracer.tangent))
        apart = tracer.separations(seeds[-1])
        longest = 1.5 * length / limit

        def advance(step: float) -> tuple[tuple[SegmentedOrbit, Vector], float]:
            step = min(step, length - abs(found[-1].arclength))
            return _advance(tracer, vectors[-3:], tangents[-3:], step), min(longest, 1.5 * step)

        failures = CorrectionFailure, FlowFailure, ZeroDivisionError
        steps = walked(advance, min(abs(found[-1].arclength), longest), SMALLEST_STEP, failures)
        while len(found) < limit:
            if abs(found[-1].arclength) >= length * (1 - 1e-9):
                return ended("length", f"followed over the arclength {length:g}")
            orbit, tangent = next(steps)
            here = tracer.separations(orbit)
            if np.min(np.sum(here * apart, axis=1)) <= 0:
                return ended("meets family", "the branch meets orbits of smaller period, or of more symmetry, again")
            accept(orbit, tangent)
            apart = here
    except NoStep as error:
        return ended("failed", f"{error} (after the arclength {abs(found[-1].arclength):.3g})")
    except CorrectionFailure as error:
        return ended("failed", str(error))
    except KeyboardInterrupt:
        return ended("interrupted", "interrupted")
    return ended("orbits", f"{limit} orbits")


def _advance(
    tracer: BranchTracer, vectors: list[Vector], tangents: list[Vector], step: float
) -> tuple[SegmentedOrbit, Vector]:
    """The next orbit after the last of `vectors`, with its tangent. Raises `CorrectionFailure`."""
    problem, size = tracer.problem, tracer.problem.point_size
    units = np.ones(problem.size)
    units[:size] = tracer.scale
    # Distances are those of the starting points: the direction has no other part.
    direction = np.zeros(problem.size)
    direction[:size] = (tangents[-1] / units)[:size]
    places = [vector / units for vector in reversed(vectors)]
    prediction = predict(places, [tangent / units for tangent in reversed(tangents)], direction, step) * units
    orbit = problem.correct(prediction, direction[:size] / tracer.scale, tracer.resolved * step)
    tangent = problem.tangent(orbit.evaluation, tracer.scale, tangents[-1])
    old, new = ((vector / units)[:size] for vector in (tangents[-1], tangent))
    moved = float(np.linalg.norm(((orbit.unknowns - vectors[-1]) / units)[:size]))
    if float(np.arccos(min(1.0, float(old @ new)))) > TURNING or moved > 1.5 * step:
        raise CorrectionFailure("the branch turns too sharply")
    if not problem.crosses_once(orbit.unknowns):
        raise CorrectionFailure("the orbit becomes tangent to the section")
    return orbit, tangent
