"""Distances along the orbits of a curve: bounds hold for independently integrated orbits, and forged ones are found."""

from __future__ import annotations

import copy
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_poly, ctx, fmpz_poly
from scipy.integrate import solve_ivp
from support.flow_checks import ball
from support.stability_cases import HALO_INTERVALS, HALO_LIMITS, halo_functions, halo_piece
from support.stored import stored_distances, unconfirmed_of
from support.within import within

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Piece
from orbitproof.shared.systems import CR3BP
from orbitproof.verify.algebra import Grading, Series, WideArithmetic
from orbitproof.verify.curve import PieceLimits
from orbitproof.verify.distances import (
    KnownDistances,
    Where,
    is_distance_of_orbits,
    ranges_between,
)
from orbitproof.verify.distances.distances import _GRID as GRID
from orbitproof.verify.distances.distances import PARTS, Cells, _Side
from orbitproof.verify.evidence import sign
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.stability import Segment

_precision = within(lambda: ctx.workprec(160))


@pytest.fixture(scope="module", params=["symmetric", pytest.param("regularised", marks=pytest.mark.slow)])
def found(request: Any) -> tuple[str, dict[str, Any]]:
    name = request.param
    with ctx.workprec(160):
        return name, halo_functions(name, HALO_INTERVALS[name], HALO_LIMITS[name])


def distances_of(piece: Piece, s: Fraction, mu: float) -> Any:
    """The distance from the smaller primary at many times of the half orbit, both ends among them."""
    x, z, vy = (float(value) for value in piece.point(s))

    def crossing(_: float, state: Any) -> Any:
        return state[1]

    crossing.terminal, crossing.direction = True, -np.sign(vy)  # type: ignore[attr-defined]

    def field(_: float, state: Any) -> Any:
        return CR3BP.vector_field(list(state), [mu])

    start = [x, 0.0, z, 0.0, vy, 0.0]
    run = solve_ivp(field, (0, 20), start, "DOP853", events=crossing, dense_output=True, rtol=3e-14, atol=1e-15)
    times = np.linspace(0, run.t_events[0][0], 20001)
    places = run.sol(times)
    return np.sqrt((places[0] + mu - 1) ** 2 + places[1] ** 2 + places[2] ** 2)


def test_distances_of_independent_orbits_lie_within_the_bounds(found: tuple[str, dict[str, Any]]) -> None:
    name, entry = found
    piece, parameters = halo_piece(name)
    known = stored_distances(entry["distance"])
    assert known is not None
    start, end = HALO_INTERVALS[name]
    source = np.random.default_rng(3)
    places = set()
    for share in source.uniform(0, 1, 12):
        s = start + (end - start) * Fraction(float(share))
        tau = (2 * (s - start) / (end - start) - 1) / REACH
        along = distances_of(piece, s, float(parameters["mu"]))
        for function, value in ((known.here, along[0]), (known.there, along[-1])):
            enclosure = function.value(ball(tau)).sqrt()
            assert abs(float(enclosure.mid()) / value - 1) < 1e-9
            assert float(enclosure.rad()) < 1e-9
        extremes = known.over(tau, tau)
        assert extremes is not None
        for extreme, value, at_end in zip(extremes, (along.min(), along.max()), (np.argmin, np.argmax), strict=True):
            assert (extreme.square.sqrt() + arb(0, 1e-8)).contains(arb(value))
            assert float(extreme.square.sqrt().rad()) < 0.02 * value
            expected = {0: Where.HERE, len(along) - 1: Where.THERE}.get(int(at_end(along)), Where.ALONG)
            assert extreme.where in (expected, Where.ALONG)
            places.add(extreme.where)
    assert places - {Where.ALONG}


def test_bounds_hold_on_cells_and_are_about_as_narrow_as_the_values() -> None:
    """A polynomial in theta and sigma against its values on a fine grid."""
    arithmetic = WideArithmetic(Grading((1,), 0), 80, 0, 5, width=4)
    source = np.random.default_rng(4)
    numbers = source.uniform(-1, 1, (6, 5))
    integers = [[int(value * 2**40) << 40 for value in row] for row in numbers]
    packed = [value for row in integers for value in [*row, *[0] * 4]]
    element = Series(arithmetic, [fmpz_poly(packed)], [1e-3, 0.0])
    cells = Cells.of(element)
    grid = cells.lower.shape[0]
    reach = 16 / 17
    for cell in range(0, grid, 5):
        for part in range(PARTS):
            theta = np.linspace(cell, cell + 1, 9) / grid
            sigma = reach * (2 * np.linspace(part, part + 1, 9) / PARTS - 1)
            values = np.polynomial.polynomial.polygrid2d(theta, sigma, numbers)
            assert cells.lower[cell, part] <= values.min() - 0.999e-3
            assert cells.upper[cell, part] >= values.max() + 0.999e-3
            assert cells.upper[cell, part] - cells.lower[cell, part] < 1.5 * np.ptp(values) + 0.02
            middle = values[4]
            assert cells.upper_at_times[cell, part] >= middle.max() + 0.999e-3
            assert cells.lower_at_times[cell, part] <= middle.min() - 0.999e-3
            true_sign = sign(arb(values.min() - 1e-3).union(arb(values.max() + 1e-3)))
            assert cells.signs[cell][part] in (0, true_sign)
            assert cells.signs[cell][part] == true_sign or abs(values).min() < 0.05


