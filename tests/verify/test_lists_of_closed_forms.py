"""Complete lists of systems in closed form: no point of any kind is missing, and none is false."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.closed_form_lists import Truth, ellipse, line, minors, misses, results
from support.piece_cases import slow
from support.skew_products import SkewProduct, energy, half_period

from orbitproof.shared.formats.atlas import Atlas
from orbitproof.verify.curve.piece import PieceLimits, prove_piece
from orbitproof.verify.curve.theorem import conclude
from orbitproof.verify.evidence.outcome import Proved
from orbitproof.verify.functions.functions import REACH, function_from_json
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability.matrix import SLOPE_BITS, orbit_functions, stability_to_json
from orbitproof.verify.stability.theorem import with_complete_list

Make = Callable[[int], SkewProduct]

SYSTEMS: dict[str, Make] = {
    "one": lambda seed: line(seed, 1, True),
    "two, symplectic": lambda seed: line(seed, 2, True),
    "two": lambda seed: line(seed, 2, False),
    "three": lambda seed: line(seed, 3, False),
    "three, symplectic": lambda seed: line(seed, 3, True),
    "folds": lambda seed: ellipse(seed, 1, "folds"),
    "folds of two": lambda seed: ellipse(seed, 2, "folds"),
    "loop": lambda seed: ellipse(seed, 1, "loop"),
    "symmetric loop": lambda seed: ellipse(seed, 1, "breaks"),
}
_FAST = [("one", 1), ("two", 2), ("three", 0), ("folds", 1), ("loop", 0), ("symmetric loop", 1), ("symmetric loop", 2)]
_SLOW = [(name, seed) for name in SYSTEMS for seed in range(5) if (name, seed) not in _FAST]
LIMITS = PieceLimits(72, 22, 20)


def claimed(system: SkewProduct, share: int = 1) -> Atlas:
    number = 6 if system.ellipse is None else 18 if system.end - system.begin > 4 else 10
    return system.atlas(number * share)


def check(system: SkewProduct, atlas: Atlas, found: Sequence[dict[str, Any]], order: int, undecided: int = 0) -> None:
    """The list has all that is true, and no more; at most so many places are named as not covered."""
    document = with_complete_list(atlas, found, conclude(atlas, found), order)
    assert document["verdict"] == "proved"
    said = document["complete"]
    assert misses(Truth(system, atlas, order), said) == []
    assert len(said["gaps"]) <= undecided
    assert len(said["points"]) > 3


@pytest.mark.parametrize(("name", "seed"), [*_FAST, *(pytest.param(*case, marks=pytest.mark.slow) for case in _SLOW)])
def test_lists_from_closed_forms_are_complete_and_true(name: str, seed: int) -> None:
    """Stored functions are made from the closed forms; every second system has two intervals on each piece."""
    system = SYSTEMS[name](seed)
    atlas = claimed(system)
    check(system, atlas, results(system, atlas, split=seed % 2 == 1), 7, undecided=4)


def test_what_wide_bounds_leave_open_is_named() -> None:
    """With large errors points are missing, each in a gap, and none is false."""
    system = SYSTEMS["symmetric loop"](1)
    atlas = claimed(system)
    found = results(system, atlas, error=3e-3)
    document = with_complete_list(atlas, found, conclude(atlas, found), 5)["complete"]
    assert document["gaps"]
    assert misses(Truth(system, atlas, 5), document) == []


@pytest.mark.parametrize(
    "make",
    [
        lambda: line(1, 1, True),
        *slow(
            lambda: ellipse(1, 1, "folds"),
            lambda: line(3, 2, False),
            lambda: ellipse(1, 2, "folds"),
            lambda: line(1, 3, False),
        ),
    ],
    ids=["line, n = 1", "fold, n = 1", "line, n = 2", "fold, n = 2", "line, n = 3"],
)
def test_sigma_of_a_skew_product_contains_the_closed_form(make: Callable[[], SkewProduct]) -> None:
    """By integration of a short part of the curve; symplectic or not."""
    system = make()
    atlas = claimed(system, 4)
    piece, n = atlas.curve_pieces()[5], system.size
    interval = (Fraction(-1, 4), Fraction(1, 4))
    limits = PieceLimits(56, 16, 8)
    found = orbit_functions(system.system, {}, piece, interval, limits, "physical", ORACLE).to_json()
    for number in range(-4, 5):
        place = system.places(piece, np.array([float(REACH) * number / 4 / 4]))
        amplitude = system.amplitude(place)[0]
        expected = [float(value[0]) for value in minors(system.sigma(place))]
        expected += [energy(amplitude), half_period(amplitude)]
        stored = [*found["characteristic"], found["level"], found["half_period"]]
        with ctx.workprec(128):
            for entry, value in zip(stored, expected, strict=True):
                enclosure = function_from_json(entry).value(arb(number) / 4)
                assert (enclosure + arb(0, 1e-8 * max(1.0, abs(value)))).contains(arb(value))
                assert float(enclosure.rad()) < 1e-3 * max(1.0, abs(value))
    assert len(found["characteristic"]) == n


@pytest.mark.parametrize("name", slow("one", "two", "folds", "symmetric loop"))
def test_lists_of_integrated_pieces_are_complete_and_true(name: str) -> None:
    system = SYSTEMS[name](0)
    atlas = claimed(system, 2 if name == "folds" else 1)
    found = []
    for piece in atlas.curve_pieces():
        interval = (Fraction(0 if piece.kind == "symmetric" else -1), Fraction(1))
        symmetry = atlas.claim.symmetry
        proof = prove_piece(system.system, {}, piece, interval, ORACLE, LIMITS, None, symmetry, slope_bits=SLOPE_BITS)
        assert isinstance(proof.outcome, Proved)
        known = proof.outcome.results
        stability = stability_to_json(
            system.system,
            {},
            piece,
            (known.start, known.end),
            LIMITS,
            "physical",
            ORACLE,
            symmetry,
            None,
            known.half_return,
        )
        found.append(proof.to_json() | {"stability": stability})
    check(system, atlas, found, 8)
