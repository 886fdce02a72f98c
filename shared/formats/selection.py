"""What `only` asks for: some of the names in a file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from orbitproof.shared.arguments import ArgumentError

_WILD = frozenset("*?[")


def select_ids(names: Iterable[str], only: Sequence[str] | None, what: str, *, or_none: bool = False) -> list[str]:
    """The names asked for, in their order: ids, or patterns with * and ? as in file names; all if `only` is `None`.

    Args:
        what: what has the names, for the message.
        or_none: a pattern may match nothing; an id may not.

    Raises `InputError` for what matches nothing.
    """
    known = list(names)
    for pattern in only or ():
        if not any(fnmatchcase(name, pattern) for name in known) and not (or_none and _WILD.intersection(pattern)):
            raise ArgumentError("{only} {0}: no such {1}; known: {2}", pattern, what, ", ".join(known) or "none")
    return [name for name in known if only is None or any(fnmatchcase(name, pattern) for pattern in only)]
