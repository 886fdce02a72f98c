"""Families of periodic orbits without symmetry: continuation in a parameter or the level.

Pseudo-arclength continuation in float64 (`family`); bifurcations on the way are found by `detection`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice
from typing import Any

import numpy as np

from orbitproof.explore import numerics
from orbitproof.explore.engines import Progress
from orbitproof.explore.names import told_apart
from orbitproof.explore.numerics import NoStep, walked
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.detection import (
    Bifurcation,
    Passage,
    UnresolvedError,
    is_real,
    passage,
)
from orbitproof.explore.periodic.family import FamilyEquations, FamilyMember
from orbitproof.explore.periodic.flow import Vector
from orbitproof.explore.periodic.hopf import Hopf, hopf_as_json, hopf_described, hopf_of_orbit
from orbitproof.explore.periodic.symmetries import Symmetry, linear_symmetries

_FARTHEST = 0.5
"""A point moves at most so far in a step, relative to the size of its orbit."""
_SHRUNK = 1e-2
"""An orbit of this part of the first one's size is close to an equilibrium."""
PATIENCE = 1e-4
"""Steps are not made shorter than this for the sake of multipliers."""
_ASKED = 0.1
"""A Hopf point is looked for where an orbit is smaller than this part of the largest, and again whenever it is half as
large."""
_SMALL = 0.5
"""A family that cannot be followed further may end at a Hopf point if its last orbit is smaller than this part of the
largest one before."""
_GROWN = 2.0
"""Steps are measured anew where an orbit is so many times as large as the one that they were measured by."""

_OPEN = 1e-8
"""An orbit that closes no better, relative to its size, amplifies errors too much for one shot."""
_LONGER, _SLOW = 2.5, 0.05
"""Period and least speed, by those of the first orbit and by the greatest, from which orbits come close to a saddle."""


@dataclass(frozen=True)
class StepControl(numerics.StepControl):
    """Steps along a family, in units of its size, period and parameter.

    Attributes:
        most: number of orbits.
    """

    initial: float = 0.02
    minimum: float = 1e-7
    maximum: float = 0.1
    turning: float = 0.3
    most: int = 500


@dataclass(frozen=True)
class PeriodicFamily:
    """A family of periodic orbits.

    Attributes:
        name: of the parameter, or that of the first integral.
        members: in order along the family.
        bifurcations: in the same order.
        reason: why it ends.
        born: the bifurcation from which it was followed; `None` for the family of a given orbit.
        generation: how many bifurcations led to it.
        interrupted: whether it was cut short by the user.
        hopf: the Hopf points at which it ends, where its orbits shrink to an equilibrium.
    """

    problem: PeriodicProblem
    parameter: str | None
    members: tuple[FamilyMember, ...]
    bifurcations: tuple[Bifurcation, ...]
    reason: str
    born: Bifurcation | Hopf | None = None
    generation: int = 0
    interrupted: bool = False
    hopf: tuple[Hopf, ...] = ()

    @property
    def name(self) -> str:
        """What people call what varies; a first integral may be called like a parameter."""
        return self.parameter or self.problem.system.first_integral_name or "first integral"


def continue_orbit(
    problem: PeriodicProblem,
    orbit: ClosedOrbit,
    name: str | None,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
    level: Fraction | None = None,
) -> PeriodicFamily:
    """The family of an orbit in a parameter, or over the levels of the first integral, both ways.

    The members are in the order in which the parameter or level grows at the orbit.

    Arguments:
        name: of the parameter; `None` for the level.
        bounds: its least and greatest value; the family ends with the first orbit beyond.
        symmetries: that tell pitchforks from other branch points; `None`: those that are found.
        level: of the first integral, exact, on which a parameter varies; `None`: that of the orbit.

    Raises `PeriodicFailure` if the family has no first step.
    """
    control = control or StepControl()
    has_level = problem.system.first_integral_program is not None
    if name is None and not has_level:
        raise PeriodicFailure(f"{problem.system.name} has no first integral; give a parameter")
    if symmetries is None:
        symmetries = linear_symmetries(problem, name)
    if level is None and orbit.level is not None:
        level = Fraction(orbit.level)
    family = FamilyEquations(
        problem, name, scale_of(orbit, name, bounds), None if name is None else level,
        symmetries if orbit.segments == 1 else (), segments=orbit.segments,
    )  # fmt: skip
    first = family.member_of(orbit)
    if family.rate(first) < 0:
        # Rounding chooses the sign of a tangent; the order of the family and the numbers in it do not depend on it.
        first = replace(first, tangent=-first.tangent)
    back = traced(family, replace(first, tangent=-first.tangent), bounds, control, _part(progress, 0, 2))
    ahead = Trace([], [], "is not followed the other way", False)
    if not back.interrupted:
        ahead = traced(family, first, bounds, control, _part(progress, 1, 2))
    turned = [replace(member, tangent=-member.tangent) for member in reversed(back.members)]
    return PeriodicFamily(
        problem,
        name,
        (*turned, first, *ahead.members),
        (*reversed(back.bifurcations), *ahead.bifurcations),
        f"{back.reason}; {ahead.reason}",
        interrupted=back.interrupted or ahead.interrupted,
        hopf=(*back.hopf, *ahead.hopf),
    )


