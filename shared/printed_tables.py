"""Tables on standard output, for terminals of any width."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from shutil import get_terminal_size
from textwrap import TextWrapper

_WIDTH = 80
"""The width of what is no terminal and has no COLUMNS."""
_LEAST = 40
_JOINT = "\0=\0"


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """The rows as lines of one table; the first has the titles of the columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def fitted(rows: Sequence[Sequence[str]], head: int = 0) -> list[str]:
    """The rows as a table or, where that is wider than the terminal, each as a block of lines.

    A block begins with the cell of column `head`, a name, in one piece; the others follow below, each beside its title.
    Numbers are not broken.

    >>> fitted([("name", "x"), ("a", "1"), ("b", "2")])
    ['name  x', 'a     1', 'b     2']
    """
    lines = aligned(rows)
    width = terminal_width()
    if max(map(len, lines)) <= width:
        return lines
    titles, *rest = rows
    head %= len(titles)
    column = max(len(title) for place, title in enumerate(titles) if place != head)
    lines = []
    for row in rest:
        lines.append(row[head])
        for place, (title, cell) in enumerate(zip(titles, row, strict=True)):
            if place != head and cell:
                lines += filled(cell, width, f"  {title:{column}}  ", " " * (column + 4))
    return lines


def filled(text: str, width: int, first: str, other: str) -> list[str]:
    """A text as lines that begin so; words and numbers stay in one piece, numbers beside their names."""
    filler = TextWrapper(
        width, initial_indent=first, subsequent_indent=other, break_long_words=False, break_on_hyphens=False
    )
    return [line.replace(_JOINT, " = ") for line in filler.wrap(text.replace(" = ", _JOINT))] or [first.rstrip()]


def wrapped(lines: Iterable[str]) -> str:
    """Lines of text, those that are wider than the terminal in several, indented below their first."""
    width, parts = terminal_width(), []
    for line in lines:
        margin = " " * (len(line) - len(line.lstrip()))
        parts += [line] if len(line) <= width else filled(line.strip(), width, margin, f"{margin}    ")
    return "\n".join(parts)


def shortened(text: str, other: str = "") -> str:
    """What a progress bar is about: the text, the other one, or its beginning. The times beside it stay whole."""
    room = terminal_width() - _BESIDE
    if len(text) > room and other:
        text = other
    return text if len(text) <= room else f"{text[: room - 2]}.."


_BESIDE = 50
"""Columns of the terminal that a bar of `BAR_WIDTH`, its share and its times take."""
BAR_WIDTH = 16


def terminal_width() -> int:
    """Columns of the terminal, as COLUMNS or it says."""
    return max(_LEAST, get_terminal_size((_WIDTH, 24)).columns)
