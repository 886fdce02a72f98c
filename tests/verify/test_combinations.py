"""Combination resonances along curves with two stability parameters: all of them, and no others; Krein collisions."""

from __future__ import annotations

import copy
from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import test_lists_of_three_bodies as three_bodies
from flint import arb, arb_poly, ctx
from support.closed_form_lists import curve_of, ellipse, line, results
from support.conclusions import with_complete_list
from support.forgeries import checked, forged, forged_elsewhere
from support.list_truths import Truth, _around, _interval, _within
from support.skew_products import SkewProduct
from support.stored import values

from orbitproof.shared.errors import InputError
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.branches.recheck import lists_combinations
from orbitproof.verify.curve import conclude
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.run.branches import limits_of
from orbitproof.verify.stability import Matter, Segment
from orbitproof.verify.stability.complete_list import Finder

SYSTEMS = {
    "two, symplectic": lambda seed: line(seed, 2, True),
    "two": lambda seed: line(seed, 2, False),
    "symmetric loop of two": lambda seed: ellipse(seed, 2, "breaks"),
}
CASES = (("two", 0), ("two", 1), ("two, symplectic", 2))
SLOW = (("two, symplectic", 0), ("two, symplectic", 1), ("symmetric loop of two", 0), ("symmetric loop of two", 4))


def chebyshev(m: int, x: Any) -> Any:
    return 2 * x * x - 1 if m == 2 else 4 * x**3 - 3 * x


def truths(truth: Truth) -> list[tuple[str, float]]:
    """By angles: places of linearly stable orbits where m omega = +-omega', or omega + omega' = pi."""

    def relation(m: int, swapped: bool) -> Any:
        def value(place: Any) -> Any:
            first, second = truth.parameters(place)[:: -1 if swapped else 1]
            return chebyshev(m, first) - second

        return value

    functions = [(f"combination {m}:1", relation(m, swapped)) for m in (2, 3) for swapped in (False, True)]
    functions.append(("combination 2:2", lambda place: truth.curve.minors(place)[0]))
    found = []
    for kind, function in functions:
        with np.errstate(invalid="ignore"):
            for place in truth.curve.zeros(function):
                first, second = (float(value) for value in truth.parameters(place))
                if abs(first) < 1 and abs(second) < 1 and first != second:
                    found.append((kind, place))
    return found


def listed(system: SkewProduct, combinations: bool = True) -> tuple[Truth, dict[str, Any], str]:
    atlas = system.atlas(6 if system.ellipse is None else 10)
    given = results(system, atlas)
    document = with_complete_list(atlas, given, conclude(atlas, values(given)), 4, combinations)
    assert document["verdict"] == "proved"
    return Truth(curve_of(system, atlas), 4), document["complete"], document["statement"]


@pytest.fixture(scope="module")
def all_lists() -> list[tuple[Truth, dict[str, Any], str]]:
    return [listed(SYSTEMS[name](seed)) for name, seed in CASES]


def compared(truth: Truth, said: dict[str, Any], text: str) -> list[str]:
    """The kinds of all that are listed, each of which is there, none being left out."""
    expected = truths(truth)
    places = [(entry["kind"], _around(truth, entry)) for entry in said["combinations"]]
    open_ = [_interval(truth, entry) for entry in (*said["open_combinations"], *said["gaps"])]
    for kind, place in expected:
        there = [at for name, at in places if name == kind and _within(truth, at, place)]
        assert len(there) == 1 or any(_within(truth, at, place) for at in open_), (kind, place)
    for name, at in places:
        assert any(kind == name and _within(truth, at, place) for kind, place in expected), name
    assert "combination resonance" in text
    assert "Combination resonances of two pairs of multipliers are not listed." not in text
    return [name for name, _ in places]


def test_lists_have_all_combination_resonances_and_no_others(all_lists: Any) -> None:
    kinds = [name for entry in all_lists for name in compared(*entry)]
    assert len(kinds) > 20
    assert {*kinds} == {"combination 2:1", "combination 3:1", "combination 2:2"}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "seed"), SLOW)
def test_further_lists_have_all_of_them(name: str, seed: int) -> None:
    assert compared(*listed(SYSTEMS[name](seed)))


def test_without_being_asked_for_they_are_said_not_to_be_listed() -> None:
    _, said, text = listed(SYSTEMS["two"](2), False)
    assert "combinations" not in said
    assert "Combination resonances of two pairs of multipliers are not listed." in text
    assert not lists_combinations({"conclusion": {"complete": said}})


def test_what_a_file_lists_is_seen(all_lists: Any) -> None:
    assert lists_combinations({"conclusion": {"complete": copy.deepcopy(all_lists[0][1])}})
    assert not lists_combinations({"conclusion": None})
    assert not lists_combinations({"conclusion": {}})


