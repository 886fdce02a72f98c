"""Complete lists of systems in closed form: no point of any kind is missing, and none is false."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.closed_form_lists import curve_of, ellipse, in_plane, line, minors, results
from support.conclusions import with_complete_list
from support.list_truths import Truth, misses
from support.piece_cases import slow
from support.skew_products import SkewProduct, energy, half_period
from support.stored import entry_of, function_of, values

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.codec import to_json
from orbitproof.verify.curve import PieceLimits, conclude, prove_piece
from orbitproof.verify.evidence import Proved
from orbitproof.verify.functions import REACH
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import (
    Gap,
    Matter,
    Resonance,
    TubeOfOrbits,
    orbit_functions,
    stability_of_piece,
    stability_slope_bits,
)
from orbitproof.verify.stability.across_list import list_across
from orbitproof.verify.stability.complete_list import PRECISION, complete_list

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
    "symmetric loop of two": lambda seed: ellipse(seed, 2, "breaks"),
    "symmetric loop of three": lambda seed: ellipse(seed, 3, "breaks"),
    "in a plane": lambda seed: in_plane(seed, line(seed, 1, True)),
    "two, in a plane": lambda seed: in_plane(seed, line(seed, 2, False)),
    "loop in a plane": lambda seed: in_plane(seed, ellipse(seed, 1, "loop")),
    "symmetric loop in a plane": lambda seed: in_plane(seed, ellipse(seed, 1, "breaks")),
}
_FAST = [
    *(("one", 1), ("two", 2), ("three", 0), ("folds", 1), ("loop", 0), ("symmetric loop", 1), ("symmetric loop", 2)),
    *(("symmetric loop of two", 4), ("in a plane", 3), ("loop in a plane", 1)),
]
_SLOW = [(name, seed) for name in SYSTEMS for seed in range(5) if (name, seed) not in _FAST]
LIMITS = PieceLimits(72, 22, 20)


def claimed(system: SkewProduct, share: int = 1) -> Atlas:
    number = 6 if system.ellipse is None else 18 if system.end - system.begin > 4 else 10
    return system.atlas(number * share)


def check(system: SkewProduct, atlas: Atlas, found: Sequence[dict[str, Any]], order: int, undecided: int = 0) -> None:
    """The list has all that is true, and no more; at most so many places are named as not covered."""
    document = with_complete_list(atlas, found, conclude(atlas, values(found)), order)
    assert document["verdict"] == "proved"
    said = document["complete"]
    assert misses(Truth(curve_of(system, atlas), order), said) == []
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
    document = with_complete_list(atlas, found, conclude(atlas, values(found)), 5)["complete"]
    assert document["gaps"]
    assert misses(Truth(curve_of(system, atlas), 5), document) == []


@pytest.mark.parametrize("power", [1, 2])
def test_out_of_a_plane_nothing_is_said_without_the_symmetry_of_the_curve(power: int) -> None:
    """Functions that are known on one side of a symmetric point would not be those on the other side."""
    system = in_plane(0, ellipse(0, 1, "breaks"))
    atlas = claimed(system)
    stiffness = atlas.system.stiffness_across
    assert stiffness is not None
    other = replace(atlas.system, stiffness_across=lambda state, _: (stiffness(state, _)[0] + state[2] ** power,))
    found = results(system, atlas, split=True)
    complete = with_complete_list(replace(atlas, system=other), found, conclude(atlas, values(found)), 2)["complete"]
    assert ("out_of_plane" in complete) == (power == 2)


def test_out_of_a_plane_only_that_is_open_which_is_open_for_all_functions() -> None:
    system = SYSTEMS["in a plane"](3)
    atlas = claimed(system)
    found = values(results(system, atlas))
    outcome = conclude(atlas, found).outcome
    assert isinstance(outcome, Proved)
    chain = outcome.results.chain
    with ctx.workprec(PRECISION):
        plane = complete_list(atlas, chain, found, 4)
        subjects = (Matter.EVERYTHING, Matter.COLLISION, Resonance(1, 0), Resonance(2, 1), Matter.EVERYTHING)
        gaps = tuple(Gap(0, "p", Fraction(n), Fraction(n), subject, "") for n, subject in enumerate(subjects))
        alone, beside = (list_across(atlas, chain, replace(plane, gaps=own), ()) for own in ((), gaps))
    assert alone is not None
    assert beside is not None
    assert set(beside.found.gaps) - set(alone.found.gaps) == {gaps[0], gaps[-1]}
    assert repr(beside.found.points) == repr(alone.found.points)


Change = Callable[[dict[str, Any]], None]


def moved(entry: dict[str, Any], name: str, by: Fraction = Fraction(1, 2**10)) -> None:
    entry[name]["mid"] = format_exact(parse_exact(entry[name]["mid"]) + by)


def other_kind(point: dict[str, Any]) -> None:
    point["kind"] = {"resonance": "fold", "singular at this point": "singular at the other point"}.get(
        point["kind"], "resonance"
    )


def later(entry: dict[str, Any]) -> None:
    entry["from"]["interval"] = [format_exact(parse_exact(end) + Fraction(1, 8)) for end in entry["from"]["interval"]]


CHANGES: dict[str, Sequence[Change]] = {
    "points": [
        other_kind,
        lambda point: moved(point, "s"),
        lambda point: moved(point, "level"),
        lambda point: moved(point, "half_period"),
        lambda point: moved(point["point"], "x"),
        lambda point: point.update(k=point["k"] + 1),
    ],
    "extrema": [lambda entry: moved(entry, "s"), lambda entry: moved(entry, "value")],
    "stable": [later, lambda entry: moved(entry["between"], "half_period", Fraction(1, 2))],
}


def test_any_change_of_a_list_is_noticed() -> None:
    """Every entry is left out, and changed in one way or another: what is asked of lists here is not true of others."""
    system = in_plane(4, ellipse(4, 2, "breaks"))
    atlas = claimed(system)
    found = results(system, atlas)
    said, truth = (
        with_complete_list(atlas, found, conclude(atlas, values(found)), 5)["complete"],
        Truth(curve_of(system, atlas), 5),
    )
    assert misses(truth, said) == []
    for path in ((), ("out_of_plane",)):
        for name, changes in CHANGES.items():
            part = said[path[0]] if path else said
            assert part.get(name) or (path and name == "extrema")
            for number in range(len(part.get(name, ()))):
                for change in (None, changes[number % len(changes)]):
                    other = copy.deepcopy(said)
                    entries = (other[path[0]] if path else other)[name]
                    if change is None:
                        del entries[number]
                    else:
                        change(entries[number])
                    assert misses(truth, other), (path, name, number, change)


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
    found = to_json(
        orbit_functions(TubeOfOrbits(system.system, {}, piece, interval, limits, "physical", ORACLE)).stored
    )
    for number in range(-4, 5):
        place = system.places(piece, np.array([float(REACH) * number / 4 / 4]))
        amplitude = system.amplitude(place)[0]
        expected = [float(value[0]) for value in minors(system.sigma(place))]
        expected += [energy(amplitude), half_period(amplitude)]
        stored = [*found["characteristic"], found["level"], found["half_period"]]
        with ctx.workprec(128):
            for entry, value in zip(stored, expected, strict=True):
                enclosure = function_of(entry).value(arb(number) / 4)
                assert (enclosure + arb(0, 1e-8 * max(1.0, abs(value)))).contains(arb(value))
                assert float(enclosure.rad()) < 1e-3 * max(1.0, abs(value))
    assert len(found["characteristic"]) == n


@pytest.mark.parametrize("name", slow("one", "two", "folds", "symmetric loop", "symmetric loop of two", "in a plane"))
def test_lists_of_integrated_pieces_are_complete_and_true(name: str) -> None:
    system = SYSTEMS[name](0)
    atlas = claimed(system, 2 if name == "folds" else 1)
    found = []
    for piece in atlas.curve_pieces():
        interval = (Fraction(0 if piece.kind == "symmetric" else -1), Fraction(1))
        symmetry = atlas.claim.symmetry
        proof = prove_piece(
            system.system,
            {},
            piece,
            interval,
            ORACLE,
            LIMITS,
            None,
            symmetry,
            slope_bits=stability_slope_bits(LIMITS.precision),
        )
        assert isinstance(proof.outcome, Proved)
        known = proof.outcome.results
        stability = to_json(
            stability_of_piece(
                TubeOfOrbits(system.system, {}, piece, (known.start, known.end), LIMITS, "physical", ORACLE, symmetry),
                half=known.half_return,
            )
        )
        found.append(entry_of(proof) | {"stability": stability})
    check(system, atlas, found, 8)
