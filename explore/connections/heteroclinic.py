"""Heteroclinic orbits between two symmetric periodic orbits on one level of the first integral.

R maps the unstable manifold of the second orbit to its stable manifold. Both unstable manifolds are followed, half the
way each; where the first one meets the mirror image of the other one in the section, an orbit leads from the first to
the second. Not rigorous.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import log

import numpy as np

from orbitproof.explore.connections.homoclinic import (
    LONGEST,
    ConnectionFailure,
    Homoclinic,
    Hyperbolic,
    from_manifold,
    nth_place,
)
from orbitproof.explore.connections.swarm import Array
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement import IntegrationFailure

_SAMPLES = 600
_NEWTON_STEPS = 40
_DOUBLE_STEPS = 8
_PART = 1e-6
_CLOSE = 1e-9
_SAME = 1e-6
"""Orbits whose a differ by a smaller part of it are one."""


@dataclass(frozen=True)
class Heteroclinic:
    """An orbit from one periodic orbit to another one.

    Attributes:
        ends: a point on the unstable manifold of the first, and one on that of the second; the mirror image of the
            second one's crossing of that number is that of the first one.
    """

    ends: tuple[Homoclinic, Homoclinic]


@dataclass(frozen=True)
class Branch:
    """One branch of the unstable manifold of a periodic orbit: p grows on it for side 1, and falls for -1."""

    orbit: Hyperbolic
    side: int

    def crossings(self, distances: Array, most: int) -> Array:
        """Shape (most, 4, N): the states at the crossings from points at these distances; NaN where there is none."""
        orbit, setting = self.orbit, self.orbit.setting
        start = setting.states(float(orbit.p) + distances, float(orbit.slope) * distances)
        time = orbit.period * (most / (2 * orbit.half) + LONGEST)
        return setting.crossings_of(start, most, time)[:, :4]

    def distances(self) -> Array:
        """Those of one fundamental interval."""
        length = log(abs(float(self.orbit.multiplier))) * (1 if self.orbit.multiplier > 0 else 2)
        return self.side * self.orbit.first * np.exp(length * np.linspace(0, 1, _SAMPLES + 1))


def heteroclinic_orbits(first: Branch, second: Branch, numbers: Sequence[int]) -> list[Heteroclinic]:
    """Orbits from one branch to the mirror image of another one, with so many crossings between both in all."""
    most = (max(numbers) + 1) // 2
    ways = [(branch, branch.distances()) for branch in (first, second)]
    states = [branch.crossings(distances, most) for branch, distances in ways]
    found: list[Heteroclinic] = []
    for number in sorted(numbers):
        counts = (number + 1) // 2, number // 2
        if not counts[1]:
            continue
        curves = [state[count - 1] for state, count in zip(states, counts, strict=True)]
        for places in _meetings(first, *curves):
            guess = [
                distances[place] + part * (distances[place + 1] - distances[place])
                for (_, distances), (place, part) in zip(ways, places, strict=True)
            ]
            near = _nearer(first, second, np.array(guess), counts)
            if near is not None and not any(_is_same(near, counts, each) for each in found):
                ends = [
                    Homoclinic(branch.orbit, Fraction(float(a)), count)
                    for branch, a, count in zip((first, second), near, counts, strict=True)
                ]
                found.append(Heteroclinic((ends[0], ends[1])))
    return found


def _meetings(branch: Branch, first: Array, second: Array) -> Iterator[tuple[tuple[int, float], tuple[int, float]]]:
    """Where polylines (p, q) and (p, -q) with w of one sign intersect: the segments and the parts of them."""
    setting = branch.orbit.setting
    height = setting.system.state.index(str(setting.system.level_coordinate))
    here, there = first[[setting.along, setting.across]], second[[setting.along, setting.across]] * [[1], [-1]]
    u, v = np.diff(here), np.diff(there)
    between = there[:, None, :-1] - here[:, :-1, None]
    with np.errstate(all="ignore"):
        size = u[0][:, None] * v[1] - u[1][:, None] * v[0]
        s = (between[0] * v[1] - between[1] * v[0]) / size
        t = (between[0] * u[1][:, None] - between[1] * u[0][:, None]) / size
        alike = first[height, :-1, None] * second[height, :-1] > 0
        hits = alike & (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    for i, j in np.argwhere(hits):
        yield (int(i), float(s[i, j])), (int(j), float(t[i, j]))


def _nearer(first: Branch, second: Branch, a: Array, counts: tuple[int, int]) -> Array | None:
    """Newton's method in double precision; `None` where it leads elsewhere."""
    begun = a.copy()
    setting = first.orbit.setting
    wanted = [setting.along, setting.across]
    for _ in range(_DOUBLE_STEPS):
        values, slopes = [], []
        for branch, distance, count in zip((first, second), a, counts, strict=True):
            at = branch.crossings(distance * np.array([1, 1 + _PART, 1 - _PART]), count)[count - 1][wanted]
            values.append(at[:, 0])
            slopes.append((at[:, 1] - at[:, 2]) / (2 * _PART * distance))
        mirror = np.array([1, -1])
        gap = values[0] - mirror * values[1]
        matrix = np.array([slopes[0], -mirror * slopes[1]]).T
        if not (np.all(np.isfinite(matrix)) and np.linalg.det(matrix)):
            return None
        step = np.linalg.solve(matrix, gap)
        a = a - step
        if np.max(abs(step / a)) < _CLOSE:
            return a if np.max(abs(a / begun - 1)) < 0.2 else None
    return None


