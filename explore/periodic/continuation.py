"""Families of periodic orbits without symmetry: continuation in a parameter or the level, and onto new orbits.

Pseudo-arclength continuation in float64 (`family`); bifurcations on the way are found by `detection`. At a period
doubling or a pitchfork the new orbits can be followed in turn, and those that are born from them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.detection import (
    DOUBLING,
    PITCHFORK,
    Bifurcation,
    UnresolvedError,
    is_real,
    passage,
)
from orbitproof.explore.periodic.family import Family, FamilyMember
from orbitproof.explore.periodic.flow import Vector, arc_of
from orbitproof.explore.periodic.symmetries import Symmetry, linear_symmetries

_FARTHEST = 0.5
"""A point moves at most so far in a step, relative to the size of its orbit."""
_SHRUNK = 1e-2
"""Of its size at the beginning, that of an orbit close to an equilibrium."""
_PATIENCE = 1e-4
"""Steps are not made shorter than this for the sake of multipliers."""
_SAME = 1e-6
"""Two bifurcations are one if parameter and period differ less, relative to their sizes."""


@dataclass(frozen=True)
class StepControl:
    """Steps along a family, in units of its size, period and parameter.

    Attributes:
        initial, smallest, largest: lengths.
        turning: largest angle in radians between tangents of neighbours.
        most: number of orbits.
    """

    initial: float = 0.02
    smallest: float = 1e-7
    largest: float = 0.1
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
    """

    problem: PeriodicProblem
    name: str
    members: tuple[FamilyMember, ...]
    bifurcations: tuple[Bifurcation, ...]
    reason: str
    born: Bifurcation | None = None
    generation: int = 0


