"""Atlases: a curve of symmetric periodic orbits in pieces, or a surface of them over the mass parameter.

The format is in docs/formats.md, the schema in ``schemas/atlas.schema.json``; bad input raises `InputError`, one
line with file, field and remedy.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from orbitproof.shared.formats.candidates import find_system, read_system
from orbitproof.shared.formats.documents import ID_IN_WORDS, InputError, read_document, validate_document, write_text
from orbitproof.shared.formats.pieces import (
    AnyPiece,
    LibrationPiece,
    Piece,
    SurfacePiece,
    check_length,
    piece_from_json,
)
from orbitproof.shared.numbers import format_exact, format_rational, parse_exact
from orbitproof.shared.systems import BRANCH_SYSTEMS, HILL, ID, LINE, ReversibleSystem, describe, fits

SURFACE = "symmetry-breaking-surface"
CLAIMS = ("arc", "symmetric-arc", "symmetric-loop", "loop", SURFACE)


@dataclass(frozen=True)
class Covers:
    """The claim that a coordinate goes from a value <= `start` to one >= `end`."""

    coordinate: str
    start: Fraction
    end: Fraction

    def to_json(self) -> dict[str, str]:
        """The JSON object."""
        return {"coordinate": self.coordinate, "from": format_exact(self.start), "to": format_exact(self.end)}


@dataclass(frozen=True)
class Claim:
    """What the pieces are claimed to be together.

    Attributes:
        kind: one of `CLAIMS`.
        symmetry: name of the symmetry of the curve (for a surface, of the one that breaks), or `None`.
        increasing: coordinates that increase along the curve, on a symmetric arc away from its symmetric point.
        covers: the range that a coordinate takes, or `None`.
        crossings: m, how often half orbits meet the section after their start; P^m then stands for P.
    """

    kind: str
    symmetry: str | None = None
    increasing: tuple[str, ...] = ()
    covers: Covers | None = None
    crossings: int = 1

    def to_json(self) -> dict[str, Any]:
        """The JSON object."""
        result: dict[str, Any] = {"kind": self.kind, "symmetry": self.symmetry}
        if self.increasing:
            result["increasing"] = list(self.increasing)
        if self.covers is not None:
            result["covers"] = self.covers.to_json()
        if self.crossings != 1:
            result["crossings"] = self.crossings
        return result


@dataclass(frozen=True)
class Atlas:
    """A claim about a curve or a surface, and its pieces in order along it.

    Attributes:
        id: short name.
        title: what people read.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name; empty for a surface.
        claim: what the pieces are together.
        pieces: all of them `Piece`, or for a surface `SurfacePiece`, and `LibrationPiece` in Hill's units.
        provenance: free-form, ignored by the verifier.
    """

    id: str
    title: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    claim: Claim
    pieces: tuple[AnyPiece, ...]
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_surface(self) -> bool:
        """Whether the claim is about a surface over the parameters."""
        return self.claim.kind == SURFACE

    def curve_pieces(self) -> tuple[Piece, ...]:
        """The pieces of a curve; none for a surface."""
        return tuple(piece for piece in self.pieces if isinstance(piece, Piece))

    def surface_pieces(self) -> tuple[SurfacePiece, ...]:
        """The pieces of a surface; none for a curve."""
        return tuple(piece for piece in self.pieces if isinstance(piece, SurfacePiece))

    def libration_pieces(self) -> tuple[LibrationPiece, ...]:
        """The pieces of the planar families over which a surface lives; none for a curve."""
        return tuple(piece for piece in self.pieces if isinstance(piece, LibrationPiece))

    def to_json(self, provenance: bool = True) -> dict[str, Any]:
        """The JSON object of the atlas, a whole document. All numbers must be dyadic or decimal fractions."""
        result: dict[str, Any] = {
            "format": "orbitproof-atlas",
            "version": 1,
            "id": self.id,
            "title": self.title,
            "system": describe(self.system),
        }
        if not self.is_surface:
            result["parameters"] = {name: format_rational(value) for name, value in self.parameters.items()}
        result["claim"] = self.claim.to_json()
        result["pieces"] = [piece.to_json() for piece in self.pieces]
        if provenance:
            result["provenance"] = dict(self.provenance)
        return result


def read_atlas(path: Path) -> Atlas:
    """Read an atlas file. Raises `InputError` for anything that is not a well-formed claim."""
    return atlas_from_json(read_document(path, "atlas"), str(path))


def write_atlas(path: Path, atlas: Atlas) -> None:
    """Write an atlas file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = atlas.to_json()
    validate_document(document, "atlas", "atlas to be written")
    rest = json.dumps({**document, "pieces": []}, indent=1, allow_nan=False)
    # One piece a line: a list of numbers with one number a line is long and says nothing.
    pieces = ",\n".join(f"  {json.dumps(entry, allow_nan=False)}" for entry in document["pieces"])
    write_text(path, rest.replace('\n "pieces": []', f'\n "pieces": [\n{pieces}\n ]', 1) + "\n")


