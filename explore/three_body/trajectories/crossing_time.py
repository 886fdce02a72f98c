"""How long an orbit takes until it has crossed a plane so many times: what a claim about an orbit leaves open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.shared.systems import System

LONGEST = 1e4
_AT_START = 1e-6


def time_of_crossing(
    system: System, parameters: Sequence[float], start: Vector, normal: Vector, count: int, direction: int = 0
) -> float | None:
    """The time of the crossing number `count` of the plane through `start`, which itself does not count.

    Arguments:
        parameters: all of the vector field, in its order.
        normal: shape (m,), of the plane.
        direction: 1 or -1: only crossings in which normal . x grows or falls; 0: all.

    `None` if there are not so many.
    """
    # Only now: scipy takes a moment to load.
    from scipy.integrate import solve_ivp

    def field(_: float, state: Vector) -> Sequence[float]:
        return [float(value) for value in system.vector_field(state.tolist(), parameters)]

    def height(_: float, state: Vector) -> float:
        return float(normal @ (state - start))

    # The start may count as a crossing.
    height.terminal = count + 1  # type: ignore[attr-defined]
    height.direction = direction  # type: ignore[attr-defined]
    try:
        solution = solve_ivp(field, (0.0, LONGEST), start, method="DOP853", rtol=1e-12, atol=1e-12, events=height)
    except (ArithmeticError, ValueError):
        return None
    times = solution.t_events[0]
    times = times[times > _AT_START]
    return float(times[count - 1]) if len(times) >= count else None


def half_period_of(
    system: System, parameters: Sequence[float], start: Vector, section: int, crossings: int
) -> float | None:
    """The time from a point of Fix(R) to the crossing of the section with this number, `None` if there is none."""
    return time_of_crossing(system, parameters, start, np.eye(len(start))[section], crossings)
