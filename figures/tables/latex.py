"""Tables as LaTeX: the masses side by side as in the paper, then each beside the published enclosures."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from orbitproof.figures.tables.cells import (
    KINDS,
    NONE,
    NOT_PROVED,
    bound_of,
    crossing_of,
    footnotes,
    kind_of,
    note_of,
    one_line,
    published_of,
)
from orbitproof.figures.tables.tables import MISSING, Section, Table, TableRow
from orbitproof.shared.systems import MASS_PARAMETERS

_REPLACED = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "#": r"\#",
    "$": r"\$",
    "%": r"\%",
    "&": r"\&",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    "[": "{[}",
    "]": "{]}",
}


_GREEK = frozenset({"alpha", "beta", "gamma", "delta", "epsilon", "lambda", "mu", "nu", "sigma", "omega"})
_DASH = "--"


def to_latex(table: Table, digits: int) -> str:
    """Table environments for ``\\input``, with nothing but the standard commands of LaTeX."""
    parts = [_side_by_side(table, digits)]
    parts += [_details(section, table, digits) for section in table.sections]
    return "\n".join(parts)


def aligned(sections: Sequence[Section]) -> list[tuple[TableRow | None, ...]]:
    """The rows of all sections in lines: one entry for each section, `None` where it has no such row.

    Rows stand in one line if they have the same k, the same crossing and no different number j, paired along
    the family so that as many as possible have partners; missing ones come last. It is layout and claims nothing.
    """
    lines: list[tuple[TableRow | None, ...]] = [(row,) for row in sections[0].rows]
    for width, section in enumerate(sections[1:], start=1):
        pairs = _common(lines, section.rows)
        merged: list[tuple[TableRow | None, ...]] = []
        for (i, j), (next_i, next_j) in pairwise([(-1, -1), *pairs, (len(lines), len(section.rows))]):
            if i >= 0:
                merged.append((*lines[i], section.rows[j]))
            merged += [(*line, None) for line in lines[i + 1 : next_i]]
            merged += [(*(None,) * width, row) for row in section.rows[j + 1 : next_j]]
        lines = merged
    # What is missing comes last also where only one of the sections misses it.
    return sorted(lines, key=_is_missing)


def _common(lines: Sequence[tuple[TableRow | None, ...]], rows: Sequence[TableRow]) -> list[tuple[int, int]]:
    """Indices of a longest common subsequence."""
    best = [[0] * (len(rows) + 1) for _ in range(len(lines) + 1)]
    for i in reversed(range(len(lines))):
        for j in reversed(range(len(rows))):
            together = 1 + best[i + 1][j + 1] if _same(lines[i], rows[j]) else 0
            best[i][j] = max(together, best[i + 1][j], best[i][j + 1])
    pairs, i, j = [], 0, 0
    while i < len(lines) and j < len(rows):
        if _same(lines[i], rows[j]) and best[i][j] == 1 + best[i + 1][j + 1]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif best[i + 1][j] >= best[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


def _is_missing(line: Sequence[TableRow | None]) -> bool:
    return all(row is None or row.certified is None for row in line)


def _same(line: Sequence[TableRow | None], row: TableRow) -> bool:
    """Whether a row may stand in a line."""
    others = [other for other in line if other is not None]
    crossings = {crossing_of(other) for other in (*others, row)} - {NONE}
    numbers = {other.j for other in (*others, row) if other.j.isdigit()}
    if _is_missing(line) != _is_missing([row]):
        return False
    return all(other.k == row.k for other in others) and len(crossings) <= 1 and len(numbers) <= 1


def _side_by_side(table: Table, digits: int) -> str:
    columns = [(section, name) for section in table.sections for name in section.quantities]
    heads = [_head(section, name, table) for section, name in columns]
    lines = []
    notes: list[str] = []
    for line in aligned(table.sections):
        rows = [row for row in line if row is not None]
        numbers = sorted({row.j for row in rows}, key=lambda j: (not j.isdigit(), j == NONE))
        by_section = dict(zip(map(id, table.sections), line, strict=True))
        cells = [_plain(numbers[0]), str(rows[0].k), _crossing(rows)]
        cells += [_bound(by_section[id(section)], name, section, digits) for section, name in columns]
        lines.append(cells)
    for section in table.sections:
        notes += _notes(section, several=len(table.sections) > 1)
    kinds = sorted({(row.k, KINDS[row.kind]) for section in table.sections for row in section.certified})
    named = ", ".join(f"$k={k}$: {kind}" for k, kind in kinds)
    listed = [section for section in table.sections if section.sources]
    compared = r" ``new'': not listed in the paper" if listed else ""
    if listed and len(listed) < len(table.sections):
        compared += ", as far as its lists are at hand: " + ", ".join(_escaped(section.label) for section in listed)
    compared += "." if listed else ""
    caption = (
        f"Certified bounds on {_name(table.parameter_name)} at the bifurcations of the family "
        f"{_escaped(table.family)}, {_escaped(table.system.title)}. Multiplicity {named}. "
        f"Fix$(R)$: direction in which the orbit crosses the section at the certified point.{compared}"
    )
    return _environment(caption, f"tab:{_key(table)}", ["j", "k", "Fix$(R)$", *heads], lines, notes)


def _details(section: Section, table: Table, digits: int) -> str:
    """One section: side, what the paper prints, where ours lies, and what the proof took."""
    published = [f"published, {_name(name)}" for name in section.quantities] if section.sources else []
    heads = ["j", "k", "kind", "side", *published, *(["compared"] if published else []), "s", "bits"]
    lines: list[list[str]] = []
    notes: list[str] = []
    for row in section.rows:
        ours, verdict = row.certified, row.verdict
        if row.comparison is not None and row.comparison.explanation:
            mark = f"$^{{{len(notes) + 1}}}$"
            notes.append(f"{mark} {_escaped(str(row.comparison))}")
            verdict = row.comparison.status + mark
        cells = [_plain(cell) for cell in (row.j, str(row.k), kind_of(row), ours.side if ours else NONE)]
        if published:
            cells += [_number(published_of(row, name, table)) for name in section.quantities]
            cells.append(_plain(verdict))
        cells += [f"{ours.seconds:.1f}", str(ours.precision)] if ours else [_DASH, _DASH]
        lines.append(cells)
    about = f", {_escaped(section.label)}" if section.label else ""
    sources = "".join(f" Published: {_escaped(source)}." for source in section.sources)
    caption = (
        f"The family {_escaped(table.family)}{about}: side of the bifurcation value at which the new orbits exist, "
        f"seconds and bits of the proof. {_escaped(section.summary())}.{sources}"
    )
    key = f"tab:{_key(table)}-{table.sections.index(section) + 1}"
    return _environment(caption, key, heads, lines, notes)


def _environment(
    caption: str, key: str, heads: Sequence[str], lines: Sequence[Sequence[str]], notes: Sequence[str]
) -> str:
    rule = r"\hline"
    body = [" & ".join(cells) + r" \\" for cells in lines]
    return "\n".join(
        [
            r"\begin{table}",
            rf"\caption{{{caption}}}",
            rf"\label{{{key}}}",
            r"\centering",
            r"\scriptsize",
            rf"\begin{{tabular}}{{{'l' * len(heads)}}}",
            rule,
            " & ".join(heads) + r" \\",
            rule,
            *body,
            rule,
            r"\end{tabular}",
            *(rf"\par\smallskip\raggedright {note}" for note in notes),
            r"\end{table}",
            "",
        ]
    )


def _bound(row: TableRow | None, quantity: str, section: Section, digits: int) -> str:
    if row is None:
        return _DASH
    if row.certified is None:
        return MISSING
    note = note_of(row, section)
    return _number(bound_of(row, quantity, digits)) if note is None else f"not proved$^{{{_mark(section, note)}}}$"


def _mark(section: Section, note: int) -> str:
    return f"{_subscript(section)}{note}"


def _notes(section: Section, several: bool) -> list[str]:
    notes = [f"$^{{{_mark(section, number)}}}$ {_escaped(text)}" for number, text in footnotes(section)]
    return [*notes, NOT_PROVED] if notes else []


def _subscript(section: Section) -> str:
    """EM for Earth-Moon: the initials with which the paper tells masses apart; empty for other parameters."""
    names = {value: name for name, value in MASS_PARAMETERS.items()}
    known = [names[value] for value in section.parameters.values() if value in names]
    return "".join(part[0].upper() for part in known[0].split("-")) if known else ""


def _head(section: Section, quantity: str, table: Table) -> str:
    name = _name(quantity)
    if not section.parameters:
        return name
    mass = _subscript(section)
    return f"{name} ($\\mu_{{\\mathrm{{{mass}}}}}$)" if mass else f"{name} ({_escaped(section.label)})"


def _number(text: str) -> str:
    """A number or an enclosure: signs and powers of ten in mathematics, so that no minus is a hyphen."""
    if text == NONE:
        return _DASH
    text = text.replace("+-", "±")
    text = re.sub(r"e([+-]?[0-9]+)|-", lambda m: rf"$\cdot10^{{{m[1]}}}$" if m[1] else "$-$", text)
    return text.replace("±", r"$\pm$")


def _plain(text: str) -> str:
    return _DASH if text in (NONE, "") else text


def _name(quantity: str) -> str:
    """Greek names as letters."""
    return rf"$\{quantity}$" if quantity in _GREEK else _escaped(quantity)


def _crossing(rows: Sequence[TableRow]) -> str:
    found = sorted({crossing_of(row) for row in rows} - {NONE})
    return f"${found[0]}$" if found else _DASH


def _key(table: Table) -> str:
    kept = "".join(c if c.isalnum() else "-" for c in f"{table.system.name}-{table.family}")
    return kept.encode("ascii", "replace").decode().replace("?", "-")


def _escaped(text: str) -> str:
    return "".join(_REPLACED.get(c, c) for c in one_line(text))
