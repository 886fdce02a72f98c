"""Periodic orbits without symmetry in float64: Newton's method for a point and its period.

phi_T(x) = x, with a phase condition, and with the first integral of the system, if it has one, at a level: then there
are more equations than unknowns, which are solved in the sense of least squares; at an orbit all of them hold.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import CLOSING
from orbitproof.explore.periodic.flow import (
    SAMPLES,
    Arc,
    Matrix,
    Vector,
    arc_of,
    slopes_of_state,
    values_of,
    velocity_at,
    whole_state,
)
from orbitproof.explore.periodic.section import AffineSection
from orbitproof.explore.periodic.segments import Segments, nodes_of, segments_for, shot
from orbitproof.shared.systems import Program, System, with_slope

_STALLED, _STALLED_TOLERANCE = 4, 1e-7
"""Steps below this that have not become shorter for so many in a row are rounding, as for orbits near a double one."""
_STALLED_IN_SEGMENTS = 1e-4
"""So short are such steps of segments, which close all the same: orbits of one parameter may differ by no more."""
_LONGEST = 0.2
"""Longest step, relative to the size of the orbit."""
_REPEATS = 1e-6
"""How far an orbit may be from closing, relative to its size."""
_PASSES, _RETURNS = 0.05, 0.01
"""Distances from a point, relative to the size of the orbit, at which it passes by: as samples tell that are far apart,
and close together."""
_BENDS, _SHARE = 0.1, 16
"""Samples are close enough if chords between them differ from the flow by less than this, as a rule; else this part of
the time is looked at."""
_LONGER, _LAST, _LOOKED_AT = 1.01, 0.75, 64
_EQUILIBRIUM = 1e-7


class PeriodicFailure(Exception):
    """No periodic orbit was found; one line that says why."""


@dataclass(frozen=True)
class PeriodicProblem:
    """A system with all its parameters, and what counts as the same level of its first integral.

    Attributes:
        parameters: all of the vector field's, exact.
    """

    system: System
    parameters: Mapping[str, Fraction]

    @property
    def values(self) -> Vector:
        """The parameters as doubles, in the vector field's order."""
        return np.array([float(self.parameters[name]) for name in self.system.parameters])

    def level(self, point: Sequence[float] | Vector, values: Vector) -> float | None:
        """The first integral at a point. Raises `FlowFailure` where it is not defined."""
        program = self.system.first_integral_program
        return None if program is None else float(values_of(self.system, program, point, values)[0])

    def level_slopes(self, point: Vector, values: Vector) -> tuple[Vector, Vector]:
        """Derivatives of the first integral in the state and in the parameters."""
        program = self.system.first_integral_program
        assert program is not None
        inputs = np.array([*whole_state(self.system, point, values), *values], dtype=float)
        with np.errstate(all="ignore"):
            slopes = np.array([float(both.evaluate(list(inputs))[1]) for both in _slopes_of(program)])
        if self.system.defined:
            slopes = slopes @ slopes_of_state(self.system, point, values)
        return slopes[: len(point)], slopes[len(point) :]


@cache
def _slopes_of(program: Program) -> tuple[Program, ...]:
    """The program with its derivative in each of its inputs."""
    return tuple(with_slope(program, name) for name in program.inputs)


@dataclass(frozen=True)
class ClosedOrbit:
    """A periodic orbit in float64.

    Attributes:
        point: shape (N,), a point of it.
        period: the least one, as far as float64 tells.
        values: shape (P,), all parameters.
        arc: the orbit over the period from there.
        level: the first integral, or `None`.
        multipliers: complex, without the 1 of the direction of the flow and, with a first integral, the second 1;
            the largest first.
        error: length of the last Newton step, relative to the size of the orbit.
        nodes: shape (m, N), the first states of its segments, if it was shot in several; the first one is the point.
    """

    point: Vector
    period: float
    values: Vector
    arc: Arc
    level: float | None
    multipliers: Vector
    error: float
    nodes: Matrix | None = None

    @property
    def segments(self) -> int:
        """In how many it was shot."""
        return 1 if self.nodes is None else len(self.nodes)

    @property
    def loop(self) -> Matrix:
        """States at equal times over the period, both ends included, shape (`SAMPLES`, N)."""
        return self.arc.samples

    @property
    def size(self) -> float:
        """Diameter of the orbit in its widest coordinate."""
        return float(np.max(np.ptp(self.loop, axis=0)))

    @property
    def gap(self) -> float:
        """Between its ends as they are integrated, relative to its size."""
        return float(np.max(np.abs(self.arc.end - self.point))) / (self.size or 1.0)

    def distance_from(self, point: Sequence[float]) -> float:
        """About how far a point is from the orbit, from the chords between its states."""
        starts, chords = self.loop[:-1], np.diff(self.loop, axis=0)
        lengths = np.maximum(np.sum(chords**2, axis=1), np.finfo(float).tiny)
        parts = np.clip(np.sum((np.array(point) - starts) * chords, axis=1) / lengths, 0.0, 1.0)
        return float(np.min(np.linalg.norm(starts + parts[:, None] * chords - np.array(point), axis=1)))


