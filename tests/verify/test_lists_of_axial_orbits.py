"""Axial orbits in units of their speed across the plane: their index, by another way too, and false ones."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from support.forgeries import forged
from support.graph_index import index_of_orbit
from support.stored import values

from orbitproof.shared.claims import Atlas
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.atlas import (
    AtlasCertificate,
    IndexCertificate,
    certified_index,
    check_of_conclusion,
    checked_index,
    conclusion_of,
    make_atlas_certificate,
)

DATA = Path(__file__).parents[1] / "data"
"""The family of L1, Earth-Moon, from its birth on the planar orbits to that on the vertical ones."""


@cache
def family() -> Atlas:
    atlas = read_atlas(DATA / "atlas-axial-family.json")
    assert isinstance(atlas, Atlas)
    return atlas


@cache
def without_list() -> AtlasCertificate:
    results = values(json.loads((DATA / "results-axial-family.json").read_text()))
    conclusion = conclusion_of(family(), results, (), lambda _: (), None)
    return AtlasCertificate(family(), make_atlas_certificate(family(), results, conclusion))


def place(piece: str, s: float) -> Any:
    """(eps2, x, vy) by the polynomials of a piece."""
    (found,) = [each for each in family().curve_pieces() if each.id == piece]
    local = [float(found.half_width) * s, *(np.polyval([float(c) for c in row][::-1], s) for row in found.polynomial)]
    return np.array(found.centre, float) + np.array(found.frame, float) @ local


def test_without_a_list_the_index_of_one_orbit_is_that_of_the_graph_of_the_flow() -> None:
    document = certified_index(without_list())
    assert document["verdict"] == "proved"
    (orbit,) = IndexCertificate(document).orbits
    eps2, x, vy = place(orbit.piece, float(orbit.s))
    state = (x, 0.0, 0.0, 0.0, vy, eps2**0.5)
    assert index_of_orbit(state, float(family().parameters["mu"]), 1) == (orbit.index,)
    theorem = document["statement"]["theorem"]
    assert "the points with eps2 > 0 stand for, over the period 2 T" in theorem
    assert "Single orbits; of others nothing is said:" in theorem

    def check(entry: dict[str, Any]) -> bool:
        return checked_index(entry, without_list(), check_of_conclusion(without_list().document)).stands

    def moved(entry: dict[str, Any]) -> None:
        # Where eps2 < 0 there is no orbit.
        entry["orbits"][0]["s"] = "-0x1"

    assert check(document)
    assert not check(forged(document, moved))
    assert not check(forged(document, lambda entry: entry["orbits"][0].update(index=5)))
