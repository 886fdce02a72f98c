"""Complete lists of orbits of the three-body problem against an integrator that shares nothing with verify/.

Orbits near the Moon, in regularised coordinates; planar orbits, with variations out of the plane.
"""

from __future__ import annotations

import copy
import json
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.conclusions import with_complete_list
from support.list_truths import Truth, misses
from support.piece_cases import slow
from support.stored import ENTRIES, entry_of, function_of, stored_distances, unconfirmed_of, values
from support.three_body import Numbers, Orbits, numbers
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Atlas, Piece
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import atlas_from_json, read_atlas
from orbitproof.verify.branches import conclusion_of
from orbitproof.verify.curve import PieceLimits, conclude, prove_piece
from orbitproof.verify.distances import Where
from orbitproof.verify.evidence import Proved
from orbitproof.verify.functions import REACH
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import TubeOfOrbits, stability_of_piece, stability_slope_bits

DATA = Path(__file__).parents[1] / "data"
ARCS: dict[str, Any] = json.loads((DATA / "three-body-arcs.json").read_text())
LOOP, NEAR, CLOSE = "fold-and-doublings", "near-the-moon", "close-to-the-moon"
PLANAR, AXIAL, RETROGRADE = "lyapunov", "births-of-axial-orbits", "distant-retrograde"
IN_UNITS = (PLANAR, AXIAL)
FLAT = (*IN_UNITS, RETROGRADE)
ORDERS = {AXIAL: 40}
"""Of lists; else 12."""
_RANDOM = 160
"""Parameters on a piece at which all functions are compared."""

Results = list[dict[str, Any]]

_precision = within(lambda: ctx.workprec(192))


@cache
def case(name: str) -> tuple[Atlas, Results]:
    """An arc, and what is proved of its pieces."""
    if name == PLANAR:
        return read_atlas(DATA / "atlas-lyapunov.json"), json.loads((DATA / "stability-lyapunov.json").read_text())
    return atlas_from_json(ARCS[name]["atlas"], name), ARCS[name]["results"]


@cache
def listed(name: str) -> dict[str, Any]:
    """The conclusion."""
    atlas, results = case(name)
    document = with_complete_list(atlas, results, conclude(atlas, values(results)), ORDERS.get(name, 12))
    assert document["verdict"] == "proved"
    return document


@cache
def truth(name: str) -> tuple[Numbers, Truth]:
    """The same by the other integrator."""
    found = numbers(case(name)[0], listed(name)["stretches"])
    return found, Truth(found.curve(), ORDERS.get(name, 12))


def contains(known: dict[str, Any], taus: Any, values: Any) -> bool:
    """Whether a stored function encloses values that are known to 9 digits of their greatest size, and closely."""
    function, size = function_of(known), float(np.abs(values).max())
    enclosures = [function.value(arb(tau)) for tau in taus]
    return all(float(enclosure.rad()) < 1e-2 * size for enclosure in enclosures) and all(
        (enclosure + arb(0, 1e-9 * size)).contains(arb(value))
        for enclosure, value in zip(enclosures, values, strict=True)
    )


@cache
def random_orbits(name: str, piece: Piece, interval: tuple[float, float], number: int) -> tuple[Any, Orbits]:
    """Random s of a piece, and the orbits there."""
    s = np.sort(np.random.default_rng(11).uniform(*interval, number))
    return s, truth(name)[0].problem.on_curve(piece, s)


def check_functions(name: str, result: dict[str, Any], number: int = _RANDOM) -> None:
    """All functions of a result, and its bounds of distances, at random parameters."""
    atlas, _ = case(name)
    found, _ = truth(name)
    (piece,) = [piece for piece in atlas.curve_pieces() if piece.id == result["piece"]]
    low, high = (float(parse_exact(end)) for end in result["interval"])
    s, orbits = random_orbits(name, piece, (low, high), number)
    taus = (2 * s - low - high) / (high - low) / float(REACH)
    n = len(piece.tube)
    _, minors, factor, level, half_period, _, across = np.split(
        found.functions(orbits), np.cumsum([n + 1, n, 1, 1, 1, 1])
    )
    known = result["stability"]
    stored = [*known["characteristic"], known["level"], known["half_period"]]
    values = [*minors, *level, *half_period]
    if name in FLAT:
        stored += [known["out_of_plane"][entry] for entry in ENTRIES]
        values += list(across)
    if name not in IN_UNITS:
        # det (dy/dsigma, A b_1, A b_2) = det A det (dx/dsigma, b_1, b_2), and ds/dsigma = 17/16 (high - low)/2.
        frame = np.linalg.det(np.array(piece.frame, dtype=float))
        stored.append(known["first_factor"])
        values.append(factor[0] * frame * float(piece.half_width) * (high - low) / 2 * 17 / 16)
        check_distances(known["distance"], taus, orbits.distances)
    for function, row in zip(stored, values, strict=True):
        assert contains(function, taus, row)


