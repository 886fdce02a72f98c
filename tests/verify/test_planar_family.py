"""The planar orbits under a surface are the Lyapunov family of the libration point; other ones are refused."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, pairwise
from math import comb, floor
from pathlib import Path
from typing import Any

import mpmath
import pytest
from flint import arb, ctx
from support.balls import agree
from support.forgeries import atlas_certificate, checked, forged, honest, noticed
from support.stored import values

from orbitproof.explore.__main__ import main
from orbitproof.explore.three_body.atlases import LyapunovFamily
from orbitproof.explore.three_body.seeds import libration_point
from orbitproof.shared import parse_exact
from orbitproof.shared.claims import Atlas, LibrationPiece, evaluate
from orbitproof.shared.formats import read_atlas
from orbitproof.shared.systems import AROUND, OVER_MASSES, SIDES, mass_of_distance
from orbitproof.verify.evidence import NotProved, Proved, enclose, exact_value, hull
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import SurfaceLimits, conclude_surface, prove_libration_piece
from orbitproof.verify.surface.gluing import read_sheet
from orbitproof.verify.surface.planar_family import _breaking
from orbitproof.verify.theorems.surface import told

DATA = Path(__file__).parents[1] / "data"
WHOLE = (Fraction(-1), Fraction(1))


def in_words(conclusion: Any) -> str:
    return str(told(conclusion)["statement"] or "")


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """A surface of L1 around the mass of the Earth and the Moon, with the planar family over it."""
    return read_atlas(DATA / "surface-planar.json")


@pytest.fixture(scope="module")
def piece(atlas: Atlas) -> LibrationPiece:
    return atlas.libration_pieces()[0]


@pytest.fixture(scope="module")
def results() -> list[dict[str, Any]]:
    """What the verifier found for all pieces."""
    names = ("surface-results.json", "surface-planar-results.json")
    return [result for name in names for result in json.loads((DATA / name).read_text())]


def test_symmetry_breakings_over_a_part_of_a_piece_are_those_of_all_of_its_distances(
    atlas: Atlas, piece: LibrationPiece, results: list[dict[str, Any]]
) -> None:
    known = values(results)
    sheets = [read_sheet(each, "h", [r for r in known if r.piece == each.id]) for each in atlas.surface_pieces()]  # type: ignore[misc]
    middle, half = piece.distance
    with ctx.workprec(128):
        for place in (Fraction(-1, 2), Fraction(0), Fraction(1, 4)):
            low, high = (middle + half * (place + Fraction(side, 3)) for side in (-1, 1))
            over = _breaking(piece, sheets, (low, high))
            assert isinstance(over, tuple)
            for distance in (low, (low + high) / 2, high):
                at = _breaking(piece, sheets, (distance, distance))
                assert isinstance(at, tuple)
                assert all(wide.contains(ball.mid()) for wide, ball in zip(over, at, strict=True))


def test_over_a_part_a_sheet_is_asked_from_the_first_to_the_last_of_its_masses(piece: LibrationPiece) -> None:
    asked = list[tuple[Fraction, Fraction]]()

    class Asked:
        """Its parameter is 2 s, whose places are known up to 1/1024."""

        parameter = Fraction(0), Fraction(2)

        def place(self, value: Fraction) -> tuple[Fraction, Fraction]:
            return value / 2 - Fraction(1, 1024), value / 2 + Fraction(1, 1024)

        def point(self, low: Fraction, high: Fraction) -> list[arb]:
            asked.append((low, high))
            return [arb(0.7), arb(0), arb(1.3)]

    middle, half = piece.distance
    sheets: Any = [Asked()]
    places = [middle + half * Fraction(share, 4) for share in (-4, 0, 3, 4)]
    assert all(isinstance(_breaking(piece, sheets, (b, b)), tuple) for b in places)
    singly = [*asked]
    for first, last in combinations(range(len(places)), 2):
        asked.clear()
        assert isinstance(_breaking(piece, sheets, (places[first], places[last])), tuple)
        ((low, high),) = asked
        assert low <= min(each[0] for each in singly[first : last + 1])
        assert high >= max(each[1] for each in singly[first : last + 1])


class Linear:
    """A sheet whose parameter h is linear in s, and whose symmetry breakings have xi = 2 + h and veta = h."""

    def __init__(self, first: Fraction, last: Fraction) -> None:
        self.parameter = (first + last) / 2, (last - first) / 2

    def place(self, value: Fraction) -> tuple[Fraction, Fraction]:
        s = max(min((value - self.parameter[0]) / self.parameter[1], Fraction(1)), Fraction(-1))
        return max(s - Fraction(1, 2**40), Fraction(-1)), min(s + Fraction(1, 2**40), Fraction(1))

    def point(self, low: Fraction, high: Fraction) -> list[arb]:
        h = hull(*(enclose(evaluate(self.parameter, s)) for s in (low, high)))
        return [2 + h, arb(0), h]


@pytest.mark.parametrize("seed", range(4))
def test_symmetry_breakings_are_those_of_a_sheet_that_reaches_over_all_masses(piece: LibrationPiece, seed: int) -> None:
    """Of several sheets one after the other: none is read beyond its ends, where others have the orbits."""
    source, (middle, half) = random.Random(seed), piece.distance
    side = SIDES[piece.point]

    def scaled(b: Fraction) -> tuple[arb, arb]:
        scale = side * enclose(side * mass_of_distance(side, b)).root(3)
        return enclose(b) * scale, scale

    with ctx.workprec(128):
        ends = sorted(exact_value(scaled(middle + half * Fraction(n, 4))[0].mid()) for n in (-5, -1, 2, 5))
        more = Fraction(1, 2**14)
        sheets: Any = [Linear(low - more, high + more) for low, high in pairwise(ends)]
        known = set()
        for _ in range(40):
            first = middle + half * Fraction(source.randint(-256, 224), 256)
            last = first + half * Fraction(source.choice((0, 8, 32)), 256)
            found = _breaking(piece, sheets, (first, last))
            known.add(isinstance(found, tuple))
            for b in (first, (first + last) / 2, last):
                h, scale = scaled(b)
                if isinstance(found, tuple):
                    eps = scale * (2 + h) - 1
                    assert agree(found[0], eps)
                    assert agree(found[1], scale * h / eps)
        assert known == {True, False}


@pytest.mark.parametrize("point", ["L1", "L2"])
@pytest.mark.parametrize("mu", [1e-6, 0.012, 0.3, 0.5])
def test_the_distance_of_the_libration_point_determines_the_mass(point: str, mu: float) -> None:
    distance = libration_point(point, mu).x - 1 + mu
    assert distance**3 * mass_of_distance(SIDES[point], distance) == pytest.approx(mu, rel=1e-8)


@pytest.mark.parametrize("point", ["L1", "L2"])
def test_the_equations_over_masses_are_those_around_the_libration_point(point: str) -> None:
    source = random.Random(1)
    with mpmath.workdps(50):
        number = lambda value: mpmath.mpf(value.numerator) / value.denominator  # noqa: E731
        power = lambda base, exponent: mpmath.power(base, number(exponent))  # noqa: E731
        for _ in range(5):
            b = SIDES[point] * mpmath.mpf(source.uniform(0.01, 0.4))
            mu = b**3 * mass_of_distance(SIDES[point], b)
            eps = mpmath.mpf(source.uniform(-0.1, 0.1))
            state = [mpmath.mpf(source.uniform(-1, 1)) for _ in range(4)]
            around = AROUND[point].program.evaluate([*state, mu, 1 - mu + b, b * eps], number, power)
            over = OVER_MASSES[point].program.evaluate([*state, b, eps], number, power)
            for left, right in zip(around, over, strict=True):
                assert abs(left - right) < mpmath.mpf(10) ** -44


def test_at_distance_zero_the_equations_are_hills_about_his_point() -> None:
    x, y, vx, vy = state = [0.3, -0.4, 0.5, 0.6]
    for point in ("L1", "L2"):
        field = OVER_MASSES[point].program.evaluate([*state, 0.0, 0.0], float, lambda base, power: base ** float(power))
        assert field == pytest.approx([vx, vy, 2 * vy + 9 * x, -2 * vx - 3 * y])


def test_planar_orbits_that_go_down_to_the_libration_point_make_the_statement_stronger(
    atlas: Atlas, results: list[dict[str, Any]]
) -> None:
    conclusion = conclude_surface(atlas, values(results))
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    text = in_words(conclusion)
    assert "belongs to the planar Lyapunov family of L1" in text
    assert "For all mu in [0.010648000, 0.013824000] the planar orbit" in text
    assert "up to the identification" not in text
    assert "not part of the theorem" not in text
    alone = conclude_surface(replace(atlas, pieces=atlas.surface_pieces()), values(results[:1]))
    assert isinstance(alone.outcome, Proved)
    assert "not part of the theorem" in in_words(alone)
    assert "up to the identification" in in_words(alone)


def test_where_the_family_is_known_for_some_masses_only_the_statement_says_so(
    atlas: Atlas, piece: LibrationPiece, results: list[dict[str, Any]]
) -> None:
    middle, half = piece.distance
    polynomial = tuple(tuple(value / 2**k for value in row) for k, row in enumerate(piece.polynomial))
    narrow = replace(piece, distance=(middle, half / 2), polynomial=polynomial)
    conclusion = conclude_surface(replace(atlas, pieces=(*atlas.surface_pieces(), narrow)), values(results))
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    assert "up to the identification of the family with that of Lyapunov, where that is not said here" in (
        in_words(conclusion)
    )
    mass = [(middle + sign * half / 2) ** 3 * mass_of_distance(-1, middle + sign * half / 2) for sign in (1, -1)]
    _, _, words = in_words(conclusion).rpartition("For all mu in [")
    low, high = (float(text) for text in words[: words.index("]")].split(", "))
    assert float(mass[0]) <= low < float(mass[0]) + 2e-9
    assert float(mass[1]) - 2e-9 < high <= float(mass[1])


Change = Callable[[list[LibrationPiece], list[dict[str, Any]]], None]


def _other_family(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    (constant, *rest), *others = pieces[0].polynomial
    pieces[0] = replace(pieces[0], polynomial=((constant + 2 * pieces[0].tube, *rest), *others))


def _wrong_point(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    middle, half = pieces[0].distance
    pieces[0] = replace(pieces[0], point="L2", distance=(-middle + Fraction(1, 50), half))


def _two_points(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    pieces.append(replace(pieces[0], id="other", point="L2"))
    results.append({**results[1], "piece": "other"})


def _other_side(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    pieces[0] = replace(pieces[0], point="L2")


def _without_the_point(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    middle, half = pieces[0].size
    pieces[0] = replace(pieces[0], size=(middle + half / 4, half * 3 / 4))


def _beyond_the_point(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    _, half = pieces[0].size
    pieces[0] = replace(pieces[0], size=(-2 * half, half))


def _gap_before_the_surface(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    middle, half = pieces[0].size
    pieces[0] = replace(pieces[0], size=(middle - half / 4, half * 3 / 4))


def _gap_in_size(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    results[1:] = [{**results[1], "interval": ["-1", "0x1p-3"]}, {**results[1], "interval": ["0x1p-2", "1"]}]


def _gap_in_mass(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    middle, half = pieces[0].distance
    near = replace(pieces[0], id="near", distance=(middle + half / 2, half / 4))
    far = replace(pieces[0], distance=(middle - half / 2, half / 4))
    pieces[:] = [near, far]
    results.append({**results[1], "piece": "near"})


def _out_of_order(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    pieces.append(replace(pieces[0], id="again"))
    results.append({**results[1], "piece": "again"})


def _unproved(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    results[1] = {**results[1], "verdict": "not proved", "reason": {"message": "no", "remedy": ""}}


def _missing(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    del results[1]


def _forged_bound(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    results[1] = {**results[1], "deviation": ["0x1"]}


def _no_time(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    results[1] = {**results[1], "time": None}


def _beyond(pieces: list[LibrationPiece], results: list[dict[str, Any]]) -> None:
    results[1] = {**results[1], "interval": ["-2", "1"]}


REFUSED: dict[str, tuple[Change, str]] = {
    "the planar orbits are not those of the family": (_other_family, "is not in the tube"),
    "the family is that of the other libration point": (_wrong_point, "not shown to be among the sizes"),
    "the pieces are about both libration points": (_two_points, "two libration points"),
    "the distances have the wrong side": (_other_side, "other side of the smaller mass"),
    "the family does not reach the libration point": (_without_the_point, "does not reach the libration point"),
    "the family is beyond the libration point": (_beyond_the_point, "does not reach the libration point"),
    "the family ends before the surface": (_gap_before_the_surface, "not shown to be among the sizes"),
    "sizes are missing": (_gap_in_size, "is not proved from s = 0.125"),
    "masses are missing": (_gap_in_mass, "there is a gap"),
    "pieces out of order": (_out_of_order, "not in order"),
    "the piece is not proved": (_unproved, "is not proved from s = -1"),
    "the piece has no result": (_missing, "is not proved from s = -1"),
    "the bound is not below the tube": (_forged_bound, "not below the tube"),
    "the half periods are not known": (_no_time, "planar001"),
    "the result is about more than the piece": (_beyond, "not within [-1, 1]"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_planar_family_with_a_flaw_is_refused(name: str, atlas: Atlas, results: list[dict[str, Any]]) -> None:
    change, message = REFUSED[name]
    pieces, changed = list(atlas.libration_pieces()), copy.deepcopy(results)
    change(pieces, changed)
    conclusion = conclude_surface(replace(atlas, pieces=(*atlas.surface_pieces(), *pieces)), values(changed))
    assert isinstance(conclusion.outcome, NotProved)
    assert conclusion.outcome.reason.condition == "planar-family"
    assert message in conclusion.outcome.reason.message
    assert not in_words(conclusion)


def test_a_certificate_with_the_family_stands_and_forgeries_are_found(
    atlas: Atlas, results: list[dict[str, Any]]
) -> None:
    document = json.loads(json.dumps(atlas_certificate(atlas, results)))
    assert checked(document, honest(results)).stands

    def narrower(entry: dict[str, Any]) -> None:
        entry["results"][1]["deviation"] = ["0x1p-60"]

    def wider(entry: dict[str, Any]) -> None:
        entry["results"][1]["deviation"] = ["0x1"]

    def more(entry: dict[str, Any]) -> None:
        theorem = entry["statement"]["theorem"]
        entry["statement"]["theorem"] = theorem.replace("[0.010648000, 0.013824000]", "[0.010648000, 0.020000000]")

    def other(entry: dict[str, Any]) -> None:
        piece = entry["statement"]["atlas"]["pieces"][1]
        piece["size"][1] = "0x1p-4"

    def parts(entry: dict[str, Any]) -> None:
        entry["results"][1]["parts"] = entry["results"][0]["parts"]

    for change in (narrower, wider, more, other, parts):
        found = checked(forged(document, change), honest(results, document["statement"]["atlas"]["pieces"]))
        assert noticed(found), change.__name__


@pytest.fixture(scope="module")
def light() -> tuple[Atlas, list[dict[str, Any]]]:
    """A surface of L2 from mass 0 on, with the planar family over all of it, and what the verifier found."""
    results = json.loads((DATA / "surface-light-results.json").read_text())
    return read_atlas(DATA / "surface-light.json"), results


def test_around_l2_the_family_is_known_from_mass_0_on_and_for_no_more_masses_than_proved(
    light: tuple[Atlas, list[dict[str, Any]]],
) -> None:
    atlas, results = light
    (piece,) = atlas.libration_pieces()
    document = json.loads(json.dumps(atlas_certificate(atlas, results)))
    theorem = document["statement"]["theorem"]
    covered = atlas.claim.covers
    assert covered is not None
    end = floor(covered.end**3 * 10**9) / 10**9
    assert f"For all mu in (0, {end:.9f}] the planar orbit of X(h, 0) belongs to the planar Lyapunov family of L2" in (
        theorem
    )
    assert "At h = 0 the equations are those of Hill's lunar problem." in theorem
    assert checked(document, honest(results)).stands
    assert piece.distance[0] == piece.distance[1]

    def more_in_words(entry: dict[str, Any]) -> None:
        entry["statement"]["theorem"] = theorem.replace(f"(0, {end:.9f}]", "(0, 0.500000000]")

    def more_in_the_claim(entry: dict[str, Any]) -> None:
        more_in_words(entry)
        entry["statement"]["atlas"]["claim"]["covers"]["to"] = "7938e-4"

    def more_in_the_piece(entry: dict[str, Any]) -> None:
        entry["statement"]["atlas"]["pieces"][1]["distance"] = ["0x1p-2", "0x1p-2"]

    def on_the_other_side(entry: dict[str, Any]) -> None:
        entry["statement"]["atlas"]["pieces"][1]["distance"][0] = "0x0"

    for change in (more_in_words, more_in_the_claim, more_in_the_piece, on_the_other_side):
        found = checked(forged(document, change), honest(results, document["statement"]["atlas"]["pieces"]))
        assert noticed(found), change.__name__


def test_a_range_of_masses_beyond_the_pieces_of_the_family_is_named_as_far_as_they_go(
    light: tuple[Atlas, list[dict[str, Any]]],
) -> None:
    atlas, results = light
    (piece,) = atlas.libration_pieces()
    middle, half = piece.distance[0] / 2, piece.distance[1] / 2
    # With b = d (1 + beta) = d/2 (1 + gamma), beta = (gamma - 1)/2: the same orbits on the half that begins at mass 0.
    polynomial = tuple(
        tuple(
            sum(
                (
                    row[n] * comb(j, k) * Fraction(1, 2) ** k * Fraction(-1, 2) ** (j - k)
                    for j, row in enumerate(piece.polynomial)
                    if j >= k
                ),
                Fraction(0),
            )
            for n in range(len(piece.polynomial[0]))
        )
        for k in range(len(piece.polynomial))
    )
    less = replace(piece, distance=(middle, half), polynomial=polynomial)
    conclusion = conclude_surface(replace(atlas, pieces=(*atlas.surface_pieces(), less)), values(results))
    assert isinstance(conclusion.outcome, Proved), conclusion.outcome.reason
    mass = (2 * half) ** 3 * mass_of_distance(1, 2 * half)
    assert f"For all mu in (0, {floor(mass * 10**9) / 10**9:.9f}]" in in_words(conclusion)
    assert "where that is not said here" in in_words(conclusion)


@pytest.mark.parametrize(
    ("point", "low", "high"), [pytest.param("L1", "0.01", "0.012", marks=pytest.mark.slow), ("L2", "0", "0.0002")]
)
def test_the_command_writes_pieces_of_the_family_for_all_masses_of_the_surface(
    point: str, low: str, high: str, tmp_path: Path
) -> None:
    path = tmp_path / "mass.json"
    asked = ["--point", point, "--mu-min", low, "--mu-max", high, "--lyapunov", "--quiet", "-o", str(path)]
    assert main(["atlas-mass", *asked]) == 0
    written = read_atlas(path)
    pieces = written.libration_pieces()
    first, last = pieces[0], pieces[-1]
    side, covers = SIDES[point], written.claim.covers
    assert covers is not None
    near, far = first.distance[0] - side * first.distance[1], last.distance[0] + side * last.distance[1]
    assert 0 <= near**3 * mass_of_distance(side, near) <= covers.start**3
    assert covers.end**3 <= far**3 * mass_of_distance(side, far) < covers.end**3 + Fraction(1, 10**4)
    assert all(abs(piece.size[0]) < piece.size[1] for piece in pieces)


def test_the_family_of_l3_is_not_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["atlas-mass", "--point", "L3", "--lyapunov", "-o", str(tmp_path / "x.json")]) == 2
    assert "--lyapunov" in capsys.readouterr().err


@pytest.mark.slow
def test_a_piece_is_proved_and_contains_the_orbits_of_the_family(piece: LibrationPiece) -> None:
    found = prove_libration_piece(piece, WHOLE, ORACLE, SurfaceLimits(64, 20, 14, 5))
    assert isinstance(found.outcome, Proved), found.outcome.reason
    deviation = float(found.outcome.results.deviation)
    for beta in (Fraction(-1), Fraction(1, 3), Fraction(1)):
        b = piece.distance[0] + beta * piece.distance[1]
        mu = b**3 * Fraction(mass_of_distance(-1, b))
        for s in (Fraction(-1), Fraction(0), Fraction(7, 8)):
            eps = piece.size[0] + s * piece.size[1]
            orbit = LyapunovFamily("L1", mu).orbit(float(b * eps))
            expected = sum(float(evaluate(row, s) * beta**k) for k, row in enumerate(piece.polynomial))
            assert abs(orbit.vy - expected) < deviation + 1e-8
            assert found.outcome.results.time.contains(arb(orbit.half_period))


@pytest.mark.slow
def test_a_tube_beside_the_family_is_not_proved(piece: LibrationPiece) -> None:
    (constant, *rest), *others = piece.polynomial
    beside = replace(piece, polynomial=((constant + 2 * piece.tube, *rest), *others))
    found = prove_libration_piece(beside, (Fraction(0), Fraction(1, 8)), ORACLE, SurfaceLimits(64, 20, 8, 5))
    assert isinstance(found.outcome, NotProved)
    assert found.outcome.reason.condition == "newton"


def test_a_piece_that_is_none_is_not_proved(piece: LibrationPiece) -> None:
    for other, interval in (
        (piece, (Fraction(0), Fraction(2))),
        (replace(piece, distance=(Fraction(-9, 8), Fraction(1, 4))), WHOLE),
        (replace(piece, polynomial=piece.polynomial + piece.polynomial), WHOLE),
    ):
        found = prove_libration_piece(other, interval, ORACLE)
        assert isinstance(found.outcome, NotProved)
        assert found.outcome.reason.condition == "piece"


def test_the_stored_result_says_how_far_the_family_is_from_the_polynomial(
    piece: LibrationPiece, results: Sequence[dict[str, Any]]
) -> None:
    (deviation,) = (parse_exact(text) for text in results[1]["deviation"])
    assert 0 < deviation < piece.tube / 2
