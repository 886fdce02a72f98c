"""Halo orbits over ranges of the mass: Hill's units, one integration for all masses, pieces glued."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from support.claims import known

from orbitproof.explore.__main__ import main
from orbitproof.explore.atlases.surface import intervals
from orbitproof.explore.flow.flow import flow_of
from orbitproof.shared.formats.atlas import SURFACE, Atlas, Claim, Covers, read_atlas
from orbitproof.shared.formats.pieces import SurfacePiece, evaluate
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems.hill import hill_field, hill_integral
from orbitproof.shared.systems.system import CR3BP, HILL, MASS_PARAMETERS
from orbitproof.verify.curve.conclusion import Conclusion
from orbitproof.verify.curve.piece_result import PieceResult
from orbitproof.verify.evidence.balls_as_text import ball_to_json
from orbitproof.verify.evidence.comparisons import enclose, is_inside
from orbitproof.verify.evidence.outcome import NotProved, Proved
from orbitproof.verify.surface.gluing import Sheet, read_sheet
from orbitproof.verify.surface.half_return import SurfaceLimits, SurfaceReturn, coordinate_terms, enclose_surface
from orbitproof.verify.surface.piece import candidate_at, prove_surface_piece
from orbitproof.verify.surface.proved_parts import ProvedParts
from orbitproof.verify.surface.theorem import ProvedSurface, conclude_surface, heights

FAST = SurfaceLimits(60, 20, 5, 3)
NARROW = SurfaceLimits(52, 20, 3, 3)
PART = (Fraction(-1, 8), Fraction(1, 8))
WHOLE = (Fraction(-1), Fraction(1))
ONE = Fraction(1)


def number(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


@pytest.mark.parametrize("seed", range(5))
def test_hills_units_are_those_of_the_three_body_problem(seed: int) -> None:
    """Field and first integral at random points, in high precision."""
    source = random.Random(seed)
    with mpmath.workdps(60):
        h = mpmath.mpf(source.uniform(0.01, 0.79))
        mu = h**3
        state = [mpmath.mpf(source.uniform(-1, 1)) for _ in range(6)]
        own = [h * value for value in state]
        own[0] += 1 - mu
        power = lambda base, exponent: mpmath.power(base, number(exponent))  # noqa: E731
        field = CR3BP.program.evaluate([*own, mu], number, power)
        assert CR3BP.first_integral_program is not None
        (jacobi,) = CR3BP.first_integral_program.evaluate([*own, mu], number, power)
        for left, right in zip(hill_field(state, [h]), field, strict=True):
            assert abs(h * left - right) < mpmath.mpf(10) ** -50
        (level,) = hill_integral(state, [h])
        assert abs(level - (jacobi - (1 - mu) * (3 - mu)) / h**2) < mpmath.mpf(10) ** -45


def test_at_h_zero_the_equations_are_those_of_hills_lunar_problem() -> None:
    state = [0.3, -0.4, 1.2, 0.5, 0.6, 0.7]
    x, y, z, vx, vy, vz = state
    distance = 1.3
    wanted = [vx, vy, vz, 2 * vy + 3 * x - x / distance**3, -2 * vx - y / distance**3, -z - z / distance**3]
    assert list(hill_field(state, [0.0])) == pytest.approx(wanted, abs=1e-15)
    level = 3 * x * x - z * z + 2 / distance - (vx * vx + vy * vy + vz * vz)
    assert hill_integral(state, [0.0])[0] == pytest.approx(level, abs=1e-14)


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """One piece of L1 around the mass of the Earth and the Moon, h from 0.22 to 0.24."""
    return read_atlas(Path(__file__).parents[1] / "data" / "surface.json")


@pytest.fixture(scope="module")
def piece(atlas: Atlas) -> SurfacePiece:
    return atlas.surface_pieces()[0]


@pytest.fixture(scope="module")
def returned(piece: SurfacePiece) -> SurfaceReturn:
    return enclose_surface(HILL, piece, WHOLE, FAST)


@pytest.fixture(scope="module")
def proved(piece: SurfacePiece, returned: SurfaceReturn) -> PieceResult[ProvedParts]:
    """The proof with the integration above, which takes the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("orbitproof.verify.surface.piece.enclose_surface", lambda *_: returned)
        return prove_surface_piece(HILL, piece, WHOLE, FAST)


