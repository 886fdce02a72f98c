"""The families that can be asked for by name.

- cr3bp: ``L1-lyapunov`` (planar), ``L1-vertical`` and ``L1-halo``, which branches off where the symmetry S of the
  planar family breaks first; ``L1-halo-2``, ``L1-halo-3``, .. branch off where it does so the next times. The same for
  L2 and L3. ``L1-butterfly``, ``L1-dragonfly`` and those of L2 have twice the period (`families.doubled`).
  ``dro``, the distant retrograde orbits, are planar orbits around the smaller primary, from small circles outwards;
  ``dpo``, ``lpo-east``, ``lpo-west`` go round it the other way (`families.prograde`), ``resonant-3-1`` and
  others round the larger one (`families.resonant`).
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
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.families import (
    CONTROL,
    Course,
    Family,
    FamilyFailure,
    Following,
    Limits,
    Start,
    StepControl,
    after_breakings,
    branch_seed,
    continue_family,
    extend,
    stop_at,
    symmetry_breakings,
    trace,
    trace_falkner_skan,
)
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.explore.three_body.families.doubled import DOUBLED, NEAREST, doubled_seed
from orbitproof.explore.three_body.families.hemispheres import on_side, side_reaching
from orbitproof.explore.three_body.families.prograde import PROGRADE, distant_prograde, greatest_level, prograde_circle
from orbitproof.explore.three_body.families.resonant import resonant_seed, while_resonant
from orbitproof.explore.three_body.names import (
    BRANCHES,
    DEFAULT_BRANCH,
    Branch,
    branch_number,
    is_family_name,
    resonance_of,
)
from orbitproof.explore.three_body.seeds import LinearOrbit, detuning, libration_point, lyapunov_orbit, vertical_orbit
from orbitproof.shared.systems import CR3BP_PLANAR, FALKNER_SKAN, ReversibleSystem

AMPLITUDE = 1e-3

PLANAR_ORBITS = 2000

RETROGRADE_RADIUS, NEAREST_RADIUS = 0.1, 0.01
"""Radius of the first distant retrograde orbit, and of that in the planar problem, in units of (mu/3)^(1/3)."""


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
            return trace_falkner_skan(tracer)
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


def by_name(name: str, branch: Branch = DEFAULT_BRANCH) -> Callable[[Following], Family]:
    """What traces a family by name, as the start of a `TraceTask`."""
    return partial(_traced, name, branch)


def _traced(name: str, branch: Branch, how: Following) -> Family:
    return trace_family(
        how.system, name, how.parameters, how.limits, branch=branch, control=how.control, progress=how.progress
    )


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


@dataclass(frozen=True)
class _Tracer(Following):
    """Traces families of given parameters from their first orbits; of those with two sides that of `branch`."""

    branch: Branch = DEFAULT_BRANCH

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
        stop = greatest_level(stop_at(problem, near, ()))
        way = Course(stop, self.control, near.max_orbits, self._report_start(name))
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
        stop = after_breakings(planar, number, stop_at(planar, near, ()))
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
