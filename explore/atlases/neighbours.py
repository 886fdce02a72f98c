"""Orbits at places along a family, each from the nearest one that is known."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

FARTHEST, HALVINGS = 0.05, 6
"""A step after which an orbit is another by more than this part of it is halved, so many times at most."""

Orbit = TypeVar("Orbit")


class LibrationFailure(Exception):
    """The family could not be followed; one line says why."""


def orbit_at(
    place: float,
    known: list[Orbit],
    step: float,
    place_of: Callable[[Orbit], Any],
    beside: Callable[[Orbit, float], Orbit],
    is_far: Callable[[Orbit, Orbit], bool] = lambda found, near: False,
) -> Orbit:
    """The orbit at a place, in steps from the nearest known one; those on the way become known.

    Arguments:
        beside: the orbit at a place, by Newton's method from one near it. Raises `LibrationFailure`.
        is_far: whether that may have led from one to another family.

    Raises `LibrationFailure`.
    """

    def led(near: Orbit, goal: float, halvings: int) -> Orbit:
        try:
            found = beside(near, goal)
            if not (halvings and is_far(found, near)):
                known.append(found)
                return found
        except LibrationFailure:
            if not halvings:
                raise
        middle = led(near, 0.5 * (place_of(near) + goal), halvings - 1)
        return led(middle, goal, halvings - 1)

    near = min(known, key=lambda orbit: abs(place_of(orbit) - place))
    begin = place_of(near)
    for goal in np.linspace(begin, place, int(np.ceil(abs(place - begin) / step)) + 1)[1:]:
        near = led(near, float(goal), HALVINGS)
    return near
