"""The families that can be asked for by name.

- cr3bp: ``L1-lyapunov`` (planar), ``L1-vertical`` and ``L1-halo``, which branches off where the symmetry S of the
  planar family breaks first; ``L1-halo-2``, ``L1-halo-3``, .. branch off where it does so the next times. The same for
  L2 and L3. ``L1-butterfly``, ``L1-dragonfly`` and those of L2 have twice the period (`explore.families.doubled`).
  ``dro``, the distant retrograde orbits, are planar orbits around the smaller primary, from small circles outwards;
  ``dpo``, ``lpo-east``, ``lpo-west`` go round it the other way (`explore.families.prograde`), ``resonant-3-1`` and
  others round the larger one (`explore.families.resonant`).
- cr3bp-planar, the CR3BP in the plane z = 0: ``dro`` again, by the crossing beyond the smaller primary, so that x
  increases outwards.
- cr3bp-axial, the CR3BP under its second reversor, the half turn about the x axis: ``L1-axial`` branches off where S
  breaks first on the planar family among orbits with that symmetry. The same for L2 and L3.
- falkner-skan: ``odd``, the symmetric periodic orbits in the parameter beta.

Halo orbits and those that branch off from them are northern or southern, mirror images: z is positive or negative where
they are farthest from the smaller primary. Southern ones are traced unless northern ones are asked for.

The first point of an orbit on Fix(R) is the crossing from which the paper draws the family: for L1
and L2 the one with x < x_L (there vy > 0), for L3 the one with x > x_L (there vy < 0). On a vertical family it is
the highest point; such an orbit also meets the x axis, so that its half orbit crosses the section twice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.families.branching import after_breakings, branch_seed
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
from orbitproof.explore.families.detection import symmetry_breaking_near, symmetry_breakings
from orbitproof.explore.families.doubled import DOUBLED, NEAREST, doubled_seed
from orbitproof.explore.families.hemispheres import on_side, side_reaching
from orbitproof.explore.families.limits import Limits
from orbitproof.explore.families.prograde import PROGRADE, distant_prograde, greatest_level, prograde_circle
from orbitproof.explore.families.resonant import resonant_seed, while_resonant
from orbitproof.explore.families.step_control import CONTROL, StepControl
from orbitproof.explore.flow import FlowFailure, Matrix
from orbitproof.explore.names import BRANCHES, DEFAULT_BRANCH, Branch, branch_number, is_family_name, resonance_of
from orbitproof.explore.numerics import bracketed_zero
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.explore.seeds import LinearOrbit, detuning, libration_point, limit_orbit, lyapunov_orbit, vertical_orbit
from orbitproof.shared.systems import CR3BP_PLANAR, FALKNER_SKAN, ReversibleSystem

AMPLITUDE = 1e-3
BETA = (100.0, 1000.0)
"""Range of the parameter of the Falkner-Skan family unless told otherwise; it starts at the lower end."""

PLANAR_ORBITS = 2000

RETROGRADE_RADIUS, NEAREST_RADIUS = 0.1, 0.01
"""Radius of the first distant retrograde orbit, and of that in the planar problem, in units of (mu/3)^(1/3)."""


class FamilyFailure(Exception):
    """The family's first orbit could not be found; one line says why."""


def trace_family(
    system: ReversibleSystem,
    name: str,
    parameters: Mapping[str, Fraction],
    limits: Limits,
    *,
    branch: Branch = DEFAULT_BRANCH,
    control: StepControl = CONTROL,
    progress: Progress | None = None,
) -> Family:
    """Trace a family by name up to `limits`.

    Arguments:
        parameters: exact fixed parameters of the system.
        branch: the northern or the southern one of a halo family, or of one that branches off it.

    Raises `FamilyFailure` if no first orbit is found and `ValueError` for an unknown name.
    """
    if not is_family_name(system.name, name):
        raise ValueError(f"unknown family {name!r} of {system.name}")
    if branch not in BRANCHES:
        raise ValueError(f"branch: {branch!r} is unknown; there are {' and '.join(BRANCHES)}")
    tracer = _Tracer(system, parameters, limits, control, progress, branch)
    try:
        if system is FALKNER_SKAN:
            return tracer.falkner_skan()
        if name == "dro":
            return tracer.grown(*tracer.retrograde_start())
        if name in PROGRADE:
            return tracer.prograde(name)
        if (resonance := resonance_of(name)) is not None:
            return tracer.resonant(*resonance)
        point, kind = name.split("-")[:2]
        if kind in DOUBLED:
            return tracer.doubled(point, kind)
        if kind == "lyapunov":
            return tracer.grown(*tracer.planar_start(point))
        if kind == "vertical":
            return tracer.grown(*tracer.vertical_start(point))
        return tracer.halo(point, branch_number(name) or 1)
    except (CorrectionFailure, ZeroDivisionError) as error:
        raise FamilyFailure(f"no first orbit of {name}: {error}") from None