def continue_orbit(
    problem: PeriodicProblem,
    orbit: ClosedOrbit,
    name: str | None,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Callable[[float], None] | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
    level: Fraction | None = None,
) -> PeriodicFamily:
    """The family of an orbit in a parameter, or over the levels of the first integral, both ways.

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
    family = Family(problem, name, _scale(orbit, name, bounds), None if name is None else level, symmetries)
    first = family.member_of(orbit)
    halves = []
    for number, sign in enumerate((-1.0, 1.0)):
        start = replace(first, tangent=sign * first.tangent)
        halves.append(_traced(family, start, bounds, control, _part(progress, number, 2)))
    (back, back_found, back_reason), (ahead, found, reason) = halves
    turned = [replace(member, tangent=-member.tangent) for member in reversed(back)]
    members = (*turned, first, *ahead)
    return PeriodicFamily(
        problem, _called(problem, name), members, (*reversed(back_found), *found), f"{back_reason}; {reason}"
    )


def new_orbits(
    bifurcation: Bifurcation,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Callable[[float], None] | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
) -> PeriodicFamily:
    """The family that is born at a period doubling or pitchfork; of a pair of mirror images one.

    Raises `PeriodicFailure` if it cannot be reached.
    """
    if bifurcation.kind not in (DOUBLING, PITCHFORK):
        raise PeriodicFailure(f"no new orbits are looked for at a {bifurcation.kind}")
    control = control or StepControl()
    problem, name, old = bifurcation.problem, bifurcation.name, bifurcation.member.orbit
    times = 2 if bifurcation.kind == DOUBLING else 1
    try:
        arc = arc_of(problem.system, old.point, times * old.period, old.values)
        direction = _new_direction(bifurcation)
        start = replace(old, period=times * old.period, arc=arc)
        if symmetries is None:
            symmetries = linear_symmetries(problem, name)
        family = Family(problem, name, _scale(start, name, bounds), bifurcation.level, symmetries)
        tangent = np.append(direction, np.zeros(len(family.scale) - len(direction)))
        begin = FamilyMember(start, bifurcation.member.value, tangent / np.linalg.norm(tangent))
        length = control.initial
        while True:
            try:
                first = family.corrected(begin, length)
                break
            except PeriodicFailure:
                length /= 2
                if length < _PATIENCE:
                    raise
    except FlowFailure as failure:
        raise PeriodicFailure(str(failure)) from None
    members, found, reason = _traced(family, first, bounds, control, progress)
    return PeriodicFamily(problem, _called(problem, name), (first, *members), tuple(found), reason, bifurcation)


def families(
    problem: PeriodicProblem,
    orbit: ClosedOrbit,
    name: str | None,
    bounds: tuple[float, float],
    generations: int = 0,
    control: StepControl | None = None,
    progress: Callable[[str, float | None], None] | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
    level: Fraction | None = None,
) -> Iterator[PeriodicFamily]:
    """The family of an orbit, then those born at its doublings and pitchforks, so many generations of them.

    A family that cannot be reached is left out. Raises `PeriodicFailure` if the first one has no first step.
    """
    say = progress or (lambda _message, _fraction: None)
    if symmetries is None:
        symmetries = linear_symmetries(problem, name)
    family = continue_orbit(problem, orbit, name, bounds, control, lambda done: say("", done), symmetries, level)
    yield family
    waiting, known = [family], [each for each in family.bifurcations if each.ends]
    while waiting:
        parent = waiting.pop(0)
        if parent.generation == generations:
            continue
        for birth in parent.bifurcations:
            if birth.kind not in (DOUBLING, PITCHFORK) or any(is_same(birth, other) for other in known):
                continue
            known.append(birth)
            say(f"new orbits of the {birth.kind} at {parent.name} = {birth.member.value:.8g}", None)
            try:
                found = new_orbits(birth, bounds, control, lambda done: say("", done), symmetries)
            except PeriodicFailure as failure:
                say(f"no new orbits at {parent.name} = {birth.member.value:.8g}: {failure}", None)
                continue
            known += [each for each in found.bifurcations if each.ends]
            child = replace(found, generation=parent.generation + 1)
            waiting.append(child)
            yield child


def is_same(left: Bifurcation, right: Bifurcation) -> bool:
    """Whether two bifurcations agree in kind, parameter and period, as mirror images do and both ends of a family."""
    near = abs(left.member.value - right.member.value) <= _SAME * max(1.0, abs(right.member.value))
    periods = left.member.orbit.period, right.member.orbit.period
    return left.kind == right.kind and near and abs(periods[0] - periods[1]) <= 10 * _SAME * periods[1]


def _scale(orbit: ClosedOrbit, name: str | None, bounds: tuple[float, float]) -> Vector:
    width = [] if name is None else [bounds[1] - bounds[0]]
    return np.concatenate([np.full(len(orbit.point), orbit.size), [orbit.period], width])


def _called(problem: PeriodicProblem, name: str | None) -> str:
    return name or problem.system.first_integral_name or "first integral"


def _part(progress: Callable[[float], None] | None, number: int, parts: int) -> Callable[[float], None] | None:
    return None if progress is None else lambda done: progress((number + done) / parts)


def _new_direction(bifurcation: Bifurcation) -> Vector:
    """Where the new orbits leave the old one: the direction of the multiplier -1."""
    orbit, system = bifurcation.member.orbit, bifurcation.problem.system
    arc = orbit.arc
    if bifurcation.parts == 2:
        arc = arc_of(system, orbit.point, orbit.period / 2, orbit.values)
    matrix = arc.by_state if bifurcation.symmetry is None else bifurcation.symmetry.matrix @ arc.by_state
    return np.asarray(np.linalg.svd(matrix + np.eye(len(matrix)))[2][-1])


def _traced(
    family: Family,
    start: FamilyMember,
    bounds: tuple[float, float],
    control: StepControl,
    progress: Callable[[float], None] | None,
) -> tuple[list[FamilyMember], list[Bifurcation], str]:
    members, found, before, length = [start], [], start, control.initial
    low, high = bounds
    while len(members) < control.most:
        try:
            now = family.corrected(before, length)
            angle = float(np.arccos(np.clip(now.tangent @ before.tangent, -1, 1)))
            if angle > control.turning:
                raise PeriodicFailure("it turns too fast")
            if np.max(np.abs(now.orbit.point - before.orbit.point)) > _FARTHEST * now.orbit.size:
                raise PeriodicFailure("its orbits shrink to a point")
            passed = passage(family, before, now, length, length > _PATIENCE)
        except (PeriodicFailure, UnresolvedError) as failure:
            length /= 2
            if length < control.smallest:
                return members[1:], found, f"ends near {before.value:.10g}: {failure}"
            continue
        found += passed.bifurcations
        if passed.end is not None:
            return members[1:], found, f"{passed.end}, near {now.value:.8g}"
        members.append(now)
        if progress is not None:
            progress(_share(start.value, now.value, bounds, len(members) / control.most))
        if now.orbit.size < _SHRUNK * family.scale[0]:
            return members[1:], found, f"shrinks to an equilibrium near {now.value:.6g}"
        if not low <= now.value <= high:
            return members[1:], found, f"reaches {now.value:.6g}"
        if abs(now.value - start.value) < 1e-9 * (high - low) and _is_back(start, now) and len(members) > 4:
            return members[1:], found, "is closed"
        before = now
        length = min(control.largest, length * (1.4 if angle < control.turning / 3 else 1.0))
    return members[1:], found, f"has {control.most} orbits, the most that were asked for, at {before.value:.6g}"


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
    for each in family.bifurcations:
        orbit, value = each.member.orbit, each.multiplier
        shown = f"{value.real:.8g}" if is_real(value) else f"{value.real:.8g} + {abs(value.imag):.8g}i"
        lines.append(
            f"  {each.kind}: {family.name} = {each.member.value:.10g}, period {orbit.period:.10g}, multiplier {shown}"
        )
    return lines


def family_csv(family: PeriodicFamily) -> str:
    """The orbits of a family as a table, an orbit a line, in order along the family."""
    system = family.problem.system
    count = max(len(each.orbit.multipliers) for each in family.members)
    head = [family.name.replace(",", " "), "period", *system.state]
    head += [f"multiplier{number} {part}" for number in range(1, count + 1) for part in ("real", "imaginary")]
    rows = [",".join(head)]
    for each in family.members:
        numbers = [each.value, each.orbit.period, *each.orbit.point]
        for value in each.orbit.multipliers:
            numbers += [value.real, value.imag]
        rows.append(",".join(repr(float(number)) for number in numbers))
    return "\n".join(rows) + "\n"
