"""Atlases as JSON, read and written.

The format is in docs/formats.md, the schema in ``schemas/atlas.schema.json``; bad input raises `InputError`, one
line with file, field and remedy.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from orbitproof.shared.claims import (
    ATLASES_WITHOUT_REVERSOR,
    SURFACE,
    AnyAtlas,
    AnyPiece,
    Atlas,
    BirthPiece,
    Claim,
    LibrationPiece,
    SurfacePiece,
)
from orbitproof.shared.claims.pieces import pieces_of
from orbitproof.shared.codec import from_json, to_json
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.candidates import find_system, read_system
from orbitproof.shared.formats.documents import json_text, read_document, validate_document
from orbitproof.shared.formats.periodic_curve import periodic_atlas_from_json
from orbitproof.shared.formats.pieces import check_length, piece_from_json
from orbitproof.shared.output import write_text
from orbitproof.shared.systems import (
    BRANCH_SYSTEMS,
    CR3BP,
    HILL,
    HILL_VARIED,
    ID,
    ID_IN_WORDS,
    LIFTED,
    LINE,
    ReversibleSystem,
    fits,
)


def read_atlas(path: Path) -> AnyAtlas:
    """Read an atlas file. Raises `InputError` for anything that is not a well-formed claim."""
    return atlas_from_json(read_document(path, "atlas"), str(path))


def write_atlas(path: Path, atlas: AnyAtlas) -> None:
    """Write an atlas file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = atlas_to_json(atlas)
    validate_document(document, "atlas", "atlas to be written")
    write_text(path, json_text(document, [("pieces",)]) + "\n")


def atlas_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = BRANCH_SYSTEMS
) -> AnyAtlas:
    """An atlas about one of `systems` from a schema-valid JSON document; `source` begins the text of errors.

    Raises `InputError`.
    """

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}: field {name}: {why}; {remedy}")

    for name, pattern, wanted in (("id", ID, ID_IN_WORDS), ("title", LINE, "give one line of text")):
        if not fits(pattern, entry[name]):
            refuse(name, f"{entry[name]!r} is no {name}", wanted)
    if entry["claim"]["kind"] in ATLASES_WITHOUT_REVERSOR:
        return periodic_atlas_from_json(entry, source, systems)
    surface = entry["claim"]["kind"] == SURFACE
    if surface == ("parameters" in entry):
        why = "a surface has its parameters in its pieces" if surface else "missing"
        refuse("parameters", why, "leave it out here" if surface else "give all but the family parameter")
    if surface:
        system = find_system(entry["system"], f"{source}: field system", systems)
        parameters = dict[str, Fraction]()
    else:
        system, parameters = read_system(entry, f"{source}: field atlas", systems)
        for name, value in parameters.items():
            check_length(value, f"{source}: field parameters.{name}")
    if surface and system.fixed_level is not None:
        refuse("system", "surfaces on a fixed level are not claimed", "leave out fixed_level")
    claim = claim_from_json(entry["claim"], system, f"{source}: field claim")
    pieces: list[AnyPiece] = []
    seen: set[str] = set()
    for index, item in enumerate(entry["pieces"]):
        place = f"pieces[{index}]"
        if (item["kind"] in (SurfacePiece.kind, LibrationPiece.kind)) != surface:
            why = f"{item['kind']!r} in a claim {claim.kind!r}"
            refuse(f"{place}.kind", why, "symmetry_breaking belongs to surfaces, and libration; the others to curves")
        kind = item["kind"]
        if kind == LibrationPiece.kind and system is not HILL:
            refuse(f"{place}.kind", f"'libration' in a surface of {system.name}", f"it belongs to {HILL.name}")
        takes_birth = system is LIFTED or (system is CR3BP and claim.is_arc and claim.crossings == 2)
        if kind == BirthPiece.kind and not (takes_birth and index == len(entry["pieces"]) - 1 > 0):
            why = f"'birth' in a curve of {system.name}"
            others = f"in an arc of {LIFTED.name}, or of {CR3BP.name} with 2 crossings"
            refuse(f"{place}.kind", why, f"it stands last, after other pieces, {others}")
        piece = piece_from_json(item, system, f"{source}: field {place}")
        if piece.id in seen:
            refuse(f"{place}.id", f"{piece.id!r} appears twice", "give each piece its own id")
        if piece.is_symmetric and claim.symmetry is None:
            refuse(f"{place}.kind", "a symmetric piece in a claim without a symmetry", "name it in claim.symmetry")
        seen.add(piece.id)
        pieces.append(piece)
    if len({piece.point for piece in pieces_of(LibrationPiece, pieces)}) > 1:
        refuse("pieces", "libration pieces of two points", "an atlas is about one libration point")
    if surface and not pieces_of(SurfacePiece, pieces):
        refuse("pieces", "no symmetry_breaking piece in a surface", "give the pieces of the surface")
    provenance = entry.get("provenance", {})
    return Atlas(entry["id"], entry["title"], system, parameters, claim, tuple(pieces), provenance)


def claim_from_json(entry: Mapping[str, Any], system: ReversibleSystem, source: str) -> Claim:
    """A `Claim` from a schema-valid JSON object; raises `InputError` that names the field."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    claim = from_json(Claim, entry, source)
    known = ", ".join(system.symmetries) or "none"
    if system is HILL_VARIED and not claim.is_arc:
        refuse("kind", f"{claim.kind!r} of {system.name}", "period doublings over the mass are claimed as an arc")
    if claim.symmetry is not None and claim.symmetry not in system.symmetries:
        refuse("symmetry", f"{system.name} has no symmetry {claim.symmetry!r}", f"known: {known}")
    if claim.symmetry is None and (claim.is_of_symmetric_curve or claim.is_of_surface):
        refuse("symmetry", f"{claim.kind} without a symmetry", f"name one; {system.name} has: {known}")
    for position, name in enumerate(claim.increasing):
        if name not in system.centre_coordinates or name in claim.increasing[:position]:
            wanted = ", ".join(system.centre_coordinates)
            refuse(f"increasing[{position}]", f"{name!r}", f"name each coordinate once; {system.name} has: {wanted}")
    surface = claim.is_of_surface
    if claim.crossings != 1 and (surface or system.normalised):
        where = "on a surface" if surface else f"in {system.name}"
        remedy = "leave it out if half orbits meet the section once; others are claimed in arcs and loops"
        refuse("crossings", f"{claim.crossings} {where}, where it can only be 1", remedy)
    if claim.covers is not None:
        covers, names = claim.covers, system.fixed_parameters if surface else system.centre_coordinates
        if covers.coordinate not in names:
            refuse("covers.coordinate", f"{covers.coordinate!r}", f"choose one of: {', '.join(names)}")
        for key, value in (("from", covers.start), ("to", covers.end)):
            check_length(value, f"{source}.covers.{key}")
        if not covers.start < covers.end:
            refuse("covers.to", "not greater than covers.from", "give a range that is not empty")
    return claim


def atlas_to_json(atlas: AnyAtlas, provenance: bool = True) -> dict[str, Any]:
    """The JSON object of an atlas, a whole document, with or without what the verifier ignores."""
    left_out = {*(["parameters"] if atlas.is_surface else []), *([] if provenance else ["provenance"])}
    entry = {key: value for key, value in to_json(atlas).items() if key not in left_out}
    return {"format": "orbitproof-atlas", "version": 1, **entry}