@pytest.mark.parametrize("seed", range(8))
def test_an_extreme_at_an_end_is_one_in_all_cells_by_its_curvature_or_by_its_value(seed: int) -> None:
    """Lemma 20.1: from this end on some cells, one at least, are curved so, and the others, one at least, are away."""
    chance = random.Random(seed)
    cells, shown = 2 * GRID, list[bool]()
    for sign_ in (1, -1) * 40:
        rest = chance.randint(0, cells)
        bad = [chance.choice((0, -sign_)) for _ in range(4)]
        away = [chance.choice((sign_, sign_, bad[0])) if i < rest else sign_ for i in range(cells)]
        # Often the first cell that need not be curved so is curved the other way.
        curved = rest + chance.choice((-1, 0, 0, 1, cells))
        bends = [sign_ if i < curved else chance.choice((sign_, *bad)) for i in range(cells)]
        rows = range(GRID - 1, -1, -1) if seed % 2 else range(GRID)
        curvatures = ([[bend] for bend in bends[:GRID]], [[bend] for bend in bends[GRID:]])
        steps: Any = [SimpleNamespace(curvature=part[:: rows.step]) for part in curvatures]
        side = _Side(Where.HERE, steps, rows, np.array(away, dtype=float)[:, None])
        known = [
            set(bends[:beside]) == {sign_} and set(away[beside:]) == {sign_} for beside in range(1, cells)
        ]  # fmt: skip
        shown.append(any(known))
        assert side.has_extreme(0, sign_) == shown[-1]
    assert {*shown} == {True, False}


def test_what_is_not_finite_has_no_sign() -> None:
    arithmetic = WideArithmetic(Grading((1,), 0), 80, 0, 5, width=4)
    cells = Cells.of(arithmetic.constant(Fraction(1)).widened(Fraction(2) ** 2000))
    assert {sign_ for row in cells.signs for sign_ in row} == {0}


@pytest.mark.parametrize("found", ["symmetric"], indirect=True)
def test_another_integration_confirms_the_bounds(found: tuple[str, dict[str, Any]]) -> None:
    name, entry = found
    assert list(unconfirmed_of(entry, halo_functions(name, HALO_INTERVALS[name], PieceLimits(72, 24, 12)))) == []


def test_an_integration_confirms_itself_and_one_that_rounds_another_way(found: tuple[str, dict[str, Any]]) -> None:
    _, entry = found
    assert list(unconfirmed_of(entry, entry)) == []
    fresh = copy.deepcopy(entry)
    for share, confirmed in ((Fraction(1, 2**14), True), (Fraction(1, 2**6), False)):
        for part, old in zip(fresh["distance"]["parts"], entry["distance"]["parts"], strict=True):
            low, high = (parse_exact(bound) for bound in old["greatest"])
            part["greatest"] = [format_exact(low * (1 - share)), format_exact(high * (1 + share))]
        assert (list(unconfirmed_of(entry, fresh)) == []) == confirmed


def narrow_least(distance: dict[str, Any]) -> None:
    part = distance["parts"][5]
    part["least"] = [part["least"][1], part["least"][1]]


def lower_greatest(distance: dict[str, Any]) -> None:
    part = distance["parts"][2]
    part["greatest"] = [format_exact(parse_exact(bound) * Fraction(9, 10)) for bound in part["greatest"]]


def taken_elsewhere(distance: dict[str, Any]) -> None:
    part = distance["parts"][3]
    part["least_at"] = "the other point" if part["least_at"] == "this point" else "this point"


def moved_function(distance: dict[str, Any]) -> None:
    first = distance["there"]["coefficients"][0]
    distance["there"]["coefficients"][0] = format_exact(parse_exact(first) * (1 + Fraction(1, 2**20)))


def narrow_function(distance: dict[str, Any]) -> None:
    distance["here"]["error"] = "0x0"


FORGERIES = [narrow_least, lower_greatest, taken_elsewhere, moved_function, narrow_function]


@pytest.mark.parametrize("change", FORGERIES, ids=lambda f: f.__name__)
def test_forged_distances_are_not_confirmed(
    found: tuple[str, dict[str, Any]], change: Callable[[dict[str, Any]], None]
) -> None:
    _, entry = found
    fresh = copy.deepcopy(entry)
    for part in fresh["distance"]["parts"]:
        for name in ("least", "greatest"):
            low, high = (parse_exact(bound) for bound in part[name])
            part[name] = [format_exact(low + (high - low) / 8), format_exact(high - (high - low) / 8)]
    for function in (*fresh["characteristic"], *(fresh[n] for n in ("level", "half_period", "first_factor"))):
        function["error"] = format_exact(parse_exact(function["error"]) / 4)
    for name in ("here", "there"):
        function = fresh["distance"][name]
        function["error"] = format_exact(parse_exact(function["error"]) / 4)
    assert list(unconfirmed_of(entry, fresh)) == []
    forged = copy.deepcopy(entry)
    change(forged["distance"])
    assert list(unconfirmed_of(forged, fresh))
    without = {key: value for key, value in fresh.items() if key != "distance"}
    assert "distances are not enclosed again" in list(unconfirmed_of(entry, without))


