"""Words of ours beside names of a file: a word that the file uses as well stands in parentheses."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems import System, own_name

LEVEL = "level"
"""The value of the first integral, where something varies or has a value."""


def told_apart(ours: Sequence[str], theirs: Sequence[str]) -> tuple[str, ...]:
    """Our words, all different; one that is a name of the file too stands in parentheses, as no name of a file does.

    >>> told_apart(("t", "period"), ("x", "t"))
    ('(t)', 'period')
    """
    found: list[str] = []
    for word in ours:
        while word in theirs or word in found:
            word = own_name(word)
        found.append(word)
    return tuple(found)


def varied(system: System, name: str) -> str | None:
    """The parameter of this name; `None` for the level of the first integral. Raises `LookupError` for neither."""
    if name in system.parameters:
        return name
    (level,) = told_apart([LEVEL], tuple(system.parameters))
    has_level = system.first_integral_program is not None
    if has_level and name in (level, own_name(LEVEL)):
        return None
    known = ", ".join([*system.parameters, *([level] if has_level else [])])
    raise LookupError(f"there is nothing of that name to vary; there are {known or 'none'}")
