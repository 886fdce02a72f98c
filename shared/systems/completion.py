"""In floating point, states whose last coordinates follow from the others: functions of these, and the coordinate of a
fixed level. Not for proofs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from math import nan, sqrt

from orbitproof.shared.systems.defined_coordinates import with_functions
from orbitproof.shared.systems.system import ReversibleSystem, System

_MOST_HALVINGS = 60
_CLOSE = 1e-15

_FLOATS: Mapping[str, Callable[[float], float]] = {
    "sin": math.sin, "cos": math.cos, "exp": math.exp, "log": math.log,
}  # fmt: skip


def completed(system: ReversibleSystem, state: Sequence[float], parameters: Sequence[float]) -> list[float]:
    """The state with the coordinates that follow from the others: the level coordinate, then functions.

    The level coordinate w belongs to the fixed level, if there is one: from H = A + b w^2, or in its interval. NaN
    where no point of the level lies over the other coordinates, or where a function is not defined.
    """
    level, integral = system.fixed_level, system.first_integral
    if level is None:
        return functions_in_floats(system, state, parameters)
    assert integral is not None
    place = system.state.index(str(system.level_coordinate))
    before, after = state[:place], state[place + 1 :]

    def height(w: float) -> float:
        """H where the level coordinate is w."""
        return float(integral(functions_in_floats(system, [*before, w, *after], parameters), parameters)[0])

    if level.between is None:
        rest, one = height(0.0), height(1.0)
        square = (float(level.value) - rest) / (one - rest)
        w = int(level.sign or 1) * sqrt(square) if square >= 0 else nan
    else:
        w = level_root(lambda w: height(w) - float(level.value), *map(float, level.between))
    return functions_in_floats(system, [*before, w, *after], parameters)


def level_root(function: Callable[[float], float], low: float, high: float) -> float:
    """A zero of a function between two places where it has different signs, by Ridders' method; NaN if it has not."""
    try:
        left, right = function(low), function(high)
        if not left * right < 0:
            return nan
        found = nan
        for _ in range(_MOST_HALVINGS):
            middle = (low + high) / 2
            there = function(middle)
            step = (middle - low) * there / sqrt(there * there - left * right)
            before, found = found, middle + (step if left > right else -step)
            value = function(found)
            if value == 0.0 or abs(found - before) <= _CLOSE * abs(found):
                return found
            if value * there < 0:
                (low, left), (high, right) = sorted(((middle, there), (found, value)))
            elif value * left < 0:
                high, right = found, value
            else:
                low, left = found, value
    except (ArithmeticError, ValueError):
        return nan
    return found


def functions_in_floats(system: System, state: Sequence[float], parameters: Sequence[float]) -> list[float]:
    """The state with the coordinates that are functions of others; NaN where one is not defined."""
    try:
        return with_functions(system, state, parameters, _FLOATS)
    except (ArithmeticError, ValueError):
        given = len(system.given_state)
        return [*state[:given], *([nan] * len(system.defined))]
