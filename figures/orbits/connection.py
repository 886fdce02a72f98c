"""Homoclinic orbits as polylines, with the manifolds where they meet, for drawing only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from orbitproof.explore.connections import ConnectionFailure, OnLevel, setting_of
from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.shared.claims import HomoclinicOrbit

_NEAR = 1e-7
"""So far from the periodic orbit, relative to its distance from 0, the multiplier is taken."""
_FARTHEST = 1e-6
"""A homoclinic orbit is drawn from a point at most so far from the periodic orbit: double precision loses less then."""
_TOLERANCE = 1e-12
_ROWS = 4000
_SAMPLES = 401
_NEWTON_STEPS = 6
_PART = 1e-4
_REACH = 0.5
"""The manifold is drawn for so large a part of a about that of the homoclinic orbit."""
_JUMP = 20.0
"""It ends where the next point is so many times as far as usual."""
_LONGEST = 1e3
_AT_FIXED_SET = 1e-6
_MOVED = 0.02
"""What is farther from the claim, relative to a, is another orbit."""


@dataclass(frozen=True)
class Connection:
    """A homoclinic orbit and what it connects.

    Attributes:
        periodic: shape (K, 4), the periodic orbit.
        orbit: shape (K, 4), the homoclinic orbit from near the periodic one through Fix(R) and back.
        meeting: shape (4,), where it is in Fix(R).
        unstable: shape (M, 4), the unstable manifold in the section, about the meeting; R maps it to the stable one.
    """

    periodic: Array
    orbit: Array
    meeting: Array
    unstable: Array


def connection_of(claim: HomoclinicOrbit) -> Connection:
    """The homoclinic orbit of a claim, in double precision. Raises `OrbitNotClosed` if it does not come to Fix(R)."""
    try:
        setting = setting_of(claim)
    except ConnectionFailure as failure:
        raise OrbitNotClosed(str(failure)) from None
    c, slope = float(claim.centre[0]), float(claim.slope)

    def start(a: Array) -> Array:
        return setting.states(c + a, slope * a)

    def crossing(a: Array, number: int) -> Array:
        """Shape (5, N): state and time at the crossing of that number."""
        return setting.crossings_of(start(a), number, _LONGEST)[number - 1]

    near = _NEAR * max(1.0, abs(c))
    back = crossing(np.array([0.0, near, -near]), claim.crossings)
    moved = (back[setting.along] + back[setting.across] / slope)[1:]
    multiplier = float(moved[0] - moved[1]) / (4 * near)
    a, number = float(claim.centre[1]), claim.arrival
    while abs(a * multiplier) < _FARTHEST and number > claim.crossings:
        a, number = a * multiplier, number - claim.crossings
    claimed = a
    for _ in range(_NEWTON_STEPS):
        low, here, high = crossing(a * np.array([1 - _PART, 1.0, 1 + _PART]), number)[setting.across]
        a -= 2 * _PART * a * here / (high - low)
    at = crossing(np.array([a]), number)[:, 0]
    is_found = abs(a - claimed) < _MOVED * abs(claimed)
    if not (is_found and abs(at[setting.across]) < _AT_FIXED_SET * (1 + np.abs(at[:4]).max())):
        raise OrbitNotClosed(f"the homoclinic orbit of {claim.id} does not come to Fix(R) in double precision")
    half = _over(setting, start(np.array([a]))[:, 0], float(at[4]))
    signs = np.array(claim.reversing_symmetry, dtype=float)
    near_it = crossing(a * (1 + _REACH * np.linspace(-1, 1, _SAMPLES)), number)[:4].T
    return Connection(
        _over(setting, start(np.array([0.0]))[:, 0], float(back[4, 0])),
        np.vstack([half, half[-2::-1] * signs]),
        at[:4],
        _without_jumps(near_it),
    )


def _without_jumps(points: Array) -> Array:
    """The part about the middle in which each point is near the one before."""
    far = np.abs(np.diff(points, axis=0)).max(axis=1)
    middle = len(points) // 2
    usual = np.nanmedian(far[middle - 20 : middle + 20])
    bad = np.flatnonzero(~(far < _JUMP * usual))
    first = max((int(place) + 1 for place in bad if place < middle), default=0)
    last = min((int(place) + 1 for place in bad if place >= middle), default=len(points))
    return points[first:last]


def _over(setting: OnLevel, start: Array, time: float) -> Array:
    """An orbit over a time, shape (K, 4)."""

    def field(_time: float, state: Array) -> Array:
        return setting.field(state[:, None])[:, 0]

    times = np.linspace(0.0, time, _ROWS)
    found = solve_ivp(field, (0.0, time), start, "DOP853", times, rtol=_TOLERANCE, atol=_TOLERANCE)
    if not (found.success and np.all(np.isfinite(found.y))):
        raise OrbitNotClosed("the orbit cannot be followed")
    rows: Array = found.y.T
    return rows
