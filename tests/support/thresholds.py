"""What is proved of a ball is proved of each of its points: where one point is refused, the ball is refused."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from flint import acb, arb
from support.inclusion import Path, Refused, answer, encloses, leaves, with_leaf


def unsound_balls(
    proves: Callable[[Any], bool],
    argument: Any,
    chance: random.Random,
    most: int = 8,
    powers: tuple[int, int] = (-120, 8),
    where: Callable[[Path], bool] = lambda path: True,
) -> list[tuple[Path, int]]:
    """The numbers, and directions, in which a ball is accepted although the point at its end is not.

    Each number is moved by the least power of 2 with which the argument is refused: half as far it is not, so that the
    middle of the ball is no reason to refuse. Raises `AssertionError` if none is ever refused.
    """
    assert proves(argument)
    places = [(path, leaf, sign) for path, leaf in leaves(argument) if where(path) for sign in (-1, 1)]
    unsound, tried = [], 0
    for path, leaf, sign in chance.sample(places, min(most, len(places))):

        def moved(power: int, path: Path = path, leaf: arb = leaf, sign: int = sign) -> Any:
            return with_leaf(argument, path, leaf + sign * arb(2) ** power)

        low, high = powers
        if proves(moved(high)):
            continue
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if proves(moved(middle)) else (low, middle)
        tried += 1
        if proves(with_leaf(argument, path, leaf.union(leaf + sign * arb(2) ** high))):
            unsound.append((path, sign))
    assert tried, "nothing is refused"
    return unsound


def contradiction(function: Callable[[arb], Any], sizes: Sequence[arb]) -> bool:
    """Whether a function answers for a ball about 0 otherwise than at an end, of which one tells another side.

    Raises `AssertionError` if the ends never differ in words.
    """
    differ, wrong = False, False
    for size in sizes:
        ends = [answer(function, (sign * size,)) for sign in (-1, 1)]
        differ |= any(isinstance(end, Refused) for end in ends) or not encloses(*map(words, ends))
        wide = answer(function, (arb(0, 1) * size,))
        wrong |= not all(encloses(wide, end) for end in ends)
    assert differ, "the ends are never told apart"
    return wrong


def words(value: Any) -> Any:
    """What is not a number of an answer."""
    if isinstance(value, Mapping):
        return {key: words(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [words(each) for each in value]
    return None if isinstance(value, (arb, acb)) else value
