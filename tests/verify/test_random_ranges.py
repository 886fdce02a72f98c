"""Ranges over parts of curves and of intervals, at random: they hold every member, and no more than their own parts."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.random_pieces import number, random_piece, values
from support.within import within

from orbitproof.shared.claims import Piece
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve.gluing import Chain, Stretch
from orbitproof.verify.curve.proved_intervals import ProvedInterval, Run
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.distances import Where
from orbitproof.verify.distances.ranges import (
    Extreme,
    KnownDistances,
    PartOfInterval,
    Ranges,
    known_distances,
    ranges_between,
    together,
)
from orbitproof.verify.distances.stored_distances import PARTS, DistanceFunctions, Extremes
from orbitproof.verify.evidence import enclose, hull
from orbitproof.verify.functions import REACH, BoundedFunction, StoredFunction
from orbitproof.verify.index.along_curve import Interval, places_in
from orbitproof.verify.lasting.stored import may_be_stable
from orbitproof.verify.periodic_curve.turns import turns_of
from orbitproof.verify.stability.linear_stability import Bound
from orbitproof.verify.stability.list_entries import Segment

BITS = 192
END = 1 / REACH

precision = within(lambda: ctx.workprec(BITS))


def line(chance: random.Random) -> tuple[list[Fraction], BoundedFunction]:
    """A function that increases or decreases, so that its values are those between the ones at the ends."""
    coefficients = [number(chance, 4), Fraction(chance.choice([-2, -1, 1, 2]))]
    return coefficients, BoundedFunction(ball_polynomial(coefficients), arb(0))


def between(low: Fraction, high: Fraction) -> list[Fraction]:
    """Numbers of an interval, its ends among them."""
    return [low + (high - low) * Fraction(share, 8) for share in range(9)]


def is_narrow(ball: arb, low: Fraction, high: Fraction) -> bool:
    """Whether it is the hull of two numbers, but for rounding: radii have few bits."""
    more = arb(2) ** -24 * (1 + enclose(high - low))
    return bool(ball.lower() > enclose(low) - more and ball.upper() < enclose(high) + more)


def random_distances(
    chance: random.Random,
) -> tuple[KnownDistances, list[list[Fraction]], list[tuple[Fraction, Fraction]]]:
    """With what they are at x(s) and y(s), and for each part what holds along the orbits."""
    (here, first), (there, second) = line(chance), line(chance)
    ends = [Fraction(2 * n - 4, 4) * END for n in range(5)]
    parts, along = [], []
    for lower, upper in pairwise(ends):
        low = Fraction(chance.randint(0, 64), 8)
        along.append((low, low + Fraction(chance.randint(0, 16), 16)))
        square = hull(enclose(along[-1][0]), enclose(along[-1][1]))
        least, greatest = (Extreme(square, chance.choice(list(Where))) for _ in range(2))
        parts.append(PartOfInterval(lower, upper, least, greatest))
    return KnownDistances(first, second, tuple(parts)), [here, there], along


def test_distances_over_an_interval_are_those_of_each_part_that_it_meets() -> None:
    chance = random.Random(0)
    for _ in range(120):
        known, (here, there), along = random_distances(chance)
        low, high = sorted(chance.choice(between(-END, END)) + number(chance) / 64 for _ in range(2))
        mirrored = known.mirrored().over(-high, -low)
        for found, which in zip(known.over(low, high) or (), ("least", "greatest"), strict=False):
            members: list[Fraction] = []
            places = set()
            for part, bounds in zip(known.parts, along, strict=True):
                if part.lower > high or part.upper < low:
                    continue
                where = getattr(part, which).where
                places.add(where)
                if where is Where.ALONG:
                    members += bounds
                else:
                    inside = between(max(low, part.lower), min(high, part.upper))
                    members += [values(here if where is Where.HERE else there, tau) for tau in inside]
            assert members
            assert all(agree(found.square, enclose(value)) for value in members)
            assert is_narrow(found.square, min(members), max(members))
            assert found.where is (places.pop() if len(places) == 1 else Where.ALONG)
            assert mirrored is not None
            again = mirrored[0] if which == "least" else mirrored[1]
            assert (again.where, is_narrow(again.square, min(members), max(members))) == (found.where, True)
            assert all(agree(again.square, enclose(value)) for value in members)
    known, _, _ = random_distances(chance)
    assert known.over(END + Fraction(1, 64), END + 1) is None
    assert known.over(-END - 1, -END - Fraction(1, 64)) is None
    assert known.over(END, END + 1) is not None


def segments_of(chance: random.Random) -> list[tuple[Segment, list[Fraction], list[Fraction]]]:
    """Three stretches of two segments each, with their half periods and the squares at x(s); one may lack distances."""
    found = []
    for stretch in range(3):
        places = [Fraction(-1), Fraction(chance.randint(-3, 3), 8), Fraction(1)]
        for start, end in pairwise(places):
            (times, half_period), (squares, here) = line(chance), line(chance)
            squares[0] += 16
            here = here.shifted(arb(16))
            extreme = Extreme(arb(-1), Where.HERE)
            reach = (end - start) / 2 * REACH
            distances = KnownDistances(here, here, (PartOfInterval(-END, END, extreme, extreme),))
            segment = Segment(
                stretch, start, start, end, (start + end) / 2, reach, (half_period,), half_period, half_period,
                half_period, distances,
            )  # fmt: skip
            found.append((segment, times, squares))
    return found


def test_ranges_between_two_places_are_those_of_all_orbits_between_them() -> None:
    chance = random.Random(0)
    for _ in range(80):
        known = segments_of(chance)
        unknown = chance.choice([None, None, chance.randrange(6)])
        segments = [
            replace(segment, distances=None) if index == unknown else segment
            for index, (segment, _, _) in enumerate(known)
        ]
        begin, end = sorted((chance.randrange(3), Fraction(chance.randint(-16, 16), 16)) for _ in range(2))
        found = ranges_between(segments, begin, end)
        times, squares, meets_unknown = [], [], False
        for index, (segment, time, square) in enumerate(known):
            first = max((segment.stretch, segment.start), begin)
            last = min((segment.stretch, segment.end), end)
            if first > last or not first[0] == last[0] == segment.stretch:
                continue
            taus = [segment.tau(s) for s in between(first[1], last[1])]
            times += [values(time, tau) for tau in taus]
            squares += [values(square, tau) for tau in taus]
            meets_unknown = meets_unknown or index == unknown
        assert found is not None
        assert all(agree(found.half_period, enclose(time)) for time in times)
        assert is_narrow(found.half_period, min(times), max(times))
        for extreme, name in ((found.least, "least"), (found.greatest, "greatest")):
            assert (extreme is None) == meets_unknown == (name not in found.distances)
            if extreme is not None:
                assert all(agree(extreme.square, enclose(square)) for square in squares)
                assert is_narrow(extreme.square, min(squares), max(squares))
                distance, where = found.distances[name]
                assert where is Where.HERE
                assert all(agree(distance, enclose(square).sqrt()) for square in squares)
                root = enclose(min(squares)).sqrt(), enclose(max(squares)).sqrt()
                assert distance.rad() < (root[1] - root[0]) / 2 + arb(2) ** -16
    segments = [segment for segment, _, _ in segments_of(chance)[:2]]
    assert ranges_between(segments, (1, Fraction(0)), (2, Fraction(0))) is None
    assert together([]) is None


def test_ranges_of_parts_together_are_known_if_those_of_each_are() -> None:
    chance = random.Random(0)
    for _ in range(60):
        parts = []
        for _ in range(chance.randint(1, 4)):
            low = Fraction(chance.randint(0, 8))
            extremes = [
                chance.choice([None, Extreme(hull(enclose(low), enclose(low + 1)), chance.choice(list(Where)))])
                for _ in range(2)
            ]
            parts.append(Ranges(arb(chance.randint(1, 9)), *extremes))
        found = together(parts)
        assert found is not None
        assert all(found.half_period.contains(part.half_period) for part in parts)
        for name in ("least", "greatest"):
            own, whole = [getattr(part, name) for part in parts], getattr(found, name)
            assert (whole is None) == (None in own)
            if whole is not None:
                assert all(whole.square.contains(each.square) for each in own)
                places = {each.where for each in own}
                assert whole.where is (places.pop() if len(places) == 1 else Where.ALONG)


@pytest.mark.parametrize(("low", "high"), [("4", "9"), ("0", "9"), ("-1e-30", "9"), ("-2", "1"), ("0", "0")])
def test_a_distance_whose_square_may_be_0_lies_between_0_and_its_bound(low: str, high: str) -> None:
    extreme = Extreme(hull(arb(low), arb(high)), Where.ALONG)
    distance, _ = Ranges(arb(1), extreme, None).distances["least"]
    assert distance.contains(max(arb(low), arb(0)).sqrt().mid())
    assert distance.contains(arb(high).sqrt().mid())
    assert distance.upper() < arb(high).sqrt() + arb(2) ** -20
    assert distance.lower() > -(arb(2) ** -20)


def test_stored_parts_are_equal_parts_of_the_interval_from_left_to_right() -> None:
    chance = random.Random(0)
    function = StoredFunction.near([arb(1), arb(2)], arb(0))
    bounds = [(Fraction(n), Fraction(n + 1)) for n in range(PARTS)]
    parts = [Extremes(each, (each[0] + 1, each[1] + 1), Where.HERE, Where.THERE) for each in bounds]
    found = known_distances(DistanceFunctions(function, function, tuple(parts))).parts
    assert (found[0].lower, found[-1].upper) == (-END, END)
    assert all(one.upper == other.lower for one, other in pairwise(found))
    assert {part.upper - part.lower for part in found} == {2 * END / PARTS}
    for part, (low, high) in zip(found, bounds, strict=True):
        assert (part.least.where, part.greatest.where) == (Where.HERE, Where.THERE)
        assert is_narrow(part.least.square, low, high)
        assert is_narrow(part.greatest.square, low + 1, high + 1)
        assert all(agree(part.least.square, enclose(end)) for end in (low, high))
    place = chance.randrange(PARTS)
    for wrong in (parts[:-1], [*parts, parts[0]]):
        with pytest.raises(ValueError, match="another number of parts"):
            known_distances(DistanceFunctions(function, function, tuple(wrong)))
    for change in ({"least": (Fraction(2), Fraction(1))}, {"greatest": (Fraction(-1), Fraction(1))}):
        other = [replace(part, **change) if n == place else part for n, part in enumerate(parts)]  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="bounds of a distance are none"):
            known_distances(DistanceFunctions(function, function, tuple(other)))


@pytest.mark.parametrize("place", [-1, Fraction(-31, 32), Fraction(-1, 2), 0, Fraction(1, 64), Fraction(3, 4), 1])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_twist_is_asked_for_wherever_on_an_interval_one_orbit_may_be_stable(place: Fraction, sign: int) -> None:
    """c = 9/10 + 4096 (tau - place)^2 or its opposite: below 1 next to one place alone."""
    tau = place * END
    row = [sign * each for each in (Fraction(9, 10) + 4096 * tau * tau, -8192 * tau, Fraction(4096))]
    known: Any = SimpleNamespace(characteristic=(StoredFunction.near(list(map(enclose, row)), arb(0)),))
    assert may_be_stable(known)
    flat: Any = SimpleNamespace(characteristic=(StoredFunction.near([sign * arb("1.1"), arb("0.05")], arb(0)),))
    assert not may_be_stable(flat)


# Curves whose first coordinate turns.


def turning_chain(chance: random.Random) -> Chain:
    """Of pieces with polynomials of degree 3, with bounds of their slopes."""
    stretches = []
    for index in range(3):
        piece = random_piece(chance, 1, 3, name=f"p{index}")
        bound = (Fraction(chance.randint(0, 8), 64),)
        parts = tuple(
            ProvedInterval(*ends, bound, bound) for ends in ((Fraction(-1), Fraction(0)), (Fraction(0), Fraction(1)))
        )
        enters = Fraction(chance.randint(-8, -4), 8)
        run = Run(parts)
        stretches.append(
            Stretch(Tube(piece, (run,)), run, enters, enters + Fraction(1, 16), Fraction(chance.randint(1, 8), 8))
        )
    return Chain(tuple(stretches), ())


def slope_of(piece: Piece) -> Callable[[Fraction], Fraction]:
    """d/ds of the first coordinate, exactly."""
    along, across = piece.frame[0]
    return lambda s: along * piece.half_width + across * values(piece.polynomial[0], s, 1)


def test_extrema_lie_between_places_at_which_every_curve_goes_in_opposite_directions() -> None:
    chance, seen = random.Random(0), [0, 0]
    for _ in range(60):
        chain = turning_chain(chance)
        known = {each.tube.piece.id: each for each in chain.stretches}
        order = list(known)
        signs: list[int] = []
        for stretch in chain.stretches:
            unknown = abs(stretch.tube.piece.frame[0][1]) * stretch.run.intervals[0].slope_deviation[0]
            for share in range(17):
                s = stretch.entered + (stretch.leaves - stretch.entered) * Fraction(share, 16)
                slope = slope_of(stretch.tube.piece)(s)
                if abs(slope) > unknown:
                    signs.append(1 if slope > 0 else -1)
        wanted = [second < 0 for first, second in pairwise(signs) if first != second]
        found = turns_of(chain)
        assert [turn.is_maximum for turn in found] == wanted
        for turn in found:
            seen[turn.is_maximum] += 1
            ends = [(order.index(name), s) for name, s in zip(turn.pieces, turn.between, strict=True)]
            assert ends == sorted(ends)
            for name, s, value, is_first in zip(turn.pieces, turn.between, turn.values, (True, False), strict=True):
                stretch = known[name]
                piece = stretch.tube.piece
                assert stretch.entered <= s <= stretch.leaves
                slope = slope_of(piece)(s)
                assert (slope > 0) == (turn.is_maximum == is_first)
                along, across = piece.frame[0]
                exact = piece.centre[0] + along * piece.half_width * s + across * values(piece.polynomial[0], s)
                for sign in (1, -1):
                    bound = sign * abs(across) * stretch.run.at(s).deviation[0]
                    assert agree(value, enclose(exact + bound))
    assert min(seen) > 10


def test_orbits_that_are_tried_in_an_interval_of_the_index_lie_in_it() -> None:
    """Surely behind where it begins and before where it ends, on any stretch in between."""
    chance = random.Random(0)
    for _ in range(60):
        chain = turning_chain(chance)
        curve: Any = SimpleNamespace(chain=chain)
        first, last = sorted(chance.randrange(3) for _ in range(2))
        low, high = (Fraction(chance.randint(-14, 14), 16) for _ in range(2))
        if first == last:
            low, high = min(low, high) - Fraction(1, 16), max(low, high) + Fraction(1, 16)
        little = Fraction(1, 64)
        interval = Interval(Bound(first, low - little, low, ()), Bound(last, high, high + little, ()))
        found = places_in(curve, interval)
        for number_of, s in found:
            assert interval.holds(number_of, s)
        whole = places_in(curve, None)
        assert {number_of for number_of, _ in whole} == {0, 1, 2}
        for number_of, s in whole:
            assert chain.stretches[number_of].entered < s < chain.stretches[number_of].leaves
