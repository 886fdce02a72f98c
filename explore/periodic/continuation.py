"""Families of periodic orbits without symmetry: continuation in a parameter or the level, bifurcations by multipliers.

Pseudo-arclength continuation in float64. The unknowns are the point, the period and the parameter; without a parameter,
for a system with a first integral, the family is that over its levels. Multipliers are followed one by one from
orbit to orbit; where one of them, or a pair, meets the unit circle the step is bisected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem, multipliers
from orbitproof.explore.periodic.flow import Matrix, Vector, arc_of

FOLD, BRANCH, DOUBLING, TORUS = "fold", "branch point", "period doubling", "Neimark-Sacker"

_NEWTON_STEPS = 8
_TOLERANCE = 1e-10
_STALLED = 1e-7
_FARTHEST = 0.5
"""A point moves at most so far in a step, relative to the size of its orbit."""
_SHRUNK = 1e-2
"""Of its size at the beginning, that of an orbit close to an equilibrium."""
_BISECTIONS = 40
_RESOLUTION = 1e-9
_REAL = 1e-7
"""An imaginary part below this, relative to the multiplier, is rounding."""


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
class FamilyMember:
    """One orbit of a family: the orbit, the value of the parameter or level, and the tangent of the family there."""

    orbit: ClosedOrbit
    value: float
    tangent: Vector


@dataclass(frozen=True)
class Bifurcation:
    """Where multipliers meet the unit circle, in float64.

    Attributes:
        kind: `FOLD`: the family turns back in the parameter; `BRANCH`: a multiplier is 1 and it does not, as at a
            pitchfork or where two families cross; `DOUBLING`: a multiplier is -1; `TORUS`: a complex pair.
        member: the orbit there.
        multiplier: the one that meets the circle.
    """

    kind: str
    member: FamilyMember
    multiplier: complex


@dataclass(frozen=True)
class PeriodicFamily:
    """A family of periodic orbits.

    Attributes:
        name: of the parameter, or that of the first integral.
        members: in order along the family.
        bifurcations: in the same order.
        reason: why it ends.
    """

    problem: PeriodicProblem
    name: str
    members: tuple[FamilyMember, ...]
    bifurcations: tuple[Bifurcation, ...]
    reason: str


@dataclass(frozen=True)
class _Family:
    """The equations of a family.

    Attributes:
        place: of the parameter among all; `None` for the level of the first integral.
        scale: shape of the unknowns (N, 1 and, with a parameter, 1 more), in which steps are measured.
        level: of the first integral, if the parameter is another one.
    """

    problem: PeriodicProblem
    place: int | None
    scale: Vector
    level: float | None

    def values(self, z: Vector) -> Vector:
        """All parameters at the unknowns z."""
        values = self.problem.values
        if self.place is not None:
            values[self.place] = z[-1]
        return values

    def equations(self, z: Vector, phase: tuple[Vector, Vector]) -> tuple[Vector, Matrix, ClosedOrbit]:
        """What is zero on the family, its derivatives by z / scale, and the orbit, for what it is worth."""
        normal, origin = phase
        n = len(normal)
        x, time, values = z[:n], float(z[n]), self.values(z)
        arc = arc_of(self.problem.system, x, time, values)
        columns = [arc.by_state - np.eye(n), arc.velocity[:, None]]
        if self.place is not None:
            columns.append(arc.by_parameters[:, [self.place]])
        rows = [np.hstack(columns), np.append(normal, np.zeros(len(z) - n))[None]]
        residual = [arc.end - x, [normal @ (x - origin)]]
        if self.level is not None:
            by_state, by_values = self.problem.level_slopes(x, values)
            assert self.place is not None
            rows.append(np.concatenate([by_state, [0.0], [by_values[self.place]]])[None])
            residual.append([(self.problem.level(x, values) or 0.0) - self.level])
        found = multipliers(self.problem, x, arc, values)
        orbit = ClosedOrbit(x, time, values, arc, self.problem.level(x, values), found, 0.0)
        size = np.concatenate([self.scale[:n] ** -1, [1.0] * (len(np.concatenate(residual)) - n)])
        return size * np.concatenate(residual), size[:, None] * np.vstack(rows) * self.scale, orbit

    def phase(self, orbit: ClosedOrbit) -> tuple[Vector, Vector]:
        """The plane across the flow at the orbit's point."""
        velocity = orbit.arc.velocity
        return velocity / (np.linalg.norm(velocity) * self.scale[0]), orbit.point

    def member(self, z: Vector, orbit: ClosedOrbit, matrix: Matrix, along: Vector | None) -> FamilyMember:
        """With the tangent in the direction of `along`."""
        tangent = np.linalg.svd(matrix)[2][-1]
        if along is not None and tangent @ along < 0:
            tangent = -tangent
        value = float(z[-1]) if self.place is not None else float(orbit.level or 0.0)
        return FamilyMember(orbit, value, tangent)

    def corrected(self, before: FamilyMember, length: float) -> FamilyMember:
        """The orbit so far along the family. Raises `PeriodicFailure`."""
        start = self.unknowns(before)
        phase, predicted = self.phase(before.orbit), start + length * before.tangent * self.scale
        z, last = predicted.copy(), np.inf
        try:
            for _ in range(_NEWTON_STEPS):
                residual, matrix, orbit = self.equations(z, phase)
                here = before.tangent @ ((z - predicted) / self.scale)
                step = -np.linalg.lstsq(np.vstack([matrix, before.tangent]), np.append(residual, here), rcond=None)[0]
                z = z + step * self.scale
                size = float(np.max(np.abs(step)))
                if not np.isfinite(size) or size > 10 * abs(length) + 1e-3 or not z[len(phase[0])] > 0:
                    break
                # A step that is hardly shorter than the one before is rounding.
                if size < _TOLERANCE or (size < _STALLED and size > last / 4):
                    residual, matrix, orbit = self.equations(z, phase)
                    return self.member(z, replace(orbit, error=size), matrix, before.tangent)
                last = size
        except (FlowFailure, np.linalg.LinAlgError) as failure:
            raise PeriodicFailure(str(failure)) from None
        raise PeriodicFailure("Newton's method does not converge")

    def unknowns(self, member: FamilyMember) -> Vector:
        """z of an orbit."""
        z = np.append(member.orbit.point, member.orbit.period)
        return z if self.place is None else np.append(z, member.orbit.values[self.place])


