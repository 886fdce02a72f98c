"""A proved arc of halo orbits with the functions of its list, and rows of a published catalogue on it and beside it."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from support.stored import values

from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import atlas_from_json
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.certificate import Certificate

DATA = Path(__file__).parents[1] / "data"
STORED: dict[str, Any] = json.loads((DATA / "catalogue-arc.json").read_text())
ROWS = (1427, 1477, 1523, 1524, 245)
"""Numbers in the published catalogue; the third one is a mirror image, the last one is elsewhere in the family."""
ON_THE_ARC = 4


def certificate_of(atlas: Atlas, results: list[dict[str, Any]], order: int | None = 1) -> Certificate:
    """The certificate of a curve, with its list."""
    found = values(results)
    conclusion = conclusion_of(atlas, found, [], lambda _: [], order or 1)
    assert conclusion["verdict"] == "proved"
    return Certificate(make_atlas_certificate(atlas, found, conclusion))


@cache
def curve() -> Certificate:
    """That of the arc, from the plane on: L2, southern halo orbits at the far side of the Moon."""
    return certificate_of(atlas_from_json(STORED["atlas"], "the arc"), STORED["results"])
