"""Balls give what contains the values at their points: one number among the arguments after the other is made a ball.

Only one is one at a time, so that the radius of no other hides one that is lost on the way.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from flint import acb, acb_mat, arb, arb_mat

from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    IntegrationFailure,
    NotEstablishedError,
)

Path = tuple[Any, ...]
REFUSED = (ArithmeticError, IntegrationFailure, NotEstablishedError, ValueError)
SIZE = arb(2) ** -34
"""Radius of a ball about a number of the size 1."""


class Refused:
    """In place of what a function returns: it did not answer."""


def leaves(value: Any, path: Path = ()) -> Iterator[tuple[Path, arb]]:
    """All numbers in lists, mappings and dataclasses, and where they are."""
    if isinstance(value, arb):
        yield path, value
    elif isinstance(value, acb):
        yield from (((*path, 0), value.real), ((*path, 1), value.imag))
    elif isinstance(value, (list, tuple)):
        for place, each in enumerate(value):
            yield from leaves(each, (*path, place))
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield from leaves(each, (*path, key))
    elif is_dataclass(value):
        for field in fields(value):
            yield from leaves(getattr(value, field.name), (*path, field.name))


def with_leaf(value: Any, path: Path, leaf: arb) -> Any:
    """The same with another number there."""
    if not path:
        return leaf
    first, *rest = path
    if isinstance(value, acb):
        return acb(value.real, leaf) if first else acb(leaf, value.imag)
    if isinstance(value, (list, tuple)):
        items = [with_leaf(each, tuple(rest), leaf) if i == first else each for i, each in enumerate(value)]
        return items if isinstance(value, list) else tuple(items)
    if isinstance(value, Mapping):
        return {**value, first: with_leaf(value[first], tuple(rest), leaf)}
    return replace(value, **{first: with_leaf(getattr(value, first), tuple(rest), leaf)})


def encloses(wide: Any, at: Any) -> bool:
    """Whether an answer for balls may be that for points: equal, and numbers within up to what is rounded."""
    if isinstance(wide, Refused) or wide is None or wide is False or isinstance(at, EmptyIntersectionError):
        return True
    if isinstance(wide, (arb, acb)):
        return isinstance(at, type(wide)) and (not wide.is_finite() or bool(wide.overlaps(at)))
    if isinstance(wide, (arb_mat, acb_mat)):
        return encloses(wide.tolist(), at.tolist())
    if type(wide) is not type(at):
        return False
    if isinstance(wide, (list, tuple)):
        return len(wide) == len(at) and all(map(encloses, wide, at))
    if isinstance(wide, Mapping):
        return set(wide) == set(at) and all(encloses(each, at[key]) for key, each in wide.items())
    if is_dataclass(wide) and not isinstance(wide, type):
        return all(encloses(getattr(wide, each.name), getattr(at, each.name)) for each in fields(wide))
    return bool(wide == at)


def checked(check: Callable[..., Any], *arguments: Any) -> Any:
    """What a check returns and records."""
    checklist = Checklist()
    found = check(checklist, *arguments)
    return found, [dict(hypothesis.enclosures) for hypothesis in checklist.hypotheses]


def answer(function: Callable[..., Any], arguments: Any) -> Any:
    """What it returns, or `Refused`."""
    try:
        return function(*arguments)
    except EmptyIntersectionError as error:
        return error
    except REFUSED:
        return Refused()


def broken_inclusions(
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    chance: random.Random,
    most: int = 12,
    size: arb = SIZE,
    where: Callable[[Path], bool] = lambda path: True,
) -> list[Path]:
    """The numbers of which a ball gives an answer that does not enclose those at its ends; so many are tried.

    Only numbers count on which the answer depends, and of which a ball has an answer. Raises `AssertionError` if there
    is none.
    """
    places = [(path, leaf) for path, leaf in leaves(arguments) if where(path)]
    broken, tried = [], 0
    for path, leaf in chance.sample(places, len(places)):
        radius = size * (1 + abs(leaf.mid()))
        ends = [answer(function, with_leaf(arguments, path, leaf.mid() + sign * radius)) for sign in (-1, 1)]
        if any(isinstance(end, Refused) for end in ends) or encloses(*ends):
            continue
        wide = answer(function, with_leaf(arguments, path, leaf.mid() + arb(0, 1) * radius))
        if isinstance(wide, (Refused, EmptyIntersectionError)):
            continue
        tried += 1
        if not all(encloses(wide, end) for end in ends):
            broken.append(path)
        if tried == most:
            break
    assert tried, "there is no number on which the answer depends"
    return broken
