"""Orbits that are born at period doublings and pitchforks: followed in turn, and those that are born from them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import NoStep, walked
from orbitproof.explore.periodic.continuation import (
    PATIENCE,
    PeriodicFamily,
    StepControl,
    continue_orbit,
    scale_of,
    traced,
)
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.detection import Bifurcation, gap_of, is_real
from orbitproof.explore.periodic.family import FamilyEquations, FamilyMember
from orbitproof.explore.periodic.flow import Vector, arc_of
from orbitproof.explore.periodic.symmetries import Symmetry, linear_symmetries

_SAME = 1e-6
"""Two bifurcations are one if parameter and period differ less, relative to their sizes."""
_NEW = 0.1
"""A new orbit is no old one if it differs from its image by more than this part of the step to it."""


def new_orbits(
    bifurcation: Bifurcation,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
) -> PeriodicFamily:
    """The family that is born at a period doubling or pitchfork; of a pair of mirror images one.

    Raises `PeriodicFailure` if it cannot be reached.
    """
    if not bifurcation.has_new_orbits:
        raise PeriodicFailure(f"no new orbits are looked for at a {bifurcation.kind}")
    control = control or StepControl()
    problem, name, old = bifurcation.problem, bifurcation.name, bifurcation.member.orbit
    times = bifurcation.times
    if symmetries is None:
        symmetries = linear_symmetries(problem, name)
    try:
        start = replace(
            old, period=times * old.period, arc=arc_of(problem.system, old.point, times * old.period, old.values),
            nodes=None,
        )  # fmt: skip
        family = FamilyEquations(problem, name, scale_of(start, name, bounds), bifurcation.level, symmetries)
        begin = FamilyMember(start, bifurcation.member.value, _new_direction(bifurcation, family))
        first = _first(bifurcation, family, begin, control.initial)
    except FlowFailure as failure:
        raise PeriodicFailure(str(failure)) from None
    ahead = traced(family, first, bounds, control, progress)
    return PeriodicFamily(
        problem,
        name,
        (first, *ahead.members),
        tuple(ahead.bifurcations),
        ahead.reason,
        bifurcation,
        interrupted=ahead.interrupted,
    )


def _first(bifurcation: Bifurcation, family: FamilyEquations, begin: FamilyMember, length: float) -> FamilyMember:
    """An orbit that is no old one, not farther than the length. Raises `PeriodicFailure`.

    The new orbits may bifurcate themselves, close to where they are born: one before that is taken if there is one.
    """
    old = 0 if bifurcation.times == 2 else _past_doubling(bifurcation.member.orbit)
    longest: list[FamilyMember] = []
    parts = max(bifurcation.times, bifurcation.parts)

    def attempt(length: float) -> tuple[FamilyMember, float]:
        first = family.corrected(begin, length)
        gap = gap_of(family, first.orbit, bifurcation.symmetry, parts)
        if np.max(np.abs(gap)) < _NEW * length * family.scale[0]:
            raise PeriodicFailure("Newton's method leads back to the old orbits")
        longest.append(first)
        if _past_doubling(first.orbit) != old:
            raise PeriodicFailure("the new orbits are beyond a period doubling of their own")
        return first, length

    try:
        return next(walked(attempt, length, PATIENCE, (PeriodicFailure,)))
    except NoStep as failure:
        if longest:
            return longest[0]
        raise PeriodicFailure(str(failure)) from None


def _past_doubling(orbit: ClosedOrbit) -> int:
    """How many multipliers are real and below -1."""
    return sum(is_real(value) and value.real < -1 for value in orbit.multipliers)


def _new_direction(bifurcation: Bifurcation, family: FamilyEquations) -> Vector:
    """Where the new orbits leave the old ones: the direction of the multiplier -1, across that of the old family.

    Both in the scale of the new family. The map is that of the flow over the old period, or half of it, followed by S.
    """
    orbit, system = bifurcation.member.orbit, bifurcation.problem.system
    arc = arc_of(system, orbit.point, orbit.period / bifurcation.parts, orbit.values)
    matrix = np.eye(len(orbit.point)) if bifurcation.symmetry is None else bifurcation.symmetry.matrix
    n, scale = len(matrix), family.scale
    flow = matrix @ arc.by_state
    vector, velocity = np.linalg.svd(flow + np.eye(n))[2][-1], orbit.arc.velocity
    vector = vector - (velocity @ vector) / (velocity @ velocity) * velocity
    direction = np.append(vector, np.zeros(len(scale) - n))
    # Relative to the period a change of it is the same, once, twice or half through the orbit.
    columns = [(flow - np.eye(n)) * scale[0], (matrix @ arc.velocity)[:, None] * orbit.period / bifurcation.parts]
    if family.place is not None:
        columns.append((matrix @ arc.by_parameters)[:, [family.place]] * scale[-1])
    rows = np.hstack(columns) / scale[0]
    rows = np.vstack([rows, np.append(family.phase(orbit)[0] * scale[0], np.zeros(len(scale) - n))])
    if family.level is not None:
        by_state, by_values = family.problem.level_slopes(orbit.point, orbit.values)
        rows = np.vstack([rows, np.concatenate([by_state * scale[0], [0.0], [by_values[family.place] * scale[-1]]])])
    along = np.linalg.svd(rows)[2][-1]
    direction = direction - (direction @ along) * along
    return np.asarray(direction / np.linalg.norm(direction))


def families(
    problem: PeriodicProblem,
    orbit: ClosedOrbit,
    name: str | None,
    bounds: tuple[float, float],
    generations: int = 0,
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
    level: Fraction | None = None,
) -> Iterator[PeriodicFamily]:
    """The family of an orbit, then those born at its doublings and pitchforks, so many generations of them.

    A family that cannot be reached is left out. Raises `PeriodicFailure` if the first one has no first step.
    """
    if symmetries is None:
        symmetries = linear_symmetries(problem, name)
    family = continue_orbit(problem, orbit, name, bounds, control, progress, symmetries, level)
    yield from with_descendants(family, bounds, generations, control, progress, symmetries)


def with_descendants(
    family: PeriodicFamily,
    bounds: tuple[float, float],
    generations: int = 0,
    control: StepControl | None = None,
    progress: Progress | None = None,
    symmetries: tuple[Symmetry, ...] | None = None,
) -> Iterator[PeriodicFamily]:
    """A family, then those born at its doublings and pitchforks, so many generations of them."""
    say = progress or (lambda _message, _fraction: None)
    yield family
    if family.interrupted:
        return
    waiting, known = [family], [each for each in family.bifurcations if each.ends]
    while waiting:
        parent = waiting.pop(0)
        if parent.generation == generations:
            continue
        for birth in parent.bifurcations:
            if not birth.has_new_orbits or any(is_same(birth, other) for other in known):
                continue
            known.append(birth)
            say(f"new orbits of the {birth.kind} at {parent.name} = {birth.member.value:.8g}", None)
            try:
                found = new_orbits(birth, bounds, control, progress, symmetries)
            except PeriodicFailure as failure:
                say(f"no new orbits at {parent.name} = {birth.member.value:.8g}: {failure}", None)
                continue
            known += [each for each in found.bifurcations if each.ends]
            child = replace(found, generation=parent.generation + 1)
            waiting.append(child)
            yield child
            if child.interrupted:
                return


def is_same(left: Bifurcation, right: Bifurcation) -> bool:
    """Whether two bifurcations agree in kind, parameter and period, as mirror images do and both ends of a family."""
    near = abs(left.member.value - right.member.value) <= _SAME * max(1.0, abs(right.member.value))
    periods = left.member.orbit.period, right.member.orbit.period
    return left.kind == right.kind and near and abs(periods[0] - periods[1]) <= 10 * _SAME * periods[1]