def continue_orbit(
    problem: PeriodicProblem,
    orbit: ClosedOrbit,
    name: str | None,
    bounds: tuple[float, float],
    control: StepControl | None = None,
    progress: Callable[[float], None] | None = None,
) -> PeriodicFamily:
    """The family of an orbit in a parameter, or over the levels of the first integral, both ways.

    Arguments:
        name: of the parameter; `None` for the level.
        bounds: its least and greatest value; the family ends with the first orbit beyond.

    Raises `PeriodicFailure` if the family has no first step.
    """
    control = control or StepControl()
    place = None if name is None else list(problem.system.parameters).index(name)
    has_level = problem.system.first_integral_program is not None
    if name is None and not has_level:
        raise PeriodicFailure(f"{problem.system.name} has no first integral; give a parameter")
    width = bounds[1] - bounds[0]
    scale = np.concatenate([np.full(len(orbit.point), orbit.size), [orbit.period], [] if place is None else [width]])
    level = orbit.level if has_level and place is not None else None
    family = _Family(problem, place, scale, level)
    z = np.append(orbit.point, orbit.period)
    z = z if place is None else np.append(z, orbit.values[place])
    _, matrix, again = family.equations(z, family.phase(orbit))
    first = family.member(z, again, matrix, None)
    halves = []
    for sign in (-1.0, 1.0):
        start = replace(first, tangent=sign * first.tangent)
        halves.append(_traced(family, start, bounds, control, progress))
    (back, back_found, back_reason), (ahead, found, reason) = halves
    turned = [replace(member, tangent=-member.tangent) for member in reversed(back)]
    members = (*turned, first, *ahead)
    called = name or problem.system.first_integral_name or "first integral"
    reasons = f"{back_reason}; {reason}"
    return PeriodicFamily(problem, called, members, (*reversed(back_found), *found), reasons)


