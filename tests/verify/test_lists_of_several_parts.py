"""Lists of curves in several parts, with several zeros, gaps, certificates and arcs: each of them counts."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction as Q
from itertools import pairwise, permutations
from math import cos, pi
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.curve_sentences import of_curve

from orbitproof.shared.claims.web import Meeting, Web, WebArc
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Bifurcation, PlaceOnCurve
from orbitproof.verify.distances.ranges import Extreme, KnownDistances, PartOfInterval, Where
from orbitproof.verify.evidence import EmptyIntersectionError, enclose, exact_value, excludes_zero, up_to
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.stability import (
    BAND,
    CompleteList,
    Gap,
    Kind,
    Matter,
    Point,
    Resonance,
    Segment,
    StableInterval,
    extrema_on,
    left_open,
    may_change_stability,
    stable_intervals,
)
from orbitproof.verify.stability import complete_list as lists
from orbitproof.verify.stability.level import Level
from orbitproof.verify.stability.matching import with_certificates
from orbitproof.verify.stability.zeros import Zeros
from orbitproof.verify.web.proved_web import parts_of

STRETCHES = 4
ATLAS: Any = SimpleNamespace(system=SimpleNamespace(normalised={}, centre_coordinates=()))


@pytest.fixture(autouse=True)
def _precision(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(lists, "point_over", lambda stretch, s: ())
    with ctx.workprec(192):
        yield


Polynomial = list[Q]


def at(function: Polynomial, place: Q) -> Q:
    return sum((c * place**n for n, c in enumerate(function)), Q(0))


def along(function: Polynomial, middle: Q, radius: Q) -> BoundedFunction:
    """As a function of tau, place = middle + radius tau."""
    result = [Q(0)] * len(function)
    power = [Q(1)]
    for c in function:
        for n, each in enumerate(power):
            result[n] += c * each
        power = [
            middle * low + radius * high
            for low, high in zip([*power, Q(0)], [Q(0), *power], strict=True)
        ]  # fmt: skip
    return BoundedFunction(ball_polynomial(result), arb(0))


def distances(function: Polynomial, middle: Q, radius: Q, cut: Q) -> KnownDistances:
    """The least one grows and the greatest falls along the curve, in two parts."""
    ends = [Q(-1), cut, Q(1)]
    parts = tuple(
        PartOfInterval(
            low, high,
            *(
                Extreme((enclose(at(function, middle + radius * low)).union(
                    enclose(at(function, middle + radius * high)))) * factor, Where.ALONG)
                for factor in (1, 3)
            ),
        )
        for low, high in pairwise(ends)
    )  # fmt: skip
    known = along(function, middle, radius)
    return KnownDistances(known, known, parts)


class Known:
    """A curve in stretches of length 2, each of two or three segments, along which all functions are known."""

    def __init__(self, seed: int, factors: tuple[int, int] = (72, 80), parameter: Polynomial | None = None) -> None:
        chance = self.chance = random.Random(seed)
        # A stability parameter that goes from beyond -1 to beyond 1 and back again and again.
        factor, shift = Q(chance.randint(*factors), 64), Q(chance.choice((-3, -1, 1, 3)), 61)
        self.extremes = {STRETCHES * cos(pi * n / 5): float((-1) ** n * factor + shift) for n in range(1, 5)}
        chebyshev = [[Q(1)], [Q(0), Q(1, STRETCHES)]]
        for _ in range(4):
            twice = [Q(0), *(2 * c / STRETCHES for c in chebyshev[-1])]
            chebyshev.append([a - b for a, b in zip(twice, [*chebyshev[-2], Q(0), Q(0)], strict=True)])
        self.parameter = [factor * c for c in chebyshev[-1]]
        self.parameter[0] += shift
        self.parameter = parameter or self.parameter
        self.half_period = [Q(20), Q(chance.choice((-1, 1))), Q(chance.randint(-4, 4), 64)]
        self.square = [Q(10), Q(1)]
        stretches, segments, points, extrema = [], [], [], []
        for number in range(STRETCHES):
            piece = SimpleNamespace(id=f"p{number}")
            tube = SimpleNamespace(piece=piece, is_symmetric=False)
            stretch: Any = SimpleNamespace(tube=tube, enters=Q(-1), entered=Q(-1), leaves=Q(1))
            stretches.append(stretch)
            cuts = sorted(Q(chance.randint(-48, 48), 64) for _ in range(chance.choice((1, 2))))
            for low, high in pairwise([Q(-1), *cuts, Q(1)]):
                if low < high:
                    segments.append(self._segment(number, low, high))
                    finder = lists.Finder(ATLAS, stretch, segments[-1])
                    for k, j in lists.orders(6):
                        finder.resonances(k, j)
                    assert not finder.gaps
                    finder.turns()
                    points += finder.points
                    extrema += finder.extrema
        self.chain: Any = SimpleNamespace(stretches=stretches)
        self.found = CompleteList(6, 1, tuple(points), (), tuple(segments), tuple(extrema))

    def _segment(self, number: int, low: Q, high: Q) -> Segment:
        middle, radius = (low + high) / 2, (high - low) / 2 * Q(17, 16)
        there = 2 * number + 1 - STRETCHES + middle
        own = [along(each, there, radius) for each in (self.parameter, [Q(0), Q(1)], self.half_period)]
        cut = Q(self.chance.randint(-32, 32), 64)
        return Segment(
            number, low, low, high, middle, radius, (own[0],), own[1], own[2], own[1],
            distances(self.square, there, radius, cut),
        )  # fmt: skip

    @property
    def places(self) -> list[tuple[int, Q]]:
        """Stretch and s of places all along."""
        return [(number, Q(2 * n + 1, 64) - 1) for number in range(STRETCHES) for n in range(64)]

    @staticmethod
    def place(number: int, s: Q) -> Q:
        return 2 * number + 1 - STRETCHES + s


def is_in(entry: StableInterval, number: int, s: Q) -> bool:
    begin, end = entry.begin, entry.end
    return (begin.stretch, begin.upper) < (number, s) < (end.stretch, end.lower)


@pytest.mark.parametrize("seed", range(6))
def test_all_zeros_of_all_parts_are_listed(seed: int) -> None:
    known = Known(seed)
    places = [(0, Q(-1)), *known.places, (STRETCHES - 1, Q(1))]
    for k, j in lists.orders(6):
        value = cos(2 * pi * j / k)
        signs = [float(at(known.parameter, known.place(*each))) > value for each in places]
        crossed = [place for place, pair in zip(pairwise(places), pairwise(signs), strict=True) if pair[0] != pair[1]]
        points = [point for point in known.found.points if (point.k, point.j) == (k, j)]
        assert len(points) == len(crossed)
        for point, (before, after) in zip(points, crossed, strict=True):
            here = (point.stretch, float(point.s.mid()))
            assert (before[0], float(before[1])) <= here <= (after[0], float(after[1]))
            assert agree(point.half_period, enclose(at(known.half_period, known.place(*before))).union(
                enclose(at(known.half_period, known.place(*after)))))  # fmt: skip


@pytest.mark.parametrize("seed", range(20))
def test_all_extrema_of_all_parts_are_listed_but_for_those_beyond_the_band(seed: int) -> None:
    known = Known(seed, (56, 80))
    expected = {place: value for place, value in known.extremes.items() if abs(value) < BAND}
    assert len(known.found.extrema) == len(expected)
    for entry, place in zip(known.found.extrema, sorted(expected), strict=True):
        assert entry.in_band
        assert float(known.place(entry.stretch, Q(0))) + float(entry.s.mid()) == pytest.approx(place)
        assert float(entry.value.mid()) == pytest.approx(expected[place])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("open_places", [0, 3])
def test_orbits_are_stable_where_all_parts_say_so_and_between_their_ranges(seed: int, open_places: int) -> None:
    known = Known(seed)
    chance, subjects = known.chance, [Matter.EVERYTHING, Matter.COLLISION, Resonance(1, 0), Resonance(2, 1)]
    gaps = []
    for number in chance.sample(range(STRETCHES), open_places):
        low = Q(chance.randint(-60, 50), 64)
        gaps.append(Gap(number, f"p{number}", low, low + Q(chance.randint(1, 8), 64), chance.choice(subjects), ""))
    harmless = [Gap(0, "p0", Q(-1, 2), Q(1, 2), subject, "") for subject in (Resonance(3, 1), Matter.EXTREMA)]
    assert not any(may_change_stability(gap.subject) for gap in harmless)
    found = replace(known.found, gaps=(*gaps, *harmless))
    stable, unknown = stable_intervals(known.chain, found, False)
    assert len(stable) > 3
    for number, s in known.places:
        place = known.place(number, s)
        is_open = [gap for gap in gaps if gap.stretch == number and gap.start <= s <= gap.end]
        inside = [entry for entry in stable if is_in(entry, number, s)]
        if is_open:
            assert not inside
            (gap,) = is_open
            assert any(
                entry.begin is entry.end and gap.subject in entry.begin.what
                and entry.begin.lower <= gap.start and gap.end <= entry.begin.upper and entry.begin.stretch == number
                for entry in unknown
            )  # fmt: skip
        else:
            assert bool(inside) == (abs(at(known.parameter, place)) < 1)
        for entry in inside:
            ranges = entry.ranges
            assert ranges is not None
            assert ranges.half_period.contains(enclose(at(known.half_period, place)).mid())
    for entry in stable:
        assert entry.ranges is not None
        first, last = (
            known.place(entry.begin.stretch, entry.begin.lower),
            known.place(entry.end.stretch, entry.end.upper),
        )
        # The least of a part is at its first orbit, the greatest at its last.
        least, greatest = entry.ranges.least, entry.ranges.greatest
        assert least is not None
        assert greatest is not None
        assert least.square.contains(enclose(at(known.square, first)).mid())
        assert greatest.square.contains(enclose(3 * at(known.square, last)).mid())


@pytest.mark.parametrize("seed", range(12))
def test_a_loop_goes_on_over_the_place_where_it_is_cut_unless_something_is_open_there(seed: int) -> None:
    """All orbits are stable but for those beside gaps, of which some reach an end."""
    known, chance = Known(seed, parameter=[Q(3, 7)]), random.Random(seed)
    last = STRETCHES - 1
    inner = [Gap(n, f"p{n}", Q(-1, 4), Q(1, 4), Matter.COLLISION, "") for n in chance.sample(range(STRETCHES), 2)]
    beginning = Gap(0, "p0", Q(-1), Q(-3, 4), Matter.EVERYTHING, "")
    end = Gap(last, f"p{last}", Q(3, 4), Q(1), Resonance(1, 0), "")
    for at_ends in ([], [beginning], [end], [beginning, end]):
        found = replace(known.found, gaps=(*inner, *at_ends))
        stable, unknown = stable_intervals(known.chain, found, True)
        opened, _ = stable_intervals(known.chain, found, False)
        assert len(opened) == 3
        assert len(unknown) == 2 + len(at_ends)
        assert len(stable) == (2 if not at_ends else 3)
        if not at_ends:
            assert (stable[0].begin, stable[0].end) == (opened[-1].begin, opened[0].end)
            assert stable[0].pieces == (opened[-1].pieces[0], opened[0].pieces[1])
            ranges, parts = stable[0].ranges, [entry.ranges for entry in (opened[-1], opened[0])]
            assert ranges is not None
            assert all(part is not None and ranges.half_period.contains(part.half_period) for part in parts)


@pytest.mark.parametrize("seed", range(10))
def test_of_many_stationary_points_each_is_found_or_open(seed: int) -> None:
    """Simple zeros of the derivative are found, double ones and that at the joint are open."""
    chance = random.Random(seed)
    places = sorted(Q(n, 16) for n in chance.sample(range(-12, 13, 3), 5))
    double = chance.sample(places, 3)
    slope = [Q(1)]
    for root in (*places, *double):
        slope = [a - root * b for a, b in zip([Q(0), *slope], [*slope, Q(0)], strict=True)]
    trace = [Q(chance.randint(-8, 8), 16), *(c / (n + 1) for n, c in enumerate(slope))]
    entered = places[0] + Q(1, 32)
    flat = along([Q(1)], Q(0), Q(1))
    ends = places[0] - Q(1, 32), entered, Q(15, 16)
    segment = Segment(0, *ends, Q(0), Q(1), (along(trace, Q(0), Q(1)),), flat, flat, flat)
    found, undecided = extrema_on(segment, 0)
    for root in places:
        parts = [part for part in undecided if part[0] <= root <= part[1]]
        near = [value for place, value in found if abs(float(place.mid()) - float(root)) < 1e-6]
        if root < entered or root in double:
            assert (len(parts), near) == (1, [])
        else:
            (value,) = near
            assert agree(value, enclose(at(trace, root)))
            assert parts == []


@pytest.mark.parametrize("seed", range(8))
def test_the_derivative_of_the_level_is_as_large_as_is_recorded_on_all_parts_of_a_piece(seed: int) -> None:
    chance, level = random.Random(seed), Level(of_curve("list"))
    least = {f"p{number}": (Q(chance.randint(1, 99), 100), Q(chance.randint(-60, 60), 64)) for number in range(3)}

    def gradient(_: Any, stretch: Any, low: Q, high: Q) -> list[arb]:
        size, place = least[stretch.tube.piece.id]
        away = enclose(low - place).union(enclose(high - place))
        square = away * away if excludes_zero(away) else up_to((away * away).abs_upper())
        return [enclose(size) + square, arb(0, 1)]

    level._gradient = gradient  # type: ignore[method-assign]
    flat = along([Q(1)], Q(0), Q(1))
    for number in range(3):
        stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id=f"p{number}")))
        ends = [Q(-1), *sorted(Q(chance.randint(-60, 60), 64) for _ in range(3)), Q(1)]
        parts = [Segment(number, low, low, high, Q(0), Q(1), (flat,), flat, flat, flat) for low, high in pairwise(ends)]
        chance.shuffle(parts)
        regular, gaps = level.regular(stretch, parts)
        assert [(part.start, part.end) for part in regular] == [(part.start, part.end) for part in parts]
        assert gaps == []
    (hypothesis,) = level.hypotheses
    for name, (size, _) in least.items():
        (bound,) = [ball for key, ball in hypothesis.enclosures.items() if f"on {name}," in key]
        assert 0 < float(bound.mid()) <= float(size) + 1e-12


def test_a_list_is_open_where_something_inside_is_undecided_and_not_at_the_ends_alone() -> None:
    inner = Q(-3, 4), Q(3, 4)
    ends, inside = ((Q(-1), Q(-3, 4)), (Q(3, 4), Q(1))), ((Q(-1), Q(-1, 2)), (Q(0), Q(1, 8)), (Q(5, 8), Q(1)))
    assert not left_open._is_open(Zeros((), ()), inner)
    assert not left_open._is_open(Zeros((), ends), inner)
    for each in inside:
        for undecided in ((each,), (ends[0], each), (each, ends[1])):
            assert left_open._is_open(Zeros((), undecided), inner)


@pytest.mark.parametrize("size", [1, 2])
@pytest.mark.parametrize("seed", range(3))
def test_a_list_has_all_that_is_found_or_open_on_each_of_its_parts(
    size: int, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    chance = random.Random(seed)

    def function() -> BoundedFunction:
        polynomial = [Q(chance.randint(-16, 16), 16) for _ in range(5)]
        return replace(along(polynomial, Q(0), Q(1)), error=arb(chance.choice((2**-6, 2**-3))))

    parts: dict[int, list[Segment]] = {}
    others: dict[int, list[Gap]] = {}
    stretches = []
    for number in range(3):
        tube = SimpleNamespace(piece=SimpleNamespace(id=f"p{number}", tube=(1,) * size), is_symmetric=False)
        stretches.append(SimpleNamespace(tube=tube))
        own = [[function() for _ in range(size + 3)] for _ in range(2)]
        ends = (Q(-7, 8), Q(-3, 4), Q(0)), (Q(0), Q(1, 16), Q(7, 8))
        parts[number] = [
            Segment(number, *places, Q(0), Q(1), tuple(each[:size]), *each[size:])
            for places, each in zip(ends, own, strict=True)
        ]
        others[number] = [Gap(number, f"p{number}", Q(-1), Q(n), Matter.EVERYTHING, f"{n}") for n in range(4)]
    level: Any = SimpleNamespace(regular=lambda stretch, found: (found, others[found[0].stretch][:2]), hypotheses=())
    monkeypatch.setattr(lists, "Level", lambda atlas: level)
    monkeypatch.setattr(lists, "segments_of", lambda number, stretch, results: (parts[number], others[number][2:]))
    chain: Any = SimpleNamespace(stretches=stretches)
    found = lists.complete_list(ATLAS, chain, (), 4, combinations=True)
    expected: dict[str, list[Any]] = {"gaps": [gap for each in others.values() for gap in each], "segments": []}
    for number, segments in parts.items():
        for segment in segments:
            finder, combiner = (lists.Finder(ATLAS, chain.stretches[number], segment) for _ in range(2))
            for k, j in lists.orders(4):
                finder.resonances(k, j)
            finder.collisions()
            finder.turns()
            combiner.combinations()
            expected["segments"].append(segment)
            for name in ("points", "gaps", "extrema", "open_extrema"):
                expected.setdefault(name, []).extend(getattr(finder, name))
            for name in ("points", "gaps"):
                expected.setdefault(f"combined {name}", []).extend(getattr(combiner, name))
    combined = found.combinations
    assert (combined is not None) == (size == 2)
    if combined is not None:
        assert sorted(map(repr, combined.points)) == sorted(map(repr, expected.pop("combined points")))
        assert sorted(map(repr, combined.open)) == sorted(map(repr, expected.pop("combined gaps")))
    for name in ("points", "gaps", "extrema", "open_extrema", "segments"):
        assert sorted(map(repr, getattr(found, name))) == sorted(map(repr, expected[name]))
    assert len({gap.stretch for gap in found.gaps if gap.subject is not Matter.EVERYTHING}) > 1
    places = [(gap.stretch, gap.start) for gap in found.gaps]
    assert places == sorted(places)
    for entries in (found.points, found.extrema):
        along_it = [(entry.stretch, exact_value(entry.s.lower())) for entry in entries]
        assert along_it == sorted(along_it)


@pytest.mark.parametrize("entered", [Q(-7, 8), Q(-1, 3), Q(1, 3), Q(7, 8)])
def test_where_the_level_is_stationary_the_list_is_open_and_its_parts_are_entered_as_before(entered: Q) -> None:
    level = Level(of_curve("list"))
    level._gradient = lambda program, stretch, low, high: [enclose(low).union(enclose(high))]  # type: ignore[method-assign]
    stretch: Any = SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id="p0")))
    flat = along([Q(1)], Q(0), Q(1))
    segment = Segment(0, Q(-1), entered, Q(1), Q(0), Q(1), (flat,), flat, flat, flat)
    parts, (gap,) = level.regular(stretch, [segment])
    assert gap.start <= 0 <= gap.end
    assert gap.end - gap.start < Q(1, 100)
    assert [(part.start, part.end) for part in parts] == [(Q(-1), gap.start), (gap.end, Q(1))]
    before, after = (part.entered for part in parts)
    assert (before, after) == ((entered, gap.end) if entered < 0 else (gap.start, entered))


@pytest.mark.parametrize("seed", range(8))
def test_each_certificate_is_with_the_point_that_it_is_about(seed: int) -> None:
    """Several on one point, none on others, beside gaps; each of all that are on no point is refused."""
    known, chance = Known(seed), random.Random(seed)
    points = [replace(point, kind=_certified(point)) for point in known.found.points]
    wanted: list[tuple[str, ...]] = [() for _ in points]
    entries = []
    for number in range(3 * len(points) // 2):
        at_point = chance.randrange(len(points))
        point, name = points[at_point], f"row-{number}"
        other_point = point.kind is Kind.THERE
        kind = "fold" if point.kind is Kind.FOLD else "period_tupling"
        entries.append(_entry(name, kind, point, other_point))
        wanted[at_point] = (*wanted[at_point], name)
    beside = [Gap(0, "p0", Q(-1), Q(-1), Resonance(7, 1), ""), Gap(9, "p9", Q(-1), Q(1), Matter.EVERYTHING, "")]
    near = [
        Gap(0, point.piece, s + share * Q(1, 2**40), s + (share + 1) * Q(1, 2**40), Resonance(point.k, 1), "")
        for point in points for s in [exact_value(point.s.mid())] for share in (-3, 2)
    ]  # fmt: skip
    assert [point.certificates for point in with_certificates(points, [*beside, *near], entries)] == wanted
    # Of two points that are not separated it is not known which one a certificate is about.
    twin = replace(points[0], s=points[0].s + arb(0, 2**-30))
    found = with_certificates([*points, twin], beside, entries)
    assert [point.certificates for point in found] == [(), *wanted[1:], ()]
    for entry in chance.sample(entries, 4):
        assert entry.place is not None
        away = replace(entry, place=replace(entry.place, s=entry.place.s + arb(2) ** -20))
        with pytest.raises(EmptyIntersectionError, match="is no zero"):
            with_certificates(points, beside, [*entries, away])
        here = Gap(0, entry.place.piece, Q(-1), Q(1), Resonance(entry.k, 1), "")
        found = with_certificates(points, [*beside, here], [*entries, away])
        hidden = {
            each.id for each in entries if each.place and (each.k, each.place.piece) == (entry.k, entry.place.piece)
        }
        expected = [tuple(name for name in names if name not in hidden) for names in wanted]
        assert [point.certificates for point in found] == expected


def _certified(point: Point) -> Kind:
    return Kind.FOLD if point.k == 1 else point.kind


def _entry(name: str, kind: str, point: Point, other_point: bool) -> Bifurcation:
    return Bifurcation(name, kind, point.k, PlaceOnCurve(point.piece, point.s, False, other_point), "", {})


@pytest.mark.parametrize("seed", range(20))
def test_arcs_hang_together_by_all_vertices_that_they_share(seed: int) -> None:
    chance = random.Random(seed)
    names = [f"a{number}" for number in range(8)]
    meets = {name: chance.sample([f"v{number}" for number in range(9)], chance.randint(0, 2)) for name in names}
    arcs = tuple(WebArc(name, tuple(Meeting(vertex, "passes through") for vertex in meets[name])) for name in names)
    near = {(one, other) for one, other in permutations(names, 2) if set(meets[one]) & set(meets[other])}
    expected: list[tuple[str, ...]] = []
    for name in names:
        if not any(name in part for part in expected):
            reached = {name}
            while more := {other for one, other in near if one in reached} - reached:
                reached |= more
            expected.append(tuple(each for each in names if each in reached))
    assert parts_of(Web("web", "a web", arcs)) == tuple(expected)


def test_parts_are_joined_in_any_order() -> None:
    """A chain of arcs, whichever is first."""
    for order in permutations(range(4)):
        arcs: Sequence[WebArc] = [
            WebArc(f"a{n}", tuple(Meeting(f"v{m}", "passes through") for m in (n, n + 1))) for n in order
        ]
        assert parts_of(Web("web", "a web", tuple(arcs))) == (tuple(arc.id for arc in arcs),)
