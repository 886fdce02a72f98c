"""Bifurcations as rows of a certificates file (sections 8, 9 and 12)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from functools import partial
from typing import Any

from flint import arb

from orbitproof.shared.claims import KINDS, Candidate
from orbitproof.verify import bifurcation
from orbitproof.verify.bifurcation import BifurcationResults, BifurcationTheorem
from orbitproof.verify.certificate.levels import Finding, confirmed
from orbitproof.verify.certificate.row_kind import Progress, of_iterates
from orbitproof.verify.certificate.tables import (
    ball_to_text,
    read_ball,
    read_iterates,
    read_table,
    table_to_json,
    tables_of_iterates,
)
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, Reason, ball_from_json
from orbitproof.verify.oracle import ORACLE, counsel
from orbitproof.verify.oracle.precision import first_precision, steps_of_centre
from orbitproof.verify.poincare import PHYSICAL, EarlyEnd, Enclosures, IntegratorSettings, enclose_iterates

_WORDS = {
    "symmetry_breaking": "symmetry breaking",
    "fold": "fold",
    "period_tupling": "tupling",
    "touch_and_go": "touch-and-go",
}


class BifurcationRows:
    """See `row_kind.RowKind`."""

    names: tuple[str, ...] = KINDS
    enclosures = Enclosures
    results = BifurcationResults
    keys: Set[str] = frozenset({"iterates", "first_integral", "return_times"})
    with_distance = False

    def theorem_of(self, candidate: Candidate, form: Candidate | None) -> BifurcationTheorem | Reason:
        """As in `RowKind`."""
        return bifurcation.theorem_of(candidate, form)

    def level_form(self, candidate: Candidate) -> Candidate | None:
        """As in `RowKind`."""
        return bifurcation.level_form(candidate)

    def first_precision(self, candidate: Candidate, digits: int) -> int:
        """As in `RowKind`."""
        least = first_precision(candidate, digits)
        return least if candidate.k == 1 else first_precision(candidate, digits, steps_of_centre(candidate, least))

    def check_exactly(self, checklist: Checklist, candidate: Candidate) -> None:
        """As in `RowKind`."""
        bifurcation.check_exactly(checklist, candidate)

    def enclose(self, candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> Enclosures:
        """As in `RowKind`."""
        decide = partial(bifurcation.check_half_returns, counsel=counsel)
        return enclose_iterates(candidate, settings, ORACLE, progress, EarlyEnd(settings.accuracy, decide))

    def prove(
        self, candidate: Candidate, checklist: Checklist, found: Enclosures | None
    ) -> Outcome[BifurcationResults]:
        """As in `RowKind`."""
        if found is None:
            return bifurcation.prove(candidate, checklist, (), None)
        tables = (found.iterates, found.first_integral, found.return_times)
        return bifurcation.prove(candidate, checklist, *tables, counsel)

    def to_json(self, found: Enclosures) -> dict[str, Any]:
        """As in `RowKind`."""
        integral = found.first_integral
        return {
            "iterates": tables_of_iterates(found.iterates),
            "first_integral": None if integral is None else table_to_json(integral),
            "return_times": [ball_to_text(time) for time in found.return_times],
        }

    def from_json(self, entry: Mapping[str, Any], dimension: int, computation: Mapping[str, Any]) -> Enclosures:
        """As in `RowKind`."""
        integral = entry["first_integral"]
        return Enclosures(
            read_iterates(entry["iterates"], dimension),
            None if integral is None else read_table(integral, dimension, "the first integral"),
            tuple(read_ball(text, f"time of crossing {i}") for i, text in enumerate(entry["return_times"], start=1)),
            computation["order"], computation["precision"], computation.get("steps", 0),
            computation.get("coordinates", PHYSICAL),
        )  # fmt: skip

    def tables(self, found: Enclosures) -> Iterator[tuple[str, DerivativeTable]]:
        """As in `RowKind`."""
        yield from of_iterates(found.iterates)
        if found.first_integral is not None:
            yield "the first integral", found.first_integral

    def numbers(self, found: Enclosures) -> Iterator[tuple[str, arb]]:
        """As in `RowKind`."""
        for number, time in enumerate(found.return_times, start=1):
            yield f"time of crossing {number}", time

    def unconfirmed(self, stored: Mapping[str, Any], found: BifurcationResults, place: str) -> Iterator[Finding]:
        """As in `RowKind`."""
        if stored["side"] != found.side:
            yield Finding(f"{place}, side", f"stored is {stored['side']!r}, found {found.side!r}")
        yield from confirmed(ball_from_json(stored["parameter"]), found.parameter, f"{place}, {found.parameter_name}")
        for group, balls in (("point", found.point), ("normal_form", found.normal_form)):
            if set(stored[group]) != set(balls):
                yield Finding(f"{place}, {group}", "has other numbers than are found")
                continue
            for name, ball in balls.items():
                yield from confirmed(ball_from_json(stored[group][name]), ball, f"{place}, {name}")

    def said(self, k: int, kind: str) -> str:
        """As in `RowKind`."""
        return f"k = {k} {_WORDS.get(kind, kind)}"

    def attributes(self, results: Mapping[str, Any], source: str) -> dict[str, Any]:
        """As in `RowKind`."""
        return {
            "parameter_name": results["parameter_name"],
            "parameter": ball_from_json(results["parameter"]),
            "side": results.get("side"),
        }


BIFURCATIONS = BifurcationRows()
