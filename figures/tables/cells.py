"""What stands in the cells of a table, in every format the same."""

from __future__ import annotations

from orbitproof.figures.tables.rows import Enclosure
from orbitproof.figures.tables.tables import Section, Table, TableRow
from orbitproof.shared.systems import shown
from orbitproof.verify.evidence import certain_digits

NONE = "-"
KINDS = {
    "symmetry_breaking": "symmetry breaking",
    "fold": "fold",
    "period_tupling": "period tupling",
    "touch_and_go": "touch-and-go",
    "reversor_breaking": "loss of R",
}
LEGEND = (
    "An enclosure such as 1.5[24,31] is the interval from 1.524 to 1.531.",
    "side: parameter values at which the new orbits exist.",
    "Fix(R): direction in which the orbit crosses the section at the point that is certified.",
)
COMPARED_LEGEND = (
    'j: the row in the paper, "new" where the paper lists none.',
    "inside: our enclosure is a subset of the published one.",
)
NOT_PROVED = "Not proved does not mean that there is no such bifurcation."


def kind_of(row: TableRow) -> str:
    """The kind in words; a dash at a row that we do not have."""
    if row.certified is None:
        return NONE
    doubling = row.certified.kind == "period_tupling" and row.certified.k == 2
    return "period doubling" if doubling else KINDS[row.certified.kind]


def crossing_of(row: TableRow) -> str:
    """Which of the two points on Fix(R): the direction in which the orbit crosses the section there."""
    if row.certified is None or row.certified.crossing == 0:
        return NONE
    return f"{row.certified.system.section}' {'>' if row.certified.crossing > 0 else '<'} 0"


def enclosure_of(row: TableRow, quantity: str) -> Enclosure | None:
    """Our enclosure of the bifurcation parameter or of a coordinate; `None` if not proved."""
    ours = row.certified
    if ours is None:
        return None
    return ours.parameter if quantity == ours.parameter_name else ours.point.get(quantity)


def bound_of(row: TableRow, quantity: str, digits: int) -> str:
    """Our enclosure in the paper's notation: common digits, then the ends of the last ones."""
    enclosure = enclosure_of(row, quantity)
    return NONE if enclosure is None else certain_digits(enclosure.ball, digits)


def published_of(row: TableRow, quantity: str, table: Table) -> str:
    """The published enclosure as it is printed, or a dash."""
    if row.published is None:
        return NONE
    printed = row.published.parameter if quantity == table.parameter_name else row.published.point.get(quantity)
    return NONE if printed is None else printed.text


def note_of(row: TableRow, section: Section) -> int | None:
    """Number of the footnote that says why a row is not proved; `None` if it is, or if it is not ours."""
    if row.certified is None or row.certified.proved:
        return None
    return section.not_proved.index(row.certified) + 1


def footnotes(section: Section) -> list[tuple[int, str]]:
    """Numbers and texts of the reasons of rows that are not proved."""
    return [
        (number, one_line(f"{shown(row.id)}: {row.reason}")) for number, row in enumerate(section.not_proved, start=1)
    ]


def legend_of(table: Table) -> list[str]:
    """Sentences that explain the columns."""
    compared = any(section.sources for section in table.sections)
    failed = any(section.not_proved for section in table.sections)
    return [*LEGEND, *(COMPARED_LEGEND if compared else ()), *([NOT_PROVED] if failed else [])]


def quantities_of(table: Table) -> list[str]:
    """All quantities of which the table prints enclosures."""
    return list(dict.fromkeys(name for section in table.sections for name in section.quantities))


def one_line(text: str) -> str:
    """A text without line breaks and control characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
