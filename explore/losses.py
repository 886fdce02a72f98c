"""Where complete lists say that the reversor may be lost, or that multipliers collide: guesses for claims about it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from orbitproof.explore.names import examined
from orbitproof.explore.refinement import Task
from orbitproof.shared.formats import (
    KREIN_COLLISION,
    REVERSOR_BREAKING,
    Atlas,
    InputError,
    atlas_from_json,
    read_document,
)
from orbitproof.shared.numbers import parse_exact

LISTED = {REVERSOR_BREAKING: ("loss of R", "loss"), KREIN_COLLISION: ("Krein collision", "collision")}
"""What the list of a certificate calls the points of a kind, and a word for ids."""


def read_losses(path: Path, digits: int, kind: str = REVERSOR_BREAKING) -> list[Task]:
    """The points of a certificate's complete list that may be of a kind, to be refined. Raises `InputError`."""
    document = read_document(path, "atlas-certificate")
    listed = (document["conclusion"] or {}).get("complete")
    if not listed:
        raise InputError(f"{path}: there is no complete list; make one with: orbitproof verify atlas --complete K")
    atlas = atlas_from_json(document["statement"]["atlas"], f"{path}: field statement.atlas")
    examined(atlas.system, f"{path}: statement.atlas")
    if not atlas.is_of_symmetric_orbits or atlas.system.normalised:
        raise InputError(f"{path}: its orbits have no such claims; give the list of another curve")
    return tasks_of(atlas, listed, digits, kind)


def tasks_of(atlas: Atlas, listed: Mapping[str, Any], digits: int, kind: str = REVERSOR_BREAKING) -> list[Task]:
    """Tasks from a curve and its list."""
    pieces = {piece.id: piece for piece in atlas.curve_pieces()}
    called, word = LISTED[kind]
    found = [entry for entry in listed["points"] if entry["kind"] == called]
    tasks = []
    for number, entry in enumerate(found, start=1):
        point = pieces[entry["piece"]].point(parse_exact(entry["s"]["mid"]))
        tasks.append(
            Task(
                id=f"{atlas.id}-{word}-{number}",
                system=atlas.system,
                parameters=atlas.parameters,
                kind=kind,
                k=1,
                symmetry=None,
                guess=tuple(map(float, point)),
                digits=digits,
                provenance={"atlas": atlas.id, "piece": entry["piece"]},
                crossings=atlas.claim.crossings,
            )
        )
    return tasks
