"""Portrait files: phase portraits of reversible planar maps as JSON, version 1, for pictures.

``{"format": "orbitproof-portraits", "version": 1, "portraits": [...]}``; the fields stand in
``shared/schemas/portraits.schema.json``. Reading it needs neither JAX nor diffrax.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from orbitproof.explore.portraits.planar_map import Array, PeriodicOrbit, Portrait, ReversibleMap
from orbitproof.shared.formats import InputError, read_document, validate_document, write_text

_DIGITS = 5


def write_portraits(path: Path, portraits: Sequence[Portrait]) -> None:
    """Write a portrait file, whole or not at all; coordinates to 5 decimals. Raises `InputError`."""
    document = {
        "format": "orbitproof-portraits",
        "version": 1,
        "portraits": [_to_json(portrait) for portrait in portraits],
    }
    validate_document(document, "portraits", "portrait file to be written")
    write_text(path, json.dumps(document, allow_nan=False, separators=(",", ":")) + "\n")


def _to_json(portrait: Portrait) -> dict[str, Any]:
    def rounded(lines: Sequence[Array]) -> list[Any]:
        return [np.round(line.T, _DIGITS).tolist() for line in lines]

    mapping = portrait.map
    return {
        "k": portrait.k,
        "parameter": portrait.parameter,
        "map": {"c": mapping.c, "a": mapping.a, "b": mapping.b},
        "window": portrait.window,
        "orbits": rounded(portrait.orbits),
        "curves": rounded(portrait.curves),
        "manifolds": rounded(portrait.manifolds),
        "periodic": [
            {"points": orbit.points.tolist(), "line": orbit.line, "trace": orbit.trace} for orbit in portrait.periodic
        ],
    }


def read_portraits(path: Path) -> list[Portrait]:
    """Read a portrait file. Raises `InputError`, one line, for anything that is not well formed."""
    document = read_document(path, "portraits")
    return [_portrait(entry, f"{path}: field portraits[{i}]") for i, entry in enumerate(document["portraits"])]


def _portrait(entry: Mapping[str, Any], source: str) -> Portrait:
    def lines(name: str) -> tuple[Array, ...]:
        try:
            arrays = tuple(np.array(columns, dtype=float).T for columns in entry[name])
        except (TypeError, ValueError):
            raise InputError(f"{source}.{name}: not two rows of numbers of one length; write the file again") from None
        if not all(array.ndim == 2 and np.all(np.isfinite(array)) for array in arrays):
            raise InputError(f"{source}.{name}: not two rows of finite numbers; write the file again")
        return arrays

    numbers = [entry["parameter"], entry["window"], *entry["map"].values()]
    numbers += [orbit["trace"] for orbit in entry["periodic"]]
    if not all(isfinite(number) for number in numbers):
        raise InputError(f"{source}: a number is too large for a double; write the file again")
    periodic = []
    for index, orbit in enumerate(entry["periodic"]):
        points = np.array(orbit["points"], dtype=float)
        if len(points) != entry["k"] or not np.all(np.isfinite(points)):
            raise InputError(f"{source}.periodic[{index}].points: need {entry['k']} points; write the file again")
        periodic.append(PeriodicOrbit(points, orbit["line"], float(orbit["trace"])))
    return Portrait(
        k=entry["k"],
        parameter=float(entry["parameter"]),
        map=ReversibleMap(**entry["map"]),
        window=float(entry["window"]),
        orbits=lines("orbits"),
        curves=lines("curves"),
        manifolds=lines("manifolds"),
        periodic=tuple(periodic),
    )