def atlas_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = BRANCH_SYSTEMS
) -> Atlas:
    """An `Atlas` about one of `systems` from a schema-valid JSON document; `source` begins the text of errors.

    Raises `InputError`.
    """

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}: field {name}: {why}; {remedy}")

    for name, pattern, wanted in (("id", ID, ID_IN_WORDS), ("title", LINE, "give one line of text")):
        if not fits(pattern, entry[name]):
            refuse(name, f"{entry[name]!r} is no {name}", wanted)
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
        if item["kind"] == LibrationPiece.kind and system is not HILL:
            refuse(f"{place}.kind", f"'libration' in a surface of {system.name}", f"it belongs to {HILL.name}")
        piece = piece_from_json(item, system, f"{source}: field {place}")
        if piece.id in seen:
            refuse(f"{place}.id", f"{piece.id!r} appears twice", "give each piece its own id")
        if piece.kind == "symmetric" and claim.symmetry is None:
            refuse(f"{place}.kind", "a symmetric piece in a claim without a symmetry", "name it in claim.symmetry")
        seen.add(piece.id)
        pieces.append(piece)
    if len({piece.point for piece in pieces if isinstance(piece, LibrationPiece)}) > 1:
        refuse("pieces", "libration pieces of two points", "an atlas is about one libration point")
    if surface and not any(isinstance(piece, SurfacePiece) for piece in pieces):
        refuse("pieces", "no symmetry_breaking piece in a surface", "give the pieces of the surface")
    provenance = entry.get("provenance", {})
    return Atlas(entry["id"], entry["title"], system, parameters, claim, tuple(pieces), provenance)


def claim_from_json(entry: Mapping[str, Any], system: ReversibleSystem, source: str) -> Claim:
    """A `Claim` from a schema-valid JSON object; raises `InputError` that names the field."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    kind, symmetry = entry["kind"], entry.get("symmetry")
    known = ", ".join(system.symmetries) or "none"
    if symmetry is not None and symmetry not in system.symmetries:
        refuse("symmetry", f"{system.name} has no symmetry {symmetry!r}", f"known: {known}")
    if symmetry is None and kind.startswith("symmetr"):
        refuse("symmetry", f"{kind} without a symmetry", f"name one; {system.name} has: {known}")
    increasing = tuple(entry.get("increasing", ()))
    for position, name in enumerate(increasing):
        if name not in system.centre_coordinates or name in increasing[:position]:
            wanted = ", ".join(system.centre_coordinates)
            refuse(f"increasing[{position}]", f"{name!r}", f"name each coordinate once; {system.name} has: {wanted}")
    crossings = entry.get("crossings", 1)
    if crossings != 1 and (kind == SURFACE or system.normalised):
        where = "on a surface" if kind == SURFACE else "around a libration point"
        remedy = "leave it out if half orbits meet the section once; others are claimed in arcs and loops"
        refuse("crossings", f"{crossings} {where}, where it can only be 1", remedy)
    if "covers" not in entry:
        return Claim(kind, symmetry, increasing, None, crossings)
    name = entry["covers"]["coordinate"]
    names = system.fixed_parameters if kind == SURFACE else system.centre_coordinates
    if name not in names:
        refuse("covers.coordinate", f"{name!r}", f"choose one of: {', '.join(names)}")
    start, end = (parse_exact(entry["covers"][key]) for key in ("from", "to"))
    for key, value in (("from", start), ("to", end)):
        check_length(value, f"{source}.covers.{key}")
    if not start < end:
        refuse("covers.to", "not greater than covers.from", "give a range that is not empty")
    return Claim(kind, symmetry, increasing, Covers(name, start, end), crossings)
