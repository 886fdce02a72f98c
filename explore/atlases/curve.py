"""The points of a traced family as a curve in the coordinates of an atlas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.atlases.complex_flow import LANES, HalfReturns
from orbitproof.explore.families import Family
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import CorrectionFailure, singularities_of

BEYOND, DOUBLINGS = 1.25, 30
"""The time of an orbit is first searched up to so many times that of the last one; this range is doubled so often."""

RESOLVED = LANES // 4
"""Interpolation is exact enough with so many of the times before the one that is searched."""


@dataclass(frozen=True)
class FamilyPoint:
    """A point of a family.

    Attributes:
        place: arclength of the family, in its own units.
        point: shape (1 + n,), in the system's `centre_coordinates`.
        tangent: shape (1 + n,), derivative of the point in `place`.
        half_period: in the system's time.
    """

    place: float
    point: Vector
    tangent: Vector
    half_period: float


@dataclass(frozen=True)
class Curve:
    """A traced family, with the frames in which it is expanded.

    Attributes:
        family: traced a little further than the curve goes.
        graph: whether p_0 is the family parameter alone, instead of the direction of the tangent.
    """

    family: Family
    graph: bool

    def at(self, place: float) -> FamilyPoint:
        """The point at an arclength of the family. Raises `CorrectionFailure`."""
        family, problem = self.family, self.family.problem
        orbit = family.orbit_at(place)
        nearest = int(np.argmin(np.abs(np.array(family.arclengths) - place)))
        try:
            _, jacobian, _ = problem.evaluate(orbit.unknowns)
        except FlowFailure as error:
            raise CorrectionFailure(str(error)) from None
        tangent = problem.tangent(jacobian, family.tangents[nearest]) * problem.scales
        return FamilyPoint(place, orbit.unknowns[:-1], tangent[:-1], orbit.half_period)

    def frame(self, tangent: Vector) -> Matrix:
        """A frame whose column 0 is along the curve: orthonormal, or for a graph the identity."""
        size = len(tangent)
        if self.graph:
            return np.eye(size)
        columns = [tangent / float(np.linalg.norm(tangent))]
        while len(columns) < size:
            rest = np.eye(size) - sum(np.outer(column, column) for column in columns)
            chosen = rest[:, int(np.argmax(np.linalg.norm(rest, axis=0)))]
            columns.append(chosen / float(np.linalg.norm(chosen)))
        return np.column_stack(columns)

    def scale(self, point: Vector) -> float:
        """A typical length near a point: the distance from the nearest primary, 1 in other systems."""
        problem = self.family.problem
        places = singularities_of(problem.system, problem.parameters)
        return 1.0 if places is None else places.distance(problem.initial_state(np.append(point, 1.0)))


def coordinate_time(returns: HalfReturns, point: Vector, half_period: float, guess: float) -> float:
    """The time of the coordinates after which the system's time is `half_period`, to some six digits.

    The orbit is followed over many times at once, between which the system's, which increases, is interpolated.
    Raises `FlowFailure`.
    """
    if returns.regularisation is None:
        return half_period
    longest = BEYOND * guess
    for _ in range(DOUBLINGS):
        times = longest * (np.arange(LANES) + 1) / LANES
        clocks = returns.clocks(point, times)
        number = int(np.searchsorted(clocks, half_period))
        if number < RESOLVED:
            longest = longest * 2 * (number + 1) / LANES
        elif number == LANES:
            longest *= 2
        else:
            near = slice(min(number - 2, LANES - 4), number + 2)
            return float(np.polyfit(clocks[near] / half_period - 1, times[near], 3)[-1])
    raise FlowFailure(f"the orbit does not reach the time {half_period:.6g} in regularised coordinates")