def test_they_are_listed_for_two_stability_parameters_only() -> None:
    two = SYSTEMS["two"](2).atlas(6)
    one, three = line(1, 1, True).atlas(6), line(0, 3, False).atlas(6)
    assert limits_of(two, 4, combinations=True).combinations
    for atlas, complete in ((one, 4), (three, 4), (two, None)):
        with pytest.raises(InputError, match="combinations"):
            limits_of(atlas, complete, combinations=True)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "number"), [(three_bodies.LOOP, 6), (three_bodies.NEAR, 2)])
def test_those_of_halo_orbits_are_found_by_another_integrator(name: str, number: int) -> None:
    atlas, given = three_bodies.case(name)
    with ctx.workprec(192):
        document = with_complete_list(atlas, given, conclude(atlas, values(given)), 4, True)
        assert len(compared(three_bodies.truth(name)[1], document["complete"], document["statement"])) == number


def test_where_zeros_are_not_separated_is_told() -> None:
    """Near the smaller primary, where functions are known to few digits."""
    atlas, given = three_bodies.case(three_bodies.NEAR)
    with ctx.workprec(192):
        document = with_complete_list(atlas, given, conclude(atlas, values(given)), 4, True)
    assert [gap["about"] for gap in document["complete"]["open_combinations"]] == ["combination resonances"]
    assert "Whether there are more of these is not decided:" in document["statement"]
    assert len(document["complete"]["stable"]) == 1


@pytest.fixture(scope="module")
def certificate() -> dict[str, Any]:
    system = SYSTEMS["two"](0)
    atlas = system.atlas(6)
    given = results(system, atlas)
    conclusion = with_complete_list(atlas, given, conclude(atlas, values(given)), 4, True)
    return make_atlas_certificate(atlas, values(given), conclusion)


def _list(entry: dict[str, Any]) -> dict[str, Any]:
    return entry["conclusion"]["complete"]  # type: ignore[no-any-return]


FORGERIES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "one left out": lambda entry: _list(entry)["combinations"].pop(0),
    "all left out": lambda entry: _list(entry).update(combinations=[]),
    "one twice": lambda entry: _list(entry)["combinations"].append(_list(entry)["combinations"][0]),
    "another kind": lambda entry: _list(entry)["combinations"][0].update(kind="combination 2:2"),
    "another level": lambda entry: _list(entry)["combinations"][0].update(level=_list(entry)["points"][0]["level"]),
    "open places alone": lambda entry: _list(entry).pop("combinations"),
    "a collision more": lambda entry: _list(entry)["points"].append(
        {**_list(entry)["combinations"][0], "kind": "Krein collision"}
    ),
    "a collision that is a resonance": lambda entry: next(
        point for point in _list(entry)["points"] if point["kind"] == "Krein collision"
    ).update(kind="resonance", k=5, j=1),
}


QUICK = ("one left out", "another kind", "a collision that is a resonance")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in FORGERIES]
)
def test_forged_lists_are_refused(certificate: dict[str, Any], name: str) -> None:
    assert _list(certificate)["combinations"][0]["kind"] == "combination 3:1"
    assert not checked(forged(certificate, FORGERIES[name])).stands


@pytest.mark.slow
def test_the_list_that_is_forged_stands(certificate: dict[str, Any]) -> None:
    assert checked(certificate).stands


def test_a_list_without_combinations_says_nothing_of_them(certificate: dict[str, Any]) -> None:
    def without(entry: dict[str, Any]) -> None:
        for name in ("combinations", "open_combinations"):
            del _list(entry)[name]

    found = checked(forged_elsewhere(certificate, without))
    refused = checked(forged(certificate, without))
    assert "these sources, which word what it proves otherwise" in refused.why
    assert found.stands
    assert found.rendered is not None
    text = found.rendered["conclusion"]["statement"]
    assert "Combination resonances of two pairs of multipliers are not listed." in text
    assert "combination resonance of order" not in text


def test_where_stability_is_not_decided_a_place_is_named() -> None:
    """s_1 + s_2 = tau and s_1 s_2 about -1: where s_1 = -s_2 both may be beyond 1 or not."""
    flat, one = BoundedFunction(arb_poly([0]), arb(0)), Fraction(1)
    product = BoundedFunction(arb_poly([-1]), arb("0.1"))
    segment = Segment(
        0, -one, -one, one, Fraction(0), one, (BoundedFunction(arb_poly([0, 1]), arb(0)), product), flat, flat, flat
    )
    stretch = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p"), is_symmetric=False))
    finder = Finder(None, stretch, segment)  # type: ignore[arg-type]
    finder.combinations()
    assert not finder.points
    assert any("stable there is not decided" in gap.reason and gap.start < 0 < gap.end for gap in finder.gaps)
    assert all(gap.subject is Matter.COMBINATIONS for gap in finder.gaps)