@pytest.mark.parametrize("bounds", [["-0x1", "0x1"], ["0x2", "0x1"]])
def test_bounds_that_are_none_are_refused(found: tuple[str, dict[str, Any]], bounds: list[str]) -> None:
    distance = copy.deepcopy(found[1]["distance"])
    distance["parts"][0]["least"] = bounds
    with pytest.raises(ValueError, match="bounds of a distance"):
        stored_distances(distance)
    distance = copy.deepcopy(found[1]["distance"])
    del distance["parts"][0]
    with pytest.raises(ValueError, match="number of parts"):
        stored_distances(distance)


def test_only_distances_with_the_symmetries_of_the_curve_count() -> None:
    assert is_distance_of_orbits(CR3BP, "S")
    assert not is_distance_of_orbits(replace(CR3BP, squared_distance=None), "S")
    above = replace(CR3BP, squared_distance=lambda state, _: ((state[0] - 1) ** 2 + (state[2] - 1) ** 2,))
    assert is_distance_of_orbits(above, None)
    assert not is_distance_of_orbits(above, "S")
    beside = replace(CR3BP, squared_distance=lambda state, _: ((state[1] - 1) ** 2,))
    assert not is_distance_of_orbits(beside, None)


def linear(value: int, slope: int) -> BoundedFunction:
    return BoundedFunction(arb_poly([value, slope]), arb(0))


def segment_with(distances: KnownDistances | None, stretch: int = 0) -> Segment:
    flat, one = linear(0, 0), Fraction(1)
    start, end = -one / REACH, one / REACH
    return Segment(
        stretch, start, start, end, Fraction(0), one, (flat,), flat, linear(3 + 4 * stretch, 1), flat, distances
    )


def stored(places: list[Where]) -> KnownDistances:
    """The distance is 2 + tau at this point, 7 - tau at the other one, between 1 and 9 in any case."""
    parts = [
        {
            "least": ["0x1", "0x2"],
            "greatest": ["0x40", "0x51"],
            "least_at": least.value,
            "greatest_at": "along the orbit",
        }
        for least in places
    ]
    shapes = {"here": ["0x4", "0x4", "0x1"], "there": ["0x31", "-0xe", "0x1"]}
    entry = {name: {"coefficients": row, "error": "0x0"} for name, row in shapes.items()}
    known = stored_distances({**entry, "parts": parts})
    assert known is not None
    return known


def test_ranges_over_a_part_of_a_curve_are_those_of_its_segments() -> None:
    halves = [Where.HERE] * 8 + [Where.ALONG] * 8
    segment = segment_with(stored(halves))
    left = ranges_between([segment], (0, Fraction(-1, 2)), (0, Fraction(-1, 4)))
    assert left is not None
    least, where = left.distances["least"]
    assert where == Where.HERE
    assert least.contains(arb(1.5))
    assert least.contains(arb(1.75))
    assert float(least.lower()) > 1.45
    assert float(least.upper()) < 1.8
    assert left.distances["greatest"][1] == Where.ALONG
    assert left.distances["greatest"][0].contains(arb(8))
    assert left.distances["greatest"][0].contains(arb(9))
    assert left.half_period.contains(arb(2.5))
    assert left.half_period.contains(arb(2.75))
    both = ranges_between([segment], (0, Fraction(-1, 2)), (0, Fraction(1, 2)))
    assert both is not None
    assert both.distances["least"][1] == Where.ALONG
    assert both.distances["least"][0].contains(arb(1))
    assert both.distances["least"][0].contains(arb(1.99))
    mirrored = segment_with(stored(halves).mirrored())
    right = ranges_between([mirrored], (0, Fraction(1, 4)), (0, Fraction(1, 2)))
    assert right is not None
    assert right.distances["least"][1] == Where.HERE
    assert right.distances["least"][0].contains(arb(1.5))


def test_ranges_over_several_stretches_are_known_if_they_are_on_each() -> None:
    parts = [segment_with(stored([Where.THERE] * PARTS), 0), segment_with(stored([Where.THERE] * PARTS), 1)]
    whole = ranges_between(parts, (0, Fraction(0)), (1, Fraction(0)))
    assert whole is not None
    assert whole.half_period.contains(arb(3))
    assert whole.half_period.contains(arb(7))
    assert set(whole.distances) == {"least", "greatest"}
    assert set(whole.distances) == {"least", "greatest"}
    some = ranges_between([parts[0], segment_with(None, 1)], (0, Fraction(0)), (1, Fraction(0)))
    assert some is not None
    assert some.distances == {}
    assert ranges_between([parts[0]], (1, Fraction(0)), (2, Fraction(0))) is None
