"""A first symmetric periodic orbit of the Falkner-Skan equation, from its limit for large beta.

With the time sqrt(beta) t the equations become, for beta -> infinity, y'' = y^2 - 1: motion in a cubic
potential around y = -1. A periodic solution of the full equations needs x to return, so y has mean 0
over the period: this selects one orbit of the limit, from which Newton's method starts.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sqrt


@dataclass(frozen=True)
class LimitOrbit:
    """The orbit of y'' = y^2 - 1 with mean 0.

    Attributes:
        upper, lower: the turning points of y, at which the orbit meets Fix(R).
        half_period: in the time sqrt(beta) t.
    """

    upper: float
    lower: float
    half_period: float


def limit_orbit() -> LimitOrbit:
    """The orbit of y'' = y^2 - 1 whose y has mean 0, by bisection in its upper turning point."""
    low, high = 0.0, 1.0
    while True:
        upper = 0.5 * (low + high)
        if not low < upper < high:
            break
        low, high = (upper, high) if _orbit(upper)[1] < 0 else (low, upper)
    lower, _, half_period = _orbit(high)
    return LimitOrbit(high, lower, half_period)


def _orbit(upper: float, nodes: int = 400) -> tuple[float, float, float]:
    """Lower turning point, integral of y over the half period and the half period.

    y'^2 = 2/3 (y - upper)(y - lower)(y - other), the three roots having sum 0 and pair products -3.
    With y = middle + radius cos(theta) the integrals are regular and the midpoint rule converges
    geometrically.
    """
    root = sqrt(12.0 - 3.0 * upper * upper)
    lower, other = 0.5 * (-upper - root), 0.5 * (-upper + root)
    middle, radius = 0.5 * (upper + lower), 0.5 * (upper - lower)
    integral = time = 0.0
    for i in range(nodes):
        y = middle + radius * cos(pi * (i + 0.5) / nodes)
        weight = pi / nodes / sqrt(2.0 / 3.0 * (other - y))
        time += weight
        integral += weight * y
    return lower, integral, time