def check_distances(known: dict[str, Any], taus: Any, values: Any) -> None:
    """Bounds of the least and the greatest, and at which point of Fix(R) they are."""
    stored = stored_distances(known)
    assert stored is not None
    ends = {Where.HERE: values[2], Where.THERE: values[3]}
    for function, row in ((stored.here, values[2]), (stored.there, values[3])):
        for tau, value in zip(taus, row, strict=True):
            assert abs(float(function.value(arb(tau)).mid()) / value**2 - 1) < 1e-9
            assert float(function.value(arb(tau)).rad()) < 1e-6 * value**2
    for part in stored.parts:
        here = (taus >= float(part.lower)) & (taus <= float(part.upper))
        for extreme, row in zip((part.least, part.greatest), values, strict=False):
            low, high = (float(end) ** 0.5 for end in (extreme.square.lower(), extreme.square.upper()))
            assert np.all((low <= row[here]) & (row[here] <= high))
            assert high - low < 1.5 * np.ptp(row) + 0.01 * row.max()
            if extreme.where is not Where.ALONG:
                assert np.abs(row[here] / ends[extreme.where][here] - 1).max(initial=0) < 1e-9
            else:
                # Not named only where it changes, or is in between.
                assert all(np.abs(row[here] / end[here] - 1).max(initial=0) > 1e-9 for end in ends.values())


