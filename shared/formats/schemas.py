"""The JSON schema of a file from the type that describes it; ``python docs/schemas.py`` writes them."""

from __future__ import annotations

import json
from collections.abc import Collection

from orbitproof.shared.codec import Schema, schema_of


def document_schema(name: str, words: str, kind: type, optional: Collection[str] = ()) -> Schema:
    """The schema of the files that hold the fields of a dataclass, beside their format and version.

    `words` say what they are; `optional` are fields that may be left out although they have no default.
    """
    reference, definitions = schema_of(kind)
    whole = definitions.pop(reference["$ref"].rpartition("/")[2])
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"orbitproof-{name}-1",
        "title": f"orbitproof {name}, version 1",
        "description": words,
        **whole,
        "required": ["format", "version", *(key for key in whole["required"] if key not in optional)],
        "properties": {"format": {"const": f"orbitproof-{name}"}, "version": {"const": 1}, **whole["properties"]},
        "$defs": definitions,
    }


def schema_text(schema: Schema) -> str:
    """A schema as its file has it."""
    return json.dumps(schema, indent=2) + "\n"
