"""The Falkner-Skan family with the stability of its orbits: what is proved of a short arc, and its complete list."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from support.conclusions import with_complete_list
from support.stored import values

from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.curve import conclude

DATA = Path(__file__).parents[1] / "data"
Results = list[dict[str, Any]]


@cache
def atlas() -> Atlas:
    """The Falkner-Skan family for beta from 260 to 690."""
    return read_atlas(DATA / "atlas-falkner-skan.json")


def results() -> Results:
    """What is proved of its two pieces, with the stability of the orbits."""
    found: Results = json.loads((DATA / "stability-falkner-skan.json").read_text())
    return found


def listed(found: Results, order: int = 12) -> dict[str, Any]:
    """The conclusion with the complete list."""
    return with_complete_list(atlas(), found, conclude(atlas(), values(found)), order)
