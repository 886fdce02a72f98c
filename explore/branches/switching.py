"""Switching onto the branch at a bifurcation point: the first new orbits on both sides, and how the level begins.

The multiple shooting equations are singular at the bifurcation, where family and branch cross. New orbits are
found at given amplitudes p_1, at which there is one on the branch and none on the family.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from orbitproof.explore.branches.file import Birth, BranchOrbit
from orbitproof.explore.branches.start import BranchPoint, NoBranch
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.orbits import CorrectionFailure, MultipleShooting, SegmentedOrbit

FIRST_AMPLITUDE = 1e-2
LAST_AMPLITUDE = 1e-8
AGREEMENT = 0.1
"""Relative difference of the level's coefficient at an amplitude and at half of it that is accepted."""

FARTHER = 2**0.5
"""Ratio of successive amplitudes away from the bifurcation."""

RESOLVED, BARELY_RESOLVED = 1e-3, 3e-2
"""Tolerances for `BranchTracer.resolved`; the second where nothing better is found, near a collision."""


class _SmallerPeriod(CorrectionFailure):
    """An orbit was found, but not one of the full period."""


@dataclass(frozen=True)
class BranchTracer:
    """What following one branch needs.

    Attributes:
        start: the bifurcation point.
        problem: the equations.
        origin: their solution there, the resonant orbit passed k/2 times.
        tangent: tangent of the branch there.
        defect: largest residual of the equations at `origin`.
        resolved: largest Newton step at an orbit, relative to its distance from the bifurcation or from the one before.
    """

    start: BranchPoint
    problem: MultipleShooting
    origin: Vector
    tangent: Vector
    defect: float
    resolved: float = RESOLVED

    @property
    def scale(self) -> Vector:
        """Units of arclength."""
        return self.start.scale

    @property
    def amplitude_form(self) -> Vector:
        """The row that takes a difference of points to the amplitude."""
        return self.start.amplitude_form

    def level_difference(self, point: Vector) -> tuple[float, float]:
        """Level at a point minus that of the bifurcation, and its rounding."""
        return self.start.level_difference(point)

    def at_amplitude(self, amplitude: float, known: Sequence[tuple[float, SegmentedOrbit]] = ()) -> SegmentedOrbit:
        """The new orbit with this amplitude, two others with theirs on the same side being `known` or none.

        Raises `CorrectionFailure`.
        """
        prediction = self.origin + amplitude * self.tangent
        if known:
            # (unknowns - origin - amplitude tangent) / amplitude^2, extrapolated linearly in the amplitude.
            (a, left), (b, right) = known
            sign = np.sign(amplitude)
            bent, more = (
                (orbit.unknowns - self.origin - sign * x * self.tangent) / x**2 for x, orbit in ((a, left), (b, right))
            )
            prediction += amplitude**2 * (more + (more - bent) * (abs(amplitude) - b) / (b - a))
        orbit = self.problem.correct(prediction, self.amplitude_form, self.resolved * abs(amplitude))
        moved = (orbit.unknowns - self.origin)[: self.problem.point_size]
        if np.linalg.norm(moved / self.scale) > 3 * abs(amplitude):
            raise CorrectionFailure("Newton's method finds another orbit")
        if np.min(np.linalg.norm(self.separations(orbit), axis=1)) < 1e-3 * abs(amplitude):
            raise _SmallerPeriod("Newton's method finds orbits of the family, or others of a smaller period")
        return orbit

    def separations(self, orbit: SegmentedOrbit) -> Matrix:
        """Vectors, one in each row, none of which vanishes if the orbit is new and has the full period.

        The points 2, 4, .. k crossings after the start, minus the start; for k = 1 the coordinates that S negates.
        Farther returns are images of these under R.
        """
        start, problem = self.start, self.problem
        states = np.vstack([problem.states(orbit.unknowns), orbit.evaluation.flows[-1].state])
        if start.k == 1:
            signs = start.system.symmetries[str(start.symmetry)]
            return states[:1, [i for i in start.system.fixed_coordinates if signs[i] == -1]]
        return np.asarray((states[2::2] - states[0])[:, list(problem.section_coordinates)])

    def branch_orbit(self, orbit: SegmentedOrbit, arclength: float) -> BranchOrbit:
        """What is recorded of an orbit."""
        problem, point = self.problem, orbit.unknowns[: self.problem.point_size]
        difference, _ = self.level_difference(point)
        return BranchOrbit(
            arclength=arclength,
            point=point,
            second_point=problem.end(orbit),
            crossings=problem.states(orbit.unknowns)[1:],
            times=problem.times(orbit.unknowns),
            half_period=float(problem.times(orbit.unknowns).sum()),
            level=float(self.start.level) + difference,
            level_difference=difference,
            stability=problem.stability(orbit),
        )


def branch_tracer(start: BranchPoint) -> tuple[BranchTracer, Vector]:
    """What following the branch needs, and the resonant orbit's other point on Fix(R).

    Raises `NoBranch` if the resonant orbit cannot be integrated.
    """
    problem = MultipleShooting(start.system, start.parameters, start.k)
    first, values = problem.initial_state(start.point), problem.parameter_values(start.point)
    try:
        second = flow_of(start.system).derivative(first, start.half_period, values).state
        fixed = list(start.system.fixed_coordinates)
        symmetric = np.where(np.array(start.system.reversing_symmetry) == 1, second, 0.0)
        states = np.array([symmetric if i % 2 == 0 else first for i in range(start.k - 1)]).reshape(-1, len(first))
        origin = problem.assemble(start.point, states, np.full(start.k, start.half_period))
        evaluation = problem.evaluate(origin)
    except FlowFailure as error:
        raise NoBranch(f"the resonant orbit: {error}") from None
    tangent = np.concatenate([start.direction, inner_tangent(evaluation.jacobian, start.direction)])
    lead = problem.point_size - len(start.system.fixed_coordinates)
    return (
        BranchTracer(start, problem, origin, tangent, float(np.abs(evaluation.residual).max())),
        np.concatenate([start.point[:lead], symmetric[fixed]]),
    )


