"""Bifurcations between two neighbours of a family: multipliers followed one by one to the unit circle, in float64."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem, correct
from orbitproof.explore.periodic.family import FamilyEquations, FamilyMember
from orbitproof.explore.periodic.flow import Vector, arc_of
from orbitproof.explore.periodic.symmetries import Symmetry, invariance

FOLD, BRANCH, DOUBLING, TORUS = "fold", "branch point", "period doubling", "Neimark-Sacker"
PITCHFORK = "pitchfork"

_RESOLUTION = 1e-9
_REAL = 1e-7
"""An imaginary part below this, relative to the multiplier, is rounding."""
_ON_CIRCLE = 1e-6
"""A distance from the unit circle that is rounding."""
_FARTHEST = 0.2
"""Multipliers move at most so far from orbit to orbit, relative to their sizes, where they are followed."""
_ZERO = 1e-6
"""Gaps below this, relative to the size of the orbit, are rounding."""
_TOGETHER = 1e-4
"""Multipliers that differ by less where one of them meets the circle do so together."""
_FLAT = 1e-10
"""A rate at which a parameter of a family shot in segments changes no more than by rounding, in the units of steps."""
_FLIP = 1e-2
_NEARBY, _SECANTS = 1e-4, 6
_SINGULAR = 1e-4
"""Singular values below this part of the largest are those of two families that cross."""

Test = Callable[[FamilyMember], float]


class _OfKind(NamedTuple):
    sign: int
    times: int
    has_new_orbits: bool


_OF_KINDS = {
    FOLD: _OfKind(1, 1, False),
    DOUBLING: _OfKind(-1, 2, True),
    TORUS: _OfKind(-1, 1, False),
    PITCHFORK: _OfKind(-1, 1, True),
    BRANCH: _OfKind(-1, 1, False),
}
"""What differs from kind to kind, as properties of `Bifurcation` tell it."""


@dataclass(frozen=True)
class Bifurcation:
    """Where multipliers meet the unit circle, in float64.

    Attributes:
        kind: `FOLD`: the family turns back in the parameter; `DOUBLING`: a multiplier is -1; `TORUS`: a complex pair;
            `PITCHFORK`: a multiplier is 1, and -1 for the return map followed by a symmetry of the orbit; `BRANCH`: a
            multiplier is 1 for another reason, as where two families cross.
        member: the orbit there.
        multiplier: the one that meets the circle.
        problem: the system with its parameters; that of `name` is the orbit's.
        name: of the parameter that varies; `None` for the level of the first integral.
        level: of the first integral where a parameter varies on it; exact.
        symmetry: of a pitchfork.
        parts: 2 if the symmetry maps the orbit to itself half a period later, else 1.
        ends: whether the family that was followed is that of the new orbits, which begins here.
        is_double: whether two multipliers meet the circle there at once, as those of systems with many symmetries do.
    """

    kind: str
    member: FamilyMember
    multiplier: complex
    problem: PeriodicProblem
    name: str | None
    level: Fraction | None = None
    symmetry: Symmetry | None = None
    parts: int = 1
    ends: bool = False
    is_double: bool = False

    @property
    def value(self) -> float:
        """Parameter, or level of the first integral, at which the bifurcation lies."""
        return self.member.value

    @property
    def is_torus(self) -> bool:
        """Whether a complex pair meets the circle."""
        return self.kind == TORUS

    @property
    def sign(self) -> int:
        """The multiplier, of a pitchfork that of the map followed by the symmetry, where it is real."""
        return _OF_KINDS[self.kind].sign

    @property
    def has_new_orbits(self) -> bool:
        """Whether one family of new orbits is known to begin there."""
        return _OF_KINDS[self.kind].has_new_orbits

    @property
    def times(self) -> int:
        """How many periods of the old orbit one of a new one is near."""
        return _OF_KINDS[self.kind].times


class UnresolvedError(Exception):
    """The multipliers moved too far to be followed; a shorter step may do."""


@dataclass(frozen=True)
class Passage:
    """What lies between two neighbours.

    Attributes:
        bifurcations: in order of their detection.
        end: why the family ends here; `None` where it goes on.
    """

    bifurcations: list[Bifurcation]
    end: str | None = None


def passage(family: FamilyEquations, before: FamilyMember, now: FamilyMember, length: float, patient: bool) -> Passage:
    """The bifurcations on one step.

    Arguments:
        length: of the step from one orbit to the next.
        patient: whether a shorter step is possible: then `UnresolvedError` is raised where it is needed.
    """
    crossed = list(_crossings(before, now, family.conservative))
    if patient:
        _check_resolved(before, now, crossed, family.conservative)
    found: list[Bifurcation] = []
    rates, turning = (family.rate(before), family.rate(now)), family.rate
    turns = rates[0] * rates[1] < 0
    if family.segments > 1 and max(map(abs, rates)) < _FLAT:
        # The parameter changes by rounding alone, as on canards: multipliers tell.
        over_one = [old for kind, _, old in crossed if kind == BRANCH]
        turns, turning = bool(over_one), _test(BRANCH, over_one[0] if over_one else 1.0, family.conservative)
    if turns:
        birth = _birth(family, before, now, length)
        if birth is not None:
            return Passage([birth], "ends where its orbits are born from " + _PARENT[birth.kind])
        member = _located(family, before, now, length, turning)
        found.append(_bifurcation(family, FOLD, member, _nearest(member.orbit.multipliers, 1.0)))
    taken = {each.kind for each in found}
    for kind, goal, old in crossed:
        if (kind == BRANCH and FOLD in taken) or (kind in taken and (kind == TORUS or family.conservative)):
            continue
        taken.add(kind)
        test = _test(kind, old, family.conservative)
        pitchfork = _pitchfork(family, before, now, length, test) if kind == BRANCH else None
        if pitchfork is not None:
            found.append(pitchfork)
            continue
        member = _located(family, before, now, length, test)
        near = _nearest(member.orbit.multipliers, goal) if goal is not None else _on_circle(member)
        found.append(_bifurcation(family, kind, member, near))
    return Passage(_without_doubles(found, family.conservative))


def _without_doubles(found: list[Bifurcation], conservative: bool) -> list[Bifurcation]:
    """Bifurcations, those at which two multipliers meet the circle at once told once and as such."""
    result: list[Bifurcation] = []
    for each in found:
        near = np.abs(each.member.orbit.multipliers - each.multiplier) < _TOGETHER
        # With a first integral multipliers come in pairs, which meet at 1 and -1.
        is_double = bool(np.sum(near) > (2 if conservative else 1))
        if not (is_double and any(_is_one(each, other) for other in result)):
            result.append(replace(each, is_double=is_double))
    return result


def _is_one(left: Bifurcation, right: Bifurcation) -> bool:
    """Whether two bifurcations of one step are one: orbits and multipliers agree."""
    near = (
        float(np.max(np.abs(left.member.orbit.point - right.member.orbit.point))) < _TOGETHER * left.member.orbit.size
    )
    return near and left.kind == right.kind and abs(left.multiplier - right.multiplier) < _TOGETHER


_PARENT = {DOUBLING: "those of half the period", PITCHFORK: "those with a symmetry"}


def _bifurcation(family: FamilyEquations, kind: str, member: FamilyMember, multiplier: complex) -> Bifurcation:
    return Bifurcation(kind, member, multiplier, family.problem, family.name, family.level)


def _check_resolved(
    before: FamilyMember, now: FamilyMember, crossed: list[tuple[str, float | None, complex]], conservative: bool
) -> None:
    """Multipliers moved little, and those that were found to cross the circle are all that did."""
    old, new = before.orbit.multipliers, now.orbit.multipliers
    for left, right in followed_one_by_one(old, new):
        if abs(left - right) > _FARTHEST * (1 + abs(left) + abs(right)):
            raise UnresolvedError
    # Multipliers that stay on the circle are on both sides of it by rounding.
    if not conservative and not np.any(np.abs(np.abs(np.concatenate([old, new])) - 1) < _ON_CIRCLE):
        outward = {True: 1, False: -1}
        change = sum((2 if kind == TORUS else 1) * outward[abs(each) < 1] for kind, _, each in crossed)
        if int(np.sum(np.abs(new) > 1)) - int(np.sum(np.abs(old) > 1)) != change:
            raise UnresolvedError


def followed_one_by_one(old: Vector, new: Vector) -> list[tuple[complex, complex]]:
    """Each multiplier with the one that it becomes."""
    # Only now: scipy takes a moment to load.
    from scipy.optimize import linear_sum_assignment

    if not len(old):
        return []
    sizes = 1 + np.abs(old)[:, None] + np.abs(new)[None]
    rows, columns = linear_sum_assignment(np.abs(old[:, None] - new[None]) / sizes)
    return [(complex(old[i]), complex(new[j])) for i, j in zip(rows, columns, strict=True)]


def is_real(value: complex) -> bool:
    """Up to rounding."""
    return abs(value.imag) <= _REAL * max(1.0, abs(value))


def _half_trace(value: complex) -> complex:
    """(mu + 1/mu)/2, which is real for real multipliers and for those on the circle."""
    return (value + 1 / value) / 2 if value else complex(np.inf)


def _crossings(
    before: FamilyMember, now: FamilyMember, conservative: bool
) -> Iterator[tuple[str, float | None, complex]]:
    """Which multipliers cross the circle: the kind, where they meet it, and which one before."""
    for old, new in followed_one_by_one(before.orbit.multipliers, now.orbit.multipliers):
        left, right = (_half_trace(old), _half_trace(new)) if conservative else (old, new)
        if is_real(left) and is_real(right):
            for kind, goal in ((BRANCH, 1.0), (DOUBLING, -1.0)):
                if (left.real - goal) * (right.real - goal) < 0:
                    yield kind, goal, old
        elif not (conservative or is_real(old) or is_real(new)) and old.imag > 0:
            inner, outer = sorted((abs(old) - 1, abs(new) - 1))
            if inner < 0 < outer and outer - inner > _ON_CIRCLE:
                yield TORUS, None, old


def _test(kind: str, near: complex, conservative: bool) -> Test:
    """A function of the orbit with a zero where a multiplier that is near another one meets the circle."""

    def test(member: FamilyMember) -> float:
        found = member.orbit.multipliers
        here = complex(found[int(np.argmin(np.abs(found - near) / (1 + np.abs(found))))])
        if kind == TORUS:
            return abs(here) - 1
        value = _half_trace(here) if conservative else here
        return value.real - (1.0 if kind == BRANCH else -1.0)

    return test


def _located(
    family: FamilyEquations, before: FamilyMember, now: FamilyMember, length: float, test: Test
) -> FamilyMember:
    """The orbit on a step at which a test changes its sign; the end of the step if it cannot be reached."""
    # Only now: scipy takes a moment to load.
    from scipy.optimize import brentq

    known = {0.0: before, length: now}

    def value(place: float) -> float:
        if place not in known:
            try:
                known[place] = family.corrected(before, place)
            except PeriodicFailure:
                known[place] = family.corrected(before, place, _SINGULAR)
        return test(known[place])

    try:
        return known[brentq(value, 0.0, length, xtol=_RESOLUTION * length, rtol=1e-15)]
    except (PeriodicFailure, ValueError, KeyError):
        return min(known.values(), key=lambda each: abs(test(each)))


def _pitchfork(
    family: FamilyEquations, before: FamilyMember, now: FamilyMember, length: float, test: Test
) -> Bifurcation | None:
    """The pitchfork on a step, if a symmetry of its orbits takes the direction of the multiplier 1 to its negative."""
    for symmetry in family.symmetries:
        try:
            parts = invariance(family.problem, before.orbit, symmetry)
            if parts is None:
                continue
            member = _located(replace(family, symmetry=symmetry, parts=parts), before, now, length, test)
            if _is_flip(family, member.orbit, symmetry, parts):
                found = _bifurcation(family, PITCHFORK, member, _nearest(member.orbit.multipliers, 1.0))
                return replace(found, symmetry=symmetry, parts=parts)
        except FlowFailure:
            continue
    return None


def _is_flip(family: FamilyEquations, orbit: ClosedOrbit, symmetry: Symmetry, parts: int) -> bool:
    """Whether the flow over the period or half of it, followed by S, has a multiplier near -1."""
    arc = orbit.arc if parts == 1 else arc_of(family.problem.system, orbit.point, orbit.period / 2, orbit.values)
    found = np.linalg.eigvals(symmetry.matrix @ arc.by_state)
    return bool(np.min(np.abs(found + 1)) < _FLIP)


def _birth(family: FamilyEquations, before: FamilyMember, now: FamilyMember, length: float) -> Bifurcation | None:
    """The doubling or pitchfork at which the orbits of a family are born, if this is why it turns back.

    There a point meets the one half a period later, or its mirror image, and passes it.
    """
    ways: list[tuple[Symmetry | None, int]] = [(None, 2)]
    ways += [(symmetry, parts) for symmetry in family.symmetries for parts in (2, 1)]
    for symmetry, parts in ways:

        def gap(member: FamilyMember, symmetry: Symmetry | None = symmetry, parts: int = parts) -> Vector:
            return gap_of(family, member.orbit, symmetry, parts)

        try:
            left, right = gap(before), gap(now)
            sizes = np.linalg.norm(left), np.linalg.norm(right)
            if min(sizes) < _ZERO * before.orbit.size or left @ right > -0.5 * sizes[0] * sizes[1]:
                continue
            axis = left
            member = _located(family, before, now, length, lambda each, axis=axis, gap=gap: float(gap(each) @ axis))
            if symmetry is not None:
                member = _symmetric(replace(family, symmetry=symmetry, parts=parts), member)
                found = _bifurcation(family, PITCHFORK, member, _nearest(member.orbit.multipliers, 1.0))
                return replace(found, symmetry=symmetry, parts=parts, ends=True)
            return replace(_bifurcation(family, DOUBLING, _half(family, member), -1.0), ends=True)
        except (FlowFailure, PeriodicFailure):
            continue
    return None


def gap_of(family: FamilyEquations, orbit: ClosedOrbit, symmetry: Symmetry | None, parts: int) -> Vector:
    """From a point of an orbit to the image of the one half a period later (`parts` = 2), or of itself."""
    end = orbit.point
    if parts == 2:
        end = arc_of(family.problem.system, orbit.point, orbit.period / 2, orbit.values).end
    return (end if symmetry is None else symmetry.matrix @ end) - orbit.point


def _half(family: FamilyEquations, member: FamilyMember) -> FamilyMember:
    """The orbit that a nearby one runs through nearly twice, where its multiplier is -1. Raises `PeriodicFailure`."""
    problem, orbit = family.problem, member.orbit
    if family.name is not None:
        problem = PeriodicProblem(problem.system, {**problem.parameters, family.name: Fraction(member.value)})
    half = correct(problem, orbit.point, orbit.period / 2, None, orbit.level)
    if abs(half.period - orbit.period / 2) > 1e-2 * orbit.period:
        raise PeriodicFailure("there is no orbit of half the period")
    return _polished(family, family.member_of(half), _test(DOUBLING, -1.0, family.conservative))


def _symmetric(family: FamilyEquations, member: FamilyMember) -> FamilyMember:
    """The symmetric orbit with a multiplier 1 near an orbit; that orbit if there is none."""
    try:
        start = family.corrected(family.member_of(member.orbit), 0.0)
        return _polished(family, start, _test(BRANCH, 1.0, family.conservative))
    except PeriodicFailure:
        return member


def _polished(family: FamilyEquations, start: FamilyMember, test: Test) -> FamilyMember:
    """The orbit near one of a family at which a test is 0, by the secant method. Raises `PeriodicFailure`."""
    places, values, best = [0.0, _NEARBY], [test(start)], start
    for _ in range(_SECANTS):
        best = family.corrected(start, places[-1])
        values.append(test(best))
        slope = (values[-1] - values[-2]) / (places[-1] - places[-2])
        change = -values[-1] / slope if slope else 0.0
        if abs(change) < _RESOLUTION or abs(places[-1] + change) > 1e3 * _NEARBY:
            break
        places.append(places[-1] + change)
    return best


def _nearest(found: Vector, goal: complex) -> complex:
    return complex(found[int(np.argmin(np.abs(found - goal)))]) if len(found) else complex(np.nan)


def _on_circle(member: FamilyMember) -> complex:
    found = member.orbit.multipliers
    return complex(found[int(np.argmin(np.abs(np.abs(found) - 1)))])
