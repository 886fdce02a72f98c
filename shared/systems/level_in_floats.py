"""Points of a fixed level of the first integral, in floating point; not for proofs."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan, sqrt

from orbitproof.shared.systems.system import ReversibleSystem


def on_level(system: ReversibleSystem, state: Sequence[float], parameters: Sequence[float]) -> list[float]:
    """The state with the level coordinate w that belongs to the fixed level, if there is one, from H = A + b w^2.

    NaN where no point of the level lies over the other coordinates.
    """
    if system.fixed_level is None:
        return list(state)
    assert system.first_integral is not None
    place = system.state.index(str(system.level_coordinate))
    before, after = state[:place], state[place + 1 :]
    rest, one = (float(system.first_integral([*before, w, *after], parameters)[0]) for w in (0.0, 1.0))
    square = (float(system.fixed_level.value) - rest) / (one - rest)
    return [*before, system.fixed_level.sign * sqrt(square) if square >= 0 else nan, *after]
