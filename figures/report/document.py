"""What a report is made of, for every format: sections of blocks, blocks of text, formulas, tables and pictures.

Text is plain; nothing in it is markup. Formulas are LaTeX of the small kind that `latex2mathml` reads as well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Math:
    """A formula in a line, as LaTeX."""

    latex: str


@dataclass(frozen=True)
class Code:
    """Words that are typed or copied exactly: commands, digests, exact numbers."""

    text: str


@dataclass(frozen=True)
class Link:
    """A place in the report, or an address elsewhere."""

    text: str
    target: str


@dataclass(frozen=True)
class Reference:
    """The label of a section or theorem, as its number in the text."""

    label: str
    text: str


Run = str | Math | Code | Link | Reference
Runs = tuple[Run, ...]


@dataclass(frozen=True)
class Paragraph:
    """Text and formulas in a line."""

    runs: Runs


@dataclass(frozen=True)
class Items:
    """A list."""

    entries: tuple[Runs, ...]


@dataclass(frozen=True)
class Formulas:
    """Displayed equations: left sides and right sides, LaTeX."""

    equations: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        header: of the columns.
        rows: cells.
        caption: what it shows.
        widths: parts of the text's width, adding up to less than 1, where lines are broken to fit (LaTeX).
    """

    header: tuple[str, ...]
    rows: tuple[tuple[Runs, ...], ...]
    caption: str
    widths: tuple[float, ...]

    def without_empty_columns(self) -> Table:
        """The table with the columns in which a row has something, as wide as all of them were; the first stays."""
        kept = [i for i in range(len(self.header)) if not i or any(map(any, (row[i] for row in self.rows)))]
        scale = sum(self.widths) / sum(self.widths[i] for i in kept)
        return Table(
            tuple(self.header[i] for i in kept),
            tuple(tuple(row[i] for i in kept) for row in self.rows),
            self.caption,
            tuple(round(self.widths[i] * scale, 3) for i in kept),
        )


@dataclass(frozen=True)
class Picture:
    """A picture as PNG and PDF, with a name for its files."""

    name: str
    caption: str
    png: bytes = field(repr=False)
    pdf: bytes = field(repr=False)


@dataclass(frozen=True)
class Listing:
    """Lines to copy: commands, BibTeX."""

    text: str


@dataclass(frozen=True)
class Statement:
    """A numbered theorem: what it states."""

    label: str
    number: int
    title: str
    blocks: tuple[Block, ...]


Block = Paragraph | Items | Formulas | Table | Picture | Listing | Statement


@dataclass(frozen=True)
class Section:
    """A titled part; `level` 1 or 2."""

    label: str
    title: str
    blocks: tuple[Block, ...]
    level: int = 1


@dataclass(frozen=True)
class Document:
    """A report."""

    title: str
    sections: tuple[Section, ...]

    def pictures(self) -> Iterator[Picture]:
        """All pictures, in order."""
        for section in self.sections:
            yield from (block for block in section.blocks if isinstance(block, Picture))
