"""Texts as they may be printed."""

from __future__ import annotations


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
