"""Conditions on the index along a curve, with orbits, lists and angles at random: each holds if its definition does."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.within import within

from orbitproof.shared.systems import CR3BP, CR3BP_PLANAR
from orbitproof.verify.branches import index as stored_index
from orbitproof.verify.evidence import Checklist, NotEstablishedError
from orbitproof.verify.index import CountedOrbit, HalfTurns, proved_index
from orbitproof.verify.stability import Bound, Kind

precision = within(lambda: ctx.workprec(128))


def holds(check: Callable[..., object], *arguments: Any) -> bool:
    try:
        check(Checklist(), *arguments)
    except NotEstablishedError:
        return False
    return True


def turns(chance: random.Random, planes: int, index: int | None = None) -> HalfTurns:
    """Of an index; of the angles nothing is asked here."""
    fixed = chance.randint(-3, 3)
    negated = chance.randint(-3, 3) if index is None else index - planes - fixed
    return HalfTurns(fixed, negated, planes, (arb(0), arb(0)))


def orbit_of(chance: random.Random, *indices: int) -> CountedOrbit:
    planes = 2 if len(indices) == 1 else 1
    return CountedOrbit("p", Fraction(0), tuple(turns(chance, planes, index) for index in indices))


def test_the_index_of_an_orbit_is_the_sum_over_its_parts_of_turns_and_dimensions() -> None:
    chance = random.Random(0)
    for _ in range(40):
        parts = [turns(chance, planes) for planes in chance.choice([(1, 1), (2,)])]
        orbit = CountedOrbit("p", Fraction(0), tuple(parts))
        assert orbit.index == sum(part.fixed + part.negated + part.planes for part in parts)


@pytest.mark.parametrize("blocks", [1, 2])
def test_neighbours_differ_by_one_at_each_point_of_the_list_in_its_own_block(blocks: int) -> None:
    chance, seen = random.Random(blocks), set()
    for _ in range(300):
        points = [SimpleNamespace(kind=chance.choice([Kind.FOLD, Kind.SYMMETRIC])) for _ in range(3)]
        across = points[1:2] if blocks == 2 else []
        found: Any = SimpleNamespace(
            across=None if blocks == 1 else SimpleNamespace(found=SimpleNamespace(points=across))
        )
        bounds: list[Any] = [
            SimpleNamespace(point=chance.choice([point, point, point, None]), is_one_point=chance.random() < 0.9)
            for point in points
        ]
        ends = [object(), *bounds, object()]
        intervals: Any = [SimpleNamespace(begin=begin, end=end) for begin, end in pairwise(ends)]
        indices = [[chance.randint(0, 6) for _ in range(blocks)]]
        wrong = False
        for bound in bounds:
            known = bound.point is not None and bound.is_one_point and bound.point.kind is not Kind.SYMMETRIC
            own = [0] * blocks
            own[1 if any(bound.point is point for point in across) else 0] = 1
            step = [chance.choice([-1, 1]) * size for size in own]
            if chance.random() < 0.2:
                step[chance.randrange(blocks)] += chance.choice([-2, -1, 1, 2, 4])
            wrong = wrong or (known and [abs(each) for each in step] != own)
            indices.append([a + b for a, b in zip(indices[-1], step, strict=True)])
        orbits = [orbit_of(chance, *each) for each in indices]
        assert holds(proved_index._check_neighbours, found, intervals, orbits) != wrong
        seen.add(wrong)
    assert seen == {True, False}


def test_the_parity_of_an_index_is_that_of_the_sign_of_its_own_block() -> None:
    """det(1 - Sigma) is positive where index and dimension differ by an even number."""
    chance, seen = random.Random(0), set()
    for _ in range(200):
        blocks = chance.choice([1, 2])
        signs = [chance.choice([-1, 1]) for _ in range(blocks)]
        radius = chance.choice([0, 0, 0, 2])
        lists = [
            SimpleNamespace(segments=[_Segment(arb(3 * sign, 2 * radius if block == 0 else 0))])
            for block, sign in enumerate(signs)
        ]
        found: Any = SimpleNamespace(found=lists[0], across=None if blocks == 1 else SimpleNamespace(found=lists[1]))
        curve: Any = SimpleNamespace(
            chain=SimpleNamespace(
                stretches=[
                    SimpleNamespace(
                        tube=SimpleNamespace(piece=SimpleNamespace(id="p")), entered=Fraction(-1), leaves=Fraction(1)
                    )
                ]
            )
        )
        indices = [chance.randint(0, 7) for _ in range(blocks)]
        planes = 2 if blocks == 1 else 1
        right = all(((index - planes) % 2 == 0) == (sign > 0) for index, sign in zip(indices, signs, strict=True))
        wanted = right and not radius
        orbits = [orbit_of(chance, *indices)]
        assert holds(proved_index._check_parity, curve, found, orbits) == wanted
        seen.add(wanted)
    assert seen == {True, False}


class _Segment:
    """On all of the stretch 0, with a function that is constant."""

    stretch, start, entered, end = 0, Fraction(-1), Fraction(-1), Fraction(1)

    def __init__(self, value: arb) -> None:
        self.value = value

    def at(self, c: arb) -> Any:
        assert c == 1
        return SimpleNamespace(value=lambda _: self.value)

    def tau(self, s: Fraction) -> Fraction:
        return s


@pytest.mark.parametrize("system", [CR3BP, CR3BP_PLANAR], ids=["spatial", "planar"])
def test_half_turns_are_those_of_every_angle_strictly(system: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of each of both planes, of each block, of each orbit: m < angle < m + n."""
    chance, seen = random.Random(0), set()
    monkeypatch.setattr(proved_index, "stretch_of", lambda *_: 0)
    monkeypatch.setattr(proved_index, "start_at", lambda *_: True)
    atlas: Any = SimpleNamespace(system=system)
    curve: Any = SimpleNamespace(chain=SimpleNamespace(stretches=[None]))
    kinds = (1, 1) if system is CR3BP_PLANAR else (2,)
    little = arb(2) ** -40
    for _ in range(150):
        orbits, right = [], True
        for _ in range(chance.randint(1, 3)):
            parts = []
            for planes in kinds:
                numbers, angles = [], []
                for _ in range(2):
                    m = chance.randint(-2, 4)
                    place = chance.choice(["in"] * 12 + ["low", "high", "below", "above", "wide"])
                    angle = {
                        "in": m + chance.choice([little, planes - little, arb(planes) / 2]),
                        "low": arb(m), "high": arb(m + planes), "below": m - little, "above": m + planes + little,
                        "wide": arb(m + planes, 0.25),
                    }[place]  # fmt: skip
                    right = right and place == "in"
                    numbers.append(m)
                    angles.append(arb(angle))
                parts.append(HalfTurns(numbers[0], numbers[1], planes, (angles[0], angles[1])))
            orbits.append(CountedOrbit("p", Fraction(len(orbits), 4), tuple(parts)))
        assert holds(proved_index._check_counts, atlas, curve, None, (), orbits, "") == right
        seen.add(right)
    assert seen == {True, False}
    other = (1,) if system is CR3BP_PLANAR else (1, 1)
    wrong = CountedOrbit("p", Fraction(0), tuple(HalfTurns(0, 0, n, (arb("0.5"), arb("0.5"))) for n in other))
    assert not holds(proved_index._check_counts, atlas, curve, None, (), [wrong], "")
    assert not holds(proved_index._check_counts, atlas, curve, None, (), [], "")
    assert not holds(proved_index._check_counts, atlas, curve, None, (), orbits, "the certificate does not stand")


