"""Atlases of branches: pieces from complex circles, their widths, claims, the command and the check."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.refusals import refused

from orbitproof.explore.__main__ import main
from orbitproof.explore.atlases import (
    AtlasRequest,
    CoverControl,
    Coverer,
    CoverFailure,
    build_atlas,
    check_joint,
    check_piece,
)
from orbitproof.explore.atlases.check import first_returns
from orbitproof.explore.atlases.complex_flow import LANES, HalfReturns
from orbitproof.explore.atlases.curve import Curve, coordinate_time
from orbitproof.explore.atlases.expansion import Chart, Expansion, coefficient_transform, expand
from orbitproof.explore.families import Family, Limits, TracedFamily, family_record
from orbitproof.explore.records import write_families
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared.claims import Atlas, Covers
from orbitproof.shared.formats import read_atlas, write_atlas
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS
from orbitproof.verify.__main__ import main as verify_main

EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}


@pytest.fixture(scope="module")
def odd_family() -> Family:
    return trace_family(FALKNER_SKAN, "odd", {}, Limits(parameter_min=1.9, parameter_max=101.0))


@pytest.fixture(scope="module")
def odd_atlas(odd_family: Family) -> Atlas:
    covers = Covers("beta", Fraction(2), Fraction(6))
    return build_atlas(AtlasRequest("odd", "odd orbits", odd_family, covers, ("beta",)))


@pytest.fixture(scope="module")
def halo_family() -> Family:
    return trace_family(CR3BP, "L1-halo", EARTH_MOON, Limits(coordinate_max={"z": 0.06}), branch="north")


@pytest.fixture(scope="module")
def halo_atlas(halo_family: Family) -> Atlas:
    covers = Covers("z", Fraction(0), Fraction(5, 100))
    return build_atlas(AtlasRequest("halo", "halo orbits", halo_family, covers, ("z",), coordinates="physical"))


def halo_expansion(family: Family, coordinates: str, half_width: float) -> Expansion:
    curve = Curve(family, False)
    place = curve.at(0.7 * family.arclengths[-1])
    returns = HalfReturns(CR3BP, EARTH_MOON, "regularised" if coordinates == "regularised" else "physical")
    chart = Chart(place.point, curve.frame(place.tangent), half_width, curve.scale(place.point))
    return expand(returns, chart, coordinate_time(returns, place.point, place.half_period, 1.0))


def test_polynomials_of_pieces_agree_with_orbits_found_by_shooting(odd_family: Family, odd_atlas: Atlas) -> None:
    problem = odd_family.problem
    for piece in odd_atlas.curve_pieces():
        for s in (Fraction(-1), Fraction(1, 3), Fraction(1)):
            beta, y = (float(value) for value in piece.point(s))
            nearest = min(odd_family.orbits, key=lambda orbit: abs(orbit.unknowns[0] - beta))
            start = np.array([beta, y, nearest.half_period])
            found = problem.correct(start, np.array([1.0, 0.0, 0.0])).unknowns
            assert abs(found[1] - y) < 1e-12


def test_pieces_cover_the_range_and_overlap(odd_atlas: Atlas) -> None:
    pieces = odd_atlas.curve_pieces()
    assert odd_atlas.claim.kind == "arc"
    assert pieces[0].point(Fraction(-1))[0] <= 2 < 6 <= pieces[-1].point(Fraction(1))[0]
    assert len(pieces) > 1
    joints = [check_joint(*pair) for pair in pairwise(pieces)]
    assert all(joint.good for joint in joints)
    # The last piece may be narrow.
    assert all(-0.99 < joint.place < -0.7 for joint in joints[:-1])


def test_coefficients_fall_as_far_as_asked_and_no_further(odd_family: Family) -> None:
    curve, control = Curve(odd_family, True), CoverControl(degree=20, decay=1e-10)
    atlas = build_atlas(
        AtlasRequest("odd", "odd orbits", odd_family, Covers("beta", Fraction(3), Fraction(40)), control=control)
    )
    piece = atlas.curve_pieces()[1]
    centre = np.array([float(value) for value in piece.centre])
    half_period = min(odd_family.orbits, key=lambda orbit: abs(orbit.unknowns[0] - centre[0])).half_period
    chart = Chart(centre, curve.frame(np.ones(2)), float(piece.half_width), 1.0)
    narrow = expand(HalfReturns(FALKNER_SKAN, {}), replace(chart, half_width=0.2 * chart.half_width), half_period)
    result = expand(narrow.returns, chart, narrow.times[0], guess=narrow.predicted(chart))
    assert 1e-12 < result.spectrum[20] < 1e-9


def test_width_rule_is_exact_for_geometric_coefficients() -> None:
    spectrum = np.maximum(0.5 ** np.arange(64), 1e-17)
    chart = Chart(np.zeros(2), np.eye(2), 3.0, 1.0)
    expansion = Expansion(
        chart, HalfReturns(FALKNER_SKAN, {}), np.zeros((1, 64)), np.zeros(64), spectrum, np.zeros(1), 1
    )
    # (w / 3 / 2)^20 = 1e-12
    assert expansion.best_half_width(20, 1e-12) == pytest.approx(6.0 * 10.0**-0.6, rel=1e-9)


def test_a_branch_that_leaves_the_plane_begins_with_a_symmetric_piece(halo_family: Family, halo_atlas: Atlas) -> None:
    first, *others = halo_atlas.curve_pieces()
    assert (halo_atlas.claim.kind, halo_atlas.claim.symmetry) == ("symmetric-arc", "S")
    assert first.kind == "symmetric"
    assert all(piece.kind == "regular" for piece in others)
    assert first.centre[1] == 0
    assert [row[0] for row in first.frame] == [0, 1, 0]
    assert first.frame[1][1:] == (0, 0)
    assert all(coefficient == 0 for row in first.polynomial for coefficient in row[1::2])
    # The curve through its orbits: z = half_width * s, x and vy from the polynomial.
    for orbit in halo_family.orbits[1:4]:
        x, z, vy, _ = orbit.unknowns
        found = first.point(Fraction(z / float(first.half_width)))
        assert np.allclose([float(value) for value in found], [x, z, vy], rtol=0, atol=1e-12)


def test_a_short_arc_is_its_symmetric_piece_alone(halo_family: Family) -> None:
    covers = Covers("z", Fraction(0), Fraction(1, 100))
    atlas = build_atlas(AtlasRequest("halo", "halo orbits", halo_family, covers, coordinates="physical"))
    (piece,) = atlas.curve_pieces()
    assert piece.kind == "symmetric"
    assert piece.point(Fraction(1))[1] >= Fraction(1, 100)


def test_orbits_lie_deep_inside_the_tubes(halo_atlas: Atlas) -> None:
    for piece in halo_atlas.curve_pieces()[:2]:
        result = check_piece(halo_atlas, piece)
        assert result.good
        assert result.deviation < 1e-3
        assert result.kernel < 1e-11


def test_a_wrong_polynomial_is_found(halo_atlas: Atlas) -> None:
    piece = halo_atlas.curve_pieces()[1]
    rows = [list(row) for row in piece.polynomial]
    rows[0][2] += 2 * piece.tube[0]
    wrong = replace(piece, polynomial=tuple(tuple(row) for row in rows))
    assert not check_piece(halo_atlas, wrong).good
    assert not check_joint(
        halo_atlas.curve_pieces()[0], replace(piece, centre=(piece.centre[0] + 1, *piece.centre[1:]))
    ).good


def test_both_coordinates_give_the_same_curve(halo_family: Family) -> None:
    physical, regularised = (halo_expansion(halo_family, name, 2e-3) for name in ("physical", "regularised"))
    assert np.allclose(physical.coefficients, regularised.coefficients, rtol=0, atol=1e-14)
    assert physical.times[0] != pytest.approx(regularised.times[0], rel=0.1)


def test_first_return_in_regularised_time_is_that_of_the_orbit(halo_family: Family) -> None:
    curve = Curve(halo_family, False)
    places = [curve.at(part * halo_family.arclengths[-1]) for part in (0.3, 0.6, 0.9)]
    returns = HalfReturns(CR3BP, EARTH_MOON, "regularised")
    times = first_returns(returns, np.array([place.point for place in places]).T.astype(np.clongdouble))
    for place, time in zip(places, times, strict=True):
        clocks = returns.clocks(place.point, np.full(LANES, time))
        assert clocks == pytest.approx(np.full(LANES, place.half_period), rel=1e-4)


@pytest.mark.parametrize("guess", [1e-3, 1.0, 50.0])
def test_the_time_of_the_coordinates_is_found_from_any_guess(halo_family: Family, guess: float) -> None:
    place = Curve(halo_family, False).at(0.7 * halo_family.arclengths[-1])
    returns = HalfReturns(CR3BP, EARTH_MOON, "regularised")
    time = coordinate_time(returns, place.point, place.half_period, guess)
    clocks = returns.clocks(place.point, np.linspace(0.9, 1.0, LANES) * time)
    assert clocks[-1] == pytest.approx(place.half_period, rel=1e-5)
    assert clocks[0] < 0.95 * place.half_period


@pytest.mark.parametrize("coordinates", ["physical", "regularised"])
def test_an_expansion_predicts_the_curve_in_the_chart_of_another_point(halo_family: Family, coordinates: str) -> None:
    wide = halo_expansion(halo_family, coordinates, 2e-3)
    near = wide.point(0.4)
    turn = np.linalg.qr(wide.chart.frame + 0.05 * np.arange(9).reshape(3, 3))[0] * [-1, 1, 1]
    chart = Chart(near, turn * np.sign(turn[:, 0] @ wide.chart.frame[:, 0]), 4e-4, wide.chart.scale)
    across, times = wide.predicted(chart)
    result = expand(wide.returns, chart, wide.times[0], guess=(across, times))
    transform = coefficient_transform(len(times))
    assert np.allclose((across @ transform).real, result.coefficients, rtol=0, atol=1e-12)
    assert np.allclose((times @ transform).real, result.times, rtol=0, atol=1e-10)
    assert np.max(np.abs(result.coefficients[:, 1])) > 1e-5


def test_a_range_beyond_the_family_is_refused(odd_family: Family) -> None:
    with pytest.raises(CoverFailure, match="does not go from beta"):
        build_atlas(AtlasRequest("x", "x", odd_family, Covers("beta", Fraction(2), Fraction(500))))


def test_command_writes_an_atlas_that_its_check_accepts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "fs.json"
    words = ["atlas", "--system", "falkner-skan", "--covers", "beta", "2", "3", "--quiet"]
    assert main([*words, "-o", str(path)]) == 0
    atlas = read_atlas(path)
    assert atlas.claim.covers == Covers("beta", Fraction(2), Fraction(3))
    assert main(["atlas", "--check", str(path), "--quiet"]) == 0
    assert "all as they should be" in capsys.readouterr().out
    document = json.loads(path.read_text("utf-8"))
    document["pieces"][0]["polynomial"][0][0] = "0.9"
    path.write_text(json.dumps(document), "utf-8")
    assert main(["atlas", "--check", str(path), "--quiet"]) == 1
    assert "not all" in capsys.readouterr().out


def test_a_family_from_a_file_is_covered_in_the_direction_asked_for(tmp_path: Path, odd_family: Family) -> None:
    path, output = tmp_path / "families.json", tmp_path / "fs.json"
    write_families(path, [family_record(TracedFamily("odd", "", odd_family.turned()))])
    words = ["atlas", "--from-family", str(path), "--covers", "beta", "4", "5", "--increasing", "beta", "--quiet"]
    assert main([*words, "-o", str(output)]) == 0
    pieces = read_atlas(output).curve_pieces()
    assert pieces[0].point(Fraction(-1))[0] <= 4 < 5 <= pieces[-1].point(Fraction(1))[0]


def test_what_cannot_be_covered_ends_with_code_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "a.json"
    words = ["atlas", "--system", "cr3bp", "--mass", "earth-moon", "--family", "L1-halo", "--max-orbits", "5"]
    assert main([*words, "--covers", "z", "0", "0.3", "-o", str(output), "--quiet"]) == 1
    error = capsys.readouterr().err
    assert "does not reach z" in error
    assert len(error.splitlines()) == 1
    assert not output.exists()


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--preset", "falkner-skan", "--mass", "0.1"], "--mass"),
        (["--system", "falkner-skan"], "--covers"),
        (["--system", "falkner-skan", "--covers", "beta", "3", "2"], "empty range"),
        (["--system", "falkner-skan", "--covers", "beta", "1", "2"], "beta > 1"),
        (["--system", "falkner-skan", "--covers", "vy", "3", "4"], "no coordinate"),
        (["--system", "falkner-skan", "--covers", "beta", "x", "4"], "no number"),
        (["--system", "falkner-skan", "--covers", "beta", "3", "4", "--coordinates", "regularised"], "regularised"),
        (["--system", "falkner-skan", "--covers", "beta", "3", "4", "--degree", "5"], "--degree"),
        (["--system", "falkner-skan", "--covers", "beta", "3", "4", "--tube", "1"], "--tube"),
        (["--system", "cr3bp", "--family", "L1-halo"], "--mass"),
        (["--system", "cr3bp", "--mass", "2", "--family", "L1-halo"], "outside (0, 1/2]"),
        (["--system", "cr3bp", "--mass", "0.1"], "--family"),
        (["--system", "cr3bp", "--mass", "0.1", "--family", "L7-halo"], "L7-halo"),
        (["--system", "cr3bp", "--mass", "0.1", "--family", "L1-halo", "--increasing", "beta"], "--increasing beta"),
        (["--system", "kepler"], "kepler"),
        (["--from-family", "missing.json"], "missing.json"),
        ([], "--system"),
    ],
)
def test_bad_options_end_in_one_line(
    words: list[str], part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert part in refused(main, ["atlas", *words, "-o", str(tmp_path / "a.json")], capsys)


def test_check_refuses_a_file_that_is_no_atlas(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.json"
    path.write_text("{}", "utf-8")
    assert main(["atlas", "--check", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_written_atlas_is_read_back_unchanged(tmp_path: Path, halo_atlas: Atlas) -> None:
    path = tmp_path / "halo.json"
    write_atlas(path, halo_atlas)
    assert read_atlas(path).pieces == halo_atlas.pieces


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Michelson's family across its fold, where y goes up and comes down again."""
    place = tmp_path_factory.mktemp("turning")
    system = str(Path(__file__).resolve().parents[2] / "docs" / "examples" / "michelson.py")
    words = ["family", "--system", system, "--start", "c=1.0", "y=1.526", "--parameter-min", "c", "0.95", "--quiet"]
    assert main([*words, "-o", str(place / "family.json")]) == 0
    return place / "family.json"


