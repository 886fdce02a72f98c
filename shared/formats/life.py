"""Claims of lives as JSON, read (docs/formats.md)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from orbitproof.shared.claims.life import Life
from orbitproof.shared.codec import from_json
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.documents import read_document
from orbitproof.shared.formats.web import repeated_names


def read_life_claim(path: Path) -> Life:
    """Read the claim of a life. Raises `InputError` for anything that is not a well-formed one."""
    document = read_document(path, "life-claim")
    entry = {key: value for key, value in document.items() if key not in ("format", "version")}
    return life_from_json(entry, str(path))


def life_from_json(entry: Mapping[str, Any], source: str) -> Life:
    """A life from a schema-valid JSON object; `source` begins the text of errors. Raises `InputError`."""
    life = from_json(Life, entry, source)
    if not life.arcs:
        raise InputError(f"{source}: field arcs: is empty; name at least one arc")
    for name in repeated_names(life.certificates):
        raise InputError(f"{source}: field arcs: {name!r} appears twice; give each arc once")
    for index, arc in enumerate(life.arcs):
        where = f"{source}: field arcs[{index}].joints"
        for how in repeated_names(joint.how for joint in arc.joints):
            raise InputError(f"{where}: {how!r} appears twice; an arc begins once, and ends once")
        for name in (joint.arc for joint in arc.joints):
            if name not in life.certificates or name == arc.id:
                raise InputError(f"{where}: {name!r} is none of the other arcs; name one of them")
    return life
