"""Least and greatest distances of many periodic orbits from the primaries, in double precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import Matrix, Vector, flow_batch
from orbitproof.explore.seeds import primaries
from orbitproof.shared.systems import CR3BP

PARTS = 48
"""Into so many parts of equal time an orbit, or half of a symmetric one, is cut for each of its crossings."""

_STEPS = 6


@dataclass(frozen=True)
class Distances:
    """Shape (N,) each, in units of the distance of the primaries; NaN for an orbit that cannot be followed.

    Attributes:
        least, greatest: from the smaller primary.
        least_from_larger: from the larger one.
    """

    least: Vector
    greatest: Vector
    least_from_larger: Vector


def distances(states: Matrix, times: Vector, mass: float, parts: int = PARTS) -> Distances:
    """Over the arcs that begin at N states of the CR3BP, shape (N, 6), and take these times: whole or half orbits."""
    count = len(states)
    steps, values = times / parts, np.full((count, 1), mass)
    here = np.asarray(states, dtype=float)
    larger, smaller = primaries(mass)
    rows = {"near": [_distance(here, smaller)], "far": [_distance(here, larger)]}
    least, greatest = rows["near"][0].copy(), rows["near"][0].copy()
    nearest_larger = rows["far"][0].copy()
    for _ in range(parts):
        there = flow_batch(CR3BP, here, steps, values).states
        for place, kinds in ((smaller, (1, -1)), (larger, (1,))):
            for kind in kinds:
                found = _extremum(here, there, steps, place, kind, mass)
                if place is larger:
                    nearest_larger = np.fmin(nearest_larger, found)
                elif kind == 1:
                    least = np.fmin(least, found)
                else:
                    greatest = np.fmax(greatest, found)
        least = np.fmin(least, _distance(there, smaller))
        greatest = np.fmax(greatest, _distance(there, smaller))
        nearest_larger = np.fmin(nearest_larger, _distance(there, larger))
        here = there
    lost = ~np.all(np.isfinite(here), axis=1)
    return Distances(*(np.where(lost, np.nan, found) for found in (least, greatest, nearest_larger)))


def _distance(states: Matrix, place: Vector) -> Vector:
    return np.asarray(np.linalg.norm(states[:, :3] - place, axis=1))


def _rate(states: Matrix, place: Vector) -> Vector:
    """Half the derivative of the square of the distance."""
    return np.asarray(np.sum((states[:, :3] - place) * states[:, 3:], axis=1))


def _extremum(here: Matrix, there: Matrix, steps: Vector, place: Vector, kind: int, mass: float) -> Vector:
    """The least (kind 1) or greatest (-1) distance inside the parts that have one; NaN for the others."""
    result = np.full(len(here), np.nan)
    before, after = kind * _rate(here, place), kind * _rate(there, place)
    inside = np.flatnonzero((before < 0) & (after > 0))
    if not len(inside):
        return result
    start, low, high = here[inside], np.zeros(len(inside)), steps[inside].copy()
    f_low, f_high = before[inside], after[inside]
    values = np.full((len(inside), 1), mass)
    # The rate is followed from both sides (Illinois), which keeps the extremum between them.
    side = np.zeros(len(inside))
    states = start
    for _ in range(_STEPS):
        middle = (low * f_high - high * f_low) / (f_high - f_low)
        middle = np.clip(middle, low + 1e-3 * (high - low), high - 1e-3 * (high - low))
        states = flow_batch(CR3BP, start, middle, values).states
        rate = kind * _rate(states, place)
        left = rate < 0
        f_high = np.where(left & (side == -1), f_high / 2, np.where(left, f_high, rate))
        f_low = np.where(~left & (side == 1), f_low / 2, np.where(left, rate, f_low))
        low, high = np.where(left, middle, low), np.where(left, high, middle)
        side = np.where(left, -1, 1)
    result[inside] = _distance(states, place)
    return result
