"""Bad input, and how it is quoted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LONGEST_QUOTED = 100


class InputError(Exception):
    """Bad input, in one line: what (file and field), why, and what to do about it."""


@contextmanager
def about(*paths: Path) -> Iterator[None]:
    """`InputError` from what is done with files names them, where it does not name any."""
    try:
        yield
    except InputError as error:
        if any(str(path) in str(error) for path in paths):
            raise
        raise InputError(f"{', '.join(map(str, paths))}: {error}") from None


def short(text: str) -> str:
    """A text of one line and readable length."""
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_QUOTED else text[:LONGEST_QUOTED] + " ..."
