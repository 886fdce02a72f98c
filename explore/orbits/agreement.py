"""What is said of an orbit, against the orbit that was found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.explore.orbits.singularities import singularities_of
from orbitproof.shared.systems import System

REMEDY = "mend the file, or take the orbit that was found: --accept"

_COARSEST = 1e-4
"""Numbers with many digits are taken to be off by so much, relative to the size of the orbit."""

_MAGNIFIED = 10.0
"""An orbit next to such numbers is off by so many times more; its stability index, by that once more."""

NOISE = 1e-6
"""Coordinates that are smaller, relative to the size of the orbit, are zeros that were computed."""


@dataclass(frozen=True)
class Numbers:
    """Numbers of an orbit: what is said of it, or what was found; `None`: nothing.

    Attributes:
        state: shape (m,), at time 0.
        period: the full one, in the system's time units.
        level: of the first integral.
        stability_index: (|lambda| + 1/|lambda|)/2 of the largest multiplier.
        stability_error: how well double precision knows that, relative where it exceeds 1 (`HalfReturn.error`).
        rounded: whether the numbers may be known no better than to the decimals in which they are written.
    """

    state: Vector
    period: float | None = None
    level: float | None = None
    stability_index: float | None = None
    stability_error: float = 0.0
    rounded: bool = False

    @property
    def unit(self) -> float:
        """The unit of the last decimal of the state and the period; 0: all digits of a double are known."""
        least = NOISE * float(np.abs(self.state).max())
        written = [*(value for value in self.state if abs(value) > least), *([self.period] if self.period else ())]
        return min(map(_last_unit, written), default=0.0) if self.rounded else 0.0


def contradictions(system: System, parameters: Sequence[float], said: Numbers, found: Numbers) -> tuple[str, ...]:
    """What is said of an orbit that is not so of the one that was found, with both numbers, a line for each.

    Arguments:
        parameters: all of the system's, in its order.
    """
    sizes, period, index = sizes_at(system, parameters, found.state), found.period or np.inf, found.stability_index
    coarse = _MAGNIFIED * max(_COARSEST, said.unit / float(sizes.min()), said.unit / period)
    moved = np.abs(said.state - found.state) / sizes
    worst = int(np.argmax(moved))
    lines = [_line(system.state[worst], said.state[worst], found.state[worst])] if moved[worst] > coarse else []

    def compare(name: str, told: float | None, there: float | None, allowed: float) -> None:
        if told is None or there is None:
            return
        rounding = 0.5 * _last_unit(told) if said.rounded else 0.0
        if not abs(told - there) <= allowed + rounding:
            lines.append(_line(name, told, there))

    compare("period", said.period, found.period, coarse * period)
    if None not in (said.level, found.level):
        allowed = coarse * _slopes(system, parameters, found.state, sizes)
        compare(system.first_integral_name or "level", said.level, found.level, allowed)
    known = _MAGNIFIED * coarse + found.stability_error
    compare("stability index", said.stability_index, index, known * max(1.0, index or 1.0))
    return tuple(lines)


def _line(name: str, told: float, there: float) -> str:
    return f"{name} {told:.10g} was given, {there:.10g} found"


def _last_unit(value: float) -> float:
    """The unit of the last decimal in which a number is written."""
    exponent = Decimal(repr(float(value))).as_tuple().exponent
    return 10.0 ** min(exponent, -1) if isinstance(exponent, int) and value else 0.0


def sizes_at(system: System, parameters: Sequence[float], state: Vector) -> Vector:
    """Typical sizes of the coordinates, shape (m,): in space the distance from the nearest primary, and the speed."""
    places = singularities_of(system, dict(zip(system.parameters, parameters, strict=True)))
    if places is None:
        return np.full(len(state), float(np.abs(state).max()) or 1.0)
    distance, half = places.distance(state), len(state) // 2
    return np.repeat([distance, max(float(np.linalg.norm(state[half:])), distance)], half)


def _slopes(system: System, parameters: Sequence[float], state: Vector, sizes: Vector) -> float:
    """By how much the first integral changes if all coordinates change by their sizes, to first order."""
    integral = system.first_integral
    assert integral is not None
    total = 0.0
    for index, size in enumerate(sizes):
        step = np.zeros(len(state))
        step[index] = 1e-4 * size
        ends = [float(integral((state + sign * step).tolist(), list(parameters))[0]) for sign in (1, -1)]
        total += abs(ends[0] - ends[1]) / 2e-4
    return total