def scale_of(orbit: ClosedOrbit, name: str | None, bounds: tuple[float, float]) -> Vector:
    width = [] if name is None else [bounds[1] - bounds[0]]
    m = orbit.segments
    return np.concatenate([np.full(m * len(orbit.point), orbit.size * m**0.5), [orbit.period], width])


def _part(progress: Progress | None, number: int, parts: int) -> Progress | None:
    if progress is None:
        return None
    return lambda text, done: progress(text, None if done is None else (number + done) / parts)


@dataclass(frozen=True)
class Trace:
    """A family one way: its orbits without the first, bifurcations, and why it ends."""

    members: list[FamilyMember]
    bifurcations: list[Bifurcation]
    reason: str
    interrupted: bool = False
    hopf: tuple[Hopf, ...] = ()


def traced(
    family: FamilyEquations,
    start: FamilyMember,
    bounds: tuple[float, float],
    control: StepControl,
    progress: Progress | None,
    grows: bool = False,
) -> Trace:
    """A family one way.

    Arguments:
        grows: whether the first orbit is small, and steps are to be measured by larger ones as they come.
    """
    members: list[FamilyMember] = []
    found: list[Bifurcation] = []
    hopf: list[Hopf] = []
    try:
        reason = _follow(family, start, bounds, control, progress, members, found, hopf, grows)
    except KeyboardInterrupt:
        return Trace(members, found, "was interrupted", True)
    return Trace(members, found, reason, hopf=tuple(hopf))


def _follow(
    family: FamilyEquations,
    start: FamilyMember,
    bounds: tuple[float, float],
    control: StepControl,
    progress: Progress | None,
    members: list[FamilyMember],
    found: list[Bifurcation],
    hopf: list[Hopf],
    grows: bool,
) -> str:
    """Append to `members`, `found` and `hopf`, and say why the family ends."""
    low, high = bounds
    largest, asked = start.orbit.size, _ASKED

    def last() -> FamilyMember:
        return members[-1] if members else start

    def advance(length: float) -> tuple[tuple[FamilyMember, Passage], float]:
        before = last()
        now = family.corrected(before, length)
        angle = float(np.arccos(np.clip(now.tangent @ before.tangent, -1, 1)))
        if angle > control.turning:
            raise PeriodicFailure("it turns too fast")
        if np.max(np.abs(now.orbit.point - before.orbit.point)) > _FARTHEST * now.orbit.size:
            raise PeriodicFailure("its orbits shrink to a point")
        if family.segments == 1 and now.orbit.gap > _OPEN and family.segments_for(now.orbit) > 1:
            raise NoStep("its orbits are too unstable for one shot")
        passed = passage(family, before, now, length, length > PATIENCE)
        return (now, passed), min(control.maximum, length * (1.4 if angle < control.turning / 3 else 1.0))

    while True:
        steps = walked(advance, control.initial, control.minimum, (PeriodicFailure, UnresolvedError))
        try:
            for now, passed in islice(steps, max(0, control.most - 1 - len(members))):
                found += passed.bifurcations
                for each in passed.bifurcations if progress is not None else ():
                    progress(f"{each.kind} at {family.name or 'the level'} = {each.value:.8g}", None)
                if passed.end is not None:
                    return f"{passed.end}, near {now.value:.8g}"
                members.append(now)
                if progress is not None:
                    progress("", _share(start.value, now.value, bounds, len(members) / control.most))
                largest = max(largest, now.orbit.size)
                if now.orbit.size < asked * largest:
                    asked /= 2
                    end = _hopf_end(family, now, hopf, strict=True)
                    if end is not None:
                        return end
                if now.orbit.size < _SHRUNK * family.size:
                    return _hopf_end(family, now, hopf) or f"shrinks to an equilibrium near {now.value:.6g}"
                if not low <= now.value <= high:
                    return f"reaches {now.value:.6g}"
                if abs(now.value - start.value) < 1e-9 * (high - low) and _is_back(start, now) and len(members) > 3:
                    return "is closed"
                if grows and now.orbit.size > _GROWN * family.size:
                    family, members[-1] = _rescaled(family, now, bounds)
            return f"has {control.most} orbits, the most that were asked for, at {last().value:.6g}"
        except NoStep as failure:
            if last().orbit.size < _SMALL * largest:
                end = _hopf_end(family, last(), hopf)
                if end is not None:
                    return end
            finer = _in_segments(family, last())
            if finer is None:
                return f"ends near {last().value:.10g}: {failure}{near_rest(start.orbit, last().orbit)}"
            family, again = finer
            members[-1:] = [again] if members else []
            start = start if members else again


