"""Webs as JSON, read (docs/formats.md)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from orbitproof.shared.claims.web import LIBRATION_POINTS, Web
from orbitproof.shared.codec import from_json
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.documents import read_document


def read_web(path: Path) -> Web:
    """Read a web. Raises `InputError` for anything that is not a well-formed claim."""
    document = read_document(path, "web")
    return web_from_json({key: value for key, value in document.items() if key not in ("format", "version")}, str(path))


def web_from_json(entry: Mapping[str, Any], source: str) -> Web:
    """A web from a schema-valid JSON object; `source` begins the text of errors. Raises `InputError`."""
    web = from_json(Web, entry, source)
    if not web.arcs:
        raise InputError(f"{source}: field arcs: is empty; name at least one arc")
    for name in repeated_names(arc.id for arc in web.arcs):
        raise InputError(f"{source}: field arcs: {name!r} appears twice; give each arc once")
    for index, arc in enumerate(web.arcs):
        for name in repeated_names(meeting.vertex for meeting in arc.meets):
            raise InputError(f"{source}: field arcs[{index}].meets: {name!r} appears twice; say once how they meet")
        if arc.id in web.vertices:
            raise InputError(f"{source}: field arcs[{index}].id: {arc.id!r} is a vertex too; give it another id")
        if arc.id in LIBRATION_POINTS:
            raise InputError(f"{source}: field arcs[{index}].id: {arc.id!r} is a libration point; give it another id")
    return web


def repeated_names(names: Iterable[str]) -> list[str]:
    """Those that appear more than once."""
    return [name for name, count in Counter(names).items() if count > 1]
