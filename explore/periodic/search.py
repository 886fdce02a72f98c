"""Periodic orbits of any system, from a guess or by following an orbit, up to claims for the verifier."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import floor, isfinite, log, log10, pi
from typing import Any

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.periodic.births import families
from orbitproof.explore.periodic.continuation import PeriodicFamily, StepControl
from orbitproof.explore.periodic.correction import (
    ClosedOrbit,
    PeriodicFailure,
    PeriodicProblem,
    correct_in_segments,
)
from orbitproof.explore.periodic.flow import (
    arc_of,
    growth_in_frames,
    growth_of_bounds,
    preserves_volume,
    velocity_at,
)
from orbitproof.explore.periodic.nearly import equilibrium_of, follow, nearby_orbits, recurrences
from orbitproof.explore.periodic.refinement import GROWTH_ALLOWED, PeriodicTask, digits_of_centre, refine_periodic
from orbitproof.explore.periodic.section import AffineSection, sections, through_the_middle
from orbitproof.explore.periodic.symmetries import Symmetry, is_symmetry
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.shared.printed_tables import aligned
from orbitproof.shared.systems import FORCE_AT_START, System
from orbitproof.shared.wording import counted

FOLLOWED = 100.0
"""Time for which an orbit is followed if nothing else is said."""
_SAMPLED = 4000
_LEVEL_DIGITS = 12
_WORTH_TELLING = 0.01
_ROUNDING = 1e-12
"""Error of multipliers, relative to the derivatives of the flow over a period."""
_TOLD = 3
_FEW = 10.0
"""Bounds that may grow by fewer digits need no closer look."""
_EVERY = 16
"""Every so many states of an orbit tell how bounds grow along it."""


@dataclass(frozen=True)
class PeriodicRequest:
    """What to look for.

    Attributes:
        parameters: all of the system's, exact.
        start: shape (N,), where to begin, without coordinates that are functions of others.
        period: near that of the orbit; `None`: the orbit of the start is followed until it nearly repeats.
        section: `None` for one that suits the orbit.
        level: of the first integral, exact; `None` for that of the start, to 12 digits.
        returns: largest number of crossings of the section within a period, if the orbit is followed.
        transient, followed: for how long it is followed before and while it is looked at.
    """

    system: System
    parameters: Mapping[str, Fraction]
    start: tuple[float, ...]
    period: float | None = None
    section: AffineSection | None = None
    level: Fraction | None = None
    returns: int = 1
    transient: float = 0.0
    followed: float = FOLLOWED


@dataclass(frozen=True, repr=False)
class FoundOrbit:
    """A periodic orbit in float64, with the section in which it is to be claimed.

    Attributes:
        orbit: its point lies on the section, where it is crossed in the direction.
        crossings: of the section in the direction within a period.
        level: exact, of the first integral; `None` without one.
    """

    problem: PeriodicProblem
    orbit: ClosedOrbit
    section: AffineSection
    crossings: int
    level: Fraction | None

    def __repr__(self) -> str:
        return "\n".join(described(self))

    def task(self, name: str, digits: int) -> PeriodicTask:
        """What there is to refine."""
        return PeriodicTask(
            name, self.problem.system, self.problem.parameters, self.section, self.crossings,
            tuple(map(float, self.orbit.point)), self.orbit.period, self.level, max(digits, self._digits_of_box()), {},
        )  # fmt: skip

    @cached_property
    def growth(self) -> float:
        """By how many digits bounds of errors may grow over the period; 0 where that is not known."""
        orbit, system = self.orbit, self.problem.system
        states = orbit.loop[::_EVERY]
        rate = growth_of_bounds(system, states, orbit.values)
        digits = rate * orbit.period / log(10) if isfinite(rate) else 0.0
        if digits > _FEW and not preserves_volume(system, states, orbit.values):
            digits = min(digits, growth_in_frames(system, orbit.loop, orbit.period, orbit.values))
        return digits

    def _digits_of_box(self) -> int:
        """Digits of the centre with which derivatives are known over its box: bounds of errors grow along the orbit."""
        return digits_of_centre(self.growth)


class FoundOrbits(list[FoundOrbit]):
    """Periodic orbits in the order in which they were found; it prints as a table."""

    def __repr__(self) -> str:
        rows = [("", "period", "crossings", "largest multiplier", "point")]
        for place, found in enumerate(self):
            point = ", ".join(f"{value:.7g}" for value in found.orbit.point)
            shown = _multipliers(found.orbit)
            rows.append((f"[{place}]", f"{found.orbit.period:.10g}", f"{found.crossings}", shown[0], point))
        return "\n".join(aligned(rows)) if self else "no orbits"


class AtRest(PeriodicFailure):
    """The orbit that was followed comes to rest.

    Attributes:
        point: shape (N,), close to the equilibrium.
    """

    def __init__(self, line: str, point: np.ndarray) -> None:
        super().__init__(line)
        self.point = point


def _refuse_steady(system: System, velocity: Sequence[float]) -> None:
    """Raise `PeriodicFailure` if a coordinate has a rate that never changes: it does not come back."""
    for name, output, rate in zip(system.given_state, system.program.outputs, velocity, strict=False):
        if rate and not {*replace(system.program, outputs=(output,)).used_inputs} & {*system.state}:
            remedy = "a force is F*cos(r*t), with the time t that is no coordinate (docs/how-to/forced-systems.md)"
            raise PeriodicFailure(f"{name} has the rate {rate:.6g} everywhere, so that no orbit is periodic; {remedy}")


def find_periodic(request: PeriodicRequest, progress: Progress) -> Iterator[FoundOrbit]:
    """The periodic orbits that are found, one after another. Raises `PeriodicFailure` if there is none."""
    problem = PeriodicProblem(request.system, request.parameters)
    try:
        _refuse_steady(problem.system, velocity_at(problem.system, request.start, problem.values))
        level = _level(problem, request)
    except FlowFailure as failure:
        raise PeriodicFailure(str(failure)) from None
    value = None if level is None else float(level)
    if request.period is not None:
        progress("Newton's method", None)
        try:
            loop = arc_of(problem.system, request.start, request.period, problem.values).samples
        except FlowFailure as failure:
            raise PeriodicFailure(str(failure)) from None
        orbit = correct_in_segments(problem, loop, request.period, None, value)
        yield _claimed(problem, orbit, request.section, level)
        return
    x: Sequence[float] = request.start
    if request.transient > 0:
        states, _ = follow(problem, x, request.transient, lambda done: progress("transient", done))
        x = states[-1]
    states, times = follow(problem, x, request.followed, lambda done: progress("following", done))
    section = request.section or through_the_middle(states)
    at_rest = equilibrium_of(states)
    if at_rest is not None:
        place = ", ".join(
            f"{name} = {value:.6g}" for name, value in zip(problem.system.given_state, at_rest, strict=True)
        )
        remedy = "begin elsewhere, or choose parameters at which it is not stable"
        more = "orbitproof explore equilibria --along finds where it loses stability, and the orbits born there"
        raise AtRest(f"the orbit comes to rest at the equilibrium {place}; {remedy}; {more}", at_rest)
    why = f"within time {request.followed:g} nothing repeats after up to {request.returns} returns to the section"
    failure = PeriodicFailure(f"{why}; follow it longer, allow more returns, or give a period to begin with")
    some = False
    for orbit in nearby_orbits(problem, recurrences(problem, states, times, section, request.returns), section):
        try:
            found = _claimed(problem, orbit, section, level)
        except PeriodicFailure as reason:
            # On another level, say; the others are found all the same.
            failure = reason
            continue
        some = True
        yield found
    if not some:
        raise failure


def refined(found: FoundOrbit, name: str, digits: int, progress: Progress | None = None) -> PeriodicOrbit:
    """The claim about an orbit. Raises `RefinementFailure`."""
    if len(found.orbit.point) < 2:
        raise RefinementFailure("a state of one coordinate has no periodic orbits")
    return refine_periodic(found.task(name, digits), progress)


def followed(
    found: FoundOrbit,
    name: str | None,
    bounds: tuple[float, float],
    generations: int = 0,
    symmetry: Sequence[Sequence[Fraction]] | None = None,
    progress: Progress | None = None,
    control: StepControl | None = None,
) -> Iterator[PeriodicFamily]:
    """The family of an orbit and those that are born from it, one after another.

    Arguments:
        name, bounds, generations, control: see `families`.
        symmetry: an involution, shape (N, N); `None` for those that are found.

    Raises `ValueError` if the system does not have the symmetry, and `PeriodicFailure` as `families` does.
    """
    symmetries = symmetries_for(found.problem, symmetry, name)
    level = found.level if name is not None else None
    yield from families(found.problem, found.orbit, name, bounds, generations, control, progress, symmetries, level)


def symmetries_for(
    problem: PeriodicProblem, symmetry: Sequence[Sequence[Fraction]] | None, name: str | None
) -> tuple[Symmetry, ...] | None:
    """A symmetry that is given, for all values of a parameter; `None` for those that are found.

    Raises `ValueError` if the system does not have it.
    """
    if symmetry is None:
        return None
    if not is_symmetry(problem, symmetry, name):
        raise ValueError(f"{problem.system.name} has no such symmetry, or it is none with square 1")
    return (Symmetry(tuple(map(tuple, symmetry))),)


def _level(problem: PeriodicProblem, request: PeriodicRequest) -> Fraction | None:
    if problem.system.first_integral_program is None:
        return None
    if request.level is not None:
        return request.level
    value = problem.level(request.start, problem.values)
    return Fraction(f"{value:.{_LEVEL_DIGITS - 1}e}")


def _sections_for(problem: PeriodicProblem, states: np.ndarray) -> list[AffineSection]:
    """Sections that an orbit crosses again and again, the best first: a coordinate in the middle of its range."""
    few = states[:: max(1, len(states) // _SAMPLED)]
    return sections(few, np.array([velocity_at(problem.system, state, problem.values) for state in few]))


def _claimed(
    problem: PeriodicProblem, orbit: ClosedOrbit, section: AffineSection | None, level: Fraction | None
) -> FoundOrbit:
    """The orbit from the steepest of its crossings of a section, by default of the best in which it is found again."""
    suit = _sections_for(problem, orbit.loop)
    reason = PeriodicFailure("the orbit crosses no section")
    for chosen in suit if section is None else [section]:
        try:
            return _on_section(problem, orbit, chosen, level)
        except PeriodicFailure as failure:
            reason = failure
    others = [each.described(problem.system.given_state) for each in suit if each != section][:_TOLD]
    more = "sections that were tried" if section is None else "sections that it crosses"
    raise PeriodicFailure(f"{reason}; {more}: {', '.join(others)}" if others else str(reason))


def _on_section(
    problem: PeriodicProblem, orbit: ClosedOrbit, chosen: AffineSection, level: Fraction | None
) -> FoundOrbit:
    where = chosen.crossings(orbit.loop)
    if not where:
        raise PeriodicFailure("the orbit does not cross the section in the direction; give another section")
    normal = np.array(list(map(float, chosen.normal)))

    def steepness(index: int) -> float:
        velocity = velocity_at(problem.system, orbit.loop[index], problem.values)
        return float(abs(normal @ velocity) / (np.linalg.norm(velocity) or 1.0))

    first = max(where, key=steepness)
    value = None if level is None else float(level)
    moved = correct_in_segments(problem, orbit.loop, orbit.period, chosen, value, orbit.segments, first)
    return FoundOrbit(problem, moved, chosen, len(chosen.crossings(moved.loop)), level)


def remarks(request: PeriodicRequest, found: FoundOrbit) -> list[str]:
    """What is worth telling of an orbit: that its claim may be hard to prove, how it differs from the guess."""
    said, name = [], request.system.name
    if found.growth > GROWTH_ALLOWED:
        said.append(
            f"{name}: bounds of errors may grow by {found.growth:.0f} digits over the period, and centres have digits "
            f"for {GROWTH_ALLOWED}: the claim may not be proved; where orbits are slow a section of your own may help"
        )
    if request.period is None:
        return said
    times = round(request.period / found.orbit.period)
    if times > 1:
        said.append(f"{name}: the period given is {times} times that of the orbit, which is taken")
    moved = found.orbit.distance_from(request.start) / max(found.orbit.size, *map(abs, request.start))
    if moved > _WORTH_TELLING:
        said.append(
            f"{name}: the orbit that was found is {moved:.1%} of its size away from the guess; "
            "if another one is meant, give a closer guess"
        )
    return said


def described(found: FoundOrbit) -> list[str]:
    """An orbit in lines."""
    system, orbit = found.problem.system, found.orbit
    place = ", ".join(f"{name} = {value:.12g}" for name, value in zip(system.given_state, orbit.point, strict=True))
    lines = [f"period {orbit.period:.14g}, {counted(found.crossings, 'crossing')} of the section", f"  point: {place}"]
    shown = ", ".join(_multipliers(orbit))
    lines += _of_force(found)
    trivial = "1" if orbit.level is None else "1, 1"
    lines.append(f"  multipliers other than {trivial}: {shown}")
    if orbit.level is not None:
        lines.append(f"  {system.first_integral_name}: {orbit.level:.12g}")
    return lines


def _of_force(found: FoundOrbit) -> list[str]:
    """How often a force repeats within the period, in a line, if there is one."""
    names, point = found.problem.system.given_state, found.orbit.point
    if not set(FORCE_AT_START) <= set(names):
        return []
    velocity = velocity_at(found.problem.system, point, found.problem.values)
    u, w = (names.index(name) for name in FORCE_AT_START)
    rate = point[u] * velocity[w] - point[w] * velocity[u]
    times = round(found.orbit.period * abs(rate) / (2 * pi))
    # At rest in the middle of the circle there is no force.
    if not times:
        return []
    own = f"exp({'-' * bool(rate > 0)}{f'{times} ' * (times > 1)}pi)"
    return [f"  {times} x 2 pi/omega, the period of the force, omega = {abs(rate):.12g}; its multiplier is {own}"]


def _multipliers(orbit: ClosedOrbit) -> list[str]:
    """The multipliers as far as they are known, the largest first; "none" of a system without others than 1."""
    error = _ROUNDING * max(1.0, float(np.linalg.norm(orbit.arc.by_state)))
    return [_complex(value, error) for value in orbit.multipliers] or ["none"]


def orbit_as_json(found: FoundOrbit) -> dict[str, Any]:
    """An orbit for programs."""
    system, orbit = found.problem.system, found.orbit
    return {
        "system": system.name,
        "parameters": found.problem.parameters,
        "point": dict(zip(system.given_state, orbit.point, strict=True)),
        "period": orbit.period,
        "crossings": found.crossings,
        "multipliers": orbit.multipliers,
        "first_integral_name": system.first_integral_name,
        "first_integral": orbit.level,
    }


def _complex(value: complex, error: float) -> str:
    """A multiplier as far as it is known; nothing is said of one that is less than the error."""
    if abs(value) < error:
        return f"one below {error:.0e}"
    if abs(value.imag) < error:
        return _short(value.real, error)
    return f"{_short(value.real, error)} {'+' if value.imag > 0 else '-'} {_short(abs(value.imag), error)}i"


def _short(value: float, error: float) -> str:
    """A number to the digits that are known, 10 at most."""
    digits = 10 if value == 0 else max(1, min(10, floor(log10(abs(value) / error))))
    return f"{value:.{digits}g}"
