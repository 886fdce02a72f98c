"""A bifurcation point as the place where a branch starts: point, frame, level, directions, in float64.

The claims of candidates files and certificates are exact. Here their numbers become what the search
needs: the point on Fix(R), the half return from it, the direction of the new branch, and the value of the
bifurcation parameter (*level*: first integral or family parameter), to more digits than a double has.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, pairwise
from math import isfinite
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement import (
    Directions,
    IntegrationFailure,
    JetBasis,
    RefinementFailure,
    branch_geometry,
    operations,
    section_crossings,
    start_jets,
)
from orbitproof.shared.claims import LEADING_POWERS
from orbitproof.shared.claims.candidate import OfKind
from orbitproof.shared.formats import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem, with_functions

BITS = 100
"""Working precision for what a double cannot hold; the point of a claim is rounded to it."""


class NoBranch(Exception):
    """A branch cannot be followed from a point; one line says why."""


@dataclass(frozen=True)
class BranchPoint(OfKind):
    """Where a branch starts.

    Attributes:
        id, system, parameters, kind, k, symmetry: the claim, as in `shared.formats.candidates.Candidate`.
        order: power of p_1 with which the level begins to change along the branch.
        point: shape (1 + n,), in the order of `ReversibleSystem.centre_coordinates`.
        frame: shape (1 + n, 1 + n), columns are the directions of p_0, p_1, p_2.
        level: value of the bifurcation parameter, exact to `BITS` bits.
        times: from crossing to crossing of the section, from the point until the orbit is on Fix(R) again.
        slope: p_0'(p_1) of the branch; 0 for a tangential bifurcation.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    order: int
    k: int
    symmetry: str | None
    point: Vector
    frame: Matrix
    level: Fraction
    times: tuple[float, ...]
    slope: float

    @property
    def half_period(self) -> float:
        """From the point to the other one on Fix(R)."""
        return sum(self.times)

    @property
    def scale(self) -> Vector:
        """Shape (1 + n,): lengths are measured in units of it, a coordinate's own size where that exceeds 1."""
        return np.maximum(1.0, np.abs(self.point))

    @property
    def direction(self) -> Vector:
        """Tangent of the branch at the point, of length 1 in units of `scale`, shape (1 + n,)."""
        vector = self.frame[:, 1] + self.slope * self.frame[:, 0]
        return np.asarray(vector / np.linalg.norm(vector / self.scale))

    @property
    def amplitude_form(self) -> Vector:
        """The row that takes a difference of points to p_1, in units in which `direction` has p_1 = 1."""
        row = np.linalg.inv(self.frame)[1]
        return np.asarray(row / (row @ self.direction))

    def level_difference(self, point: Vector) -> tuple[float, float]:
        """Level at a point minus that of the bifurcation, and what the rounding of the point may change it by."""
        return self._difference(point, level_at)

    def level_difference_in_section(self, point: Vector) -> tuple[float, float]:
        """`level_difference` at a point of the section: the family parameter, if there is one, and its coordinates."""
        return self._difference(point, level_in_section)

    def _difference(self, point: Vector, level: Callable[..., Any]) -> tuple[float, float]:
        context = working_context(BITS)
        exact = [context.mpf(float(value)) for value in point]
        values = [level(self.system, self.parameters, exact, context)]
        for i, value in enumerate(exact):
            unit = np.spacing(max(1.0, abs(float(value))))
            values.append(level(self.system, self.parameters, [*exact[:i], value + unit, *exact[i + 1 :]], context))
        here = values[0]
        noise = sum(abs(float(value - here)) for value in values[1:])
        return float(here - mpf(self.level, context)), 4 * noise


def centre_of(candidate: Candidate) -> Vector:
    """The centre of a claim on Fix(R), shape (1 + n,), without a parameter that varies where two resonances meet."""
    if candidate.level_sign is None:
        return np.array([*map(float, candidate.centre[candidate.resonances_meet :])])
    context = working_context(BITS)
    centre, *frame = ([mpf(value, context) for value in row] for row in (candidate.centre, *candidate.frame))
    return _floats([_without_level(candidate, centre, frame, context)[0]])[0]


