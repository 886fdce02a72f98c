"""Least and greatest distances of many periodic orbits from the primaries, in double precision."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_batch, flow_of
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.shared.systems import CR3BP

PARTS = 48
"""Into so many parts of equal time an orbit, or half of a symmetric one, is cut for each of its crossings."""

_STEPS = 6

_FEW = 4
"""So many orbits are followed one by one: the loop over many of them takes longer to compile."""


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


def distances_from_primaries(states: Matrix, times: Vector, mass: float, parts: int = PARTS) -> Distances:
    """Over the arcs that begin at N states of the CR3BP, shape (N, 6), and take these times: whole or half orbits."""
    here, steps, values = np.asarray(states, dtype=float), times / parts, np.full((len(times), 1), mass)
    larger, smaller = primaries(mass)
    # Least values of three quantities: a distance, its negative, and the distance from the other primary.
    places, signs = np.array([smaller, smaller, larger]), np.array([1.0, -1.0, 1.0])
    least, before = _signed(here, places[:, None], signs[:, None])
    parts_with_one = []
    for _ in range(parts):
        there = _followed(here, steps, values)
        at_end, after = _signed(there, places[:, None], signs[:, None])
        which, orbit = np.nonzero((before < 0) & (after > 0))
        parts_with_one.append((which, orbit, here[orbit], before[which, orbit], after[which, orbit]))
        here, least, before = there, np.fmin(least, at_end), after
    which, orbit, start, before, after = map(np.concatenate, zip(*parts_with_one, strict=True))
    inside = _least(start, steps[orbit], places[which], signs[which], before, after, mass)
    np.fmin.at(least, (which, orbit), inside)
    return Distances(*np.where(np.all(np.isfinite(here), axis=1), signs[:, None] * least, np.nan))


def _followed(states: Matrix, times: Vector, values: Matrix) -> Matrix:
    """Where states of the CR3BP are after these times; NaN for those that cannot be followed."""
    if len(times) > _FEW:
        return flow_batch(CR3BP, states, times, values).states
    ends = np.full(states.shape, np.nan)
    for number, (state, time, parameters) in enumerate(zip(states, times, values, strict=True)):
        with suppress(FlowFailure):
            ends[number] = flow_of(CR3BP).derivative(state, float(time), parameters).state
    return ends


def _signed(states: Matrix, places: np.ndarray, signs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances from places with signs, and half the derivatives of their squares with the same signs."""
    offsets = states[:, :3] - places
    return signs * np.linalg.norm(offsets, axis=-1), signs * np.sum(offsets * states[:, 3:], axis=-1)


def _least(
    start: Matrix, steps: Vector, places: Matrix, signs: Vector, f_low: Vector, f_high: Vector, mass: float
) -> Vector:
    """The least signed distances inside parts at whose ends its rates are negative and positive."""
    low, high = np.zeros(len(start)), steps.copy()
    values = np.full((len(start), 1), mass)
    # The rate is followed from both sides (Illinois), which keeps the extremum between them.
    side = np.zeros(len(start))
    distance = np.full(len(start), np.nan)
    for _ in range(_STEPS):
        middle = (low * f_high - high * f_low) / (f_high - f_low)
        middle = np.clip(middle, low + 1e-3 * (high - low), high - 1e-3 * (high - low))
        distance, rate = _signed(_followed(start, middle, values), places, signs)
        left = rate < 0
        f_high = np.where(left & (side == -1), f_high / 2, np.where(left, f_high, rate))
        f_low = np.where(~left & (side == 1), f_low / 2, np.where(left, rate, f_low))
        low, high = np.where(left, middle, low), np.where(left, high, middle)
        side = np.where(left, -1, 1)
    return distance
