"""Where complete lists say that the reversor may be lost: guesses for claims about it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from orbitproof.explore.refinement import Task
from orbitproof.shared.formats import REVERSOR_BREAKING, Atlas, InputError, atlas_from_json, read_document
from orbitproof.shared.numbers import parse_exact

_LOSS = "loss of R"
"""What the list of a certificate calls such a point."""


def read_losses(path: Path, digits: int) -> list[Task]:
    """The points of a certificate's complete list at which R may be lost, to be refined. Raises `InputError`."""
    document = read_document(path, "atlas-certificate")
    listed = (document["conclusion"] or {}).get("complete")
    if not listed:
        raise InputError(f"{path}: there is no complete list; make one with: orbitproof verify atlas --complete K")
    atlas = atlas_from_json(document["statement"]["atlas"], f"{path}: field statement.atlas")
    if not isinstance(atlas, Atlas) or atlas.system.normalised:
        raise InputError(f"{path}: its orbits have no claims about a loss of R; give the list of another curve")
    return tasks_of(atlas, listed, digits)


def tasks_of(atlas: Atlas, listed: Mapping[str, Any], digits: int) -> list[Task]:
    """The same from the curve and its list."""
    pieces = {piece.id: piece for piece in atlas.curve_pieces()}
    found = [entry for entry in listed["points"] if entry["kind"] == _LOSS]
    tasks = []
    for number, entry in enumerate(found, start=1):
        point = pieces[entry["piece"]].point(parse_exact(entry["s"]["mid"]))
        tasks.append(
            Task(
                id=f"{atlas.id}-loss-{number}",
                system=atlas.system,
                parameters=atlas.parameters,
                kind=REVERSOR_BREAKING,
                k=1,
                symmetry=None,
                guess=tuple(map(float, point)),
                digits=digits,
                provenance={"atlas": atlas.id, "piece": entry["piece"]},
                crossings=atlas.claim.crossings,
            )
        )
    return tasks