def correct(
    problem: PeriodicProblem,
    point: Sequence[float] | Vector,
    period: float,
    section: AffineSection | None = None,
    level: float | None = None,
) -> ClosedOrbit:
    """The periodic orbit near a guess.

    Arguments:
        point: shape (N,), near the orbit; or (m, N), the first states of m segments.
        period: near its period.
        section: where the point shall lie; `None`: on the plane through the guess across the flow.
        level: of the first integral, if the system has one; `None`: that of the guess.

    Raises `PeriodicFailure`.
    """
    values, nodes, time = problem.values, np.atleast_2d(np.array(point, dtype=float)), float(period)
    if not (np.all(np.isfinite(nodes)) and np.isfinite(time) and time > 0):
        raise PeriodicFailure("the guess is not finite, or its period is not positive")
    (m, n), start, before, shortest, stalled = nodes.shape, time, np.inf, np.inf, 0
    try:
        normal, offset = _phase(problem, nodes[0], section)
        if level is None:
            level = problem.level(nodes[0], values)
        for _ in range(CLOSING.steps):
            segments = shot(problem.system, nodes, time, values)
            size = float(np.max(np.ptp(segments.whole.samples, axis=0))) or 1.0
            x, elsewhere = nodes[0], np.zeros((m - 1) * n + 1)
            matrix = np.vstack([
                np.column_stack([segments.by_nodes, segments.by_time]), np.append(normal, elsewhere)
            ])  # fmt: skip
            residual = np.append(segments.gaps, normal @ x - offset)
            if level is not None:
                slopes, _ = problem.level_slopes(x, values)
                matrix = np.vstack([matrix, np.append(slopes, elsewhere)])
                residual = np.append(residual, (problem.level(x, values) or 0.0) - level)
            scale = np.append(np.full(m * n, size), time)
            step = -np.linalg.lstsq(matrix * scale, residual, rcond=None)[0]
            length = float(np.max(np.abs(step)))
            if not np.isfinite(length):
                raise PeriodicFailure("Newton's method broke down")
            taken = step * (_LONGEST / max(length, _LONGEST)) * scale
            nodes, time = nodes + taken[:-1].reshape(m, n), time + float(taken[-1])
            if not start / 3 < time < 3 * start:
                raise PeriodicFailure("Newton's method leaves the neighbourhood of the guess")
            if CLOSING.judge(length, before)[0]:
                break
            stalled = stalled + 1 if length > 0.75 * shortest else 0
            if stalled >= _STALLED and length < (_STALLED_TOLERANCE if m == 1 else _STALLED_IN_SEGMENTS):
                break
            before, shortest = length, min(shortest, length)
        else:
            raise PeriodicFailure(f"Newton's method did not converge in {CLOSING.steps} steps (last step {length:.1e})")
        x = nodes[0]
        if size < _EQUILIBRIUM * max(1.0, float(np.max(np.abs(x)))):
            raise PeriodicFailure("Newton's method found an equilibrium")
        shorter = () if m > 1 else _shorter_periods(problem, segments.whole, x, time, size)
        for least in (*shorter, time):
            segments = shot(problem.system, nodes, least, values)
            if np.max(np.abs(segments.gaps)) < _REPEATS * size:
                return closed_orbit(problem, nodes, least, values, segments, length)
        raise PeriodicFailure("the orbit is too unstable for float64: it does not close")
    except FlowFailure as failure:
        raise PeriodicFailure(str(failure)) from None


def correct_in_segments(
    problem: PeriodicProblem,
    loop: Matrix,
    period: float,
    section: AffineSection | None = None,
    level: float | None = None,
    segments: int = 1,
    first: int = 0,
) -> ClosedOrbit:
    """The periodic orbit near a loop (`correct`), in more segments if it is not found in so many.

    Arguments:
        loop: shape (K, N), states at equal times over the period, both ends included.
        first: number of the state that is the guess of the point.

    Raises `PeriodicFailure`.
    """
    try:
        return correct(problem, nodes_of(loop, segments, first), period, section, level)
    except PeriodicFailure:
        number = segments_for(problem.system, loop, period, problem.values)
        if number <= segments:
            raise
        return correct(problem, nodes_of(loop, number, first), period, section, level)


