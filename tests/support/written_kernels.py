"""Kernels for SPICE that a test writes: the Earth and the Moon on an ellipse about each other, the Sun on another."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import spiceypy

GRAVITY = {"Earth": 398600.436, "Moon": 4902.8001, "Sun": 132712440041.28}
MASS = GRAVITY["Moon"] / (GRAVITY["Earth"] + GRAVITY["Moon"])
LENGTH, YEAR = 389703.264829278, 149597870.7
START, STOP, STEP = -2e5, 1.4e6, 1800.0
"""TDB seconds past J2000 between which there are states."""


def kepler(axis: float, eccentricity: float, gravity: float, times: np.ndarray) -> np.ndarray:
    """States on an ellipse in the plane z = 0, shape (N, 6), in the pericentre at time 0."""
    rate = np.sqrt(gravity / axis**3)
    mean = rate * np.asarray(times, dtype=float)
    angle = mean.copy()
    for _ in range(30):
        angle -= (angle - eccentricity * np.sin(angle) - mean) / (1 - eccentricity * np.cos(angle))
    root, zero = np.sqrt(1 - eccentricity**2), np.zeros_like(angle)
    fast = axis * rate / (1 - eccentricity * np.cos(angle))
    return np.column_stack([
        axis * (np.cos(angle) - eccentricity), axis * root * np.sin(angle), zero,
        -fast * np.sin(angle), fast * root * np.cos(angle), zero,
    ])  # fmt: skip


def moon(times: np.ndarray, eccentricity: float) -> np.ndarray:
    """States of the Moon relative to the Earth, inclined."""
    tilt = 0.09 if eccentricity else 0.0
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    states = kepler(LENGTH, eccentricity, GRAVITY["Earth"] + GRAVITY["Moon"], times)
    return np.hstack([states[:, :3] @ turn.T, states[:, 3:] @ turn.T])


def sun(times: np.ndarray) -> np.ndarray:
    """States of the Sun relative to the centre of mass of the Earth and the Moon."""
    return -kepler(YEAR, 0.0167, sum(GRAVITY.values()), times)


def write_kernel(path: Path, eccentricity: float) -> Path:
    """A kernel with all three."""
    times = np.arange(START, STOP, STEP)
    relative = moon(times, eccentricity)
    handle = spiceypy.spkopn(str(path), "written by a test", 0)
    for body, states in ((399, -MASS * relative), (301, (1 - MASS) * relative), (10, sun(times))):
        spiceypy.spkw13(handle, body, 3, "J2000", times[0], times[-1], "test", 7, len(times), states, times)
    spiceypy.spkcls(handle)
    return path