def branch_point(candidate: Candidate) -> BranchPoint:
    """Prepare the start of the branch of a claim. Raises `NoBranch`, one line."""
    if candidate.is_fold:
        raise NoBranch("no branch begins at a fold: the family itself turns back in the parameter")
    if not (candidate.has_branch or candidate.loses_reversor):
        raise NoBranch(f"no branch is followed from a claim of the kind {candidate.kind}")
    if candidate.crossings != 1 and not candidate.loses_reversor:
        raise NoBranch(f"its half orbit meets the section {candidate.crossings} times; branches of one are followed")
    context = working_context(BITS)
    system, parameters = candidate.system, candidate.parameters
    centre = [mpf(value, context) for value in candidate.centre]
    frame = [[mpf(value, context) for value in row] for row in candidate.frame]
    if candidate.level_sign is not None:
        centre, frame = _without_level(candidate, centre, frame, context)
    exact = [round_dyadic(fraction(value), BITS) for value in centre]
    kernel = context.matrix([[mpf(value, context) for value in row] for row in candidate.kernel_frame])
    try:
        start, parameter = start_jets(system, centre, [], JetBasis.graded((1,), 0))
        crossings = section_crossings(system, parameters, start, parameter, context)
        times = [0.0, *(crossing.time for crossing in islice(crossings, candidate.crossings))]
        order, slope = LEADING_POWERS.get(candidate.kind, 2), 0.0
        if order == 1:
            slope = _slope(candidate, exact, Directions(context.matrix(frame), kernel), context)
        level = level_at(system, parameters, centre, context)
    except (IntegrationFailure, RefinementFailure) as failure:
        raise NoBranch(str(failure)) from None
    except ZeroDivisionError:
        raise NoBranch("the point is singular, or the frame is") from None
    return BranchPoint(
        id=candidate.id,
        system=system,
        parameters=parameters,
        kind=candidate.kind,
        order=order,
        k=candidate.k,
        symmetry=candidate.symmetry,
        point=_floats([centre])[0],
        frame=_floats(frame),
        level=round_dyadic(fraction(level), BITS),
        times=tuple(after - before for before, after in pairwise(times)),
        slope=slope,
    )


def _slope(candidate: Candidate, centre: Sequence[Fraction], frame: Directions, context: mpmath.MPContext) -> float:
    """p_0'(p_1) of a touch-and-go branch: what the search noted beside the claim, otherwise from series."""
    noted = candidate.provenance.get("branch_slope")
    if isinstance(noted, float) and isfinite(noted) and candidate.level_sign is None:
        return noted
    system, parameters = candidate.system, candidate.parameters
    return branch_geometry(system, parameters, centre, frame, candidate.k, False, context).branch_slope


def level_at(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[Any], context: mpmath.MPContext
) -> Any:
    """The bifurcation parameter at a point, to the precision of `context`."""
    if system.family_parameter is not None:
        return point[0]
    return _level(system, parameters, dict(zip(system.fixed_coordinates, point, strict=True)), context)


def level_in_section(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[Any], context: mpmath.MPContext
) -> Any:
    """The bifurcation parameter at a point of the section, to the precision of `context`."""
    if system.family_parameter is not None:
        return point[0]
    places = (i for i in range(len(system.given_state)) if i != system.section_index)
    return _level(system, parameters, dict(zip(places, point, strict=True)), context)


def _level(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    coordinates: Mapping[int, Any],
    context: mpmath.MPContext,
) -> Any:
    """The first integral where these coordinates have these values, others that are given are 0."""
    program = system.first_integral_program
    assert program is not None
    state = [coordinates.get(index, context.mpf(0)) for index in range(len(system.state))]
    fixed = [mpf(parameters[name], context) for name in system.parameters]
    constant, power = operations(context)
    functions = {name: getattr(context, name) for name in ("sin", "cos", "exp", "log")}
    state = with_functions(system, state, fixed, functions, constant, power)
    return program.evaluate([*state, *fixed], constant, power)[0]


def _without_level(
    candidate: Candidate, centre: list[Any], frame: list[list[Any]], context: mpmath.MPContext
) -> tuple[list[Any], list[list[Any]]]:
    """Centre and frame of a claim in level form in the coordinates of Fix(R).

    The level coordinate w follows from H = A + b w^2 and its sign, its row of the frame from dH.
    """
    system, sign = candidate.system, candidate.level_sign
    names = list(system.centre_coordinates)
    place = names.index(str(system.level_coordinate))
    point = [context.mpf(0) if name == system.level_coordinate else None for name in names]
    for name, value in zip(candidate.coordinates[1:], centre[1:], strict=True):
        point[names.index(name)] = value

    def level(coordinates: list[Any]) -> Any:
        return level_at(system, candidate.parameters, coordinates, context)

    at_zero = level(point)
    quadratic = level([context.mpf(1) if i == place else value for i, value in enumerate(point)]) - at_zero
    point[place] = sign * context.sqrt((centre[0] - at_zero) / quadratic)
    step = context.ldexp(1, -context.prec // 3)
    gradient = []
    for i in range(len(point)):
        ahead, behind = (
            level([value + shift if j == i else value for j, value in enumerate(point)]) for shift in (step, -step)
        )
        gradient.append((ahead - behind) / (2 * step))
    rows: list[list[Any]] = [[context.mpf(0)] * len(names) for _ in names]
    for name, row in zip(candidate.coordinates[1:], frame[1:], strict=True):
        rows[names.index(name)] = row
    rows[place] = [
        (frame[0][j] - sum(gradient[i] * rows[i][j] for i in range(len(names)) if i != place)) / gradient[place]
        for j in range(len(names))
    ]
    return point, rows


def _floats(rows: Sequence[Sequence[Any]]) -> Matrix:
    return np.array([[float(value) for value in row] for row in rows])
