"""Orbits as they stand in files: a candidate, a certificate, a row of a family or of the periodic orbit catalogue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from orbitproof.explore.branches import NoBranch, branch_point
from orbitproof.explore.catalogue import Catalogue, correct_catalogue, read_catalogue
from orbitproof.explore.flow import Vector
from orbitproof.explore.records import FamilyRecord, read_families
from orbitproof.explore.trajectories.units import Units
from orbitproof.shared.formats import (
    HALF_PERIOD,
    Candidate,
    InputError,
    candidate_from_json,
    read_candidates,
    read_document,
    stated_format,
)
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import ReversibleSystem

_LISTED = 5
_REMEDY = "give candidates, certificates, families or a periodic orbit catalogue"


class NoOrbit(Exception):
    """The file's entry leads to no periodic orbit; one line says why."""


@dataclass(frozen=True)
class Choice:
    """Which orbit of a file is meant.

    Attributes:
        identifier: id of a candidate or certificate, or `None`.
        family: name of a family of a family file, its mass in front where there are several, or `None`.
        number: of the orbit along a family or in a catalogue, counted from 1, or `None`.
    """

    identifier: str | None = None
    family: str | None = None
    number: int | None = None


@dataclass(frozen=True)
class SourceOrbit:
    """A symmetric periodic orbit that a file names.

    Attributes:
        unknowns: shape (2 + n,): family parameter (if any), coordinates on Fix(R), half period.
        title: what it is.
        verdict: what the file says about it, in words.
        primaries: names of the system's two bodies, or `None`.
        units: that the file names.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    unknowns: Vector
    title: str
    verdict: str
    primaries: tuple[str, str] | None = None
    units: Units | None = None


def find_orbit(path: Path, choice: Choice) -> SourceOrbit:
    """The orbit that is meant. Raises `InputError` for bad files and choices, `NoOrbit` if there is none there."""
    readers = {
        "candidates": _candidate,
        "certificates": _certificate,
        "family": _family_row,
        "": _catalogue_row,
    }
    kind = stated_format(path, _REMEDY)
    if kind not in readers:
        raise InputError(f"{path}: holds {kind}; {_REMEDY}")
    return readers[kind](path, choice)


def _candidate(path: Path, choice: Choice) -> SourceOrbit:
    candidates = {candidate.id: candidate for candidate in read_candidates(path)}
    chosen = candidates[_identifier(path, choice, list(candidates))]
    return _bifurcating(chosen, f"candidate {chosen.id}", "not proved: a candidate, refined numerically")


def _certificate(path: Path, choice: Choice) -> SourceOrbit:
    entries = {entry["id"]: entry for entry in read_document(path, "certificates")["certificates"]}
    entry = entries[_identifier(path, choice, list(entries))]
    candidate = candidate_from_json(entry["statement"]["candidate"], f"{path}: certificate {entry['id']}")
    what = "orbit" if candidate.is_of_orbit else "bifurcation"
    said = f'the certificate says "{entry["verdict"]}" of the {what} at the first state, up to the radii of its box'
    results = entry["results"] if candidate.is_of_orbit else None
    half_period = None if results is None else float(parse_exact(results["half_period"]["mid"]))
    return _bifurcating(candidate, f"certificate {candidate.id}", f"{said}; not checked again here", half_period)


def _bifurcating(candidate: Candidate, title: str, verdict: str, half_period: float | None = None) -> SourceOrbit:
    if candidate.equation is not None:
        if candidate.equation.quantity == HALF_PERIOD:
            half_period = float(candidate.equation.value)
        if half_period is None:
            raise NoOrbit(f"{title}: the half period is not known before it is certified")
        unknowns = np.array([*map(float, candidate.centre), half_period])
        return SourceOrbit(candidate.system, candidate.parameters, unknowns, title, verdict)
    try:
        start = branch_point(candidate)
    except NoBranch as failure:
        raise NoOrbit(f"{title}: {failure}") from None
    unknowns = np.append(start.point, start.half_period)
    return SourceOrbit(candidate.system, candidate.parameters, unknowns, title, verdict)


def _identifier(path: Path, choice: Choice, known: Sequence[str]) -> str:
    _without(choice.family, "--family", f"{path} holds no families; choose with --id")
    _without(choice.number, "--orbit", f"{path} holds no families; choose with --id")
    if choice.identifier is None and len(known) == 1:
        return known[0]
    if choice.identifier not in known:
        said = "missing" if choice.identifier is None else f"no {choice.identifier!r} in {path}"
        raise InputError(f"--id: {said}; give one of {_some(known)}")
    return choice.identifier


def _family_row(path: Path, choice: Choice) -> SourceOrbit:
    _without(choice.identifier, "--id", f"{path} holds families; choose with --family and --orbit")
    records = read_families(path)
    record = _family(path, choice, records)
    number = _number(path, choice, len(record.orbits))
    orbit = record.orbits[number]
    title = f"orbit {number + 1} of {len(record.orbits)} of the family {_name(record)}"
    unknowns = np.append(orbit.point, orbit.half_period)
    return SourceOrbit(record.system, record.parameters, unknowns, title, "not proved: traced numerically")


def _family(path: Path, choice: Choice, records: Sequence[FamilyRecord]) -> FamilyRecord:
    fits = [record for record in records if choice.family in (None, record.name, _name(record))]
    if len(fits) != 1:
        said = "missing"
        if choice.family is not None:
            said = f"{len(fits) or 'no'} families of {path} are called {choice.family!r}"
        raise InputError(f"--family: {said}; give one of {_some([_name(record) for record in records])}")
    return fits[0]


def _name(record: FamilyRecord) -> str:
    return "-".join(part for part in (record.label, record.name) if part)


def _catalogue_row(path: Path, choice: Choice) -> SourceOrbit:
    _without(choice.identifier, "--id", f"{path} is a catalogue; choose with --orbit")
    catalogue = read_catalogue(path)
    _without(choice.family, "--family", f"{path} is a catalogue of one family; choose with --orbit")
    number = _number(path, choice, len(catalogue))
    corrected = correct_catalogue(_row(catalogue, number))
    if corrected.failures[0]:
        raise NoOrbit(f"{path}: orbit {number + 1}: not corrected: {corrected.failures[0]}")
    names = catalogue.system.split("-")
    units = None
    if catalogue.lunit is not None and catalogue.tunit is not None:
        units = Units(catalogue.lunit, catalogue.tunit, "as in the catalogue")
    title = f"orbit {number + 1} of {len(catalogue)} of {' '.join((catalogue.system, catalogue.title)).strip()}"
    return SourceOrbit(
        corrected.problem.system,
        {"mu": catalogue.mass_ratio},
        corrected.batch.unknowns[0],
        title,
        "not proved: corrected numerically",
        (names[0], names[1]) if len(names) == 2 else None,
        units,
    )


def _row(catalogue: Catalogue, index: int) -> Catalogue:
    rows = slice(index, index + 1)
    return replace(
        catalogue,
        states=catalogue.states[rows],
        jacobi_constants=catalogue.jacobi_constants[rows],
        periods=catalogue.periods[rows],
        stability_indices=catalogue.stability_indices[rows],
    )


def _number(path: Path, choice: Choice, count: int) -> int:
    if choice.number is None and count > 1:
        raise InputError(f"--orbit: missing; {path} has {count} orbits there: give a number from 1 to {count}")
    number = choice.number or 1
    if number > count:
        raise InputError(f"--orbit {number}: {path} has {count} orbits there; give a smaller number")
    return number - 1


def _without(value: object, option: str, why: str) -> None:
    if value is not None:
        raise InputError(f"{option}: {why}")


def _some(names: Sequence[str]) -> str:
    more = len(names) - _LISTED
    return ", ".join(names[:_LISTED]) + (f" and {more} more" if more > 0 else "")
