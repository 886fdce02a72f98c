"""Distances from a body along orbits of the Duffing oscillator: with the energy a polynomial of the position."""

from __future__ import annotations

import copy
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from support.closed_form_lists import curve_of
from support.list_truths import KnownCurve, Truth, misses
from support.one_piece import OnePiece
from support.piece_cases import slow
from support.skew_products import SkewProduct
from support.stored import stored_distances
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.verify.distances import Extreme, Where
from orbitproof.verify.functions import REACH

CASES = {
    "farthest at an end at first": (Fraction(1), Fraction(1), Fraction(1), Fraction(1, 8)),
    "met from an amplitude on": (Fraction(5, 4), Fraction(0), Fraction(5, 4), Fraction(1, 8)),
    "nearest inside": (Fraction(1, 4), Fraction(1, 4), Fraction(3, 2), Fraction(1, 16)),
    "nearest at both ends": (Fraction(0), Fraction(2), Fraction(1), Fraction(1, 8)),
    "far away": (Fraction(3), Fraction(1, 2), Fraction(1), Fraction(1, 8)),
}
"""c and kappa of the distance; the amplitudes, middle and reach."""
_NAMES = list(CASES)
_RANDOM = 24
_SAME = 1e-9

_precision = within(lambda: ctx.workprec(160))


@cache
def case(name: str) -> tuple[OnePiece, KnownCurve]:
    """A proved piece and what is true of it."""
    centre, share, middle, reach = CASES[name]
    stiffness = ((Fraction(3),),), ((Fraction(0),),), ((Fraction(1),),)
    system = SkewProduct("body", stiffness, float(middle - reach), float(middle + reach), body=(centre, share))
    proof = OnePiece(system.system, 0, middle, reach)
    return proof, curve_of(system, proof.atlas)


def places(truth: Any) -> list[set[Where]]:
    """At which points of Fix(R) the least and the greatest distance are taken on all of some orbits."""
    points = {Where.HERE: truth[2], Where.THERE: truth[3]}
    return [
        {where for where, values in points.items() if np.abs(values - extreme).max() < _SAME} for extreme in truth[:2]
    ]


@pytest.mark.parametrize("name", [*_NAMES[:3], *slow(*_NAMES[3:])])
def test_bounds_contain_the_closed_form_at_random_parameters(name: str) -> None:
    """Where the least or the greatest distance is taken is true, and missing only beside a change of it."""
    proof, curve = case(name)
    known = stored_distances(proof.results[0]["stability"]["distance"])
    assert known is not None
    source = np.random.default_rng(7)
    missing = 0
    for part in known.parts:
        shares = np.sort(source.uniform(0, 1, _RANDOM))
        taus = float(part.lower) + float(part.upper - part.lower) * shares
        truth = curve.distances([curve.place("p1", float(tau * REACH)) for tau in taus])  # type: ignore[misc]
        for function, values in ((known.here, truth[2]), (known.there, truth[3])):
            for tau, value in zip(taus, values, strict=True):
                assert (function.value(arb(tau)) + arb(0, _SAME)).contains(arb(value**2))
                assert float(function.value(arb(tau)).rad()) < 1e-6
        for extreme, values, true in zip((part.least, part.greatest), truth, places(truth), strict=False):
            low, high = (max(float(end), 0.0) ** 0.5 for end in (extreme.square.lower(), extreme.square.upper()))
            assert low <= values.min() + _SAME
            assert values.max() <= high + _SAME
            assert high - low < 1.2 * np.ptp(values) + 0.01 * values.max() + 0.01
            assert extreme.where in (*true, Where.ALONG)
            missing += len(true) == 1 and extreme.where is Where.ALONG
        for extreme, values in zip(known.over(part.lower, part.upper) or (), truth, strict=False):
            check_values(extreme, values)
    assert missing <= 2


def check_values(extreme: Extreme, values: Any) -> None:
    assert all((extreme.square + arb(0, _SAME)).contains(arb(value**2)) for value in values)


@pytest.mark.parametrize("name", [*_NAMES[:3], *slow(*_NAMES[3:])])
def test_the_ranges_of_a_list_are_true(name: str) -> None:
    proof, curve = case(name)
    said = proof.listed(9)["complete"]
    assert said["stable"]
    assert all("least_distance" in entry["between"] for entry in said["stable"])
    assert misses(Truth(curve, 9), said) == []


def narrower(stable: dict[str, Any]) -> None:
    ball = stable["between"]["greatest_distance"]
    ball["rad"] = format_exact(parse_exact(ball["rad"]) * Fraction(3, 4))


def wider(stable: dict[str, Any]) -> None:
    ball = stable["between"]["least_distance"]
    ball["rad"] = format_exact(parse_exact(ball["rad"]) * 2)


def elsewhere(stable: dict[str, Any]) -> None:
    stable["between"]["greatest_distance_at"] = "the other point"


@pytest.mark.parametrize("change", [narrower, wider, elsewhere], ids=lambda f: f.__name__)
def test_other_ranges_are_noticed(change: Callable[[dict[str, Any]], None]) -> None:
    proof, curve = case(_NAMES[0])
    said = copy.deepcopy(proof.listed(2)["complete"])
    change(said["stable"][0])
    assert misses(Truth(curve, 2), said)
