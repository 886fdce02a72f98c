"""Graphs of random polynomials as curves in pieces: what is proved of them is true, up to their ends, and no less."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb, ctx
from support.balls import agree
from support.chain_cases import MU, alone, certificate, circle_piece, proved, reversed_piece, stands
from support.conclusions import conclude
from support.random_pieces import number, values

from orbitproof.shared import format_exact
from orbitproof.shared.claims import Atlas, Claim, Covers, Piece
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN
from orbitproof.verify.curve import Conclusion, PieceLimits, ProvedCurve
from orbitproof.verify.curve import piece as piece_proof
from orbitproof.verify.evidence import Checklist, NotProved, Proved, ball_to_json, enclose
from orbitproof.verify.oracle import ORACLE

TUBE = Fraction(1, 2**16)
UNKNOWN = Fraction(1, 2**24)
SLOPE = Fraction(1, 2**20)
Polynomial = list[Fraction]


def random_polynomial(chance: random.Random) -> Polynomial:
    return [number(chance, 4), number(chance, 2), number(chance), number(chance) / 4]


def piece_over(chance: random.Random, graph: Polynomial, index: int, middle: Fraction, half: Fraction) -> Piece:
    """Of y = graph(beta), for beta from middle - half to middle + half, in a frame of its own."""
    turn, scale = number(chance), Fraction(chance.choice([-3, -1, 1, 2]), 2)
    coefficients = []
    for n in range(len(graph)):
        # Of (beta - middle)^n.
        at = values(graph, middle, n)
        for k in range(1, n + 1):
            at /= k
        coefficients.append(at * half**n)
    coefficients[0] = Fraction(0)
    coefficients[1] -= turn * half
    return Piece(
        f"p{index:03}",
        "regular",
        (middle, values(graph, middle)),
        ((Fraction(1), Fraction(0)), (turn, scale)),
        half,
        (tuple(c / scale for c in coefficients),),
        (TUBE,),
    )


def results_of(chance: random.Random, piece: Piece) -> list[dict[str, Any]]:
    """On intervals that overlap or touch, each with half periods of its own, one inside of another."""
    places = [Fraction(-1), *sorted(Fraction(n, 8) for n in chance.sample(range(-7, 8), 2)), Fraction(1)]
    ends = [(max(start - Fraction(chance.randint(0, 1), 64), Fraction(-1)), end) for start, end in pairwise(places)]
    ends.append((places[0], (places[0] + places[1]) / 2))
    return [
        proved(
            piece, format_exact(start), format_exact(end), deviation=[format_exact(UNKNOWN)],
            slope_deviation=[format_exact(SLOPE)], time=ball_to_json(arb(chance.randint(2, 30), 0.125)),
        )
        for start, end in ends
    ]  # fmt: skip


def random_arc(chance: random.Random, graph: Polynomial, **claim: Any) -> tuple[Atlas, list[dict[str, Any]]]:
    pieces: list[Piece] = []
    reached = Fraction(0)
    for index in range(chance.randint(2, 4)):
        half = Fraction(chance.randint(4, 12), 16)
        begin = reached - half * Fraction(chance.randint(2, 10), 16) if pieces else reached
        pieces.append(piece_over(chance, graph, index, begin + half, half))
        reached = begin + 2 * half
    results = [result for piece in pieces for result in results_of(chance, piece)]
    chance.shuffle(results)
    return Atlas("graph", "a graph", FALKNER_SKAN, {}, Claim("arc", None, **claim), tuple(pieces)), results


def ends_of(atlas: Atlas) -> tuple[Fraction, Fraction]:
    first, last = atlas.curve_pieces()[0], atlas.curve_pieces()[-1]
    return first.centre[0] - first.half_width, last.centre[0] + last.half_width


def concluded(atlas: Atlas, results: Any, *points: Any) -> Conclusion[ProvedCurve]:
    return conclude(atlas, results, points, stands, alone)


def holds(atlas: Atlas, results: Any) -> bool:
    return isinstance(concluded(atlas, results).outcome, Proved)


def at(beta: Fraction, y: Fraction, name: str) -> Any:
    little = arb(0, 1) * arb(2) ** -40
    with ctx.workprec(128):
        return certificate({"beta": enclose(beta) + little, "y": enclose(y) + little}, name=name)


@pytest.mark.parametrize("seed", range(8))
def test_a_graph_in_pieces_is_one_arc_from_end_to_end(seed: int) -> None:
    chance = random.Random(seed)
    graph = random_polynomial(chance)
    atlas, results = random_arc(chance, graph)
    begin, end = ends_of(atlas)
    outcome = concluded(atlas, results).outcome
    assert isinstance(outcome, Proved)
    curve = outcome.results
    with ctx.workprec(128):
        for name, beta in (("start", begin), ("end", end)):
            assert curve.ends[name]["beta"].contains(enclose(beta).mid())
            for sign in (1, -1):
                scale = atlas.curve_pieces()[0 if name == "start" else -1].frame[1][1]
                assert agree(curve.ends[name]["y"], enclose(values(graph, beta) + sign * UNKNOWN * scale))
            assert curve.ends[name]["y"].rad() < enclose(UNKNOWN * 2)
        reached = begin
        for stretch, piece in zip(curve.chain.stretches, atlas.curve_pieces(), strict=True):
            first, last = (piece.centre[0] + piece.half_width * s for s in (stretch.enters, stretch.leaves))
            # Each goes on where the one before it has ended.
            assert first <= reached < last
            assert abs(first - reached) < Fraction(1, 2**40)
            reached = last
        assert reached == end
        for joint, (one, other) in zip(curve.chain.joints, pairwise(atlas.curve_pieces()), strict=True):
            beta = one.centre[0] + one.half_width * joint.leaves
            assert agree(joint.enters, enclose((beta - other.centre[0]) / other.half_width))
            assert agree(joint.turn, enclose(one.half_width / other.half_width))


@pytest.mark.parametrize("seed", range(8))
def test_a_point_is_where_it_lies_on_the_graph_and_nowhere_else(seed: int) -> None:
    chance = random.Random(seed)
    graph = random_polynomial(chance)
    atlas, results = random_arc(chance, graph)
    begin, end = ends_of(atlas)
    least = min(abs(piece.frame[1][1]) for piece in atlas.curve_pieces())
    most = max(abs(piece.frame[1][1]) for piece in atlas.curve_pieces())
    length = end - begin
    inside = [begin + length * Fraction(chance.randint(1, 63), 64) for _ in range(5)]
    little = Fraction(1, 2**20)
    inside += [begin + little, end - little]
    points = [at(beta, values(graph, beta) + least * UNKNOWN / 2, f"on{n}") for n, beta in enumerate(inside)]
    beyond = [begin - little, end + little]
    points += [at(beta, values(graph, beta), f"beyond{n}") for n, beta in enumerate(beyond)]
    beside = [at(beta, values(graph, beta) + 2 * most * TUBE, f"beside{n}") for n, beta in enumerate(inside)]
    found = concluded(atlas, results, *points, *beside)
    assert isinstance(found.outcome, Proved)
    pieces = {piece.id: piece for piece in atlas.curve_pieces()}
    stretches = {stretch.tube.piece.id: stretch for stretch in found.outcome.results.chain.stretches}
    for entry, beta in zip(found.bifurcations, inside, strict=False):
        assert entry.place is not None, entry.reason
        piece, stretch = pieces[entry.place.piece], stretches[entry.place.piece]
        s = (beta - piece.centre[0]) / piece.half_width
        assert entry.place.s.contains(enclose(s).mid())
        assert stretch.enters <= s <= stretch.leaves
        assert (entry.place.mirrored, entry.place.other_point) == (False, False)
    assert all(entry.place is None for entry in found.bifurcations[len(inside) :])
    # In the tube, and farther off than the only orbit in it can be.
    off = at(inside[0], values(graph, inside[0]) + least * TUBE / 2, "off")
    outcome = concluded(atlas, results, off).outcome
    assert isinstance(outcome, NotProved)
    assert "contradict each other" in outcome.reason.message


def increasing(graph: Polynomial, begin: Fraction, end: Fraction) -> Fraction:
    """The least slope on an interval, exactly."""
    a, b, c = graph[1], 2 * graph[2], 3 * graph[3]
    places = [begin, end, *([-b / (2 * c)] if c and begin < -b / (2 * c) < end else [])]
    return min(a + b * t + c * t * t for t in places)


@pytest.mark.parametrize("seed", range(8))
def test_a_coordinate_increases_where_the_least_slope_of_the_graph_is_positive(seed: int) -> None:
    chance = random.Random(seed)
    graph = random_polynomial(chance)
    atlas, _ = random_arc(random.Random(seed + 100), graph)
    begin, end = ends_of(atlas)
    for margin in (Fraction(1, 2**8), -Fraction(1, 2**8)):
        other = list(graph)
        other[1] += margin - increasing(graph, begin, end)
        assert (increasing(other, begin, end) > 0) == (margin > 0)
        for names in (("beta", "y"), ("y",), ("y", "beta")):
            assert holds(*random_arc(random.Random(seed + 100), other, increasing=names)) == (margin > 0)
    assert holds(*random_arc(random.Random(seed + 100), graph, increasing=("beta",)))


@pytest.mark.parametrize("seed", range(4))
def test_a_range_is_covered_from_one_end_to_the_other_and_no_farther(seed: int) -> None:
    graph = random_polynomial(random.Random(seed))
    begin, end = ends_of(random_arc(random.Random(seed), graph)[0])
    little = Fraction(1, 2**60)
    for start, stop, wanted in (
        (begin, end, True), (begin + little, end - little, True), (begin - little, end, False),
        (begin, end + little, False),
    ):  # fmt: skip
        covers = Covers("beta", start, stop)
        assert holds(*random_arc(random.Random(seed), graph, covers=covers)) == wanted


@pytest.mark.parametrize("seed", range(6))
def test_one_flaw_of_any_piece_breaks_an_arc(seed: int) -> None:
    chance = random.Random(seed)
    atlas, results = random_arc(chance, random_polynomial(chance))
    assert holds(atlas, results)
    pieces = list(atlas.curve_pieces())
    for index, piece in enumerate(pieces):
        others = [result for result in results if result["piece"] != piece.id]
        assert not holds(atlas, others)
        # A gap in the middle, which the curve has to cross if no other piece is over it.
        bounds = {"deviation": [format_exact(UNKNOWN)], "slope_deviation": [format_exact(SLOPE)]}
        gap = [proved(piece, *ends, **bounds) for ends in (("-1", "-0x1p-10"), ("0x1p-10", "1"))]
        near = [other for other in pieces if abs(other.centre[0] - piece.centre[0]) <= other.half_width]
        if near == [piece]:
            assert not holds(atlas, [*others, *gap])
        assert holds(atlas, [*others, proved(piece, **bounds)])
        for change in (
            reversed_piece(piece),
            replace(piece, centre=(piece.centre[0], piece.centre[1] + 4 * TUBE * abs(piece.frame[1][1]))),
            replace(piece, half_width=-piece.half_width),
            replace(piece, frame=((Fraction(1), Fraction(0)), (piece.frame[1][0], Fraction(0)))),
        ):
            changed = replace(atlas, pieces=tuple(change if n == index else each for n, each in enumerate(pieces)))
            assert not holds(changed, results)
        wide = [{**result, "deviation": [format_exact(TUBE)]} for result in results if result["piece"] == piece.id]
        assert not holds(atlas, [*others, *wide])


@pytest.mark.parametrize("ends", [("1/4", "1"), ("-1", "-1/2"), ("1/8", "1/4"), ("-3/4", "-5/8")])
def test_slopes_of_a_symmetric_piece_are_divided_by_the_least_s_of_an_interval_beside_0(
    ends: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """|d'(s)| is 1 there, in units of the tube: |d'(s)/s| may be one over the s next to 0."""
    proof = piece_proof._Proof(
        CR3BP, {"mu": MU}, circle_piece(0, 0.0, "symmetric"), (Fraction(ends[0]), Fraction(ends[1])), ORACLE,
        PieceLimits(), "S",
    )  # fmt: skip
    half: Any = SimpleNamespace(time_of_all=arb(3))
    monkeypatch.setattr(piece_proof._Proof, "_half_return", lambda *_: half)
    monkeypatch.setattr(piece_proof._Proof, "_equations", lambda *_: [None, None])
    monkeypatch.setattr(piece_proof, "check_newton", lambda *_: ([arb(1) / 64] * 2, [arb(1)] * 2))
    found = proof.check_all(Checklist(), {}, None)
    least = min(abs(Fraction(end)) for end in ends)
    for bound, width in zip(found.slope_deviation, proof.tube, strict=True):
        assert width / least <= bound < width / least * Fraction(33, 32)
    for bound, width in zip(found.deviation, proof.tube, strict=True):
        assert width / 64 <= bound < width / 64 * Fraction(33, 32)
