"""Bifurcations of periodic orbits as claims for the verifier: the section, the eigenvector, and many digits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, isfinite, log, log2
from typing import Any

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import Solution
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.detection import BRANCH, DOUBLING, FOLD, PITCHFORK, TORUS, Bifurcation
from orbitproof.explore.periodic.extended import ExtendedSystem
from orbitproof.explore.periodic.flow import Matrix, Vector, arc_of, preserves_volume, stretching, velocity_at
from orbitproof.explore.periodic.refinement import RULE, box_exponent, solved
from orbitproof.explore.periodic.section import AffineSection, map_derivative, suggested
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared.claims import (
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    PeriodicBifurcation,
)

_CLAIMED = {
    FOLD: PERIODIC_FOLD,
    DOUBLING: PERIODIC_DOUBLING,
    PITCHFORK: PERIODIC_PITCHFORK,
    TORUS: PERIODIC_TORUS,
}
_KERNEL_BITS = 6
_WIDENING, _IN_FRAMES, _BOX_DIGITS = 6.5, 2.0, 8
_MOST_BOX_DIGITS, _HOPELESS = 90, 150
"""Digits of the narrowest box over which the verifier's floats can bound errors; where many more are asked for there is
no claim."""
_BEYOND_BOX = 10
"""Digits of the centre beyond those of the half-widths."""
_SAMPLED = 2
_TIMES = 4


@dataclass(frozen=True)
class _Start:
    """Where Newton's method begins.

    Attributes:
        point: shape (N,), on the section, in float64.
        time: of the return.
        vectors: for each part of the eigenvector its coordinates in the section, shape (N - 1,), and a time.
    """

    section: AffineSection
    crossings: int
    point: Vector
    time: float
    vectors: tuple[tuple[Vector, float], ...]
    multiplier: complex


def refine_bifurcation(
    found: Bifurcation, name: str, digits: int, progress: Progress | None = None, section: AffineSection | None = None
) -> PeriodicBifurcation:
    """The claim about a bifurcation: its point, parameter and eigenvector to so many digits, in a box.

    Arguments:
        section: `None` for one that suits the orbit; for a pitchfork it must be one that the symmetry maps to itself,
            and another one is chosen if it is not.

    Raises `RefinementFailure`, one line.
    """
    if found.kind == BRANCH:
        raise RefinementFailure("a branch point without a symmetry that explains it is no claim")
    if found.is_double:
        raise RefinementFailure(
            "two multipliers meet the circle at once, as a symmetry makes them; claims are of one that meets it alone"
        )
    try:
        start = _start(found, section)
    except (FlowFailure, PeriodicFailure) as failure:
        raise RefinementFailure(str(failure)) from None
    kernel = [tuple(map(Fraction, vector)) for vector, _ in start.vectors]
    length = sum((value * value for vector in kernel for value in vector), Fraction(0))
    extended = ExtendedSystem(
        found.problem.system, found.problem.parameters, found.name, found.level,
        start.section.onto(tuple(map(Fraction, start.point))), _frame(start.section, found), found.symmetry,
        None if found.is_torus else found.sign,
        tuple(tuple(value / length for value in vector) for vector in kernel),
    )  # fmt: skip
    n = extended.size
    guess = [*(Fraction(0),) * n, Fraction(start.time), Fraction(found.member.value)]
    for vector, (_, time) in zip(kernel, start.vectors, strict=True):
        guess += [*vector, Fraction(time)]
    if found.is_torus:
        guess += [Fraction(start.multiplier.real), Fraction(start.multiplier.imag)]
    narrow = digits_of_box(found)
    rule = replace(RULE, farthest=3e-2)
    solution = solved(extended.linearised, guess, max(digits, narrow + _BEYOND_BOX), rule, progress)
    exponent = max(box_exponent(digits, solution.last.spread), ceil(narrow * log2(10)))
    exponent = min(exponent, ceil(_MOST_BOX_DIGITS * log2(10)))
    return _claim(found, name, digits, start, extended, solution, Fraction(1, 2**exponent))


def _claim(
    found: Bifurcation,
    name: str,
    digits: int,
    start: _Start,
    extended: ExtendedSystem,
    solution: Solution,
    radius: Fraction,
) -> PeriodicBifurcation:
    n, system, unknowns = extended.size, found.problem.system, solution.unknowns
    value, centre = unknowns[n + 1], extended.point(unknowns)
    if found.symmetry is not None and found.parts == 1:
        centre = tuple((x + y) / 2 for x, y in zip(centre, found.symmetry.applied(centre), strict=True))
    return PeriodicBifurcation(
        id=name,
        system=system,
        parameters=dict(found.problem.parameters) if found.name is None else {
            each: value if each == found.name else exact for each, exact in found.problem.parameters.items()
        },
        normal=start.section.normal,
        offset=start.section.offset,
        direction=start.section.direction,
        crossings=start.crossings,
        centre=centre,
        frame=extended.frame,
        radii=(radius,) * n,
        kind=_CLAIMED[found.kind],
        kernel=tuple(tuple(extended.vector(unknowns, j)) for j in range(extended.vectors)),
        kernel_radius=radius * 2 ** _bits_of_kernel(extended, solution.last.matrix),
        parameter_radius=radius,
        parameter=found.name,
        level=value if found.name is None else found.level,
        multiplier=(unknowns[-2], unknowns[-1]) if found.is_torus else None,
        symmetry=None if found.symmetry is None else found.symmetry.rows,
        provenance={"digits": digits},
    )  # fmt: skip


def digits_of_box(found: Bifurcation) -> int:
    """-log10 of half-widths over which derivatives to order 3 are expected to be enclosed narrowly.

    Enclosures of the third derivatives widen a few times faster than neighbours move apart along the orbit where bounds
    are kept entry by entry, and less where they are carried in frames; measured on first and second doublings.
    Raises `RefinementFailure` where no box is narrow enough.
    """
    orbit = found.member.orbit
    states = orbit.loop[::_SAMPLED]
    apart = stretching(found.problem.system, states, orbit.values) * orbit.period / found.parts / log(10)
    widening = _WIDENING if preserves_volume(found.problem.system, states, orbit.values) else _IN_FRAMES
    wanted = ceil(widening * apart + _BOX_DIGITS) if isfinite(apart) else 0
    if wanted > _HOPELESS:
        raise RefinementFailure(
            f"neighbours move apart so fast that it could be proved over a box of width 1e-{wanted} only, which is "
            "narrower than the verifier's bounds of errors"
        )
    return min(_MOST_BOX_DIGITS, wanted)


def _bits_of_kernel(extended: ExtendedSystem, matrix: Any) -> int:
    """log2 of how many times faster than the point the eigenvector moves in the box, and some more."""
    n = extended.size
    # The equations after those of the return, solved for the eigenvector (and its multiplier): the rest moves freely.
    rows = np.array([[float(value) for value in row] for row in matrix.tolist()[n + 1 :]])
    free, bound = slice(0, n + 2), slice(n + 2, None)
    moved = np.linalg.lstsq(rows[:, bound], rows[:, free], rcond=None)[0]
    return max(0, ceil(log2(max(1.0, float(np.max(np.sum(np.abs(moved), axis=1))))))) + _KERNEL_BITS


def _frame(section: AffineSection, found: Bifurcation) -> tuple[tuple[Fraction, ...], ...]:
    """Directions of the section; where S leaves the orbit alone it maps each to itself or its negative."""
    frame = section.frame()
    if found.symmetry is None or found.parts == 2:
        return frame
    chosen: list[tuple[Fraction, ...]] = []
    for column in zip(*frame, strict=True):
        image = found.symmetry.applied(column)
        for sign in (1, -1):
            each = tuple((x + sign * y) / 2 for x, y in zip(column, image, strict=True))
            rows = np.array([[float(value) for value in other] for other in (*chosen, each)])
            if np.linalg.matrix_rank(rows) > len(chosen):
                chosen.append(each)
    return tuple(zip(*chosen, strict=True))


def _start(found: Bifurcation, section: AffineSection | None) -> _Start:
    """The orbit from the steepest of its crossings of a section, with the eigenvector there."""
    orbit, system, symmetry = found.member.orbit, found.problem.system, found.symmetry
    values = orbit.values
    velocities = np.array([velocity_at(system, state, values) for state in orbit.loop[::_SAMPLED]])
    if section is None or (symmetry is not None and not symmetry.leaves(section.normal)):
        try:
            normals = None if symmetry is None else list(symmetry.normals())
            if normals == []:
                raise PeriodicFailure("the symmetry maps no section to itself with its direction")
            section = suggested(orbit.loop[::_SAMPLED], velocities, normals)
        except ValueError:
            raise PeriodicFailure("no section that the symmetry maps to itself is crossed") from None
    where = section.crossings(orbit.loop)
    if not where or len(where) % found.parts:
        raise PeriodicFailure("the orbit does not cross the section in the direction; give another section")
    normal = np.array(list(map(float, section.normal)))

    def steepness(index: int) -> float:
        velocity = velocity_at(system, orbit.loop[index], values)
        return float(abs(normal @ velocity) / (np.linalg.norm(velocity) or 1.0))

    point = _onto(found.problem, orbit, section, max(where, key=steepness))
    time = orbit.period / found.parts
    arc = arc_of(system, point, time, values)
    matrix = np.eye(len(point)) if symmetry is None else symmetry.matrix
    flow, velocity = matrix @ arc.by_state, matrix @ arc.velocity
    frame = np.array([[float(value) for value in row] for row in _frame(section, found)])
    derivative = map_derivative(section, flow, velocity, frame)
    multiplier, vectors = _eigenvector(found, derivative, frame, point)
    speed = normal @ velocity
    pairs = tuple((vector, float(-(normal @ flow @ frame @ vector) / speed)) for vector in vectors)
    return _Start(section, len(where) // found.parts, point, time, pairs, multiplier)


def _eigenvector(
    found: Bifurcation, derivative: Matrix, frame: Matrix, point: Vector
) -> tuple[complex, tuple[Vector, ...]]:
    """The multiplier and its eigenvector: real, or real and imaginary part; of length 1."""
    if found.is_torus:
        values, vectors = np.linalg.eig(derivative)
        j = int(np.argmin(np.abs(values - found.multiplier)))
        # Real and imaginary part are as far from parallel as a complex factor can make them.
        vector = vectors[:, j] * np.exp(-0.5j * np.angle(np.sum(vectors[:, j] ** 2)))
        vector = vector / np.linalg.norm(vector)
        return values[j] / abs(values[j]), (vector.real, vector.imag)
    sign = float(found.sign)
    rows = derivative - sign * np.eye(len(derivative))
    if found.name is None or found.level is not None:
        slopes, _ = found.problem.level_slopes(point, found.member.orbit.values)
        across = slopes @ frame
        rows = np.vstack([rows, across / np.linalg.norm(across)])
    return complex(sign), (np.linalg.svd(rows)[2][-1],)


def _onto(problem: PeriodicProblem, orbit: ClosedOrbit, section: AffineSection, index: int) -> Vector:
    """The crossing after a sample of an orbit."""
    normal, offset = np.array(list(map(float, section.normal))), float(section.offset)
    step = orbit.period / (len(orbit.loop) - 1)
    before = orbit.loop[index]
    low, high = (section.heights(orbit.loop[[index, index + 1]])).tolist()
    time = step * min(0.999, max(1e-3, -low / (high - low)))
    point = before
    for _ in range(_TIMES):
        arc = arc_of(problem.system, before, time, orbit.values)
        point = arc.end
        change = -(normal @ point - offset) / (normal @ arc.velocity)
        time = min(2 * step, max(1e-3 * step, time + change))
    return point
