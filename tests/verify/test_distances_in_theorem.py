"""The theorem about a curve says how far its stable orbits are from a body, and forged distances are found."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from support import stability_cases
from support.conclusions import with_complete_list
from support.forgeries import checked, honest
from support.stored import values

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.codec import to_json
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.curve import PieceLimits, conclude
from orbitproof.verify.distances import Where
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, orbit_functions

Results = list[dict[str, Any]]


def with_a_wall() -> Atlas:
    """The Falkner-Skan family, of which it is said that y is the distance from something."""
    system = stability_cases.atlas().system
    walled = replace(
        system, name="walled-flow", squared_distance=lambda state, _: (state[1] * state[1],), distance_name="the wall"
    )
    return replace(stability_cases.atlas(), system=walled)


@pytest.fixture(scope="module")
def results() -> Results:
    """Those of the family, with the distances."""
    atlas, found = with_a_wall(), stability_cases.results()
    for piece, entry in zip(atlas.curve_pieces(), found, strict=True):
        start, end = (parse_exact(text) for text in entry["interval"])
        functions = orbit_functions(
            TubeOfOrbits(atlas.system, {}, piece, (start, end), PieceLimits(64, 28, 28), "physical", ORACLE)
        )
        entry["stability"] = to_json(functions.stored)
    return found


def document_of(found: Results, atlas: Atlas) -> dict[str, Any]:
    return make_atlas_certificate(
        atlas, values(found), with_complete_list(atlas, found, conclude(atlas, values(found)), 2)
    )


def test_the_theorem_encloses_distances_at_and_between_the_ends(results: Results) -> None:
    """y is greatest in size at one of the points of Fix(R) of these orbits, as z = 0 there."""
    document = document_of(results, with_a_wall())
    assert document["statement"]["names"]["distance_from"] == "the wall"
    assert document["statement"]["squared_distance"]
    (stable,) = document["conclusion"]["complete"]["stable"]
    for entry in (stable["from"], stable["between"]):
        assert set(entry) > {"half_period", "least_distance", "greatest_distance", "least_distance_at"}
    assert "in between half period in [" in document["statement"]["theorem"]
    assert "greatest distance from the wall in [" in document["statement"]["theorem"]
    assert checked(document).stands


def test_of_a_system_without_a_body_nothing_is_said_of_distances(results: Results) -> None:
    """Even if they are stored."""
    atlas = stability_cases.atlas()
    document = with_complete_list(atlas, results, conclude(atlas, values(results)), 2)
    (stable,) = document["complete"]["stable"]
    assert "half_period" in stable["between"]
    assert "least_distance" not in stable["between"]
    assert "distance" not in document["statement"]


def farther(distance: dict[str, Any]) -> None:
    for name in ("least", "greatest"):
        bounds = [parse_exact(bound) * Fraction(3, 2) for bound in distance["parts"][4][name]]
        distance["parts"][4][name] = [format_exact(bound) for bound in bounds]
    distance["parts"][4] |= {"least_at": Where.ALONG.value, "greatest_at": Where.ALONG.value}


def at_this_point(distance: dict[str, Any]) -> None:
    for part in distance["parts"]:
        part["least_at"] = Where.HERE.value


@pytest.mark.parametrize("change", [None, farther, at_this_point])
def test_forged_distances_are_found_by_another_integration(
    results: Results, change: Callable[[dict[str, Any]], None] | None
) -> None:
    """Also with a theorem that fits them."""
    fresh = copy.deepcopy(results)
    for entry in fresh:
        distance = entry["stability"]["distance"]
        functions = [entry["stability"][name] for name in ("level", "half_period", "first_factor")]
        for function in (*functions, *entry["stability"]["characteristic"], distance["here"], distance["there"]):
            function["error"] = format_exact(parse_exact(function["error"]) / 4)
        for part in distance["parts"]:
            for name in ("least", "greatest"):
                low, high = (parse_exact(bound) for bound in part[name])
                part[name] = [format_exact(low + (high - low) / 2**8), format_exact(high - (high - low) / 2**8)]
    stored = copy.deepcopy(results)
    if change is not None:
        change(stored[0]["stability"]["distance"])
    found = checked(document_of(stored, with_a_wall()), honest(fresh))
    assert found.stands == (change is None)
    assert change is None or any("distance" in finding.message for finding in found.findings)