def _in_segments(family: FamilyEquations, member: FamilyMember) -> tuple[FamilyEquations, FamilyMember] | None:
    """A family shot in more segments, and an orbit of it, if that may lead on."""
    try:
        return family.in_segments(member)
    except PeriodicFailure:
        return None


def _rescaled(
    family: FamilyEquations, now: FamilyMember, bounds: tuple[float, float]
) -> tuple[FamilyEquations, FamilyMember]:
    """Steps measured by an orbit, and that orbit."""
    other = replace(family, scale=scale_of(now.orbit, family.name, bounds))
    here, along = other.member_of(now.orbit), now.tangent * family.scale / other.scale
    return other, here if here.tangent @ along > 0 else replace(here, tangent=-here.tangent)


def _hopf_end(family: FamilyEquations, member: FamilyMember, hopf: list[Hopf], *, strict: bool = False) -> str | None:
    """Why a family ends whose orbits shrink, if there is a Hopf point; that is appended to `hopf`."""
    if family.name is None or family.problem.system.first_integral_program is not None:
        return None
    found = hopf_of_orbit(family.problem, family.name, member.value, member.orbit, strict=strict)
    if found is None:
        return None
    hopf.append(found)
    return f"ends at a Hopf point, {found.value:.15g}"


def near_rest(first: ClosedOrbit, last: ClosedOrbit) -> str:
    """What to say of a family whose last orbit takes much longer than the first, and is slow close to one place."""
    paces = np.linalg.norm(np.diff(last.loop, axis=0), axis=1)
    if last.period < _LONGER * first.period or paces.min() > _SLOW * paces.max():
        return ""
    place = ", ".join(f"{value:.4g}" for value in last.loop[int(np.argmin(paces))])
    return (
        f"; its period has grown to {last.period:.6g}, as towards an orbit homoclinic to an equilibrium near ({place})"
    )


def _share(start: float, now: float, bounds: tuple[float, float], orbits: float) -> float:
    """How much of a family is done, as if it went straight to the end of the interval."""
    end = bounds[1] if now > start else bounds[0]
    way = abs(end - start)
    return min(0.99, max(orbits, abs(now - start) / way if way > 0 else 0.0))


def _is_back(start: FamilyMember, now: FamilyMember) -> bool:
    return bool(np.max(np.abs(start.orbit.point - now.orbit.point)) < 1e-6 * start.orbit.size)


def family_described(family: PeriodicFamily) -> list[str]:
    """A family in lines."""
    first, last = family.members[0], family.members[-1]
    lines = [
        f"family in {family.name}: {len(family.members)} orbits from {first.value:.10g} to {last.value:.10g}; "
        f"it {family.reason}"
    ]
    if family.born is not None:
        lines[0] = f"born at the {family.born.kind} at {family.name} = {family.born.value:.10g}: {lines[0]}"
    names = family.problem.system.given_state
    for each in family.bifurcations:
        orbit, value = each.member.orbit, each.multiplier
        shown = f"{value.real:.8g}" if is_real(value) else f"{value.real:.8g} + {abs(value.imag):.8g}i"
        under = "" if each.symmetry is None else f", symmetry {each.symmetry.described(names)}"
        lines.append(
            f"  {each.kind}: {family.name} = {each.member.value:.10g}, period {orbit.period:.10g}, multiplier {shown}"
            f"{under}"
        )
        if each.is_double:
            lines.append(
                "    two multipliers meet the circle at once, as a symmetry makes them; "
                "claims are of one that meets it alone"
            )
    for point in family.hopf:
        lines += hopf_described(point)
    return lines


def family_as_json(family: PeriodicFamily) -> dict[str, Any]:
    """A family for programs; its orbits are in the files."""
    names = family.problem.system.given_state
    return {
        "family": family.name,
        "orbits": len(family.members),
        "first": family.members[0].value,
        "last": family.members[-1].value,
        "ends": family.reason,
        "born": None if family.born is None else {"kind": family.born.kind, "value": family.born.value},
        "hopf": [hopf_as_json(each) for each in family.hopf],
        "bifurcations": [
            {
                "kind": each.kind,
                "value": each.member.value,
                "period": each.member.orbit.period,
                "point": dict(zip(names, each.member.orbit.point, strict=True)),
                "multiplier": complex(each.multiplier),
                "double": each.is_double,
            }
            for each in family.bifurcations
        ],
    }


def family_csv(family: PeriodicFamily) -> str:
    """The orbits of a family as a table, an orbit a line, in order along the family."""
    system = family.problem.system
    count = max(len(each.orbit.multipliers) for each in family.members)
    head = [*told_apart((family.name.replace(",", " "), "period"), system.given_state), *system.given_state]
    head += [f"multiplier{number} {part}" for number in range(1, count + 1) for part in ("real", "imaginary")]
    rows = [",".join(head)]
    for each in family.members:
        numbers = [each.value, each.orbit.period, *each.orbit.point]
        for value in each.orbit.multipliers:
            numbers += [value.real, value.imag]
        rows.append(",".join(repr(float(number)) for number in numbers))
    return "\n".join(rows) + "\n"
