"""Heteroclinic orbits between two symmetric periodic orbits on one level of the first integral.

R maps the unstable manifold of the second orbit to its stable manifold. Both unstable manifolds are followed, half the
way each; where the first one meets the mirror image of the other one in the section, an orbit leads from the first to
the second. Not rigorous.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import log

import numpy as np

from orbitproof.explore.connections.homoclinic import (
    ConnectionFailure,
    Homoclinic,
    Hyperbolic,
    from_manifold,
    nth_place,
)
from orbitproof.explore.connections.swarm import Array
from orbitproof.explore.numerics import fraction, mpf, working_context
from orbitproof.explore.refinement import IntegrationFailure

_SAMPLES = 400
_LONGEST = 4
"""Orbits are followed for so many periods longer than the periodic orbit has as many crossings."""
_AT_ONCE = 2
"""Crossings that are computed in advance."""
_LONGEST_SEGMENT = 0.2
_NEWTON_STEPS = 40
_DOUBLE_STEPS = 5
_PART = 1e-5
_CLOSE = 1e-5
_FARTHEST = 0.1
"""So far from a guess, relative to it, a point of another intersection may be."""
_SAME = 1e-4
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
        time = orbit.period * (most / (2 * orbit.half) + _LONGEST)
        return setting.crossings_of(start, most, time)[:, :4]

    def distances(self) -> Array:
        """Those of one fundamental interval."""
        length = log(abs(float(self.orbit.multiplier))) * (1 if self.orbit.multiplier > 0 else 2)
        return self.side * self.orbit.first * np.exp(length * np.linspace(0, 1, _SAMPLES + 1))


def heteroclinic_orbits(first: Branch, second: Branch, numbers: Collection[int] = ()) -> list[Heteroclinic]:
    """Orbits from one branch to the mirror image of another one.

    Arguments:
        numbers: of crossings from the fundamental interval of the one to that of the other; by default the first at
            which there are such orbits.
    """
    within = sorted(numbers) or range(2, first.orbit.crossings + second.orbit.crossings + 1)
    branches = first, second
    distances = [branch.distances() for branch in branches]
    states: list[Array] = []
    found: list[Heteroclinic] = []
    for number in within:
        counts = (number + 1) // 2, number // 2
        if (found and not numbers) or not counts[1]:
            continue
        if not states or len(states[0]) < counts[0]:
            most = counts[0] + _AT_ONCE
            states = [branch.crossings(each, most) for branch, each in zip(branches, distances, strict=True)]
        curves = [state[count - 1] for state, count in zip(states, counts, strict=True)]
        guesses = np.array(list(_meetings(first, distances, curves))).reshape(-1, 2)
        for near in _nearer(branches, guesses, counts):
            if not any(_is_same(near, counts, each) for each in found):
                ends = [
                    Homoclinic(branch.orbit, Fraction(float(a)), count)
                    for branch, a, count in zip(branches, near, counts, strict=True)
                ]
                found.append(Heteroclinic((ends[0], ends[1])))
    return found


def _meetings(branch: Branch, distances: Sequence[Array], curves: Sequence[Array]) -> Iterator[list[float]]:
    """Where polylines (p, q) and (p, -q) with w of one sign intersect: both a."""
    setting, (first, second) = branch.orbit.setting, curves
    height = setting.system.state.index(str(setting.system.level_coordinate))
    here, there = first[[setting.along, setting.across]], second[[setting.along, setting.across]] * [[1], [-1]]
    u, v = np.diff(here), np.diff(there)
    between = there[:, None, :-1] - here[:, :-1, None]
    with np.errstate(all="ignore"):
        size = u[0][:, None] * v[1] - u[1][:, None] * v[0]
        s = (between[0] * v[1] - between[1] * v[0]) / size
        t = (between[0] * u[1][:, None] - between[1] * u[0][:, None]) / size
        alike = first[height, :-1, None] * second[height, :-1] > 0
        # A long segment is a jump.
        short = np.all(abs(u) < _LONGEST_SEGMENT, axis=0)[:, None] & np.all(abs(v) < _LONGEST_SEGMENT, axis=0)
        hits = alike & short & (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    for place in np.argwhere(hits):
        parts = s[tuple(place)], t[tuple(place)]
        yield [
            float(each[i] + part * (each[i + 1] - each[i]))
            for each, i, part in zip(distances, place, parts, strict=True)
        ]


def _nearer(branches: Sequence[Branch], guesses: Array, counts: Sequence[int]) -> Iterator[Array]:
    """Newton's method in double precision from all guesses at once; without those that lead elsewhere."""
    if not len(guesses):
        return
    setting, a, size = branches[0].orbit.setting, guesses.copy(), np.full(len(guesses), np.inf)
    mirror, moves = np.array([[1], [-1]]), np.array([1, 1 + _PART, 1 - _PART])
    for _ in range(_DOUBLE_STEPS):
        values, slopes = [], []
        for branch, distances, count in zip(branches, a.T, counts, strict=True):
            at = branch.crossings((moves[:, None] * distances).ravel(), count)[count - 1]
            found = at[[setting.along, setting.across]].reshape(2, 3, -1)
            values.append(found[:, 0])
            slopes.append((found[:, 1] - found[:, 2]) / (2 * _PART * distances))
        (p, q), (p_1, q_1), (p_2, q_2) = values[0] - mirror * values[1], slopes[0], slopes[1]
        with np.errstate(all="ignore"):
            step = np.array([q_2 * p + p_2 * q, p_1 * q - q_1 * p]).T / (p_1 * q_2 + p_2 * q_1)[:, None]
            size = np.max(abs(step / a), axis=1)
            a = a - step
        if not np.any(size > _CLOSE):
            break
    near = np.max(abs(a / guesses - 1), axis=1) < _FARTHEST
    yield from a[(size < _CLOSE) & near]


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