def _phase(problem: PeriodicProblem, x: Vector, section: AffineSection | None) -> tuple[Vector, float]:
    if section is not None:
        normal = np.array(list(map(float, section.normal)))
        return normal, float(section.offset)
    velocity = velocity_at(problem.system, x, problem.values)
    speed = float(np.linalg.norm(velocity))
    if not speed > 0:
        raise PeriodicFailure("the guess is an equilibrium")
    return velocity / speed, float(velocity @ x) / speed


def _shorter_periods(problem: PeriodicProblem, arc: Arc, x: Vector, time: float, size: float) -> Iterator[float]:
    """Parts of a period after which the orbit may be back at x already, the shortest first: it passes by there."""
    span = time
    if _bending(problem, arc, time) > _BENDS:
        span = time / _SHARE
        arc = arc_of(problem.system, x, span, problem.values)
    for moment in _passes(problem, arc, x, span, _PASSES * size):
        if moment > _LAST * time:
            return
        # Once more with all samples for one revolution, so that many of them are counted without a mistake.
        near = arc_of(problem.system, x, _LONGER * moment, problem.values)
        for found in _passes(problem, near, x, _LONGER * moment, _RETURNS * size):
            if abs(found - moment) < (_LONGER - 1) * moment:
                yield time / round(time / found)


def _bending(problem: PeriodicProblem, arc: Arc, time: float) -> float:
    """The median part by which chords between samples differ from the flow along them."""
    step, places = time / (SAMPLES - 1), range(0, SAMPLES - 1, SAMPLES // _LOOKED_AT)
    flown = step * np.array([velocity_at(problem.system, arc.samples[i], problem.values) for i in places])
    apart = np.linalg.norm(np.diff(arc.samples, axis=0)[places] - flown, axis=1)
    return float(np.median(apart / np.maximum(np.linalg.norm(flown, axis=1), np.finfo(float).tiny)))


def _passes(problem: PeriodicProblem, arc: Arc, x: Vector, time: float, distance: float) -> list[float]:
    """When an orbit that begins at x crosses the plane across the flow there again, at most so far from x."""
    heights = (arc.samples - x) @ velocity_at(problem.system, x, problem.values)
    where = np.flatnonzero((heights[:-1] < 0) & (heights[1:] >= 0))
    share = heights[where] / (heights[where] - heights[where + 1])
    points = arc.samples[where] + share[:, None] * (arc.samples[where + 1] - arc.samples[where])
    near = np.max(np.abs(points - x), axis=1) < distance
    return list((where + share)[near] * time / (SAMPLES - 1))


def closed_orbit(
    problem: PeriodicProblem, nodes: Matrix, time: float, values: Vector, segments: Segments, error: float
) -> ClosedOrbit:
    """The orbit of segments that close, with its multipliers."""
    level, found = problem.level(nodes[0], values), _multipliers(problem, nodes, segments, values)
    kept = nodes if len(nodes) > 1 else None
    return ClosedOrbit(nodes[0], time, values, segments.whole, level, found, error, kept)


def _multipliers(problem: PeriodicProblem, nodes: Matrix, segments: Segments, values: Vector) -> Vector:
    """The multipliers without the trivial ones: of the return map, on the level if there is a first integral.

    A segment maps what is across the flow to what is across it at its end: of such maps the product is taken.
    """
    bases = []
    for node, before in zip(nodes, [segments.arcs[-1], *segments.arcs], strict=False):
        fixed = [before.velocity / np.linalg.norm(before.velocity)]
        if problem.system.first_integral_program is not None:
            slopes, _ = problem.level_slopes(node, values)
            fixed.append(slopes / np.linalg.norm(slopes))
        # An orthonormal basis of what is left; the derivative of the flow acts on it modulo the flow's direction.
        bases.append(np.linalg.svd(np.array(fixed))[2][len(fixed) :])
    product = np.eye(len(bases[0]))
    for arc, here, there in zip(segments.arcs, bases, [*bases[1:], bases[0]], strict=True):
        product = there @ arc.by_state @ here.T @ product
    found = np.linalg.eigvals(product) if len(product) else np.zeros(0)
    return found[np.argsort(-np.abs(found), kind="stable")].astype(complex)
