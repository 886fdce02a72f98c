"""Tables as plain text, Markdown and CSV."""

from __future__ import annotations

import csv
import io

from orbitproof.figures.tables.cells import (
    NONE,
    bound_of,
    crossing_of,
    enclosure_of,
    footnotes,
    kind_of,
    legend_of,
    note_of,
    one_line,
    published_of,
    quantities_of,
)
from orbitproof.figures.tables.tables import Section, Table, TableRow
from orbitproof.shared.printed_tables import aligned, fitted
from orbitproof.verify.evidence import decimal_interval

_Line = tuple[str, ...]
_SPECIAL = "\\`*_{}[]<>|#"


def to_text(table: Table, digits: int, width: int | None = None) -> str:
    """Plain text with aligned columns; a row takes a line for each quantity that the paper encloses.

    Where that is wider than `width`, each row is a block of lines.
    """
    lines = [one_line(table.title), ""]
    for section in table.sections:
        lines += [one_line(section.label), ""] if section.label else []
        rows = [_lines(row, section, table, digits) for row in section.rows]
        found = aligned([_headers(section), *(line for row in rows for line in row)])
        if width is not None and max(map(len, found)) > width:
            blocks = [[", ".join(filter(None, column)) for column in zip(*row, strict=True)] for row in rows]
            found = fitted([_headers(section), *blocks], head=-1)
        lines += found
        lines += ["", *(f"published: {one_line(source)}" for source in section.sources), section.summary()]
        lines += [*(f"[{number}] {text}" for number, text in footnotes(section)), ""]
    return "\n".join([*lines, *legend_of(table)]) + "\n"


def to_markdown(table: Table, digits: int) -> str:
    """Markdown; the quantities that the paper encloses stand in one cell, each on its own line."""
    lines = [f"# {_escaped(table.title)}", ""]
    for section in table.sections:
        lines += [f"## {_escaped(section.label)}", ""] if section.label else []
        header = _headers(section)
        lines += ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
        for row in section.rows:
            columns = zip(*_lines(row, section, table, digits), strict=True)
            lines.append("| " + " | ".join("<br>".join(_escaped(cell) for cell in c if cell) for c in columns) + " |")
        sources = [f"Published: {_escaped(source)}." for source in section.sources]
        notes = [f"[{number}] {text}" for number, text in footnotes(section)]
        for paragraph in (*sources, f"{section.summary()}.", *notes):
            lines += ["", paragraph if paragraph in sources else _escaped(paragraph)]
        lines.append("")
    return "\n".join([*lines, _escaped(" ".join(legend_of(table)))]) + "\n"


def to_csv(table: Table, digits: int) -> str:
    """CSV, one line for each row; `lower` and `upper` are decimals rounded outward, at least our enclosure."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    quantities, parameters = quantities_of(table), table.system.fixed_parameters
    row_names = ["label", "j", "k", "kind", "verdict", "side", "fix_r"]
    bounds = [f"{name} {part}" for name in quantities for part in ("enclosure", "lower", "upper", "published")]
    writer.writerow(
        ["system", "family", *parameters, *row_names, *bounds, *["compared", "seconds", "bits", "id", "reason"]]
    )
    for section in table.sections:
        for row in section.rows:
            ours = row.certified
            verdict = "missing" if ours is None else "proved" if ours.proved else "not proved"
            cells: list[object] = [table.system.name, table.family]
            cells += [repr(float(section.parameters[name])) for name in parameters]
            cells += [section.label, row.j, row.k, kind_of(row), verdict, ours.side if ours else "", crossing_of(row)]
            for name in quantities:
                cells += [*_ends(row, name, digits), published_of(row, name, table)]
            cells += [row.verdict, *((ours.seconds, ours.precision, ours.id, ours.reason) if ours else ("",) * 4)]
            writer.writerow(["" if cell == NONE else one_line(str(cell)) for cell in cells])
    return stream.getvalue()


def _ends(row: TableRow, quantity: str, digits: int) -> list[str]:
    """Our enclosure in the paper's notation, its lower end and its upper end."""
    enclosure = enclosure_of(row, quantity)
    if enclosure is None:
        return ["", "", ""]
    lower, _, upper = decimal_interval(enclosure.ball, digits).strip("[]").partition(", ")
    return [bound_of(row, quantity, digits), lower, upper]


def _headers(section: Section) -> _Line:
    published = ("published", "compared") if section.sources else ()
    return ("j", "k", "kind", "side", "Fix(R)", ", ".join(section.quantities), *published, "seconds", "bits", "id")


def _lines(row: TableRow, section: Section, table: Table, digits: int) -> list[_Line]:
    """The cells of a row, one line for each quantity; what is about the whole row stands in the first line."""
    ours, note = row.certified, note_of(row, section)
    lead: _Line = (row.j, str(row.k), kind_of(row), ours.side or NONE if ours else NONE, crossing_of(row))
    trail: _Line = (NONE, NONE, NONE)
    if ours is not None:
        trail = (f"{ours.seconds:.1f}", str(ours.precision), one_line(ours.id))
    result: list[_Line] = []
    for number, name in enumerate(section.quantities):
        bound, published = bound_of(row, name, digits), published_of(row, name, table)
        if len(section.quantities) > 1 and bound != NONE:
            bound = f"{name} = {bound}"
        if note is not None:
            bound = f"not proved [{note}]" if number == 0 else ""
        compared = (published, row.verdict if number == 0 else "") if section.sources else ()
        first = number == 0
        result.append(
            (*(lead if first else [""] * len(lead)), bound, *compared, *(trail if first else [""] * len(trail)))
        )
    return result


def _escaped(text: str) -> str:
    """Text of one line that Markdown leaves alone."""
    return "".join(f"\\{c}" if c in _SPECIAL else c for c in one_line(text))
