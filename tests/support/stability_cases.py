"""The Falkner-Skan family with the stability of its orbits: what is proved of a short arc, and its complete list."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from support.conclusions import with_complete_list
from support.stored import values

from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Atlas, Piece
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import piece_from_json, read_atlas
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.curve import PieceLimits, conclude
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, orbit_functions

DATA = Path(__file__).parents[1] / "data"
PIECES: dict[str, Any] = json.loads((DATA / "branch-pieces.json").read_text())
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


def halo_piece(name: str) -> tuple[Piece, dict[str, Fraction]]:
    """A piece of halo orbits, and the parameters."""
    entry = PIECES[name]
    piece = piece_from_json(entry["piece"], CR3BP, "piece")
    assert isinstance(piece, Piece)
    return piece, {key: parse_exact(value) for key, value in entry["parameters"].items()}


@cache
def halo_functions(name: str, interval: tuple[Fraction, Fraction], limits: PieceLimits) -> dict[str, Any]:
    """What is stored of the halo orbits over an interval of a piece; callers change copies of it."""
    piece, parameters = halo_piece(name)
    coordinates = "regularised" if name == "regularised" else "physical"
    tube = TubeOfOrbits(CR3BP, parameters, piece, interval, limits, coordinates, ORACLE, "S")
    return to_json(orbit_functions(tube).stored)


HALO_INTERVALS = {"symmetric": (Fraction(-1, 8), Fraction(1, 8)), "regularised": (Fraction(5, 16), Fraction(3, 8))}
"""With 0 of a symmetric piece inside; near the Moon."""
HALO_LIMITS = {"symmetric": PieceLimits(64, 20, 10), "regularised": PieceLimits(72, 28, 14)}
