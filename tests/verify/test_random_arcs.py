"""Arcs of random pieces with several proved intervals: ranges hold each of their orbits, and little more; graphs."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.chain_cases import alone, certificate, circle, circle_point, loop, stands, symmetric_arc, symmetric_loop
from support.conclusions import conclude
from support.random_pieces import coordinates, corners, random_piece, random_run, values
from support.within import within

from orbitproof.shared.claims import Claim
from orbitproof.shared.claims.web import BRANCHES, ENDS, LIBRATION_POINTS, PASSES, Meeting, Web, WebArc
from orbitproof.shared.systems import record
from orbitproof.verify.branches.results import covers
from orbitproof.verify.curve import PlaceOnCurve, is_inside_curve
from orbitproof.verify.curve.gluing import Chain, Stretch
from orbitproof.verify.curve.proved_curve import times_of
from orbitproof.verify.curve.proved_intervals import Run
from orbitproof.verify.curve.tube import Tube
from orbitproof.verify.evidence import NotProved, Proved, enclose
from orbitproof.verify.web import Arc, Incidence, IndexOnArc, Indices, Switch, conclude_web, level_at, proved_web
from orbitproof.verify.web.proved_web import parts_of

BITS = 192

precision = within(lambda: ctx.workprec(BITS))


def random_chain(chance: random.Random, size: int, times: bool = True) -> Chain:
    """Three pieces, each run along from a place between its first two intervals or before, to one in another."""
    stretches = []
    for index in range(3):
        run = random_run(chance, size, 2**9)
        if times:
            run = Run(tuple(replace(part, time=arb(chance.randint(1, 40), 0.125)) for part in run.intervals))
        tube = Tube(random_piece(chance, size, name=f"p{index}"), (run,))
        enters = Fraction(chance.randint(-32, -9), 32)
        leaves = Fraction(chance.randint(1, 32), 32)
        stretches.append(Stretch(tube, run, enters, enters + Fraction(chance.randint(0, 4), 64), leaves))
    return Chain(tuple(stretches), ())


def random_orbits(chance: random.Random, chain: Chain, count: int) -> Iterator[list[Fraction]]:
    """Points of one of the curves that may be meant: as far off the polynomials as is allowed; ends, parts and all."""
    for stretch in chain.stretches:
        piece = stretch.tube.piece
        for part, first, last in stretch.run.between(stretch.enters, stretch.leaves):
            for share in (0, 1, *(Fraction(chance.randint(0, 64), 64) for _ in range(count))):
                s = first + (last - first) * share
                # Where two intervals overlap both bounds hold.
                known = [each for each in stretch.run.intervals if each.start <= s <= each.end]
                least = [min(bound) for bound in zip(*(each.deviation for each in known), strict=True)]
                assert part in known
                across = (values(c, s) + e for c, e in zip(piece.polynomial, corners(least, chance), strict=True))
                yield coordinates(piece, [piece.half_width * s, *across])


def system_of(size: int, family: str | None) -> Any:
    """Of which the first integral is x_0 m - x_1^2/2 + n (x_last - x_0 x_1) + v, with v = 0 on Fix(R) and n = 3."""
    state = tuple(f"x{index}" for index in range(size + 1))
    integral = record(
        lambda s, p: (s[0] * p[0] - s[1] ** 2 / 2 + s[-1] * (s[size] - s[0] * s[1]) + s[-2],),
        (*state, "v", "n"),
        ("m",),
    )
    return SimpleNamespace(
        state=(*state, "v", "n"), normalised={"n": Fraction(3)}, family_parameter=family, defined=(),
        first_integral_program=integral, centre_coordinates=state, derived_parameters={},
    )  # fmt: skip


M = Fraction(5, 7)


@pytest.mark.parametrize("family", [None, "x1"])
@pytest.mark.parametrize("size", [1, 2])
def test_the_levels_of_an_arc_hold_those_of_all_its_orbits_and_little_more(size: int, family: str | None) -> None:
    chance, system = random.Random(size), system_of(size, family)

    def level(x: Sequence[Fraction]) -> Fraction:
        return x[1] if family else x[0] * M - x[1] ** 2 / 2 + 3 * (x[size] - x[0] * x[1])

    for _ in range(3):
        chain = random_chain(chance, size)
        atlas: Any = SimpleNamespace(system=system, parameters={"m": M})
        curve: Any = SimpleNamespace(chain=chain, birth=None)
        found, orbits = Arc(atlas, curve).levels(), list(random_orbits(chance, chain, 6))
        true = [level(point) for point in orbits]
        assert all(agree(found, enclose(value)) for value in true)
        for point, value in zip(orbits, true, strict=True):
            at = level_at(atlas, dict(zip(system.centre_coordinates, map(enclose, point), strict=True)))
            assert agree(at, enclose(value))
            assert at.rad() < arb(2) ** -100
        reach = enclose(max(true) - min(true)) / 2
        assert found.rad() < reach * arb("1.5")


def test_the_levels_of_an_arc_are_those_of_every_interval_of_every_piece() -> None:
    """Over one part of one of them alone the level is another one."""
    chance, names = random.Random(0), ("x0", "x1")
    for place in range(3):
        chain = random_chain(chance, 1)
        stretch = chain.stretches[place]
        piece = stretch.tube.piece
        for _, first, last in stretch.run.between(*between(stretch)):
            s = first + (last - first) * Fraction(chance.randint(1, 63), 64)
            exact = coordinates(piece, [piece.half_width * s, values(piece.polynomial[0], s)])
            balls = list(map(enclose, exact))

            def level(_: Any, point: Any, balls: list[arb] = balls) -> arb:
                return arb(all(agree(point[name], x) for name, x in zip(names, balls, strict=True)))

            atlas: Any = SimpleNamespace(system=SimpleNamespace(centre_coordinates=names), parameters={})
            curve: Any = SimpleNamespace(chain=chain, birth=None)
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr("orbitproof.verify.web.arc.level_at", level)
                assert Arc(atlas, curve).levels().contains(1)


def between(stretch: Stretch) -> tuple[Fraction, Fraction]:
    return stretch.enters, stretch.leaves


def test_times_of_a_curve_are_those_of_the_intervals_that_it_runs_along() -> None:
    chance = random.Random(0)
    for _ in range(30):
        chain = random_chain(chance, 1)
        met = [
            part.time
            for stretch in chain.stretches
            for part in stretch.run.intervals
            if part.start <= stretch.leaves and stretch.enters <= part.end
        ]
        found = times_of(chain)
        assert all(found.contains(time) for time in met)
        low, high = min(time.lower() for time in met), max(time.upper() for time in met)
        assert agree(found, low)
        assert agree(found, high)
        assert abs(found.rad() - (high - low) / 2) < arb(2) ** -20
        atlas: Any = SimpleNamespace(system=SimpleNamespace(derived_parameters={}))
        arc = Arc(atlas, SimpleNamespace(half_period=found, birth=None))  # type: ignore[arg-type]
        assert all(arc.period.contains(2 * time) for time in met)
        assert arc.period.rad() < (high - low) * arb("1.0001")
        # One that is not known, anywhere on the way.
        place = chance.randrange(3)
        stretch = chain.stretches[place]
        unknown = chance.choice(stretch.run.between(*between(stretch)))[0]
        parts = [replace(part, time=arb("nan")) if part is unknown else part for part in stretch.run.intervals]
        others = list(chain.stretches)
        others[place] = replace(stretch, run=Run(tuple(parts)))
        assert not times_of(Chain(tuple(others), ())).is_finite()


def test_what_covers_an_interval_is_what_leaves_no_number_out() -> None:
    chance = random.Random(0)
    answers = set()
    for _ in range(400):
        pairs = [sorted(chance.sample(range(-8, 9), 2)) for _ in range(chance.randint(0, 5))]
        low, high = sorted(chance.sample(range(-8, 9), 2))
        # Every whole number, and one between each two of them.
        places = [Fraction(n, 2) for n in range(2 * low, 2 * high + 1)]
        wanted = all(any(a <= place <= b for a, b in pairs) for place in places)
        found = covers([(Fraction(a), Fraction(b)) for a, b in pairs], (Fraction(low), Fraction(high)))
        assert found == wanted, (pairs, low, high)
        answers.add(found)
    assert answers == {True, False}


# Graphs.


def random_web(chance: random.Random) -> Web:
    vertices = [*(f"v{number}" for number in range(6)), "L1"]
    arcs = [
        WebArc(f"a{number}", tuple(Meeting(name, PASSES) for name in chance.sample(vertices, chance.randint(0, 3))))
        for number in range(chance.randint(1, 7))
    ]
    chance.shuffle(arcs)
    return Web("w", "w", tuple(arcs))


def test_arcs_hang_together_if_a_way_along_common_vertices_leads_from_one_to_the_other() -> None:
    chance = random.Random(0)
    for _ in range(200):
        web = random_web(chance)
        own = {arc.id: {meeting.vertex for meeting in arc.meets} for arc in web.arcs}
        names, parts = [arc.id for arc in web.arcs], parts_of(web)
        assert sorted(name for part in parts for name in part) == sorted(names)
        reached = {name: {name} for name in names}
        for _ in names:
            for one, other in combinations(names, 2):
                if own[one] & own[other]:
                    both = reached[one] | reached[other]
                    reached[one] = reached[other] = both
        for part in parts:
            assert all(reached[name] == set(part) for name in part)
            assert list(part) == sorted(part, key=names.index)
        assert [part[0] for part in parts] == sorted((part[0] for part in parts), key=names.index)


def random_meetings(chance: random.Random, names: Sequence[str]) -> list[Incidence]:
    pairs = [(arc, vertex) for arc in names for vertex in ("u", "v", "w")]
    chosen = chance.sample(pairs, 6)
    return [
        Incidence(
            arc, vertex, chance.choice([BRANCHES, PASSES, ENDS]),
            chance.choice([None, PlaceOnCurve("p", arb(0), False), PlaceOnCurve("p", arb(0), False, True)]),
        )
        for arc, vertex in chosen
    ]  # fmt: skip


def test_an_arc_switches_where_it_branches_off_and_a_planar_one_passes_at_the_same_point(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chance, names, planar = random.Random(0), ["a", "b", "c", "d"], {"a", "c"}
    arcs: Any = [
        SimpleNamespace(id=name, atlas=SimpleNamespace(system="planar" if name in planar else "spatial"))
        for name in names
    ]
    monkeypatch.setattr(proved_web, "is_planar", lambda system: system == "planar")
    seen = 0
    for _ in range(200):
        meetings = random_meetings(chance, names)
        wanted = {
            Switch(onto.vertex, along.arc, onto.arc)
            for onto in meetings
            for along in meetings
            if (onto.how, along.how, onto.vertex) == (BRANCHES, PASSES, along.vertex)
            and along.arc in planar
            and not (along.place is not None and along.place.other_point)
        }
        found = proved_web._switches(arcs, meetings)
        assert set(found) == wanted
        assert len(found) == len(wanted)
        seen += len(found)
    assert seen > 20


CURVES: Mapping[str, Any] = {
    "arc": circle(Claim("arc"), [0.3, 0.8, 1.3]),
    "symmetric-arc": symmetric_arc(),
    "symmetric-loop": symmetric_loop(),
    "loop": loop(),
}


@pytest.mark.parametrize("kind", CURVES)
def test_the_ends_of_a_curve_are_ends_if_it_is_not_closed(kind: str) -> None:
    """That of a symmetric arc at which it begins is none: there it goes on, as its mirror image."""
    atlas, results = CURVES[kind]
    assert atlas.claim.kind == kind
    outcome = conclude(atlas, results, (), stands, alone).outcome
    assert isinstance(outcome, Proved)
    stretches = outcome.results.chain.stretches
    near = Fraction(1, 2**20)
    for index, stretch in enumerate(stretches):
        for s, at_end in (
            (stretch.entered, index == 0 and kind == "arc"),
            (stretch.entered + near, False),
            (stretch.leaves - near, False),
            (stretch.leaves, index == len(stretches) - 1 and kind in ("arc", "symmetric-arc")),
        ):
            for ball in (enclose(s), enclose(s) + arb(0, 1) * enclose(near / 2)):
                place = PlaceOnCurve(stretch.tube.piece.id, ball, False)
                assert is_inside_curve(atlas, outcome.results.chain, place) != at_end, (index, s)


def arc_of(case: Any, name: str, *vertices: Any) -> Arc:
    atlas, results = case
    conclusion = conclude(replace(atlas, id=name), results, vertices, stands, alone)
    assert isinstance(conclusion.outcome, Proved)
    return Arc(replace(atlas, id=name), conclusion.outcome.results, "", {e.id: e for e in conclusion.bifurcations})


def claimed(meets: Mapping[str, str | None], **changes: Any) -> Web:
    arcs = (WebArc(name, (Meeting(vertex, PASSES),) if vertex else ()) for name, vertex in meets.items())
    return replace(Web("w", "w", tuple(arcs), connected=False), **changes)


def why_not(web: Web, *arcs: Arc) -> str:
    outcome = conclude_web(web, arcs)
    assert isinstance(outcome, NotProved)
    return f"{outcome.reason.condition}: {outcome.reason.message}"


def other_pieces(case: Any, more: int) -> Any:
    """The same curve, written otherwise: with further coefficients, which are 0."""
    atlas, results = case
    zeros = (Fraction(0),) * more
    pieces = tuple(
        replace(piece, polynomial=tuple(row + zeros for row in piece.polynomial)) for piece in atlas.curve_pieces()
    )
    return replace(atlas, pieces=pieces), results


def test_every_arc_is_compared_with_every_other_one() -> None:
    """A fault of any one of four is noticed: equations, parameters, pieces, and what is proved of it."""
    names = ("a", "b", "c", "d")
    good = [arc_of(other_pieces(symmetric_loop(), more), name) for more, name in enumerate(names)]
    web = claimed(dict.fromkeys(names))
    assert isinstance(conclude_web(web, good), Proved)
    for place, name in enumerate(names):
        arc = good[place]
        heavier = replace(arc.atlas, parameters={"mu": arc.atlas.parameters["mu"] * 2})
        # The same states and the same field, at another level.
        elsewhere = replace(
            arc.atlas, system=replace(arc.atlas.system, name="other", first_integral=lambda s, p: (s[0],))
        )
        for change, why in (
            ({"atlas": heavier}, "equations: "),
            ({"atlas": elsewhere}, "equations: "),
            ({"problem": "it does not stand"}, "arcs: "),
            ({"curve": None}, "arcs: "),
        ):
            arcs = [*good[:place], replace(arc, **change), *good[place + 1 :]]  # type: ignore[arg-type]
            assert why_not(web, *arcs).startswith(why), (name, why)
    for first, last in combinations(range(4), 2):
        arcs = list(good)
        arcs[last] = replace(good[last], atlas=replace(good[first].atlas, id=names[last]))
        assert "have a piece in common" in why_not(web, *arcs)


@pytest.mark.parametrize("change", [{"k": 3}, {"kind": "touch_and_go"}])
def test_one_name_is_the_name_of_one_vertex(change: dict[str, Any]) -> None:
    vertex = certificate(circle_point(0.7), name="v")
    arcs = [arc_of(other_pieces(symmetric_loop(), more), name, vertex) for more, name in enumerate("abc")]
    web = claimed(dict.fromkeys("abc", "v"), connected=True)
    outcome = conclude_web(web, arcs)
    assert isinstance(outcome, Proved)
    (found,) = outcome.results.vertices
    # Its level lies in what each of the arcs says of it.
    for arc in arcs:
        assert agree(level_at(arc.atlas, arc.placed["v"].point), found.level)
    for place in range(3):
        entry = replace(arcs[place].placed["v"], **change)
        others = [*arcs[:place], replace(arcs[place], placed={"v": entry}), *arcs[place + 1 :]]
        assert "meets another vertex called v" in why_not(web, *others)


def test_the_level_of_a_vertex_is_what_all_arcs_say_of_it_and_two_that_touch_may_be_one() -> None:
    one, other = (certificate(circle_point(angle), name=name) for angle, name in ((0.7, "u"), (1.1, "v")))
    arcs = [arc_of(other_pieces(symmetric_loop(), more), name, one, other) for more, name in enumerate("ab")]
    meets = tuple(Meeting(name, PASSES) for name in ("u", "v"))
    web = Web("w", "w", (WebArc("a", meets), WebArc("b", meets)))
    exact = (arb(3), arb(5))

    def proved(levels: Mapping[tuple[int, str], arb]) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(
                "orbitproof.verify.web.proved_web.level_at",
                lambda atlas, point: levels["ab".index(atlas.id), "u" if point["x"] > arb("0.6") else "v"],
            )
            return conclude_web(web, arcs)

    wide = {(0, "u"): arb(3.5, 0.5), (1, "u"): arb(2.5, 0.5), (0, "v"): arb(5, 1), (1, "v"): arb(5.25, 0.25)}
    outcome = proved(wide)
    assert isinstance(outcome, Proved)
    for vertex, level in zip(outcome.results.vertices, exact, strict=True):
        assert vertex.level.contains(level)
        assert vertex.level.rad() < 0.26
    # Balls that touch in one number: it may be the level of both.
    touching = {**dict.fromkeys(wide, arb(3.5, 0.5)), (0, "v"): arb(4.5, 0.5), (1, "v"): arb(4.5, 0.5)}
    outcome = proved(touching)
    assert isinstance(outcome, NotProved)
    assert "may be the same orbit" in outcome.reason.message


def test_an_index_is_known_of_each_arc_of_which_that_is_claimed() -> None:
    chance = random.Random(0)
    good = [arc_of(other_pieces(symmetric_loop(), more), name) for more, name in enumerate("abc")]
    orbit = IndexOnArc((3,), "p000", Fraction(1, 2))
    known = [
        (Indices("d", (orbit,)), True), (Indices("d", (orbit,), problem="it does not stand"), False),
        (Indices("d"), False), (None, False),
    ]  # fmt: skip
    seen = set()
    for _ in range(60):
        claims = [chance.random() < 0.5 for _ in good]
        given = [chance.choice([known[0], *known]) for _ in good]
        arcs = [replace(arc, indices=indices) for arc, (indices, _) in zip(good, given, strict=True)]
        named = (WebArc(arc.id, (), claim) for arc, claim in zip(good, claims, strict=True))
        web = Web("w", "w", tuple(named), connected=False)
        wanted = all(stands for claim, (_, stands) in zip(claims, given, strict=True) if claim)
        outcome = conclude_web(web, arcs)
        assert isinstance(outcome, Proved) == wanted
        if isinstance(outcome, Proved):
            for arc, claim, (indices, _) in zip(outcome.results.arcs, claims, given, strict=True):
                assert arc.indices == (indices if claim else None)
        seen.add((wanted, *claims))
    assert len(seen) > 9


def test_the_names_of_libration_points_are_those_of_no_orbits() -> None:
    vertex = certificate(circle_point(0.7), name="v")
    arc = arc_of(symmetric_loop(), "a", vertex)
    for name in LIBRATION_POINTS:
        assert why_not(claimed({"a": name}), replace(arc, placed={name: arc.placed["v"]})).startswith("meetings: ")
