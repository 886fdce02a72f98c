"""Bad input, and how it is quoted."""

from __future__ import annotations

LONGEST_QUOTED = 100


class InputError(Exception):
    """Bad input, in one line: what (file and field), why, and what to do about it. What it quotes is printable."""

    def __str__(self) -> str:
        from orbitproof.shared.printing import printable

        return printable(super().__str__())


def short(text: str) -> str:
    """A text of one line and readable length."""
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_QUOTED else text[:LONGEST_QUOTED] + " ..."
