"""The JSON schemas of claims, made from their types; ``python -m orbitproof.shared.formats.schemas`` writes them."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

from orbitproof.shared.claims import Atlas, BoxClaim
from orbitproof.shared.codec import Definitions, schema_of
from orbitproof.shared.systems import SYSTEM

_CANDIDATES = (
    "Boxes that are claimed to contain a bifurcation of symmetric periodic orbits, or one orbit. Coordinates: the "
    "family parameter of the system, if it has one, then the state coordinates fixed by R, in the system's order; of a "
    "periodic orbit without symmetry the state coordinates."
)
_ATLAS = (
    "A curve of symmetric periodic orbits, or a surface of them over the mass parameter, as pieces in order along it. "
    "Coordinates of a point: the family parameter of the system, if it has one, then the state coordinates fixed by R, "
    "in the system's order."
)


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas by the names of their formats."""
    candidate, definitions = schema_of(BoxClaim)
    many = {"type": "array", "minItems": 1, "maxItems": 100000, "items": candidate}
    candidates = _document("candidates", _CANDIDATES, {"candidates": many}, ["candidates"], definitions)
    _, definitions = schema_of(Atlas)
    whole = definitions.pop("atlas")
    # Those of a surface stand in its pieces.
    required = [key for key in whole["required"] if key != "parameters"]
    return {
        "candidates": candidates,
        "atlas": _document("atlas", _ATLAS, whole["properties"], required, definitions),
    }


def _document(
    name: str, words: str, properties: dict[str, Any], required: list[str], definitions: Definitions
) -> dict[str, Any]:
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"orbitproof-{name}-1",
        "title": f"orbitproof {name}, version 1",
        "description": words,
        "type": "object",
        "additionalProperties": False,
        "required": ["format", "version", *required],
        "properties": {"format": {"const": f"orbitproof-{name}"}, "version": {"const": 1}, **properties},
        "$defs": {"system": {"type": "string", "pattern": SYSTEM}, **definitions},
    }


def schema_text(schema: dict[str, Any]) -> str:
    """A schema as its file has it."""
    return json.dumps(schema, indent=2) + "\n"


if __name__ == "__main__":
    for name, schema in schemas().items():
        folder = Path(str(resources.files("orbitproof.shared").joinpath("schemas")))
        folder.joinpath(f"{name}.schema.json").write_text(schema_text(schema), "utf-8")
