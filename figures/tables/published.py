"""Enclosures that the paper prints, which rows of ours they belong to, and whether ours lie inside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from fractions import Fraction
from importlib import resources
from pathlib import Path
from typing import Any

from orbitproof.figures.tables.intervals import Interval, parse_interval
from orbitproof.figures.tables.rows import CertifiedRow
from orbitproof.shared.formats import InputError, read_document, read_system
from orbitproof.shared.systems import ReversibleSystem

_NEARNESS = Fraction(1, 1000)
"""Rows that do not overlap belong together within this fraction of the gap to the next published row."""


@dataclass(frozen=True)
class Printed:
    """An enclosure as the source prints it, and the interval that this means."""

    text: str
    interval: Interval


@dataclass(frozen=True)
class PublishedRow:
    """One published bifurcation; `j` is its number in the source, if it has one."""

    j: int | None
    k: int
    parameter: Printed
    point: Mapping[str, Printed]


@dataclass(frozen=True)
class PublishedList:
    """What a source prints about one family; `complete` if it claims no other row than it prints here."""

    source: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    family: str
    parameter_name: str
    complete: bool
    rows: tuple[PublishedRow, ...]


@dataclass(frozen=True)
class Comparison:
    """Where our enclosures lie: `status` is "inside", "overlaps" or "outside"."""

    status: str
    explanation: str = ""

    def __str__(self) -> str:
        return f"{self.status}: {self.explanation}" if self.explanation else self.status


def default_published() -> Path:
    """The file with the values of the paper that comes with the project."""
    return Path(str(resources.files("orbitproof.figures.tables").joinpath("published.json")))


def read_published(path: Path) -> list[PublishedList]:
    """Read a file of published enclosures. Raises `InputError` that names file and field."""
    document = read_document(path, "published")
    return [_list(entry, f"{path}: field lists[{index}]") for index, entry in enumerate(document["lists"])]


def _list(entry: Mapping[str, Any], source: str) -> PublishedList:
    system, parameters = read_system(entry, source)
    name = system.family_parameter or system.first_integral_name
    if entry["parameter_name"] != name:
        raise InputError(f"{source}.parameter_name: not the bifurcation parameter of {system.name}; write {name!r}")
    rows = []
    for index, row in enumerate(entry["rows"]):
        where = f"{source}.rows[{index}]"
        point = {}
        for coordinate, text in row.get("point", {}).items():
            if coordinate not in system.centre_coordinates:
                known = ", ".join(system.centre_coordinates)
                raise InputError(f"{where}.point: {system.name} has no coordinate {coordinate!r}; known: {known}")
            point[coordinate] = _printed(text, f"{where}.point.{coordinate}")
        rows.append(PublishedRow(row["j"], row["k"], _printed(row["parameter"], f"{where}.parameter"), point))
    return PublishedList(
        entry["source"],
        system,
        parameters,
        entry["family"],
        entry["parameter_name"],
        entry["complete"],
        tuple(rows),
    )


def _printed(text: str, where: str) -> Printed:
    try:
        return Printed(text.strip(), parse_interval(text))
    except ValueError as error:
        raise InputError(f"{where}: {error}; write it as it is printed") from None


def match(rows: Sequence[CertifiedRow], published: Sequence[PublishedRow]) -> dict[str, PublishedRow]:
    """The published row that each of ours is about, by our id; rows of ours without one are absent.

    Both must have the same k. A row of ours belongs to the published row that its enclosure meets. If none
    meets a published row, the nearest of ours may still be meant, though it lies outside: it is, if it is
    nearer than a thousandth of the gap between the published row and the next one.
    For a row that is not proved, the value at the centre of its box takes the place of the enclosure.
    """
    valued = [(row, row.value) for row in rows if row.value is not None]
    result: dict[str, PublishedRow] = {}
    met: set[int] = set()
    for row, value in valued:
        found = [p for p in published if p.k == row.k and value.distance(p.parameter.interval) == 0]
        if found:
            nearest = min(found, key=lambda p: abs(p.parameter.interval.middle - value.middle))
            result[row.id] = nearest
            if row.proved:
                met.add(id(nearest))
    for p in published:
        limit = _NEARNESS * _gap(p, published)
        others = [(value.distance(p.parameter.interval), row) for row, value in valued if row.id not in result]
        near = [(distance, row) for distance, row in others if row.k == p.k and distance < limit]
        proved = [(distance, row) for distance, row in near if row.proved]
        if proved and id(p) not in met:
            result[min(proved, key=lambda pair: pair[0])[1].id] = p
        result.update({row.id: p for _, row in near if not row.proved})
    return result


def _gap(row: PublishedRow, published: Iterable[PublishedRow]) -> Fraction:
    """Distance to the nearest other published row; zero if there is no other."""
    others = [p.parameter.interval.distance(row.parameter.interval) for p in published if p is not row]
    return min(others, default=Fraction(0))


def compare(row: CertifiedRow, published: PublishedRow) -> Comparison | None:
    """Exact comparison of all enclosures that the published row prints; `None` if the row is not proved.

    "inside" means that every one of ours is a subset of the published one, "outside" that one has no point
    in common with it: then one of the two is wrong, or they speak of different bifurcations.
    """
    if row.parameter is None:
        return None
    pairs = [(row.parameter_name, row.parameter.interval, published.parameter.interval)]
    pairs += [(name, row.point[name].interval, printed.interval) for name, printed in published.point.items()]
    outside = [_outside(name, ours, theirs) for name, ours, theirs in pairs if ours.distance(theirs) > 0]
    if outside:
        return Comparison("outside", "; ".join(outside))
    wide = [name for name, ours, theirs in pairs if not ours.inside(theirs)]
    return Comparison("overlaps", f"{', '.join(wide)} only in part") if wide else Comparison("inside")


def _outside(name: str, ours: Interval, theirs: Interval) -> str:
    side = "above the upper" if ours.lower > theirs.upper else "below the lower"
    distance, width = _rounded(ours.distance(theirs)), _rounded(theirs.width)
    return f"{name} lies {distance} {side} end of the published enclosure, which is {width} wide"


def _rounded(value: Fraction) -> str:
    """Two digits of a value that may be beyond the range of a double."""
    with localcontext(prec=3):
        return f"{Decimal(value.numerator) / Decimal(value.denominator):.2g}"
