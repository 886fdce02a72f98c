"""The families that can be asked for by name, and the limits up to which they are traced.

- cr3bp: ``L1-lyapunov``, ``L2-lyapunov``, ``L3-lyapunov`` (planar) and ``L1-halo``, ``L2-halo``, ``L3-halo``,
  which branch off where the symmetry S of the planar family breaks first.
- falkner-skan: ``odd``, the symmetric periodic orbits in the parameter beta.

The first point of an orbit on Fix(R) is the crossing from which the paper draws the family: for L1
and L2 the one with x < x_L (there vy > 0), for L3 the one with x > x_L (there vy < 0).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal

import numpy as np

from explore.arguments import FAMILY_NAMES
from explore.continuation import Family, Start, StepControl, describe, extend, trace
from explore.detection import symmetry_breaking_near, symmetry_breakings, until_breaking
from explore.falkner_skan import limit_orbit
from explore.flow import FlowFailure, Matrix
from explore.libration import distance_to_primaries, libration_point, lyapunov_orbit
from explore.shooting import CorrectionFailure, ShootingProblem, SymmetricOrbit
from shared.systems import CR3BP, FALKNER_SKAN, ReversibleSystem

Progress = Callable[[str, float], None]
"""Called with what is being done and the fraction done, 0 to 1."""

CONTROL = StepControl(initial=2e-3, minimum=1e-8, maximum=0.1, turning=0.12)
AMPLITUDE = 1e-3
BETA_START = 100.0
PLANAR_ORBITS = 2000

TYPICAL_ORBITS = 150
"""For the progress display only: of this order is the number of orbits of a family that no limit cuts short."""


class FamilyFailure(Exception):
    """The family's first orbit could not be found; one line says why."""


@dataclass(frozen=True)
class Limits:
    """How far a family is traced; it ends with the first orbit beyond a limit.

    Attributes:
        max_orbits: number of orbits.
        coordinate_max: largest magnitude of a Fix(R) coordinate of the first point, by name.
        parameter_min, parameter_max: range of the family parameter, if the system has one.
        integral_min: smallest value of the first integral (the Jacobi constant).
        min_distance: smallest distance to a primary.
    """

    max_orbits: int = 1000
    coordinate_max: Mapping[str, float] = field(default_factory=dict)
    parameter_min: float = BETA_START
    parameter_max: float = 1000.0
    integral_min: float | None = None
    min_distance: float = 1e-5

    def reached(self, problem: ShootingProblem, orbit: SymmetricOrbit, states: Matrix) -> str | None:
        """Which limit the orbit lies beyond, in words, or `None`."""
        system = problem.system
        names = system.centre_coordinates
        for name, bound in self.coordinate_max.items():
            if abs(orbit.unknowns[names.index(name)]) >= bound:
                return f"limit {name} = {bound:g}"
        if system.family_parameter is not None and not self.parameter_min <= orbit.unknowns[0] <= self.parameter_max:
            bound = self.parameter_max if orbit.unknowns[0] > self.parameter_max else self.parameter_min
            return f"limit {system.family_parameter} = {bound:g}"
        integral = orbit.first_integral
        if self.integral_min is not None and integral is not None and integral <= self.integral_min:
            return f"limit {system.first_integral_name} = {self.integral_min:g}"
        if system is CR3BP and distance_to_primaries(states, float(problem.parameters["mu"])) <= self.min_distance:
            return f"limit distance to a primary = {self.min_distance:g}"
        return None

    def fraction(self, problem: ShootingProblem, orbit: SymmetricOrbit, count: int) -> float:
        """How much of the way to the nearest limit is done, roughly, 0 to 1."""
        system = problem.system
        names = system.centre_coordinates
        parts = [max(count / self.max_orbits, count / (count + TYPICAL_ORBITS))]
        parts += [abs(orbit.unknowns[names.index(name)]) / bound for name, bound in self.coordinate_max.items()]
        if system.family_parameter is not None:
            parts.append((orbit.unknowns[0] - self.parameter_min) / (self.parameter_max - self.parameter_min))
        return min(1.0, max(parts))


def trace_family(
    system: ReversibleSystem,
    name: str,
    parameters: Mapping[str, Fraction],
    limits: Limits,
    *,
    mirrored: bool = False,
    progress: Progress | None = None,
) -> Family:
    """Trace a family by name up to `limits`.

    Arguments:
        parameters: exact fixed parameters of the system.
        mirrored: the mirror image of a halo family under S (z < 0 at the first point).

    Raises `FamilyFailure` if no first orbit is found and `ValueError` for an unknown name.
    """
    if name not in FAMILY_NAMES.get(system.name, ()):
        raise ValueError(f"unknown family {name!r} of {system.name}")
    try:
        if system is FALKNER_SKAN:
            return _falkner_skan(parameters, limits, progress)
        point, _, kind = name.partition("-")
        if kind == "lyapunov":
            return _lyapunov(point, parameters, limits, progress)
        return _halo(point, parameters, limits, -1 if mirrored else 1, progress)
    except CorrectionFailure as error:
        raise FamilyFailure(f"no first orbit of {name}: {error}") from None