def _traced(
    family: _Family,
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
        except PeriodicFailure as failure:
            length /= 2
            if length < control.smallest:
                return members[1:], found, f"ends near {before.value:.10g}: {failure}"
            continue
        found += _between(family, before, now, length)
        members.append(now)
        if progress is not None:
            progress(len(members) / control.most)
        if now.orbit.size < _SHRUNK * family.scale[0]:
            return members[1:], found, f"shrinks to an equilibrium near {now.value:.6g}"
        if not low <= now.value <= high:
            return members[1:], found, f"reaches {now.value:.6g}"
        if abs(now.value - start.value) < 1e-9 * (high - low) and _is_back(start, now) and len(members) > 4:
            return members[1:], found, "is closed"
        before = now
        length = min(control.largest, length * (1.4 if angle < control.turning / 3 else 1.0))
    return members[1:], found, f"has {control.most} orbits, the most that were asked for, at {before.value:.6g}"


def _is_back(start: FamilyMember, now: FamilyMember) -> bool:
    return bool(np.max(np.abs(start.orbit.point - now.orbit.point)) < 1e-6 * start.orbit.size)


Test = Callable[[FamilyMember], float]


def _between(family: _Family, before: FamilyMember, now: FamilyMember, length: float) -> Iterator[Bifurcation]:
    """Bifurcations on one step: each test that changes its sign, bisected."""
    conservative = family.problem.system.first_integral_program is not None
    turns = family.place is not None and before.tangent[-1] * now.tangent[-1] < 0
    if turns:
        try:
            member = _zero(family, before, length, lambda each: float(each.tangent[-1]))
        except PeriodicFailure:
            member = now
        yield Bifurcation(FOLD, member, _nearest(member.orbit.multipliers, 1.0))
    taken: set[str] = {FOLD} if turns else set()
    pairs = _followed(before.orbit.multipliers, now.orbit.multipliers)
    for old, new in pairs:
        for kind, goal in _crossed(old, new, conservative):
            if kind == BRANCH and FOLD in taken:
                continue
            if kind in taken and (kind == TORUS or conservative):
                continue
            taken.add(kind)
            test = _test(kind, old, conservative)
            try:
                member = _zero(family, before, length, test)
            except PeriodicFailure:
                member = now
            near = _nearest(member.orbit.multipliers, goal) if goal is not None else _on_circle(member)
            yield Bifurcation(kind, member, near)


def _followed(old: Vector, new: Vector) -> list[tuple[complex, complex]]:
    """Each multiplier with the one that it becomes."""
    if not len(old):
        return []
    sizes = 1 + np.abs(old)[:, None] + np.abs(new)[None]
    rows, columns = linear_sum_assignment(np.abs(old[:, None] - new[None]) / sizes)
    return [(complex(old[i]), complex(new[j])) for i, j in zip(rows, columns, strict=True)]


def _is_real(value: complex) -> bool:
    return abs(value.imag) <= _REAL * max(1.0, abs(value))


def _half_trace(value: complex) -> complex:
    """(mu + 1/mu)/2, which is real for real multipliers and for those on the circle."""
    return (value + 1 / value) / 2 if value else complex(np.inf)


def _crossed(old: complex, new: complex, conservative: bool) -> Iterator[tuple[str, complex | None]]:
    """Which test changes its sign from one multiplier to the next, and where it meets the circle."""
    if conservative:
        left, right = _half_trace(old), _half_trace(new)
        if _is_real(left) and _is_real(right):
            for kind, goal in ((BRANCH, 1.0), (DOUBLING, -1.0)):
                if (left.real - goal) * (right.real - goal) < 0:
                    yield kind, goal
        return
    if _is_real(old) and _is_real(new):
        for kind, goal in ((BRANCH, 1.0), (DOUBLING, -1.0)):
            if (old.real - goal) * (new.real - goal) < 0:
                yield kind, goal
    elif not _is_real(old) and not _is_real(new) and (abs(old) - 1) * (abs(new) - 1) < 0:
        yield TORUS, None


def _test(kind: str, near: complex, conservative: bool) -> Test:
    """A function of the orbit with a zero where a multiplier that is near another one meets the circle."""

    def test(member: FamilyMember) -> float:
        nonlocal near
        found = member.orbit.multipliers
        near = complex(found[int(np.argmin(np.abs(found - near) / (1 + np.abs(found))))])
        if kind == TORUS:
            return abs(near) - 1
        value = _half_trace(near) if conservative else near
        return value.real - (1.0 if kind == BRANCH else -1.0)

    return test


def _zero(family: _Family, before: FamilyMember, length: float, test: Test) -> FamilyMember:
    """The orbit on a step at which a test changes its sign."""
    low, high, member = 0.0, length, before
    sign = test(before)
    for _ in range(_BISECTIONS):
        if high - low < _RESOLUTION * length:
            break
        middle = (low + high) / 2
        member = family.corrected(before, middle)
        if test(member) * sign > 0:
            low = middle
        else:
            high = middle
    return member


def _nearest(found: Vector, goal: complex) -> complex:
    return complex(found[int(np.argmin(np.abs(found - goal)))]) if len(found) else complex(np.nan)


def _on_circle(member: FamilyMember) -> complex:
    found = member.orbit.multipliers
    return complex(found[int(np.argmin(np.abs(np.abs(found) - 1)))])


def family_described(family: PeriodicFamily) -> list[str]:
    """A family in lines."""
    first, last = family.members[0], family.members[-1]
    lines = [
        f"family in {family.name}: {len(family.members)} orbits from {first.value:.10g} to {last.value:.10g}; "
        f"it {family.reason}"
    ]
    for each in family.bifurcations:
        orbit, value = each.member.orbit, each.multiplier
        shown = f"{value.real:.8g}" if _is_real(value) else f"{value.real:.8g} + {abs(value.imag):.8g}i"
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