def test_the_half_return_is_enclosed_for_all_masses(piece: SurfacePiece, returned: SurfaceReturn) -> None:
    """At random points of the box and random s, against orbits in high precision."""
    source = random.Random(1)
    with ctx.workprec(160):
        for _ in range(2):
            s = Fraction(source.randint(-1000, 1000), 1000)
            part = (s - Fraction(1, 500), s) if s > 0 else (s, s + Fraction(1, 500))
            kernel, level = returned.tables(part)
            p = [Fraction(source.randint(-1000, 1000), 1000) * radius for radius in piece.radii]
            start = point_of(piece, s, p)
            h = evaluate(piece.parameters["h"], s)
            image = half_return(start, h)
            # q_1 = v_zeta, q_2 = v_xi in this piece.
            for table, value in zip(kernel, (image[5], image[3]), strict=True):
                assert table.box[0, 0, 0].contains(value)
            assert level.box[0, 0, 0].contains(exactly(hill_integral(start, [number(h)])[0]))


def point_of(piece: SurfacePiece, s: Fraction, p: Sequence[Fraction]) -> list[Any]:
    """The state on Fix(R) with coordinates p in the box at s, by the definition of the format."""
    p_0, p_1, p_2 = p
    bent = (
        p_0 + evaluate(piece.bend[0], s) * p_1**2,
        p_1,
        p_2 + evaluate(piece.tilt[0], s) * p_0 + evaluate(piece.bend[1], s) * p_1**2,
    )
    values = [
        evaluate(centre, s) + sum((a * b for a, b in zip(row, bent, strict=True)), Fraction(0))
        for centre, row in zip(piece.centre, piece.frame, strict=True)
    ]
    xi, zeta, veta = map(number, values)
    zero = mpmath.mpf(0)
    return [xi, zero, zeta, zero, veta, zero]


def half_return(start: list[Any], h: Fraction) -> list[arb]:
    """The state at the first zero of eta, by mpmath's Taylor integrator, to about 20 digits."""
    with mpmath.workdps(30):
        flow = mpmath.odefun(lambda _, y: list(hill_field(y, [number(h)])), 0, start, tol=mpmath.mpf(10) ** -24)
        time = mpmath.findroot(lambda t: flow(t)[1], (1.3, 1.4), tol=mpmath.mpf(10) ** -44)
        return [exactly(value) + arb(0, 1e-18) for value in flow(time)]


def exactly(value: Any) -> arb:
    sign, mantissa, exponent, _ = value._mpf_
    return arb((int(-mantissa if sign else mantissa), int(exponent)))


def test_a_surface_piece_is_proved_for_all_its_masses(proved: PieceResult[ProvedParts]) -> None:
    assert isinstance(proved.outcome, Proved)
    parts = proved.outcome.results.parts
    assert (parts[0].start, parts[-1].end) == (-1, 1)
    assert all(a.end == b.start for a, b in pairwise(parts))
    assert {part.side for part in parts} == {"below"}
    names = ("poincare-map", "HC2", "HC3", "HC4", "point", "dH/dp_0", "h_fp'", "h_b''")
    assert all(name in part.enclosures for part in parts for name in names)


