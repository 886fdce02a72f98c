"""Single orbits as rows of a certificates file (section 19)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from typing import Any

from flint import arb

from orbitproof.shared.claims import ORBIT, Candidate
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.certificate.levels import Finding, confirmed
from orbitproof.verify.certificate.row_kind import Progress, of_iterates
from orbitproof.verify.certificate.stored_balls import from_json, to_json
from orbitproof.verify.certificate.tables import (
    ball_to_text,
    read_ball,
    read_iterates,
    read_table,
    table_to_json,
    tables_of_iterates,
)
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, ball_from_json
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import first_precision
from orbitproof.verify.orbit import (
    Approach,
    Distance,
    OrbitEnclosures,
    OrbitResults,
    OrbitTheorem,
    enclose_orbit,
    prove_orbit,
)
from orbitproof.verify.poincare import PHYSICAL, IntegratorSettings


class OrbitRows:
    """See `row_kind.RowKind`."""

    names: tuple[str, ...] = (ORBIT,)
    enclosures = OrbitEnclosures
    results = OrbitResults
    keys: Set[str] = frozenset({"iterates", "image", "half_period", "first_integral", "back", "distance"})
    with_distance = True

    def theorem_of(self, candidate: Candidate, form: Candidate | None) -> OrbitTheorem:
        """As in `RowKind`."""
        return OrbitTheorem(candidate)

    def level_form(self, candidate: Candidate) -> None:
        """As in `RowKind`: an orbit has no bifurcation parameter."""
        return None

    def first_precision(self, candidate: Candidate, digits: int) -> int:
        """As in `RowKind`."""
        return first_precision(candidate, digits)

    def check_exactly(self, checklist: Checklist, candidate: Candidate) -> None:
        """As in `RowKind`."""
        check_exactly(checklist, candidate)

    def enclose(self, candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> OrbitEnclosures:
        """As in `RowKind`."""
        return enclose_orbit(candidate, settings, ORACLE, progress)

    def prove(self, candidate: Candidate, checklist: Checklist, found: OrbitEnclosures | None) -> Outcome[OrbitResults]:
        """As in `RowKind`."""
        return prove_orbit(candidate, checklist, found)

    def to_json(self, found: OrbitEnclosures) -> dict[str, Any]:
        """As in `RowKind`."""
        integral, distance = found.first_integral, found.distance
        return {
            "iterates": tables_of_iterates(found.iterates),
            "image": [table_to_json(table) for table in found.image],
            "half_period": table_to_json(found.half_period),
            "first_integral": None if integral is None else table_to_json(integral),
            "back": [[ball_to_text(ball) for ball in row] for row in found.back],
            "distance": None
            if distance is None
            else {
                "start": table_to_json(distance.start),
                "end": table_to_json(distance.end),
                "start_kind": distance.start_kind,
                "end_kind": distance.end_kind,
                "between": [
                    {"time": ball_to_text(each.time), "value": ball_to_text(each.value), "kind": each.kind}
                    for each in distance.between
                ],
            },
        }

    def from_json(self, entry: Mapping[str, Any], dimension: int, computation: Mapping[str, Any]) -> OrbitEnclosures:
        """As in `RowKind`."""
        integral, far = entry["first_integral"], entry["distance"]
        distance = None
        if far is not None:
            between = tuple(
                Approach(
                    read_ball(each["time"], f"time of extremum {i}"),
                    read_ball(each["value"], f"extremum {i}"),
                    each["kind"],
                )
                for i, each in enumerate(far["between"], start=1)
            )
            start, end = (read_table(far[name], dimension, f"distance, {name}") for name in ("start", "end"))
            distance = Distance(start, end, far["start_kind"], far["end_kind"], between)
        return OrbitEnclosures(
            read_iterates(entry["iterates"], dimension),
            tuple(read_table(table, dimension, f"coordinate {j} of P") for j, table in enumerate(entry["image"], 1)),
            read_table(entry["half_period"], dimension, "the half period"),
            None if integral is None else read_table(integral, dimension, "the first integral"),
            tuple(tuple(read_ball(text, "back") for text in row) for row in entry["back"]),
            distance,
            computation["order"], computation["precision"], computation.get("steps", 0),
            computation.get("coordinates", PHYSICAL),
        )  # fmt: skip

    def tables(self, found: OrbitEnclosures) -> Iterator[tuple[str, DerivativeTable]]:
        """As in `RowKind`."""
        yield from of_iterates(found.iterates)
        for j, table in enumerate(found.image, start=1):
            yield f"coordinate {j} of the image", table
        yield "the half period", found.half_period
        if found.first_integral is not None:
            yield "the first integral", found.first_integral
        if found.distance is not None:
            yield "squared distance at x", found.distance.start
            yield "squared distance at P(x)", found.distance.end

    def numbers(self, found: OrbitEnclosures) -> Iterator[tuple[str, arb]]:
        """As in `RowKind`."""
        for i, row in enumerate(found.back):
            for j, ball in enumerate(row):
                yield f"back, {i}, {j}", ball
        distance = found.distance
        if distance is not None:
            kinds = (distance.start_kind, *(each.kind for each in distance.between), distance.end_kind)
            yield "kinds of the extrema " + ", ".join(map(str, kinds)), arb(0)
            for number, approach in enumerate(distance.between, start=1):
                yield f"time of extremum {number}", approach.time
                yield f"extremum {number}", approach.value

    def unconfirmed(self, stored: Mapping[str, Any], found: OrbitResults, place: str) -> Iterator[Finding]:
        """As in `RowKind`."""
        yield from unconfirmed_results(stored, found, place)

    def said(self, k: int, kind: str) -> str:
        """As in `RowKind`."""
        return kind

    def attributes(self, results: Mapping[str, Any], source: str) -> dict[str, Any]:
        """As in `RowKind`."""
        return {
            "parameter_name": "period",
            "parameter": ball_from_json(results["period"]),
            "side": results.get("side"),
            "orbit": from_json(OrbitResults, results, f"{source}: field results"),
        }


def unconfirmed_results(stored: Mapping[str, Any], found: object, place: str) -> Iterator[Finding]:
    """What a certificate says of results, and what a new proof, which found others, does not confirm."""
    old, new = dict(_leaves(stored, "")), dict(_leaves(to_json(found), ""))
    if old.keys() != new.keys():
        yield Finding(place, "other results are found: " + ", ".join(sorted(old.keys() ^ new.keys())))
        return
    for name, value in old.items():
        if isinstance(value, arb) and isinstance(new[name], arb):
            yield from confirmed(value, new[name], f"{place}, {name}")
        elif value != new[name]:
            yield Finding(f"{place}, {name}", f"stored is {value!r}, found {new[name]!r}")


def _leaves(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The balls and words of a JSON value, by where they stand."""
    if isinstance(value, Mapping) and {"mid", "rad"} <= set(value):
        yield name, ball_from_json(dict(value))
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(inner, f"{name} {key}".strip())
    elif isinstance(value, list):
        for number, inner in enumerate(value, start=1):
            yield from _leaves(inner, f"{name} {number}")
    else:
        yield name, value


ORBITS = OrbitRows()