def _is_same(a: Array, counts: tuple[int, int], found: Heteroclinic) -> bool:
    return all(
        each.crossings == count and abs(float(each.distance) / value - 1) < _SAME
        for value, count, each in zip(a, counts, found.ends, strict=True)
    )


def refined_pair(ends: Sequence[Homoclinic], digits: int) -> Heteroclinic:
    """The pair of points whose arrivals are mirror images of each other. Raises `ConnectionFailure`."""
    lost = [32 - int(np.log2(abs(float(end.distance)))) for end in ends]
    bits = max(lost) + 32 + round(3.33 * digits)
    context, few = working_context(bits), max(lost) + 32
    a = [mpf(end.distance, context) for end in ends]
    try:
        for _ in range(_NEWTON_STEPS):
            at = [
                nth_place(from_manifold(end.orbit, fraction(value), few, 1), end.crossings)
                for end, value in zip(ends, a, strict=True)
            ]
            (p_1, q_1), (p_2, q_2) = ((each.slopes[0][0], each.slopes[1][0]) for each in at)
            p, q = at[0].p - at[1].p, at[0].q + at[1].q
            size = p_1 * q_2 + p_2 * q_1
            steps = (p * q_2 + q * p_2) / size, (q * p_1 - p * q_1) / size
            a = [value - step for value, step in zip(a, steps, strict=True)]
            change = max(abs(step / value) for step, value in zip(steps, a, strict=True))
            few = bits if change < 1e-4 else few
            if change < context.mpf(10) ** -digits:
                found = [
                    Homoclinic(end.orbit, fraction(value), end.crossings) for end, value in zip(ends, a, strict=True)
                ]
                return Heteroclinic((found[0], found[1]))
    except (IntegrationFailure, ZeroDivisionError) as failure:
        raise ConnectionFailure(f"the heteroclinic orbit is not found: {failure}") from None
    raise ConnectionFailure("Newton's method for the heteroclinic orbit does not converge")


def closer_pair(found: Heteroclinic, distance: float, digits: int) -> Heteroclinic:
    """The same orbit, between points of both unstable manifolds at which |a| is at most `distance`."""
    ends = []
    for end in found.ends:
        a, number = end.distance, end.crossings
        while abs(a) > distance:
            a, number = a / end.orbit.multiplier, number + 2 * end.orbit.half
        ends.append(Homoclinic(end.orbit, a, number))
    return refined_pair(ends, digits)