def test_the_certified_point_of_the_earth_moon_system_is_the_surfaces(
    piece: SurfacePiece, proved: PieceResult[ProvedParts], atlas: Atlas
) -> None:
    """A symmetry breaking that was certified in the CR3BP, at one mass: h(mu, 0) encloses it."""
    sheet = read_sheet(piece, "h", [proved.to_json()])
    candidate = known("em1")
    mu = MASS_PARAMETERS["earth-moon"]
    assert candidate.parameters["mu"] == mu
    with ctx.workprec(160):
        low, high = Fraction(-1), Fraction(1)
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if evaluate(piece.parameters["h"], middle) ** 3 <= mu else (low, middle)
        xi, zeta, veta = sheet.point(low, high)
        h = enclose(mu).root(3)
        x, _, vy = candidate.centre
        slack = Fraction(1, 10**30)
        assert is_inside(zeta, slack)
        assert (1 - enclose(mu) + h * xi).overlaps(enclose(x) + arb(0, 1e-25))
        assert (h * veta).overlaps(enclose(vy) + arb(0, 1e-25))
        assert xi.rad() < 1e-7
        assert veta.rad() < 1e-7


def test_halo_orbits_found_by_shooting_lie_where_the_box_bends(piece: SurfacePiece) -> None:
    """Float64 orbits at several masses and heights: p_0 and p_2 are far inside P_0 and P_2, for every z in P_1."""
    flow = flow_of(HILL)
    sheet = Sheet(piece, piece.parameters["h"], ())
    for s, share in ((Fraction(-1), 1.0), (Fraction(1, 3), 0.9), (ONE, -1.0)):
        h = float(evaluate(piece.parameters["h"], s))
        z = share * float(piece.radii[1])
        unknowns = np.array([float(evaluate(piece.centre[0], s)), float(evaluate(piece.centre[2], s)), 1.35])
        for _ in range(8):
            x, vy, time = unknowns
            end = flow.derivative([x, 0.0, z, 0.0, vy, 0.0], time, [h])
            rows = [1, 3, 5]
            matrix = np.column_stack([end.state_transition[rows][:, [0, 4]], end.velocity[rows]])
            unknowns = unknowns - np.linalg.solve(matrix, end.state[rows])
        with ctx.workprec(128):
            p = sheet.offsets(s, s, [arb(unknowns[0]), arb(z), arb(unknowns[1])])
        assert float(p[1]) == pytest.approx(z)
        assert all(abs(float(p[j])) < float(piece.radii[j]) / 8 for j in (0, 2))


FALSE: dict[str, tuple[Callable[[SurfacePiece], SurfacePiece], str]] = {
    "the centre off the curve": (
        lambda p: replace(p, centre=((p.centre[0][0] + Fraction(1, 1000), *p.centre[0][1:]), *p.centre[1:])),
        "p_2",
    ),
    "a tampered polynomial": (
        lambda p: replace(p, centre=((p.centre[0][0], p.centre[0][1] * 2, *p.centre[0][2:]), *p.centre[1:])),
        "p_",
    ),
    "another mass": (lambda p: replace(p, parameters={"h": (Fraction(1, 4), p.parameters["h"][1])}), "p_"),
    "a centre out of the plane": (
        lambda p: replace(p, centre=(p.centre[0], (ONE / 2**60,), p.centre[2])),
        "negates zeta",
    ),
    "a frame that is not adapted": (
        lambda p: replace(p, frame=((p.frame[0][0], ONE / 2**90, p.frame[0][2]), *p.frame[1:])),
        "column of frame",
    ),
    "a box that is too large": (lambda p: replace(p, radii=tuple(r * 300 for r in p.radii)), ""),
}  # fmt: skip


def test_the_settings_of_the_refusals_prove_what_is_true(piece: SurfacePiece) -> None:
    assert prove_surface_piece(HILL, piece, PART, NARROW).is_proved


@pytest.mark.parametrize("name", FALSE)
def test_a_false_surface_piece_is_not_proved(name: str, piece: SurfacePiece) -> None:
    change, word = FALSE[name]
    result = prove_surface_piece(HILL, change(piece), PART, NARROW)
    assert isinstance(result.outcome, NotProved)
    assert word in result.outcome.reason.message