def inner_tangent(jacobian: Matrix, direction: Vector) -> Vector:
    """What follows the known point part of a vector in the kernel: at the bifurcation this is a plane."""
    size = len(direction)
    rest = jacobian[:, size:]
    norms = np.maximum(np.linalg.norm(rest, axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(rest / norms, -jacobian[:, :size] @ direction, rcond=None)[0] / norms)


def switch(tracer: BranchTracer, amplitude: float) -> tuple[BranchTracer, Birth, dict[float, SegmentedOrbit]]:
    """New orbits at the amplitudes a, -a, a/2, -a/2, a the given amplitude or less, by their part of a.

    Returns the tracer with the accuracy that can be had. Raises `NoBranch` if no new orbit can be told from the
    family.
    """
    try:
        return (tracer, *_birth(tracer, amplitude))
    except NoBranch:
        barely = replace(tracer, resolved=BARELY_RESOLVED)
        return (barely, *_birth(barely, amplitude))


def _birth(tracer: BranchTracer, amplitude: float) -> tuple[Birth, dict[float, SegmentedOrbit]]:
    """The largest amplitude, halved from the given one, at which the level follows its leading power.

    Where orbits are found only so near to the bifurcation that their levels cannot be told apart, they lead to
    orbits farther away.
    """
    largest, failure, smaller = amplitude, "Newton's method does not converge", ""
    seeds: tuple[float, dict[float, SegmentedOrbit]] | None = None
    while amplitude >= LAST_AMPLITUDE:
        try:
            orbits = {part: tracer.at_amplitude(part * amplitude) for part in (0.5, -0.5, 1.0, -1.0)}
        except CorrectionFailure as error:
            failure = failure if seeds else str(error)
            smaller = smaller or (str(error) if isinstance(error, _SmallerPeriod) else "")
        else:
            birth = _birth_from(tracer, orbits, amplitude)
            if birth is not None:
                return birth, orbits
            seeds = seeds or (amplitude, orbits)
            failure = "orbits are found, but how the level changes along them is lost in their errors"
        amplitude /= 2
    found = _birth_farther(tracer, *seeds, largest) if seeds else None
    if found is not None:
        return found
    raise NoBranch(
        f"the new orbits cannot be followed in double precision: {smaller or failure} (at the bifurcation itself an "
        f"error of {tracer.defect:.1e} remains; amplitudes from {LAST_AMPLITUDE:.0e} to {largest:.0e} were tried)"
    )


def _birth_farther(
    tracer: BranchTracer, amplitude: float, seeds: dict[float, SegmentedOrbit], largest: float
) -> tuple[Birth, dict[float, SegmentedOrbit]] | None:
    """The smallest amplitude above that of the seeds at which the level follows its leading power."""
    chains = {sign: [(part * amplitude, seeds[sign * part]) for part in (0.5, 1.0)] for sign in (-1, 1)}
    while amplitude * FARTHER <= largest:
        amplitude *= FARTHER
        for sign, chain in chains.items():
            try:
                chain.append((amplitude, tracer.at_amplitude(sign * amplitude, chain[-2:])))
            except CorrectionFailure:
                return None
        # Two steps double the amplitude.
        if abs(chains[1][-3][0] / amplitude - 0.5) < 1e-6:
            orbits = {part * sign: chains[sign][place][1] for sign in (-1, 1) for part, place in ((1.0, -1), (0.5, -3))}
            birth = _birth_from(tracer, orbits, amplitude)
            if birth is not None:
                return birth, orbits
    return None


def _birth_from(tracer: BranchTracer, orbits: dict[float, SegmentedOrbit], amplitude: float) -> Birth | None:
    order, size = tracer.start.order, tracer.problem.point_size
    found, noises = {}, {}
    for part, orbit in orbits.items():
        found[part], rounding = tracer.level_difference(orbit.unknowns[:size])
        beside, _ = tracer.level_difference((orbit.unknowns - orbit.correction)[:size])
        noises[part] = rounding + abs(beside - found[part])

    def coefficient(part: float, power: int) -> float:
        """Coefficient of the part of the level that is odd (power 1) or even (power 2) in the amplitude."""
        sign = -1 if power == 1 else 1
        return (found[part] + sign * found[-part]) / (2 * (part * amplitude) ** power)

    whole, half = coefficient(1.0, order), coefficient(0.5, order)
    if half == 0 or abs(whole - half) > AGREEMENT * abs(half):
        return None
    noise = max(noises[part] / abs(half * (part * amplitude) ** order) for part in found)
    if noise > AGREEMENT:
        return None
    if order == 1:
        return Birth("both", half, coefficient(0.5, 2), amplitude, noise)
    # The orbits at a and -a are the same ones, or mirror images: their levels differ in the third order at most.
    if any(found[part] * found[-part] <= 0 for part in (0.5, 1.0)):
        return None
    return Birth("above" if half > 0 else "below", 0.0, half, amplitude, noise)