@pytest.mark.slow
def test_an_arc_across_a_fold_in_the_parameter_is_one_atlas_and_proved(turning: Path, tmp_path: Path) -> None:
    atlas, certificate = tmp_path / "atlas.json", tmp_path / "certificate.json"
    words = ["atlas", "--from-family", str(turning), "--covers", "y", "1", "1.55", "--quiet", "-o", str(atlas)]
    assert main(words) == 0
    (found,) = [read_atlas(atlas)]
    values = [float(piece.centre[0]) for piece in found.pieces]
    assert max(values) > max(values[0], values[-1])
    assert verify_main(["atlas", str(atlas), "-o", str(certificate), "--jobs", "1", "--quiet"]) == 0


def test_a_range_that_a_turning_family_does_not_run_through_names_what_there_is(
    turning: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["atlas", "--from-family", str(turning), "--covers", "c", "1.1", "1.3", "-o", str(tmp_path / "never.json")]
    assert main(words) == 1
    assert "c lies between" in capsys.readouterr().err


def test_pieces_that_end_early_are_kept_and_the_place_is_named(
    turning: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Coverer._next

    def lost_after_one(self: Coverer, *given: Any) -> Any:
        if given[1] > self.curve.family.arclengths[0] + 0.3:
            raise CoverFailure(f"no piece beyond {self._text(given[0])}")
        return asked(self, *given)

    monkeypatch.setattr(Coverer, "_next", lost_after_one)
    atlas = tmp_path / "atlas.json"
    words = ["atlas", "--from-family", str(turning), "--covers", "y", "0.9", "1.55", "-o", str(atlas)]
    assert main(words) == 1
    assert "no piece beyond c = " in capsys.readouterr().err
    covers = read_atlas(atlas).claim.covers
    assert covers is not None
    assert covers.start == Fraction("0.9")
    assert 0.9 < covers.end < 1.55
