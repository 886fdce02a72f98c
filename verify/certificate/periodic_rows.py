"""Periodic orbits without symmetry as rows of a certificates file (section 24)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from typing import Any

from flint import arb

from orbitproof.shared.claims import PERIODIC, PeriodicOrbit
from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.certificate.orbit_rows import unconfirmed_results
from orbitproof.verify.certificate.row_kind import Progress
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.certificate.tables import ball_to_text, read_ball
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, ball_from_json
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import periodic_precision
from orbitproof.verify.periodic import (
    Linearised,
    PeriodicEnclosures,
    PeriodicResults,
    PeriodicTheorem,
    SectionReturn,
    check_periodic_exactly,
    enclose_periodic,
    prove_periodic,
)
from orbitproof.verify.poincare import PHYSICAL, IntegratorSettings


class PeriodicRows:
    """See `row_kind.RowKind`."""

    names: tuple[str, ...] = (PERIODIC,)
    enclosures = PeriodicEnclosures
    results = PeriodicResults
    keys: Set[str] = frozenset({"returns"})
    with_distance = False

    def theorem_of(self, candidate: PeriodicOrbit, form: PeriodicOrbit | None) -> PeriodicTheorem:
        """As in `RowKind`."""
        return PeriodicTheorem(candidate)

    def level_form(self, candidate: PeriodicOrbit) -> None:
        """As in `RowKind`: an orbit has no bifurcation parameter."""
        return None

    def first_precision(self, candidate: PeriodicOrbit, digits: int) -> int:
        """As in `RowKind`."""
        return periodic_precision(candidate, digits)

    def check_exactly(self, checklist: Checklist, candidate: PeriodicOrbit) -> None:
        """As in `RowKind`."""
        check_periodic_exactly(checklist, candidate)

    def enclose(
        self, candidate: PeriodicOrbit, settings: IntegratorSettings, progress: Progress | None
    ) -> PeriodicEnclosures:
        """As in `RowKind`."""
        return enclose_periodic(candidate, settings, ORACLE, progress)

    def prove(
        self, candidate: PeriodicOrbit, checklist: Checklist, found: PeriodicEnclosures | None
    ) -> Outcome[PeriodicResults]:
        """As in `RowKind`."""
        return prove_periodic(candidate, checklist, found)

    def to_json(self, found: PeriodicEnclosures) -> dict[str, Any]:
        """As in `RowKind`."""
        return {
            "returns": [
                {
                    "crossings": each.crossings,
                    "image": [_function_to_json(function) for function in each.image],
                    "time": _function_to_json(each.time),
                }
                for each in found.returns
            ]
        }

    def from_json(self, entry: Mapping[str, Any], dimension: int, computation: Mapping[str, Any]) -> PeriodicEnclosures:
        """As in `RowKind`."""
        returns = tuple(
            SectionReturn(
                each["crossings"],
                tuple(_function(function, f"coordinate {j}, return {i}") for j, function in enumerate(each["image"])),
                _function(each["time"], f"time of return {i}"),
            )
            for i, each in enumerate(entry["returns"], start=1)
        )
        return PeriodicEnclosures(
            returns,
            computation["order"],
            computation["precision"],
            computation.get("steps", 0),
            computation.get("coordinates", PHYSICAL),
        )

    def tables(self, found: PeriodicEnclosures) -> Iterator[tuple[str, DerivativeTable]]:
        """As in `RowKind`: there are none."""
        yield from ()

    def numbers(self, found: PeriodicEnclosures) -> Iterator[tuple[str, arb]]:
        """As in `RowKind`."""
        for each in found.returns:
            for name, function in (*((f"p_{j}", f) for j, f in enumerate(each.image)), ("time", each.time)):
                yield f"{name} at the centre, crossing {each.crossings}", function.centre
                for j, slope in enumerate(function.slopes):
                    yield f"d {name} / d p_{j}, crossing {each.crossings}", slope

    def unconfirmed(self, stored: Mapping[str, Any], found: PeriodicResults, place: str) -> Iterator[Finding]:
        """As in `RowKind`."""
        yield from unconfirmed_results(stored, found, place)

    def said(self, k: int, kind: str) -> str:
        """As in `RowKind`."""
        return "periodic orbit"

    def attributes(self, results: Mapping[str, Any], source: str) -> dict[str, Any]:
        """As in `RowKind`."""
        return {
            "parameter_name": "period",
            "parameter": ball_from_json(results["period"]),
            "periodic": from_json(PeriodicResults, results, f"{source}: field results"),
        }


def _function_to_json(function: Linearised) -> list[str]:
    """The value at the centre, then the derivatives. Raises `ValueError` if one is not finite."""
    return [ball_to_text(ball) for ball in function.balls]


def _function(texts: list[str], name: str) -> Linearised:
    centre, *slopes = (read_ball(text, name) for text in texts)
    return Linearised(centre, tuple(slopes))


PERIODIC_ORBITS = PeriodicRows()
