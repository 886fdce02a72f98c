"""Bifurcating branches: from a bifurcation point onto the new orbits, and along them to both sides.

A new orbit of a 1:k resonance starts on Fix(R) near the point and is on Fix(R) again at the k-th crossing of the
section (k = 1 for symmetry breaking). Near the point its starting points form a curve, the *branch*, along which
the amplitude p_1 of the claim's frame grows or falls; the two signs are its two sides. For even k they
belong to the same orbits, each of which starts once on either side; for k = 1 the symmetry exchanges them;
for odd k >= 3 they are different orbits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from explore.branch_file import Birth, BranchOrbit, BranchRecord, BranchSide, Outcome
from explore.branch_point import BranchPoint, NoBranch
from explore.flow import FlowFailure, Matrix, Vector, flow_of
from explore.multiple_shooting import NEWTON_ACCEPTED, MultipleShooting, SegmentedOrbit
from explore.prediction import predict
from explore.shooting import CorrectionFailure

FIRST_AMPLITUDE = 1e-2
LAST_AMPLITUDE = 1e-8
AGREEMENT = 0.1
"""Relative difference of the level's coefficient at an amplitude and at half of it that is accepted."""

FARTHER = 2**0.5
"""Ratio of successive amplitudes away from the bifurcation."""

RESOLVED, BARELY_RESOLVED = 1e-3, 3e-2
"""See `_Tracer.resolved`; the second where nothing better is found, on orbits that pass near a collision."""

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
            id=start.id, system=start.system, parameters=start.parameters, kind=start.kind, k=start.k,
            symmetry=start.symmetry, verdict=verdict, certified_side=certified_side, point=start.point,
            second_point=self.second_point, half_period=start.half_period, level=float(start.level),
            scale=start.scale, birth=self.birth, failure=self.failure, sides=self.sides,
        )  # fmt: skip


class _SmallerPeriod(CorrectionFailure):
    """An orbit was found, but not one of the full period."""


@dataclass(frozen=True)
class _Tracer:
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
        orbit = self.problem.correct(
            prediction, self.start.amplitude_form, max(NEWTON_ACCEPTED, self.resolved * abs(amplitude))
        )
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
        difference, _ = self.start.level_difference(point)
        return BranchOrbit(
            arclength=arclength, point=point, second_point=problem.end(orbit),
            crossings=problem.states(orbit.unknowns)[1:],
            times=problem.times(orbit.unknowns), half_period=float(problem.times(orbit.unknowns).sum()),
            level=float(self.start.level) + difference, level_difference=difference,
            stability=problem.stability(orbit),
        )  # fmt: skip


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
    tracer, second_point = _tracer(start)
    amplitude = min(FIRST_AMPLITUDE, length)
    try:
        birth, first = _birth(tracer, amplitude)
    except NoBranch:
        tracer = replace(tracer, resolved=BARELY_RESOLVED)
        try:
            birth, first = _birth(tracer, amplitude)
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


def _tracer(start: BranchPoint) -> tuple[_Tracer, Vector]:
    problem = MultipleShooting(start.system, start.parameters, start.k)
    first, values = problem.initial_state(start.point), problem.parameter_values(start.point)
    try:
        second = flow_of(start.system).derivative(first, start.half_period, values).state
        fixed = list(start.system.fixed_coordinates)
        symmetric = np.zeros_like(first)
        symmetric[fixed] = second[fixed]
        states = np.array([symmetric if i % 2 == 0 else first for i in range(start.k - 1)]).reshape(-1, len(first))
        origin = problem.assemble(start.point, states, np.full(start.k, start.half_period))
        evaluation = problem.evaluate(origin)
    except FlowFailure as error:
        raise NoBranch(f"the resonant orbit: {error}") from None
    # At the bifurcation the kernel is a plane; the tangent of the branch is the vector with the known point part.
    size, jacobian = problem.point_size, evaluation.jacobian
    rest = jacobian[:, size:]
    norms = np.maximum(np.linalg.norm(rest, axis=0), 1e-300)
    inner = np.linalg.lstsq(rest / norms, -jacobian[:, :size] @ start.direction, rcond=None)[0] / norms
    lead = size - len(start.system.fixed_coordinates)
    return (
        _Tracer(
            start, problem, origin, np.concatenate([start.direction, inner]), float(np.abs(evaluation.residual).max())
        ),
        np.concatenate([start.point[:lead], symmetric[fixed]]),
    )


def _birth(tracer: _Tracer, amplitude: float) -> tuple[Birth, dict[float, SegmentedOrbit]]:
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
    tracer: _Tracer, amplitude: float, seeds: dict[float, SegmentedOrbit], largest: float
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


def _birth_from(tracer: _Tracer, orbits: dict[float, SegmentedOrbit], amplitude: float) -> Birth | None:
    order, size = tracer.start.order, tracer.problem.point_size
    found, noises = {}, {}
    for part, orbit in orbits.items():
        found[part], rounding = tracer.start.level_difference(orbit.unknowns[:size])
        beside, _ = tracer.start.level_difference((orbit.unknowns - orbit.correction)[:size])
        noises[part] = rounding + abs(beside - found[part])

    def coefficient(part: float, power: int) -> float:
        """Of the part of the level that is odd (power 1) or even (power 2) in the amplitude."""
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


def _side(
    tracer: _Tracer,
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
        step, longest = abs(found[-1].arclength), 1.5 * length / limit
        step = min(step, longest)
        while len(found) < limit:
            if abs(found[-1].arclength) >= length * (1 - 1e-9):
                return ended("length", f"followed over the arclength {length:g}")
            step = min(step, length - abs(found[-1].arclength))
            try:
                orbit, tangent = _advance(tracer, vectors[-3:], tangents[-3:], step)
            except (CorrectionFailure, FlowFailure, ZeroDivisionError) as error:
                step /= 2
                if step < SMALLEST_STEP:
                    return ended("failed", f"{error} (after the arclength {abs(found[-1].arclength):.3g})")
                continue
            here = tracer.separations(orbit)
            if np.min(np.sum(here * apart, axis=1)) <= 0:
                return ended("meets family", "the branch meets orbits of smaller period, or of more symmetry, again")
            accept(orbit, tangent)
            apart = here
            step = min(longest, 1.5 * step)
    except CorrectionFailure as error:
        return ended("failed", str(error))
    except KeyboardInterrupt:
        return ended("interrupted", "interrupted")
    return ended("orbits", f"{limit} orbits")


def _advance(
    tracer: _Tracer, vectors: list[Vector], tangents: list[Vector], step: float
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
    orbit = problem.correct(prediction, direction[:size] / tracer.scale, max(NEWTON_ACCEPTED, tracer.resolved * step))
    tangent = problem.tangent(orbit.evaluation, tracer.scale, tangents[-1])
    old, new = ((vector / units)[:size] for vector in (tangents[-1], tangent))
    moved = float(np.linalg.norm(((orbit.unknowns - vectors[-1]) / units)[:size]))
    if float(np.arccos(min(1.0, float(old @ new)))) > TURNING or moved > 1.5 * step:
        raise CorrectionFailure("the branch turns too sharply")
    if not problem.crosses_once(orbit.unknowns):
        raise CorrectionFailure("the orbit becomes tangent to the section")
    return orbit, tangent