NAMES = [NEAR, PLANAR, AXIAL, RETROGRADE, *slow(LOOP, CLOSE)]
FEATURES = {
    LOOP: {"resonance": 28, "singular at this point": 1, "singular at the other point": 2, "fold": 1},
    NEAR: {"resonance": 22, "loss of R": 1, "singular at the other point": 1, "Krein collision": 1},
    CLOSE: {"resonance": 3},
    RETROGRADE: {"resonance": 3},
}
ACROSS = {
    PLANAR: {"birth out of the plane": 1},
    AXIAL: {"resonance": 29, "axial birth out of the plane": 1},
    RETROGRADE: {"birth out of the plane": 1},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_list_of_an_arc_is_complete_and_true(name: str) -> None:
    """Each zero and extremum on a fine grid is in one listed interval, each interval has one, of its kind."""
    found, expected = truth(name)
    said = listed(name)["complete"]
    assert found.gap < 1e-9
    assert misses(expected, said) == []
    assert said["gaps"] == []
    assert Counter(point.kind for point in expected.points) == FEATURES.get(name, {})
    if name in FLAT:
        assert Counter(point.kind for point in expected.across.points) == ACROSS[name]


def test_a_conclusion_is_the_same_at_whatever_precision_it_is_asked_for() -> None:
    """Whoever calls may compute with other numbers of bits: roots of distances are taken at one of its own."""
    atlas, results = case(RETROGRADE)
    found = []
    for bits in (24, 53, 300):
        with ctx.workprec(bits):
            found.append(conclusion_of(atlas, values(results), (), lambda _: (), 2))
            assert ctx.prec == bits
    assert found[0] == found[1] == found[2]
    assert "least_distance" in json.dumps(found[0])


@pytest.mark.parametrize("name", NAMES)
def test_functions_and_distances_contain_those_of_orbits_at_random_parameters(name: str) -> None:
    for result in case(name)[1]:
        check_functions(name, result)


def shifted(entry: dict[str, Any]) -> None:
    """A function, by more than its bound."""
    by = max(parse_exact(entry["error"]) * 4, abs(parse_exact(entry["coefficients"][0])) / 2**20)
    entry["coefficients"][0] = format_exact(parse_exact(entry["coefficients"][0]) + by)


def narrowed(distance: dict[str, Any]) -> None:
    for part in distance["parts"]:
        part["greatest"] = [part["greatest"][0]] * 2


def at_the_other_point(distance: dict[str, Any]) -> None:
    for part in distance["parts"]:
        part["least_at"], part["greatest_at"] = part["greatest_at"], part["least_at"]


def along_the_orbit(distance: dict[str, Any]) -> None:
    distance["parts"][7]["greatest_at"] = "along the orbit"


FORGERIES: dict[str, tuple[str, Callable[[dict[str, Any]], None]]] = {
    "a_1": (NEAR, lambda known: shifted(known["characteristic"][0])),
    "a_2": (NEAR, lambda known: shifted(known["characteristic"][1])),
    "level": (NEAR, lambda known: shifted(known["level"])),
    "half period": (NEAR, lambda known: shifted(known["half_period"])),
    "first factor": (NEAR, lambda known: shifted(known["first_factor"])),
    "distance here": (NEAR, lambda known: shifted(known["distance"]["here"])),
    "distance there": (NEAR, lambda known: shifted(known["distance"]["there"])),
    "bounds": (NEAR, lambda known: narrowed(known["distance"])),
    "points of Fix(R)": (NEAR, lambda known: at_the_other_point(known["distance"])),
    "no point of Fix(R)": (NEAR, lambda known: along_the_orbit(known["distance"])),
    **{f"V_{entry}": (PLANAR, lambda known, e=entry: shifted(known["out_of_plane"][e])) for entry in ENTRIES},
}


@pytest.mark.parametrize("what", FORGERIES)
def test_other_functions_and_distances_are_noticed(what: str) -> None:
    name, change = FORGERIES[what]
    result = copy.deepcopy(case(name)[1][0])
    change(result["stability"])
    check_functions(name, case(name)[1][0])
    with pytest.raises(AssertionError):
        check_functions(name, result)


def left_out(entries: list[Any], number: int) -> None:
    del entries[number]


def moved(entries: list[Any], number: int) -> None:
    place = entries[number]["s"]
    place["mid"] = format_exact(parse_exact(place["mid"]) + Fraction(1, 2**8))


@pytest.mark.parametrize("name", [NEAR, pytest.param(AXIAL, marks=pytest.mark.slow)])
def test_other_lists_are_noticed(name: str) -> None:
    """Each point left out, or moved, and stable orbits left out."""
    said = listed(name)["complete"]
    # Distances of orbits take time.
    expected = replace(truth(name)[1], curve=replace(truth(name)[1].curve, distances=None))
    assert misses(expected, said) == []

    def changed(key: str, number: int, change: Callable[[list[Any], int], None]) -> bool:
        other = copy.deepcopy(said)
        change((other["out_of_plane"] if name in FLAT else other)[key], number)
        return bool(misses(expected, other))

    part = said["out_of_plane"] if name in FLAT else said
    assert all(
        changed("points", number, change) for number in range(len(part["points"])) for change in (left_out, moved)
    )
    assert all(changed("stable", number, left_out) for number in range(len(part["stable"])))
    assert part["points"]
    assert part["stable"]


@pytest.mark.parametrize("name", slow(NEAR))
def test_a_new_proof_of_a_piece_contains_the_numbers_too(name: str) -> None:
    """And confirms what is stored of it."""
    atlas, (stored,) = case(name)
    (piece,) = atlas.curve_pieces()
    limits = PieceLimits(*(stored["computation"][key] for key in ("precision", "order", "width")))
    proof = prove_piece(
        atlas.system,
        atlas.parameters,
        piece,
        (Fraction(-1), Fraction(1)),
        ORACLE,
        limits,
        slope_bits=stability_slope_bits(limits.precision),
    )
    assert isinstance(proof.outcome, Proved)
    known = proof.outcome.results
    interval = known.start, known.end
    stability = to_json(
        stability_of_piece(
            TubeOfOrbits(atlas.system, atlas.parameters, piece, interval, limits, "regularised", ORACLE),
            half=known.half_return,
        )
    )
    result = entry_of(proof) | {"stability": stability}
    check_functions(name, result)
    said = with_complete_list(atlas, [result], conclude(atlas, values([result])), 12)["complete"]
    assert misses(truth(name)[1], said) == []
    assert list(unconfirmed_of(stored["stability"], stability)) == []