def test_half_turns_are_those_of_orbits_of_the_curve_each_in_its_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    """A place beside the curve, a point at rest and a place in another interval have none."""
    chance, seen = random.Random(1), set()
    stretches = {"on": 0, "rest": 1, "off": None}
    monkeypatch.setattr(proved_index, "stretch_of", lambda curve, piece, s: stretches[piece])
    monkeypatch.setattr(proved_index, "start_at", lambda atlas, stretch, s: None if stretch == "at rest" else True)
    atlas: Any = SimpleNamespace(system=CR3BP)
    curve: Any = SimpleNamespace(chain=SimpleNamespace(stretches=["moves", "at rest"]))
    half = arb("0.5")
    for _ in range(60):
        count = chance.randint(1, 3)
        pieces = [chance.choice(["on"] * 6 + ["rest", "off"]) for _ in range(count)]
        inside = [chance.random() < 0.9 for _ in range(count)]
        turns = HalfTurns(0, 0, 2, (half, half))
        orbits = [CountedOrbit(piece, Fraction(number, 4), (turns,)) for number, piece in enumerate(pieces)]
        intervals: Any = [SimpleNamespace(holds=lambda stretch, s, each=each: each) for each in inside]
        counted, listed = set(pieces) == {"on"}, set(inside) == {True}
        assert holds(proved_index._check_counts, atlas, curve, None, (), orbits, "") == counted
        found: Any = SimpleNamespace(across=None)
        checked = holds(proved_index._check_counts, atlas, curve, found, intervals, orbits, "")
        assert checked == (counted and listed)
        seen |= {(counted, listed)}
    assert len(seen) == 4


def test_stored_ends_of_intervals_hold_the_places_between_which_the_index_is_known() -> None:
    """Which have as many digits as rational numbers have; the end of one interval is no end of another."""
    chance = random.Random(0)
    chain = SimpleNamespace(
        stretches=[SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id=name))) for name in ("p0", "p1")]
    )
    known: Any = SimpleNamespace(curve=SimpleNamespace(chain=chain))
    for _ in range(40):
        lower, upper = sorted(
            Fraction(chance.randint(-(10**9), 10**9), chance.randint(10**9, 10**10)) for _ in range(2)
        )
        stretch = chance.randrange(2)
        found = stored_index._listed(known, Bound(stretch, lower, upper, ()))
        assert found.piece == f"p{stretch}"
        assert found.interval[0] <= lower <= upper <= found.interval[1]
        assert max(lower - found.interval[0], found.interval[1] - upper) < Fraction(1, 2**59)
