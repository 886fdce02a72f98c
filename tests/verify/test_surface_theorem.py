"""Surfaces are glued of pieces that overlap; a flaw in one of them is refused."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx
from support.stored import entry_of, part_of, value_of, values
from support.surface_cases import ONE, WHOLE, exactly, point_of

from orbitproof.explore.__main__ import main
from orbitproof.explore.three_body.atlases import intervals
from orbitproof.shared import format_exact
from orbitproof.shared.claims import SURFACE, Atlas, Claim, Covers, SurfacePiece, evaluate
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import HILL
from orbitproof.verify.curve import Conclusion
from orbitproof.verify.evidence import Evidence, NotProved, Proved, ball_from_json, ball_to_json, enclose, hull
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import (
    ProvedPart,
    ProvedSurface,
    SurfaceResult,
    conclude_surface,
    prove_surface_piece,
    unshown,
)
from orbitproof.verify.surface.gluing import Sheet
from orbitproof.verify.surface.piece import candidate_at
from orbitproof.verify.surface.proved_surface import _require_adapted, heights
from orbitproof.verify.theorems.surface import told
from orbitproof.verify.words.surface import _digits


def in_words(conclusion: Any) -> str:
    return str(told(conclusion)["statement"])


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """One piece of L1 around the mass of the Earth and the Moon, h from 0.22 to 0.24."""
    return read_atlas(Path(__file__).parents[1] / "data" / "surface.json")


@pytest.fixture(scope="module")
def piece(atlas: Atlas) -> SurfacePiece:
    return atlas.surface_pieces()[0]


def test_each_entry_of_centre_and_frames_that_has_to_vanish_is_asked_for(atlas: Atlas, piece: SurfacePiece) -> None:
    """S negates zeta and one of the q: p_1 alone moves zeta and nothing else, and so with q_1."""

    def fits(**changes: Any) -> bool:
        evidence = Evidence("frames")
        _require_adapted(evidence, replace(atlas, pieces=(replace(piece, **changes),)))
        return evidence.holds

    def moved(rows: Any, i: int, j: int) -> Any:
        return tuple(tuple(v + ((a, b) == (i, j)) for b, v in enumerate(row)) for a, row in enumerate(rows))

    assert fits()
    for name, rows in (("frame", piece.frame), ("kernel_frame", piece.kernel_frame)):
        vanishing = [(i, j) for i, row in enumerate(rows) for j, value in enumerate(row) if not value]
        assert vanishing
        assert not any(fits(**{name: moved(rows, *place)}) for place in vanishing)
    assert not fits(centre=moved(piece.centre, 1, len(piece.centre[1]) - 1))
    assert fits(centre=moved(piece.centre, 0, 0))


def flat_piece(number: int, start: Fraction, end: Fraction, turn: Fraction = Fraction(0)) -> SurfacePiece:
    middle, half = (start + end) / 2, (end - start) / 2
    zero = Fraction(0)
    return SurfacePiece(
        id=f"p{number:03}",
        parameters={"h": (middle, half)},
        centre=((middle**2, 2 * middle * half, half**2), (zero,), (middle, half)),
        frame=((ONE, zero, turn), (zero, 2 * ONE, zero), (-turn, zero, ONE)),
        kernel_frame=((zero, ONE), (ONE, zero)),
        radii=(ONE / 100, ONE / 4096, ONE / 100),
        tilt=((turn, ONE),),
        bend=((ONE, turn), (turn, ONE)),
    )


def result_of(piece: SurfacePiece, edges: Sequence[Fraction] = WHOLE, spread: float = 1e-9) -> dict[str, Any]:
    """What a prover gives for the parts between the edges: the point at p = 0, not known exactly."""
    point = [ball_to_json(arb(0, spread)), ball_to_json(arb(0)), ball_to_json(arb(0, spread))]
    parts = [
        {"interval": [format_exact(a), format_exact(b)], "point": point, "side": "below", "hypotheses": {}}
        for a, b in pairwise(edges)
    ]
    ends = [format_exact(edges[0]), format_exact(edges[-1])]
    return {
        "piece": piece.id, "interval": ends, "verdict": "proved", "parts": parts, "time": ball_to_json(arb(1.5, 0.1)),
    }  # fmt: skip


def flat_atlas(pieces: Sequence[SurfacePiece], start: str = "0.125", end: str = "0.5") -> Atlas:
    claim = Claim(SURFACE, "S", (), Covers("h", Fraction(start), Fraction(end)))
    return Atlas("flat", "flat", HILL, {}, claim, tuple(pieces))


def three() -> list[SurfacePiece]:
    edges = [Fraction(1, 8), Fraction(1, 4), Fraction(3, 8), Fraction(1, 2)]
    grown = [(a - Fraction(k > 0, 512), b + Fraction(1, 512)) for k, (a, b) in enumerate(pairwise(edges))]
    return [flat_piece(k + 1, a, b, Fraction(k, 3)) for k, (a, b) in enumerate(grown)]


def conclude(
    pieces: Sequence[SurfacePiece], results: Sequence[dict[str, Any]] | None = None
) -> Conclusion[ProvedSurface]:
    return conclude_surface(flat_atlas(pieces), values([result_of(p) for p in pieces] if results is None else results))


def test_pieces_that_overlap_become_one_surface() -> None:
    pieces = three()
    conclusion = conclude(pieces)
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    joints = conclusion.outcome.results.joints
    assert [(joint.before, joint.after) for joint in joints] == [
        ("p001", "p002"),
        ("p002", "p003"),
    ]
    for joint, (before, after) in zip(joints, pairwise(pieces), strict=True):
        assert evaluate(after.parameters["h"], -ONE) < joint.parameter < evaluate(before.parameters["h"], ONE)
        assert all(ball.contains(0) for ball in joint.offsets)
    assert {entry.z for entry in heights(flat_atlas(pieces))} == {Fraction(2, 4096)}
    # Whichever way the directions point.
    turned = [
        replace(piece, frame=tuple(tuple(sign * entry for entry in row) for row in piece.frame))
        for piece, sign in zip(pieces, (-1, 1, -1), strict=True)
    ]
    assert {entry.z for entry in heights(flat_atlas(turned))} == {Fraction(2, 4096)}
    text = in_words(conclusion)
    assert "for all mu in [0.001953125, 0.125000000]" in text
    assert "|zeta| <= 0.00048828125" in text
    json.dumps(told(conclusion))


def test_the_statement_says_where_the_orbits_reach_higher() -> None:
    pieces = three()
    pieces[1:] = [replace(piece, radii=(piece.radii[0], ONE / 1000, piece.radii[2])) for piece in pieces[1:]]
    text = in_words(conclude(pieces))
    assert "and |zeta| <= 0.00048828125," in text
    assert "Over h in [0.248046875, 0.501953125] all this holds up to |zeta| <= 0.002." in text


def test_the_parameter_stays_in_the_range_of_the_system_and_ends_are_exact() -> None:
    pieces = three()
    assert "At the first h of the pieces, 0.125, the" in in_words(conclude(pieces))
    assert "not part of the theorem" in in_words(conclude(pieces))
    edges = [(Fraction(1, 2), Fraction(3, 4)), (Fraction(5, 8), ONE), (Fraction(7, 8), Fraction(9, 8))]
    beyond = [flat_piece(k, *edge) for k, edge in enumerate(edges)]
    claim = flat_atlas(beyond, "0.5", "0.9").claim
    outcome = conclude_surface(replace(flat_atlas(beyond), claim=claim), values([result_of(p) for p in beyond])).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "parameter"
    assert "leaves (-1, 1)" in outcome.reason.message


def test_ranges_of_parameters_are_rounded_inward() -> None:
    start, end = Fraction(1, 8) + Fraction(1, 2**50), Fraction(1, 2) - Fraction(1, 2**50)
    atlas = flat_atlas([flat_piece(1, start, end)])
    atlas = replace(atlas, claim=replace(atlas.claim, covers=None))
    statement = in_words(conclude_surface(atlas, values([result_of(piece) for piece in atlas.surface_pieces()])))
    assert "of h in [0.125000000001, 0.499999999999]" in statement


def test_the_place_of_a_point_in_the_next_box_inverts_its_coordinates() -> None:
    piece = three()[2]
    sheet = Sheet(piece, piece.parameters["h"], ())
    source = random.Random(2)
    with ctx.workprec(128):
        for _ in range(10):
            s = Fraction(source.randint(-64, 64), 64)
            p = [Fraction(source.randint(-64, 64), 64) for _ in range(3)]
            state = point_of(piece, s, p)
            point = [exactly(state[index]) + arb(0, 1e-14) for index in (0, 2, 4)]
            for ball, value in zip(sheet.offsets(s, s, point), p, strict=True):
                assert ball.contains(enclose(value))
                assert ball.rad() < 1e-9


Change = Callable[[list[SurfacePiece], list[dict[str, Any]]], None]


def _drop(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    del pieces[1], results[1]


def _unproved(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    # With its parts: they do not count.
    results[1] = {**results[1], "verdict": "not proved", "reason": {"condition": "C2", "message": "no", "remedy": ""}}


def _gap(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    results[1] = result_of(pieces[1], (-ONE, Fraction(1, 4)))
    results.append(result_of(pieces[1], (Fraction(5, 16), ONE)))


def _other_branch(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    centre = pieces[1].centre
    pieces[1] = replace(pieces[1], centre=((centre[0][0] + Fraction(1, 50), *centre[0][1:]), *centre[1:]))


def _vague(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    results[0] = result_of(pieces[0], spread=0.02)


def _turned(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    pieces[1] = replace(
        pieces[1],
        parameters={"h": tuple((-1) ** k * c for k, c in enumerate(pieces[1].parameters["h"]))},
        centre=tuple(tuple((-1) ** k * c for k, c in enumerate(row)) for row in pieces[1].centre),
    )


def _swapped(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    pieces[0], pieces[1] = pieces[1], pieces[0]


def _not_adapted(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    frame = pieces[1].frame
    pieces[1] = replace(pieces[1], frame=((ONE, ONE / 2**80, frame[0][2]), *frame[1:]))


def _off_plane(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    pieces[1] = replace(pieces[1], centre=(pieces[1].centre[0], (Fraction(0), ONE / 2**80), pieces[1].centre[2]))


def _singular(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    pieces[2] = replace(pieces[2], frame=(pieces[2].frame[0], pieces[2].frame[1], pieces[2].frame[0]))


def _short(pieces: list[SurfacePiece], results: list[dict[str, Any]]) -> None:
    del pieces[2], results[2]


REFUSED: dict[str, tuple[Change, str]] = {
    "a piece is missing": (_drop, "glued"),
    "a piece is not proved": (_unproved, "pieces"),
    "a gap in s": (_gap, "pieces"),
    "the next piece lies on another branch": (_other_branch, "glued"),
    "the point is known too badly": (_vague, "glued"),
    "the mass decreases with s": (_turned, "parameter"),
    "pieces out of order": (_swapped, "glued"),
    "a frame is not adapted": (_not_adapted, "frames"),
    "a centre leaves the plane": (_off_plane, "frames"),
    "a frame is singular": (_singular, "frames"),
    "the range is not covered": (_short, "covers"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_surface_with_a_flaw_is_refused(name: str) -> None:
    change, condition = REFUSED[name]
    pieces = three()
    results = [result_of(piece) for piece in pieces]
    change(pieces, results)
    conclusion = conclude(pieces, results)
    assert isinstance(conclusion.outcome, NotProved)
    assert not in_words(conclusion)
    assert conclusion.outcome.reason.condition == condition


def message_of(pieces: Sequence[SurfacePiece], results: Sequence[dict[str, Any]] | None = None, **covers: str) -> str:
    atlas = flat_atlas(pieces, **covers)
    if not covers:
        atlas = replace(atlas, claim=replace(atlas.claim, covers=None))
    outcome = conclude_surface(atlas, values([result_of(p) for p in pieces] if results is None else results)).outcome
    return "proved" if isinstance(outcome, Proved) else outcome.reason.message


def test_pieces_between_which_parameters_are_missing_are_not_glued_however_few() -> None:
    """The same curve on both sides of a gap that is much smaller than the boxes."""
    gap = ONE / 2**60
    for first, second in ((Fraction(1, 4), Fraction(1, 4) - gap), (Fraction(1, 4), Fraction(1, 4) + gap)):
        message = message_of([flat_piece(1, Fraction(1, 8), first), flat_piece(2, second, Fraction(1, 2))])
        assert message == "proved" if second < first else "no parameter values in common" in message
    ahead = [flat_piece(1, Fraction(1, 4) + gap, Fraction(1, 2)), flat_piece(2, Fraction(1, 8), Fraction(1, 4))]
    assert "not in order" in message_of(ahead)
    assert "not in order" in message_of([flat_piece(1, Fraction(1, 8), ONE / 2), flat_piece(2, ONE / 8, ONE / 4)])


def test_the_pieces_reach_both_ends_of_the_range() -> None:
    above = str(Fraction(1, 8) - Fraction(1, 2**20))
    assert "above the range" in message_of(three(), start=above, end="0.5")
    last = three()[-1].parameters["h"]
    beyond = str(sum(last) + Fraction(1, 2**20))
    assert "below the range's end" in message_of(three(), start="0.125", end=beyond)
    assert message_of(three(), start="0.125", end=str(sum(last))) == "proved"


@pytest.mark.parametrize("edges", [(-ONE - ONE / 2**30, ONE), (-ONE, ONE + ONE / 2**30), (ONE / 2, -ONE)])
def test_a_part_that_is_none_of_the_piece_proves_nothing(edges: Sequence[Fraction]) -> None:
    pieces = three()
    results = [result_of(piece) for piece in pieces]
    results.append(result_of(pieces[1], edges))
    assert "within [-1, 1]" in message_of(pieces, results)


def test_a_parameter_increases_only_if_it_does_so_everywhere() -> None:
    source = random.Random(4)
    piece, known = three()[0], {True: 0, False: 0}
    for _ in range(200):
        row = [Fraction(source.randint(-8, 8), 8) for _ in range(source.randint(2, 5))]
        found = Sheet(piece, tuple(row), ()).increases()
        places = [Fraction(n, 64) for n in range(-64, 65)]
        assert not found or all(sum(k * c * s ** (k - 1) for k, c in enumerate(row) if k) > 0 for s in places)
        known[found] += 1
    assert min(known.values()) > 10


def test_at_the_joint_of_two_parts_a_point_may_be_that_of_either() -> None:
    piece = three()[0]
    left, right = (tuple(arb(sign * value, 2**-40) for value in (1, 0, 2)) for sign in (-1, 1))
    parts = (ProvedPart((-ONE, Fraction(0)), left, "below", {}), ProvedPart((Fraction(0), ONE), right, "below", {}))
    sheet = Sheet(piece, piece.parameters["h"], parts)
    for edges, points in (
        ((-ONE / 2, -ONE / 4), [left]), ((ONE / 4, ONE), [right]), ((-ONE / 4, ONE / 4), [left, right]),
        ((Fraction(0), Fraction(0)), [left, right]),
    ):  # fmt: skip
        found = sheet.local(*edges)
        for point in points:
            assert all(ball.contains(value) for ball, value in zip(found, point, strict=True))
    assert sheet.local(ONE / 4, ONE)[2].rad() < 1


def test_half_periods_are_those_of_all_pieces() -> None:
    pieces = three()
    results = [{**result_of(p), "time": ball_to_json(arb(k, 0.1))} for k, p in enumerate(pieces, start=1)]
    statement = in_words(conclude(pieces, results))
    found = re.search(r"All half periods lie in \[(\S+), (\S+)\]\.", statement)
    assert found is not None
    assert 0.85 < float(found[1]) <= 0.9
    assert 3.1 <= float(found[2]) < 3.15


def test_heights_are_those_of_the_first_direction_of_the_box() -> None:
    """R_1 times the entry of the frame, whatever the other radii are."""
    pieces = [replace(piece, radii=(ONE / 7, ONE / 4096, ONE / 5)) for piece in three()]
    assert {entry.z for entry in heights(flat_atlas(pieces))} == {Fraction(2, 4096)}
    # Whichever way the directions point.
    turned = [
        replace(piece, frame=tuple(tuple(sign * entry for entry in row) for row in piece.frame))
        for piece, sign in zip(pieces, (-1, 1, -1), strict=True)
    ]
    assert {entry.z for entry in heights(flat_atlas(turned))} == {Fraction(2, 4096)}


SHOWN = [
    ("HC2", "d q_2(P^1) / d p_2", None), ("HC3", "g_0", None), ("HC4", "G_01 + G_11 p_1'", None),
    ("dH/dp_0", "dH/dp_0", None), ("h_fp'", "h_fp'", None), ("h_b''", "h_b''", None),
    ("HC2", "p_2^H", 2), ("HC2", "p_1(P_0)", 1), ("HC3", "p_0(P_1)", 0),
    ("point", "p_0", 0), ("point", "p_1", 1), ("point", "p_2", 2),
]  # fmt: skip
"""What has to be different from 0 or inside P_i (sections 8 and 9)."""


@pytest.mark.parametrize(("name", "key", "inside"), SHOWN, ids=[f"{name} {key}" for name, key, _ in SHOWN])
def test_a_stored_part_shows_each_of_its_inequalities(
    name: str, key: str, inside: int | None, piece: SurfacePiece
) -> None:
    results = json.loads((Path(__file__).parents[1] / "data" / "surface-results.json").read_text())
    part = results[0]["parts"][0]
    assert not list(unshown(piece, part_of(part)))
    entry = part["hypotheses"][name]
    stored = ball_from_json(entry[key])
    # Just over the edge, to both sides.
    edge = arb(0) if inside is None else enclose(piece.radii[inside])
    for ball in (hull(stored, edge), hull(stored, -edge)):
        entry[key] = ball_to_json(ball)
        if name == "point":
            part["point"] = list(entry.values())[:3]
        assert any(key in text for text in unshown(piece, part_of(part))), ball


def test_a_stored_part_has_the_point_and_the_side_of_its_hypotheses(piece: SurfacePiece) -> None:
    results = json.loads((Path(__file__).parents[1] / "data" / "surface-results.json").read_text())
    part = results[0]["parts"][0]
    other = [*part["point"][:2], ball_to_json(arb(0))]
    assert list(unshown(piece, part_of({**part, "point": other}))) == ["the point is not that of the hypothesis"]
    # Narrower about the same midpoint: not what was enclosed.
    narrower = [*part["point"][:2], ball_to_json(arb(ball_from_json(part["point"][2]).mid()))]
    assert list(unshown(piece, part_of({**part, "point": narrower}))) == ["the point is not that of the hypothesis"]
    assert part["side"] == "below"
    assert any("the side is 'above'" in text for text in unshown(piece, part_of({**part, "side": "above"})))


def test_a_point_that_is_not_finite_proves_nothing() -> None:
    pieces = three()
    results = [value_of(result_of(piece)) for piece in pieces]
    assert isinstance(results[1], SurfaceResult)
    first, *rest = results[1].parts
    results[1] = replace(results[1], parts=(replace(first, point=(arb(float("nan")), *first.point[1:])), *rest))
    conclusion = conclude(pieces, results)
    assert isinstance(conclusion.outcome, NotProved)
    assert conclusion.outcome.reason.condition == "pieces"


def test_a_conclusion_cannot_say_more_than_its_hypotheses() -> None:
    outcome = conclude(three()).outcome
    assert isinstance(outcome, Proved)
    with pytest.raises(ValueError, match="hypotheses"):
        replace(outcome, hypotheses=outcome.hypotheses[:-1])


@pytest.mark.parametrize(
    ("point", "low", "high"), [("L1", "0", "0.7938"), ("L2", "0.09", "0.7938"), ("L3", "0.00095", "0.5")]
)
def test_the_pieces_cover_the_range_and_overlap(point: str, low: str, high: str) -> None:
    places = intervals(point, Fraction(low), Fraction(high), 0.2)
    ends = [(centre - half, centre + half) for centre, half in places]
    assert ends[0][0] == Fraction(low)
    assert ends[-1][1] == Fraction(high)
    assert all(a[0] < b[0] < a[1] < b[1] for a, b in pairwise(ends))
    for centre, half in places:
        distance = centre + Fraction(1, 10) if point == "L3" else 1 - centre
        assert half < Fraction(21, 100) * distance


def test_the_command_writes_an_atlas_that_can_be_read(tmp_path: Path) -> None:
    path = tmp_path / "mass.json"
    assert (
        main(["atlas-mass", "--point", "L2", "--mu-min", "0.01", "--mu-max", "0.02", "--quiet", "-o", str(path)]) == 0
    )
    written = read_atlas(path)
    covers = written.claim.covers
    assert covers is not None
    assert covers.start**3 <= Fraction(1, 100)
    assert covers.end**3 >= Fraction(2, 100)
    piece = written.surface_pieces()[0]
    candidate = candidate_at(written.system, piece, Fraction(0), "S")
    assert candidate.parameters == {"h": piece.parameters["h"][0]}
    assert float(candidate.centre[0]) == pytest.approx(0.5757, abs=2e-3)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--point", "L1", "--mu-min", "x"], ["--point", "L1", "--mu-max", "0.6"], ["--point", "L3", "--mu-min", "0"],
        ["--point", "L1", "--z", "1"], ["--point", "L1", "--share", "0.9"], ["--point", "L2", "--mu-min", "0.5"],
    ],
)  # fmt: skip
def test_bad_input_of_atlas_mass_is_one_line(
    arguments: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["atlas-mass", *arguments, "-o", str(tmp_path / "x.json")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.slow
def test_the_theorem_for_l1_and_all_masses(tmp_path: Path) -> None:
    """Symmetry breaking and halo orbits of L1 for all mass parameters up to 1/2; about a minute."""
    path = tmp_path / "mass.json"
    assert main(["atlas-mass", "--point", "L1", "--quiet", "-o", str(path)]) == 0
    atlas = read_atlas(path)
    results = [entry_of(prove_surface_piece(HILL, piece, WHOLE, ORACLE)) for piece in atlas.surface_pieces()]
    conclusion = conclude_surface(atlas, values(results))
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    assert "for all mu in (0, 0.500188017]" in in_words(conclusion)
    assert "|z| <= 0.004 mu^(1/3)" in in_words(conclusion)


@pytest.mark.parametrize("size", [1, 10**14, 10**20])
def test_ranges_are_rounded_to_the_side_that_is_asked_for(size: int) -> None:
    for value in (Fraction(size, 3), Fraction(-size, 3), Fraction(size), Fraction(100 * size)):
        above, below = (Fraction(_digits(value, rounded)) for rounded in (ceil, floor))
        assert below <= value <= above
        assert above - below < Fraction(1, 10**11)
