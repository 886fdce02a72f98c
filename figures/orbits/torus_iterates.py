"""Points of the invariant curve beside a Neimark-Sacker bifurcation, by iterating a return map: for drawing only.

Points start on the ellipse that the certificate's coefficients suggest and are iterated together, with the flow where
the torus attracts, against it where it repels; where it does neither they do not come to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orbitproof.figures.orbits.fixed_set import Array
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.figures.orbits.return_map import ReturnMap
from orbitproof.figures.orbits.returning import ReturningOrbit
from orbitproof.shared.formats import PeriodicBifurcation

_RADII = (0.12, 0.06, 0.03)
"""Radii of the ellipse at its widest, relative to the size of the orbit; those that lead to nothing are left out."""
_POINTS = 12
_ITERATIONS = 400
_AT_ONCE = 20
"""Iterations after which the curve is looked at."""
_SETTLED = 5e-3
"""How far the iterates may be from one curve, relative to its size."""
_PATIENCE = 3
"""After so many looks they have to be nearer to one."""
_MOST_TIMES = 3.0
"""Which part or multiple of its first size the curve has at most."""
_TOLERANCE = 1e-8
_HARMONICS = 8


@dataclass(frozen=True)
class TorusPoints:
    """Points of the map that nearly lie on an invariant curve.

    Attributes:
        value: of the parameter.
        values: all parameters.
        states: shape (M, N), on the section.
        iterations: after how many, at most.
        backwards: whether they were iterated against the flow.
        time: of one return of the orbit that bifurcates, negative backwards.
    """

    value: float
    values: tuple[float, ...]
    states: Array
    iterations: int
    backwards: bool
    time: float


def torus_points(
    claim: PeriodicBifurcation,
    orbit: ReturningOrbit,
    values: Sequence[float],
    speed: float,
    lyapunov: float,
) -> TorusPoints:
    """Points of the invariant curve on the side where it is.

    Arguments:
        orbit: at the bifurcation, from its point on.
        values: the parameters there.
        speed: of the absolute value of the pair of multipliers in the parameter.
        lyapunov: the first Lyapunov coefficient, for the eigenvector of the claim.

    Raises `OrbitNotClosed` if iterating does not lead to one.
    """
    kernel = np.array([[float(value) for value in row] for row in claim.kernel])
    place = list(claim.system.parameters).index(str(claim.parameter))
    size, backwards = float(np.ptp(orbit.states, axis=0).max()), lyapunov > 0
    time = -float(orbit.times[-1]) if backwards else float(orbit.times[-1])
    for part in _RADII:
        start = ReturnMap(claim, values, time)
        widest = np.linalg.norm(start.states(kernel) - start.states(0 * kernel), axis=1).max()
        # A point is 2 Re(z q) with the eigenvector q; |z| is 1 + speed (a - a*) + lyapunov |z|^2 times as large next.
        radius = part * size / (2 * widest)
        moved = list(values)
        moved[place] -= lyapunov * radius**2 / speed
        try:
            section = ReturnMap(claim, moved, time, _TOLERANCE)
            states, iterations = _iterated(section, orbit.states[0], kernel, radius)
        except OrbitNotClosed:
            continue
        return TorusPoints(moved[place], tuple(moved), states, iterations, backwards, time)
    raise OrbitNotClosed("iterating the map of the section in double precision leads to no invariant curve")


def _iterated(section: ReturnMap, point: Array, kernel: Array, radius: float) -> tuple[Array, int]:
    """States of the curve, and after how many iterations."""
    angles = 2 * np.pi * np.arange(_POINTS) / _POINTS
    around = 2 * radius * (np.outer(np.cos(angles), kernel[0]) - np.outer(np.sin(angles), kernel[1]))
    states = section.states(section.coordinates(point[None]) + around)
    errors, first = list[float](), float(np.ptp(around, axis=0).max())
    for number in range(_AT_ONCE, _ITERATIONS + 1, _AT_ONCE):
        kept = []
        for _ in range(_AT_ONCE):
            states = section.images(states)
            kept.append(states)
        points = section.coordinates(np.vstack(kept))
        width = float(np.ptp(points, axis=0).max())
        if not first / _MOST_TIMES < width < first * _MOST_TIMES:
            break
        errors.append(_distance_from_curve(points, kernel) / width)
        if errors[-1] < _SETTLED and number > _AT_ONCE:
            return np.vstack(kept), number
        if len(errors) > _PATIENCE and errors[-1] > errors[-1 - _PATIENCE]:
            break
    raise OrbitNotClosed("the points do not settle on a curve")


def _distance_from_curve(points: Array, kernel: Array) -> float:
    """How far points are, at most, from a closed curve about their middle.

    The curve is the sum of sines over the angle in the plane of the kernel that is nearest to all of them.
    """
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    real, imaginary = np.linalg.lstsq(kernel.T, (points - middle).T, rcond=None)[0]
    waves = np.outer(np.arctan2(imaginary, real), np.arange(_HARMONICS + 1))
    shape = np.hstack([np.cos(waves), np.sin(waves[:, 1:])])
    nearest = shape @ np.linalg.lstsq(shape, points, rcond=None)[0]
    return float(np.abs(nearest - points).max())
