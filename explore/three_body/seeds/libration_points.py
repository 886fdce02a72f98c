"""Collinear libration points of the CR3BP and the planar and vertical orbits near them.

Nondimensional units: distance of the primaries 1, angular velocity 1, total mass 1; the primaries
stand at (-mu, 0, 0) and (1 - mu, 0, 0).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.explore.orbits import Singularities
from orbitproof.shared.systems import CR3BP


@dataclass(frozen=True)
class LibrationPoint:
    """A collinear libration point.

    Attributes:
        name: "L1" (between the primaries), "L2" (beyond the mass mu), "L3" (beyond the mass 1 - mu).
        mu: mass parameter.
        x: its coordinate; y = z = 0.
        distance: from the nearest primary.
        jacobi_constant: of the equilibrium.
    """

    name: str
    mu: float
    x: float
    distance: float
    jacobi_constant: float

    @property
    def stiffness(self) -> float:
        """c = (1-mu)/r_1^3 + mu/r_2^3 of the linearised equations; c > 1 at a collinear point."""
        first, second = primaries(self.mu)
        return (1.0 - self.mu) / abs(self.x - first[0]) ** 3 + self.mu / abs(self.x - second[0]) ** 3


LIBRATION_POINTS = ("L1", "L2", "L3")


def primaries(mu: float) -> tuple[Vector, Vector]:
    """Positions of the primaries of mass 1 - mu and mu, each of shape (3,)."""
    return np.array([-mu, 0.0, 0.0]), np.array([1.0 - mu, 0.0, 0.0])


def distance_to_primaries(states: Vector, mu: float) -> float:
    """Smallest distance of the states, shape (..., 6), to a primary."""
    return Singularities(primaries(mu), 1.0).distance(states)


def libration_point(name: str, mu: Fraction | float) -> LibrationPoint:
    """The collinear libration point `name` for any mass parameter in (0, 1).

    The force along the axis is increasing between its poles: bisection in the distance from the
    nearest primary, down to neighbouring doubles. Raises `ValueError` for an unknown name or a mass
    outside (0, 1).
    """
    mass = float(mu)
    if name not in LIBRATION_POINTS:
        raise ValueError(f"unknown libration point {name!r}")
    if not 0.0 < mass < 1.0:
        raise ValueError("the mass parameter lies in (0, 1)")
    at_smaller = name == "L2" or (name == "L1" and mass <= 0.5)
    own, other = (mass, 1.0 - mass) if at_smaller else (1.0 - mass, mass)
    centre = 1.0 - mass if at_smaller else -mass
    outwards = -1.0 if name == "L1" else 1.0
    side = outwards if at_smaller else -outwards

    def force(r: float) -> float:
        # At the distance r from the nearest primary, positive away from it; it increases with r.
        return side * centre + r - own / (r * r) - outwards * other / (1.0 + outwards * r) ** 2

    low, high = 0.0, 1.0 if name == "L1" else 2.0
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if force(middle) < 0 else (low, middle)
    x = centre + side * high
    state = (x, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert CR3BP.first_integral is not None
    return LibrationPoint(name, mass, x, high, float(CR3BP.first_integral(state, (mass,))[0]))


@dataclass(frozen=True)
class LinearOrbit:
    """A small periodic orbit of the linearised equations.

    Attributes:
        state: shape (6,), a point of the orbit on Fix(R).
        direction: shape (6,), change of `state` with the amplitude.
        half_period: pi over the frequency.
    """

    state: Vector
    direction: Vector
    half_period: float


def lyapunov_orbit(point: LibrationPoint, amplitude: float, side: int) -> LinearOrbit:
    """The planar Lyapunov orbit with a small x amplitude, to first order.

    With c as in `LibrationPoint.stiffness`, the planar equations x'' - 2y' = (1+2c) x,
    y'' + 2x' = (1-c) y have the frequency w, w^4 - (2-c) w^2 + (1+2c)(1-c) = 0, and vy = -(w^2+1+2c)/2 x
    on the axis. `side` = +-1 tells on which side of the libration point the first crossing lies.
    """
    c = point.stiffness
    square = _planar_frequency_squared(c)
    direction = side * np.array([1.0, 0.0, 0.0, 0.0, -0.5 * (square + 1.0 + 2.0 * c), 0.0])
    return LinearOrbit(_resting(point) + amplitude * direction, direction, float(np.pi / np.sqrt(square)))


def vertical_orbit(point: LibrationPoint, amplitude: float) -> LinearOrbit:
    """The vertical Lyapunov orbit with a small z amplitude, to first order, at its highest point.

    z'' = -c z; what the orbit does in the plane is of second order.
    """
    direction = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    return LinearOrbit(_resting(point) + amplitude * direction, direction, float(np.pi / np.sqrt(point.stiffness)))


def detuning(point: LibrationPoint) -> float:
    """How far apart the frequencies of the planar and of the vertical oscillation are, relative to the latter.

    Small at L3 for small mu; a family then starts only at amplitudes whose square is smaller.
    """
    c = point.stiffness
    return abs(float(np.sqrt(_planar_frequency_squared(c) / c)) - 1.0)


def _resting(point: LibrationPoint) -> Vector:
    return np.array([point.x, 0.0, 0.0, 0.0, 0.0, 0.0])


def _planar_frequency_squared(c: float) -> float:
    half = 0.5 * (2.0 - c)
    return half + float(np.sqrt(half * half + (1.0 + 2.0 * c) * (c - 1.0)))
