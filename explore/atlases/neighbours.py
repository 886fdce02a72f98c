"""Orbits at places along a family, each by Newton's method from the nearest one that is known."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any, TypeVar

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector

FARTHEST, HALVINGS = 0.05, 6
"""A step after which an orbit is another by more than this part of it is halved, so many times at most."""

Orbit = TypeVar("Orbit")


Found = TypeVar("Found")

NEWTON_STEPS = 15
NOT_FOUND = "Newton's method does not converge"


class LibrationFailure(Exception):
    """The family could not be followed; one line says why."""


def zero_near(
    guess: Vector,
    linearised: Callable[[Vector], tuple[Vector, Matrix, Found]],
    is_last: Callable[[Vector, Vector, float], bool],
    where: str,
) -> tuple[Vector, Matrix, Found]:
    """Where equations vanish, with their derivatives and what else was found in front of the last step.

    Arguments:
        guess: shape (n,).
        linearised: at unknowns the values, shape (n,), the derivatives, shape (n, n), and anything. Raises
            `FlowFailure`.
        is_last: whether to stop after a step, told the step, where it leads, and the longest part of the one before.
        where: for messages.

    Raises `LibrationFailure`.
    """
    unknowns, before = guess, inf
    for _ in range(NEWTON_STEPS):
        try:
            values, matrix, found = linearised(unknowns)
            step = np.linalg.solve(matrix, values)
        except FlowFailure as error:
            raise LibrationFailure(f"{where}: {error}") from None
        except np.linalg.LinAlgError:
            raise LibrationFailure(f"{where}: the family turns around") from None
        unknowns = unknowns - step
        if is_last(step, unknowns, before):
            return unknowns, matrix, found
        before = float(np.abs(step).max())
    raise LibrationFailure(f"{where}: {NOT_FOUND}")


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
