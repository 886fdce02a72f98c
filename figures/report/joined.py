"""Theorems that rest on other certificates, webs, rows of catalogues and indices, as blocks of a report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from statistics import median

from orbitproof.figures.certified.rows import BOUNDS, bounds_of
from orbitproof.figures.report.document import Block, Code, Paragraph, Reference, Run, Runs, Table
from orbitproof.figures.report.statements import shown_ball
from orbitproof.figures.report.theorems import Checked
from orbitproof.shared.systems import shown
from orbitproof.verify.branches.catalogue import CertifiedRow
from orbitproof.verify.certificate.kinds import CATALOGUE, WEB

_SHOWN = 40
"""A catalogue of no more rows is told row by row."""


def certified(rows: Sequence[CertifiedRow]) -> list[CertifiedRow]:
    """The rows with an orbit."""
    return [row for row in rows if row.orbit is not None and row.differences is not None]


def resting_paragraph(entry: Checked, place_of: Callable[[str], Reference | None]) -> Paragraph:
    """Which theorems it rests on; `place_of` gives those of this report by the names of certificates."""
    runs: list[Run] = ["It rests on "]
    for number, each in enumerate(entry.rests_on):
        runs += [", "] if number else []
        place = place_of(each.name)
        runs += [f"{shown(each.name)} (", *((place,) if place else (Code(str(each.document["digest"])),)), ")"]
    return Paragraph((*runs, "."))


def tables_of_joined(entry: Checked) -> Iterator[Block]:
    """What is known of arcs, or of rows; of an index all is said in the theorem."""
    if entry.part == WEB:
        yield _arcs(entry)
    elif entry.part == CATALOGUE:
        yield from _rows(entry)


def _arcs(entry: Checked) -> Table:
    rows: list[tuple[Runs, ...]] = [
        (
            (arc.id,), (arc.kind,), (str(len(arc.meets)),),
            () if arc.level is None else (shown_ball(arc.level),),
            () if arc.period is None else (shown_ball(arc.period),),
        )
        for arc in entry.certificate.arcs
    ]  # fmt: skip
    header = ("arc", "kind", "vertices", "levels of its orbits", "periods of its orbits")
    return Table(header, tuple(rows), f"Arcs, {shown(entry.name)}", (0.24, 0.14, 0.1, 0.23, 0.23))


def _rows(entry: Checked) -> Iterator[Block]:
    rows = entry.certificate.rows
    found = certified(rows)
    bounds: list[tuple[Runs, ...]] = []
    for name in BOUNDS:
        known = [(bound, row.number) for row in found if (bound := bounds_of(row).get(name)) is not None]
        if known:
            largest, number = max(known)
            middle = median(value for value, _ in known)
            bounds.append(((name,), (str(len(known)),), (f"{middle:.2e}",), (f"{largest:.2e}",), (str(number),)))
    if bounds:
        header = ("number", "rows", "median of the bounds", "largest bound", "at row")
        caption = f"How far the orbits are from their rows at most, {shown(entry.name)}"
        yield Table(header, tuple(bounds), caption, (0.22, 0.1, 0.22, 0.22, 0.1))
    if len(rows) > _SHOWN:
        yield Paragraph(("The numbers of each row stand in the certificate.",))
        return
    each: list[tuple[Runs, ...]] = []
    for row in found:
        orbit = row.orbit
        assert orbit is not None
        balls = (orbit.level, orbit.period, orbit.stability_index, orbit.least)
        each.append(((str(row.number),), *(() if ball is None else (shown_ball(ball),) for ball in balls)))
    if each:
        header = ("row", "first integral", "period", "stability index", "least distance")
        table = Table(header, tuple(each), f"The orbits, {shown(entry.name)}", (0.08, 0.22, 0.22, 0.22, 0.2))
        yield table.without_empty_columns()
