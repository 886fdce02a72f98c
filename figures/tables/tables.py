"""Tables of certified bifurcations: one for each family, beside what the paper prints about it.

A table has a section for each set of parameters (each mass). Rows stand in the order of the certificates, which is
that of the candidates and so the order along the family, unless candidates files give the arclength. A table
repeats verdicts, it does not check them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.figures.tables.published import Comparison, PublishedList, PublishedRow, compare, match
from orbitproof.figures.tables.rows import CertifiedRow
from orbitproof.shared.systems import MASS_PARAMETERS, ReversibleSystem

MISSING = "missing"
NEW = "new"


@dataclass(frozen=True)
class TableRow:
    """A row of ours, a published one, or both side by side."""

    certified: CertifiedRow | None
    published: PublishedRow | None
    comparison: Comparison | None
    unlisted: bool = False

    @property
    def j(self) -> str:
        """The number in the paper; "new" for a row that the paper does not list; "-" if nothing is known."""
        if self.published is not None and self.published.j is not None:
            return str(self.published.j)
        return NEW if self.unlisted else "-"

    @property
    def k(self) -> int:
        """The multiplicity."""
        row = self.certified or self.published
        assert row is not None
        return row.k

    @property
    def status(self) -> str:
        """In one word: missing, new, inside, overlaps, outside, or "-" where nothing is compared."""
        if self.certified is None:
            return MISSING
        if self.unlisted:
            return NEW
        return "-" if self.comparison is None else self.comparison.status

    @property
    def verdict(self) -> str:
        """Where ours lies in the paper's enclosure; "missing" if we have no such row, "-" without comparison."""
        if self.certified is None:
            return MISSING
        return "-" if self.comparison is None else str(self.comparison)


@dataclass(frozen=True)
class Section:
    """One family at one set of parameters.

    Attributes:
        parameters: exact values, by name.
        label: what people call them, for example ``mu Earth-Moon``; empty without parameters.
        quantities: the bifurcation parameter, then coordinates of which enclosures are published.
        rows: ours along the family, then the published ones that we do not have.
        sources: where the published enclosures come from.
    """

    parameters: Mapping[str, Fraction]
    label: str
    quantities: tuple[str, ...]
    rows: tuple[TableRow, ...]
    sources: tuple[str, ...]

    @property
    def certified(self) -> list[CertifiedRow]:
        """Our rows."""
        return [row.certified for row in self.rows if row.certified is not None]

    @property
    def not_proved(self) -> list[CertifiedRow]:
        """Our rows that are not proved, in the order of their footnotes."""
        return [row for row in self.certified if not row.proved]

    def count(self, status: str) -> int:
        """Number of rows of this status: inside, overlaps, outside, missing or new."""
        return sum(row.status == status for row in self.rows)

    def summary(self) -> str:
        """Counts, in one line."""
        failed, total = len(self.not_proved), len(self.certified)
        parts = [f"{total - failed} of {total} proved"]
        if self.sources:
            listed = len({id(row.published) for row in self.rows if row.published is not None})
            counts = [(self.count(name), name) for name in ("inside", "overlaps", "outside", MISSING)]
            found = ", ".join(f"{number} {name}" for number, name in counts if number or name == "inside")
            parts.append(f"of {listed} published: {found}")
        if self.count(NEW):
            parts.append(f"{self.count(NEW)} {NEW}")
        return "; ".join(parts)


@dataclass(frozen=True)
class Table:
    """All sections of one family of one system."""

    system: ReversibleSystem
    family: str
    sections: tuple[Section, ...]

    @property
    def parameter_name(self) -> str:
        """The bifurcation parameter: family parameter or first integral."""
        return self.system.family_parameter or self.system.first_integral_name or "first integral"

    @property
    def title(self) -> str:
        """System and family, for people."""
        return f"{self.system.title}, family {self.family}"


def build_tables(rows: Sequence[CertifiedRow], published: Sequence[PublishedList]) -> list[Table]:
    """One table for each family, in the order in which the families appear."""
    groups: dict[tuple[str, str], dict[tuple[tuple[str, Fraction], ...], list[CertifiedRow]]] = {}
    for row in rows:
        by_parameters = groups.setdefault((row.system.name, row.family), {})
        by_parameters.setdefault(tuple(sorted(row.parameters.items())), []).append(row)
    tables = []
    for (_, family), by_parameters in groups.items():
        sections = [_section(members, published) for members in by_parameters.values()]
        system = next(iter(by_parameters.values()))[0].system
        tables.append(Table(system, family, tuple(sections)))
    return tables


def _section(rows: Sequence[CertifiedRow], published: Sequence[PublishedList]) -> Section:
    first = rows[0]
    if all(row.arclength is not None for row in rows):
        rows = sorted(rows, key=lambda row: row.arclength or 0.0)
    same = [p for p in published if p.system is first.system and p.parameters == first.parameters]
    # A list of another name may still be about these orbits, if no list has ours: the values decide.
    named = [p for p in same if p.family == first.family]
    # No list is about orbits at which R is lost.
    resonant = [row for row in rows if not row.loses_reversor]
    found = [(p, match(resonant, p.rows)) for p in named or same]
    found = [(p, matched) for p, matched in found if named or matched]
    listed = {name: row for _, matched in found for name, row in matched.items()}
    complete = bool(found) and all(p.complete for p, _ in found)
    table = [_row(row, listed.get(row.id), complete) for row in rows]
    had = {id(row) for row in listed.values()}
    table += [TableRow(None, row, None) for p, _ in found for row in p.rows if id(row) not in had]
    coordinates = {name for p, _ in found for row in p.rows for name in row.point}
    quantities = [first.parameter_name, *(name for name in first.system.centre_coordinates if name in coordinates)]
    sides = sorted({row.branch for row in rows if row.branch})
    label = label_of(first.parameters) + (f", {' and '.join(f'{side}ern' for side in sides)} orbits" if sides else "")
    return Section(first.parameters, label, tuple(quantities), tuple(table), tuple(p.source for p, _ in found))


def _row(row: CertifiedRow, published: PublishedRow | None, complete: bool) -> TableRow:
    # Only a bifurcation that is proved can be one that the paper does not list.
    unlisted = published is None and complete and row.proved and not row.loses_reversor
    return TableRow(row, published, None if published is None else compare(row, published), unlisted)


def label_of(parameters: Mapping[str, Fraction]) -> str:
    """Parameter values for people: by their name where they have one, else rounded to a double."""
    names = {value: "-".join(part.capitalize() for part in key.split("-")) for key, value in MASS_PARAMETERS.items()}
    return ", ".join(f"{key} {names.get(value) or f'= {float(value)!r}'}" for key, value in parameters.items())