def continue_family(family: Family, limits: Limits, *, progress: Progress | None = None) -> Family:
    """Continue a traced family, for example one read from a file, up to further limits."""
    problem = family.problem
    last = family.orbits[-1]
    try:
        states = problem.samples(last.unknowns)
    except FlowFailure as error:
        raise FamilyFailure(f"the last orbit cannot be integrated: {error}") from None
    if family.outcome == "closed" or limits.reached(problem, last, states) is not None:
        return family
    if problem.symmetry is None and len(family.orbits) > 1 and _in_fixed_space(problem, last):
        return family
    more = extend(
        family, _stop(problem, limits, family.orbits), control=CONTROL, max_orbits=limits.max_orbits,
        progress=_report(problem, limits, progress, len(family.orbits)),
    )  # fmt: skip
    return _with_symmetric_end(more)


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


def _falkner_skan(parameters: Mapping[str, Fraction], limits: Limits, progress: Progress | None) -> Family:
    problem = ShootingProblem(FALKNER_SKAN, parameters, scale=(1000.0, 1.0, 1.0))
    limit = limit_orbit()
    beta = max(BETA_START, limits.parameter_min)
    start = Start(np.array([beta, limit.upper, limit.half_period / np.sqrt(beta)]), np.array([1.0, 0.0, 0.0]))
    if limits.parameter_min < beta:
        down = replace(limits, parameter_max=np.inf)
        approach = trace(
            problem,
            replace(start, direction=-start.direction),
            lambda orbit, states: down.reached(problem, orbit, states),
            control=CONTROL,
            max_orbits=limits.max_orbits,
        )
        if approach.orbits[-1].unknowns[0] > limits.parameter_min:
            raise CorrectionFailure(f"beta = {limits.parameter_min:g} is not reached: {approach.reason}")
        start = Start(approach.orbits[-1].unknowns, -approach.tangents[-1])
    return trace(
        problem, start, _stop(problem, replace(limits, parameter_min=-np.inf), ()), control=CONTROL,
        max_orbits=limits.max_orbits, progress=_report(problem, limits, progress),
    )  # fmt: skip


def _planar_start(point: str, parameters: Mapping[str, Fraction]) -> tuple[ShootingProblem, Start]:
    libration = libration_point(point, parameters["mu"])
    orbit = lyapunov_orbit(libration, AMPLITUDE * libration.distance, 1 if point == "L3" else -1)
    size = libration.distance
    problem = ShootingProblem(CR3BP, parameters, symmetry="S", scale=(size, size, size, 1.0))
    fixed = list(CR3BP.fixed_coordinates)
    return problem, Start(np.append(orbit.state[fixed], orbit.half_period), np.append(orbit.direction[fixed], 0.0))


def _lyapunov(point: str, parameters: Mapping[str, Fraction], limits: Limits, progress: Progress | None) -> Family:
    problem, start = _planar_start(point, parameters)
    return trace(
        problem, start, _stop(problem, limits, ()), control=CONTROL, max_orbits=limits.max_orbits,
        progress=_report(problem, limits, progress),
    )  # fmt: skip


def _halo(
    point: str, parameters: Mapping[str, Fraction], limits: Limits, sign: Literal[1, -1], progress: Progress | None
) -> Family:
    if progress is not None:
        progress("tracing the planar family", 0.0)
    planar, start = _planar_start(point, parameters)
    family = trace(planar, start, until_breaking(planar, np.inf), control=CONTROL, max_orbits=PLANAR_ORBITS)
    if family.outcome == "interrupted":
        raise KeyboardInterrupt
    breakings = symmetry_breakings(family)
    if not breakings:
        raise CorrectionFailure(f"S does not break on the planar family: {family.reason}")
    problem, origin = replace(planar, symmetry=None), replace(breakings[0].orbit, arclength=0.0)
    direction = np.zeros(problem.size)
    direction[list(problem.odd_unknowns("S"))] = sign
    halo = trace(
        problem, Start(origin.unknowns, direction, origin), _stop(problem, limits, ()), control=CONTROL,
        max_orbits=limits.max_orbits, progress=_report(problem, limits, progress),
    )  # fmt: skip
    return _with_symmetric_end(halo)


RETURNED = "the family returns to Fix(S)"


def _in_fixed_space(problem: ShootingProblem, orbit: SymmetricOrbit) -> bool:
    return any(
        all(orbit.unknowns[i] == 0 for i in odd) for odd in map(problem.odd_unknowns, problem.system.symmetries) if odd
    )


def _stop(
    problem: ShootingProblem, limits: Limits, orbits: tuple[SymmetricOrbit, ...]
) -> Callable[[SymmetricOrbit, Matrix], str | None]:
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
    if not family.reason.startswith(RETURNED):
        return family
    problem, before, beyond = family.problem, family.orbits[-2], family.orbits[-1]
    name, (index,) = next(
        (name, odd) for name in problem.system.symmetries if len(odd := problem.odd_unknowns(name)) == 1
    )
    weight = before.unknowns[index] / (before.unknowns[index] - beyond.unknowns[index])
    guess = before.unknowns + weight * (beyond.unknowns - before.unknowns)
    try:
        end = symmetry_breaking_near(problem, name, guess, 2.0)
    except CorrectionFailure:
        return replace(family, orbits=family.orbits[:-1], tangents=family.tangents[:-1])
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
