"""Bad input, and how it is quoted."""

from __future__ import annotations

LONGEST_QUOTED = 100


def printable(text: str, kept: str = "") -> str:
    """A text without characters that a terminal obeys, and others that nobody sees: their escapes in their place.

    Args:
        kept: characters that stay.

    >>> printable("a\x1b[31m\u202eb")
    'a\\x1b[31m\\u202eb'
    """
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() or letter in kept else letter.encode("unicode_escape").decode("ascii")
        for letter in text
    )


class InputError(Exception):
    """Bad input, in one line: what (file and field), why, and what to do about it. What it quotes is printable."""

    def __str__(self) -> str:
        return printable(super().__str__())


def short(text: str) -> str:
    """A text of one line and readable length."""
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_QUOTED else text[:LONGEST_QUOTED] + " ..."
