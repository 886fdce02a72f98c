"""Steps along a curve: half as long where one leads nowhere, longer again where the curve is straight."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

Reached = TypeVar("Reached")


@dataclass(frozen=True)
class StepControl:
    """Lengths of the steps along a family.

    Attributes:
        initial, minimum, maximum: lengths.
        turning: largest angle in radians between the tangents at both ends of a step.
    """

    initial: float
    minimum: float
    maximum: float
    turning: float


class NoStep(Exception):
    """Not even the smallest step leads on; the message is that of the last failure."""


def walked(
    advance: Callable[[float], tuple[Reached, float]],
    step: float,
    minimum: float,
    failures: tuple[type[Exception], ...],
) -> Iterator[Reached]:
    """Where one step after the other leads. Raises `NoStep`.

    Arguments:
        advance: makes a step of this length, and says how long the next one is to be.
        step: length of the first.
        failures: that `advance` raises where a shorter step may lead on.
    """
    while True:
        try:
            reached, longer = advance(step)
        except failures as failure:
            step /= 2
            if step < minimum:
                raise NoStep(str(failure)) from failure
            continue
        yield reached
        step = longer
