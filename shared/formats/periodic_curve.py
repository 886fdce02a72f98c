"""Atlases of curves of periodic orbits without symmetry as JSON, read."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NoReturn

from orbitproof.shared.claims import (
    ATLASES_WITHOUT_REVERSOR,
    CLAIMS_WITHOUT_REVERSOR,
    CurveClaim,
    PeriodicAtlas,
    Piece,
)
from orbitproof.shared.codec import from_json
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.candidates import find_system
from orbitproof.shared.formats.pieces import check_length, periodic_piece_from_json
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import DescriptionError, ReversibleSystem, System, described_plainly


def system_without_symmetry(
    entry: str | Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem]
) -> System:
    """One of `systems` by its name, or what a JSON object describes, reversible or not. Raises `InputError`."""
    if isinstance(entry, Mapping) and not {"R", "section", "reversor"} & set(entry):
        try:
            return described_plainly(entry)
        except DescriptionError as error:
            raise InputError(f"{source}.{error}") from None
    return find_system(entry, source, systems)


def periodic_atlas_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem]
) -> PeriodicAtlas:
    """A `PeriodicAtlas` from a schema-valid JSON document, its id and title checked; raises `InputError`."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}: field {name}: {why}; {remedy}")

    system = system_without_symmetry(entry["system"], f"{source}: field system", systems)
    claim = _claim(entry["claim"], system, f"{source}: field claim")
    wanted = set(system.parameters) - {claim.parameter}
    if set(entry.get("parameters", {})) != wanted:
        names = ", ".join(name for name in system.parameters if name in wanted) or "none"
        refuse("parameters", f"{system.name} takes the parameters: {names}", "give exactly these")
    parameters = {name: parse_exact(text) for name, text in entry["parameters"].items()}
    for name, value in parameters.items():
        check_length(value, f"{source}: field parameters.{name}")
        interval = system.parameters[name]
        if not interval.contains(value):
            refuse(f"parameters.{name}", f"{value} lies outside {interval}", "choose a value inside")
    coordinates = claim.coordinates(system)
    _check_coordinates(claim, coordinates, f"{source}: field claim")
    pieces: list[Piece] = []
    for index, item in enumerate(entry["pieces"]):
        place = f"pieces[{index}]"
        piece = periodic_piece_from_json(item, coordinates, system.name, f"{source}: field {place}")
        if piece.id in {other.id for other in pieces}:
            refuse(f"{place}.id", f"{piece.id!r} appears twice", "give each piece its own id")
        pieces.append(piece)
    provenance = entry.get("provenance", {})
    return atlas_without_symmetry(entry["id"], entry["title"], system, parameters, claim, tuple(pieces), provenance)


def atlas_without_symmetry(
    name: str,
    title: str,
    system: System,
    parameters: Mapping[str, Fraction],
    claim: CurveClaim,
    pieces: tuple[Piece, ...],
    provenance: Mapping[str, Any] | None = None,
) -> PeriodicAtlas:
    """An atlas of the kind of its claim."""
    more = {} if provenance is None else {"provenance": provenance}
    made: Any = ATLASES_WITHOUT_REVERSOR[claim.kind]
    atlas: PeriodicAtlas = made(name, title, system, parameters, claim, pieces, **more)
    return atlas


def curve_claim_from_json(entry: Mapping[str, Any], source: str) -> CurveClaim:
    """What is claimed of a curve, as far as it needs no system."""
    claim: CurveClaim = from_json(CLAIMS_WITHOUT_REVERSOR[entry["kind"]], entry, source)
    return claim


def _claim(entry: Mapping[str, Any], system: System, source: str) -> CurveClaim:
    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    claim = curve_claim_from_json(entry, source)
    if claim.parameter is not None and claim.parameter not in system.parameters:
        known = ", ".join(system.parameters) or "none"
        refuse("parameter", f"{system.name} has no parameter {claim.parameter!r}", f"known: {known}")
    refusal = claim.refusal(system)
    if refusal is not None:
        refuse(*refusal)
    for name, value in claim.numbers:
        check_length(value, f"{source}.{name}")
    return claim


def _check_coordinates(claim: CurveClaim, names: tuple[str, ...], source: str) -> None:
    wanted = ", ".join(names)
    for position, name in enumerate(claim.increasing):
        if name not in names or name in claim.increasing[:position]:
            raise InputError(
                f"{source}.increasing[{position}]: {name!r}; name each coordinate once; there are: {wanted}"
            )
    if claim.covers is None:
        return
    covers = claim.covers
    if covers.coordinate not in names:
        raise InputError(f"{source}.covers.coordinate: {covers.coordinate!r}; choose one of: {wanted}")
    for key, value in (("from", covers.start), ("to", covers.end)):
        check_length(value, f"{source}.covers.{key}")
    if not covers.start < covers.end:
        raise InputError(f"{source}.covers.to: not greater than covers.from; give a range that is not empty")