def trace_reaching(
    system: ReversibleSystem,
    name: str,
    parameters: Mapping[str, Fraction],
    limits: Limits,
    branch: Branch | None,
    place: tuple[str, float] | None,
    *,
    progress: Progress | None = None,
) -> tuple[Family, Branch]:
    """A family by name and its branch: of those two of which none is asked for, one that comes to a place.

    Arguments:
        branch: the one that is asked for, if any.
        place: a coordinate of the first point and its value. The other family than that of the default is traced if it
            alone reaches it.

    Raises what `trace_family` raises.
    """
    wanted = branch or DEFAULT_BRANCH
    family = trace_family(system, name, parameters, limits, branch=wanted, progress=progress)
    side = None if branch is not None or place is None else side_reaching(family, *place)
    if side in (None, wanted) or family.outcome == "interrupted":
        return family, wanted
    return trace_family(system, name, parameters, limits, branch=side, progress=progress), side


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
    course = _Tracer(problem.system, problem.parameters, limits, control, progress).course(
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


class _Tracer:
    """Traces families of given parameters from their first orbits."""

    def __init__(
        self,
        system: ReversibleSystem,
        parameters: Mapping[str, Fraction],
        limits: Limits,
        control: StepControl,
        progress: Progress | None,
        branch: Branch = DEFAULT_BRANCH,
    ) -> None:
        self.system = system
        self.parameters = parameters
        self.limits = limits
        self.control = control
        self.progress = progress
        self.branch = branch

    def problem(self, scale: tuple[float, ...], symmetry: str | None) -> ShootingProblem:
        return ShootingProblem(self.system, self.parameters, symmetry, scale, self.control.tolerance)

    def course(self, problem: ShootingProblem, bounds: Limits, orbits: tuple[SymmetricOrbit, ...] = ()) -> Course:
        """Up to `bounds` after `orbits`, with progress towards the limits asked for."""
        report = _report(problem, self.limits, self.progress, len(orbits))
        return Course(_stop(problem, bounds, orbits), self.control, bounds.max_orbits, report)

    def grown(self, problem: ShootingProblem, start: Start) -> Family:
        """The family from its start up to the limits."""
        return _with_symmetric_end(trace(problem, start, self.course(problem, self.limits)))

    def planar_start(self, point: str) -> tuple[ShootingProblem, Start]:
        libration = libration_point(point, self.parameters["mu"])
        orbit = lyapunov_orbit(libration, AMPLITUDE * libration.distance, 1 if point == "L3" else -1)
        return self._linear_start(libration.distance, orbit, "S")

    def vertical_start(self, point: str) -> tuple[ShootingProblem, Start]:
        libration = libration_point(point, self.parameters["mu"])
        # The linear orbit is a guess only where its square is small against the detuning.
        amplitude = AMPLITUDE * min(1.0, float(np.sqrt(detuning(libration) / AMPLITUDE)))
        return self._linear_start(libration.distance, vertical_orbit(libration, amplitude * libration.distance), None)

    def _linear_start(self, size: float, orbit: LinearOrbit, symmetry: str | None) -> tuple[ShootingProblem, Start]:
        fixed = list(self.system.fixed_coordinates)
        start = Start(np.append(orbit.state[fixed], orbit.half_period), np.append(orbit.direction[fixed], 0.0))
        return self.problem((size, size, size, 1.0), symmetry), start

    def retrograde_start(self) -> tuple[ShootingProblem, Start]:
        """A small circle around the smaller primary, against its turning.

        The first crossing is at x < 1 - mu with vy > 0, in the planar problem at x > 1 - mu with vy < 0, so that x
        increases outwards.
        """
        mass, planar = float(self.parameters["mu"]), self.system is CR3BP_PLANAR
        hill = float((mass / 3) ** (1 / 3))
        radius, side = (NEAREST_RADIUS * hill, 1.0) if planar else (RETROGRADE_RADIUS * hill, -1.0)
        turning = float(np.sqrt(mass / radius**3)) + 1.0
        place, direction = {"x": 1.0 - mass + side * radius, "vy": -side * turning * radius}, {"x": side}
        names = self.system.centre_coordinates
        start = Start(
            np.array([*(place.get(name, 0.0) for name in names), np.pi / turning]),
            np.array([*(direction.get(name, 0.0) for name in names), 0.0]),
        )
        return self.problem((*(hill for _ in names), 1.0), None if planar else "S"), start

    def prograde(self, name: str) -> Family:
        """One of `PROGRADE`; eastern and distant ones begin where the Jacobi constant is greatest between them."""
        mass = float(self.parameters["mu"])
        hill = float((mass / 3) ** (1 / 3))
        problem = self.problem((hill, hill, hill, 1.0), "S")
        if name == "lpo-west":
            return self.grown(problem, Start(*prograde_circle(mass, RETROGRADE_RADIUS * hill)))
        near = Limits(PLANAR_ORBITS, min_distance=self.limits.min_distance)
        way = Course(greatest_level(_stop(problem, near, ())), self.control, near.max_orbits, self._report_start(name))
        family = extend(distant_prograde(problem), way)
        if family.outcome == "interrupted":
            raise KeyboardInterrupt
        seed = replace(family.turned(), beginning=None)
        if name == "lpo-east":
            first = replace(family.orbits[-1], arclength=0.0)
            seed = replace(family, orbits=(first,), tangents=family.tangents[-1:])
        return continue_family(seed, self.limits, control=self.control, progress=self.progress)

    def resonant(self, p: int, q: int, near: bool) -> Family:
        """Both ways from an ellipse that is followed to the mass, half of the orbits each way."""
        seed, mass = resonant_seed(self.parameters, p, q, near, self.control.tolerance), float(self.parameters["mu"])
        half = replace(self.limits, max_orbits=(self.limits.max_orbits + 1) // 2)

        def way(family: Family, limits: Limits) -> Course:
            course = self.course(family.problem, limits, family.orbits)
            return replace(course, stop=while_resonant(p, q, mass, course.stop))

        family = extend(seed.turned(), way(seed, half)).turned()
        if family.beginning is not None and family.beginning.outcome == "interrupted":
            return replace(family, outcome="interrupted", beginning=None)
        return extend(family, way(family, self.limits))

    def doubled(self, point: str, kind: str) -> Family:
        """The branch of doubled period at a 1:2 resonance of the halo family."""
        hill = float((self.parameters["mu"] / 3) ** (1 / 3))
        far = Limits(PLANAR_ORBITS, min_distance=max(self.limits.min_distance or 0.0, NEAREST * hill))
        halo = _Tracer(self.system, self.parameters, far, self.control, self.progress).halo(point, 1)
        if halo.outcome == "interrupted":
            raise KeyboardInterrupt
        if self.progress is not None:
            self.progress("1:2 resonances of the halo family", 0.0)
        branch = on_side(doubled_seed(halo, kind), self.branch)
        return continue_family(branch, self.limits, control=self.control, progress=self.progress)

    def halo(self, point: str, number: int) -> Family:
        """The branch at the symmetry breaking `number` = 1, 2, .. of the planar family."""
        planar, start = self.planar_start(point)
        near = Limits(PLANAR_ORBITS, min_distance=self.limits.min_distance)
        stop = after_breakings(planar, number, _stop(planar, near, ()))
        family = trace(planar, start, Course(stop, self.control, near.max_orbits, self._report_start("planar")))
        if family.outcome == "interrupted":
            raise KeyboardInterrupt
        breakings = symmetry_breakings(family)
        if len(breakings) < number:
            times = f" a {number}. time" if number > 1 else ""
            raise CorrectionFailure(f"S does not break{times} on the planar family: {family.reason}")
        branch = on_side(branch_seed(planar, breakings[number - 1], 1), self.branch)
        return continue_family(branch, self.limits, control=self.control, progress=self.progress)

    def _report_start(self, name: str) -> Callable[[SymmetricOrbit], None] | None:
        progress = self.progress
        if progress is None:
            return None
        return lambda orbit: progress(f"on the way from the {name} family's start", 0.0)

    def falkner_skan(self) -> Family:
        """Starts at beta = 100, or where the range begins above it, goes down to its lower end and then up."""
        problem = self.problem((1000.0, 1.0, 1.0), None)
        limits, limit = self.limits, limit_orbit()
        low, high = limits.parameter_min, limits.parameter_max
        limits = replace(
            limits,
            parameter_min=low if np.isfinite(low) else BETA[0],
            parameter_max=high if np.isfinite(high) else BETA[1],
        )
        beta = max(BETA[0], limits.parameter_min)
        start = Start(np.array([beta, limit.upper, limit.half_period / np.sqrt(beta)]), np.array([1.0, 0.0, 0.0]))
        upwards = replace(limits, parameter_min=-np.inf)
        if limits.parameter_min >= beta:
            return trace(problem, start, self.course(problem, upwards))
        downwards = replace(limits, parameter_max=np.inf)
        down = trace(problem, replace(start, direction=-start.direction), self.course(problem, downwards))
        if down.outcome == "limit" and down.orbits[-1].unknowns[0] > limits.parameter_min:
            raise CorrectionFailure(f"beta = {limits.parameter_min:g} is not reached: {down.reason}; allow more orbits")
        family = down.turned()
        if down.outcome == "interrupted":
            return replace(family, outcome="interrupted", reason=down.reason, beginning=None)
        beyond = [i for i, orbit in enumerate(family.orbits) if orbit.unknowns[0] > limits.parameter_max]
        if beyond:
            end = beyond[0]
            reason = f"limit beta = {limits.parameter_max:g} ({describe(problem, family.orbits[end])})"
            orbits, tangents = family.orbits[: end + 1], family.tangents[: end + 1]
            return replace(family, orbits=orbits, tangents=tangents, outcome="limit", reason=reason)
        return extend(family, self.course(problem, upwards, family.orbits))


def _stop(problem: ShootingProblem, limits: Limits, orbits: tuple[SymmetricOrbit, ...]) -> Stop:
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
