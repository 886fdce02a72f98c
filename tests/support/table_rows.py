"""Rows, published lists and certificates files for the tests of tables."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from flint import arb

from orbitproof.figures.tables import (
    CertifiedRow,
    Enclosure,
    Interval,
    Printed,
    PublishedList,
    PublishedRow,
    Section,
    build_tables,
)

DATA = Path(__file__).parents[1] / "data"
CANDIDATES = DATA / "figures-candidates.json"
CERTIFICATES = DATA / "figures-certificates.json"
DOCUMENT = json.loads(CERTIFICATES.read_text())
TINY = Fraction(1, 10**300)


def printed(lower: Fraction, upper: Fraction) -> Printed:
    return Printed("as printed", Interval(lower, upper))


def around(row: CertifiedRow, low: Fraction, high: Fraction, k: int | None = None) -> PublishedRow:
    """A published row from `low` below our lower end to `high` above our upper end."""
    assert row.parameter is not None
    ours = row.parameter.interval
    return PublishedRow(7, k or row.k, printed(ours.lower - low, ours.upper + high), {})


def like(row: CertifiedRow, id: str, value: Fraction, radius: Fraction = Fraction(1, 10**30)) -> CertifiedRow:
    """A row of ours with another id and another enclosure."""
    interval = Interval(value - radius, value + radius)
    return replace(row, id=id, parameter=Enclosure(arb(float(value)), interval), value=interval)


def listed(row: CertifiedRow, *members: PublishedRow, complete: bool = True, family: str = "") -> PublishedList:
    return PublishedList(
        "a source", row.system, row.parameters, family or row.family, row.parameter_name, complete, members
    )


def only_section(rows: Sequence[CertifiedRow], *published: PublishedList) -> Section:
    (table,) = build_tables(rows, published)
    (section,) = table.sections
    return section


def certificates(path: Path, change: Callable[[list[Any]], list[Any] | None]) -> Path:
    """A copy of the stored certificates with a change."""
    document = copy.deepcopy(DOCUMENT)
    changed = change(document["certificates"])
    path.write_text(json.dumps({**document, "certificates": document["certificates"] if changed is None else changed}))
    return path


def proved_only(entries: list[Any]) -> list[Any]:
    return [entry for entry in entries if entry["verdict"] == "proved"]