@pytest.mark.parametrize("interval", [(-2 * ONE, ONE), (ONE, ONE), (ONE, -ONE)])
def test_an_interval_outside_the_piece_is_refused(interval: tuple[Fraction, Fraction], piece: SurfacePiece) -> None:
    assert "no interval" in prove_surface_piece(HILL, piece, interval, FAST).to_json()["reason"]["message"]


def test_what_the_box_is_made_of(piece: SurfacePiece) -> None:
    """The terms that the integration starts from are those of the format, coordinate by coordinate."""
    source = random.Random(3)
    s = Fraction(source.randint(-99, 99), 99)
    p = [Fraction(source.randint(-99, 99), 99) for _ in range(3)]
    state = point_of(piece, s, p)
    for centre, row, index in zip(piece.centre, piece.frame, (0, 2, 4), strict=True):
        value = evaluate(centre, s)
        for exponents, polynomial in coordinate_terms(piece, row).items():
            factors = [base**power for base, power in zip(p, exponents, strict=True)]
            value += evaluate(polynomial, s) * factors[0] * factors[1] * factors[2]
        assert abs(number(value) - state[index]) < 1e-14


# Gluing: fabricated results of exact pieces along (xi, veta) = (h^2, h), in different frames.


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
    return conclude_surface(flat_atlas(pieces), [result_of(p) for p in pieces] if results is None else results)


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
    text = conclusion.statement
    assert "for all mu in [0.001953125, 0.125000000]" in text
    assert "|zeta| <= 0.00048828125" in text
    json.dumps(conclusion.to_json())


def test_the_statement_says_where_the_orbits_reach_higher() -> None:
    pieces = three()
    pieces[1:] = [replace(piece, radii=(piece.radii[0], ONE / 1000, piece.radii[2])) for piece in pieces[1:]]
    text = conclude(pieces).statement
    assert "and |zeta| <= 0.00048828125," in text
    assert "Over h in [0.248046875, 0.501953125] all this holds up to |zeta| <= 0.002." in text


def test_the_parameter_stays_in_the_range_of_the_system_and_ends_are_exact() -> None:
    pieces = three()
    assert "At the first h of the pieces, 0.125, the" in conclude(pieces).statement
    assert "not part of the theorem" in conclude(pieces).statement
    edges = [(Fraction(1, 2), Fraction(3, 4)), (Fraction(5, 8), ONE), (Fraction(7, 8), Fraction(9, 8))]
    beyond = [flat_piece(k, *edge) for k, edge in enumerate(edges)]
    claim = flat_atlas(beyond, "0.5", "0.9").claim
    outcome = conclude_surface(replace(flat_atlas(beyond), claim=claim), [result_of(p) for p in beyond]).outcome
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "parameter"
    assert "leaves (-1, 1)" in outcome.reason.message


def test_ranges_of_parameters_are_rounded_inward() -> None:
    start, end = Fraction(1, 8) + Fraction(1, 2**50), Fraction(1, 2) - Fraction(1, 2**50)
    atlas = flat_atlas([flat_piece(1, start, end)])
    atlas = replace(atlas, claim=replace(atlas.claim, covers=None))
    statement = conclude_surface(atlas, [result_of(piece) for piece in atlas.surface_pieces()]).statement
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
    results[1] = {"piece": "p002", "interval": ["-1", "1"], "verdict": "not proved", "reason": {}}


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
    assert not conclusion.statement
    assert conclusion.outcome.reason.condition == condition


def test_a_point_that_is_not_finite_proves_nothing() -> None:
    pieces = three()
    results = [result_of(piece) for piece in pieces]
    results[1]["parts"][0]["point"][0]["mid"] = "nan"
    conclusion = conclude(pieces, results)
    assert isinstance(conclusion.outcome, NotProved)
    assert conclusion.outcome.reason.condition == "results"


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
    results = [prove_surface_piece(HILL, piece, WHOLE).to_json() for piece in atlas.surface_pieces()]
    conclusion = conclude_surface(atlas, results)
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    assert "for all mu in (0, 0.500188017]" in conclusion.statement
    assert "|z| <= 0.004 mu^(1/3)" in conclusion.statement
