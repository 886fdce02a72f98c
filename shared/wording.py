"""Words that go with numbers, and lines of a list."""

from __future__ import annotations

from collections.abc import Iterable


def counted(number: int, thing: str) -> str:
    """How many of a thing there are.

    >>> counted(1, "piece"), counted(0, "orbit"), counted(12, "family")
    ('1 piece', '0 orbits', '12 families')
    """
    if number == 1:
        return f"1 {thing}"
    return f"{number} {thing[:-1]}ies" if thing.endswith("y") else f"{number} {thing}s"


def itemised(head: str, items: Iterable[str]) -> list[str]:
    """The head, and each item on a line of its own; nothing where there are no items."""
    lines = [f"- {item}" for item in items]
    return [head, *lines] if lines else []
