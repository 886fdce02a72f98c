"""One orbit on the command line: from a family or a catalogue to its certificate, and to its place on a curve."""

from __future__ import annotations

import json
from dataclasses import replace
from math import pi
from pathlib import Path
from typing import Any

import pytest
from support.stored import values

from orbitproof.explore.__main__ import main as explore
from orbitproof.explore.three_body.names import MONTHS
from orbitproof.shared.formats import read_atlas, read_candidates
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.branches import make_atlas_certificate, recheck_place
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.certificate import (
    Level,
    digest,
    read_certificate,
    read_certificates,
    recheck,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.curve import conclude
from orbitproof.verify.evidence import spared
from orbitproof.verify.run import branch_checks

DATA = Path(__file__).resolve().parents[1] / "data"
FAMILY = DATA / "figures-falkner-skan-family.json"
CATALOGUE = DATA / "catalogue-halo.json"


@pytest.fixture(scope="module")
def curve(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The certificate of a curve of Falkner-Skan orbits, 260 <= beta <= 690, from stored results."""
    path = tmp_path_factory.mktemp("curve") / "curve.json"
    atlas = read_atlas(DATA / "atlas-falkner-skan.json")
    stored = values(json.loads((DATA / "stability-falkner-skan.json").read_text()))
    # As they were found: what is stored is a little wider (13.3).
    results = [replace(result, time=spared(result.time)) for result in stored]
    conclusion = conclude(atlas, results)
    assert conclusion.is_proved
    write_certificate(path, make_atlas_certificate(atlas, results, told(conclusion)))
    return path


@pytest.fixture(scope="module")
def orbits(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two orbits of the Falkner-Skan family as candidates, one of them on the curve."""
    path = tmp_path_factory.mktemp("orbits") / "orbits.json"
    for beta in ("400", "150"):
        words = [
            "orbit",
            "--from-family",
            str(FAMILY),
            "--at",
            f"beta={beta}",
            "--digits",
            "25",
            "--id",
            f"beta-{beta}",
        ]
        assert explore([*words, "-o", str(path), "--quiet"]) == 0
    return path


def test_a_refined_orbit_is_printed_with_days_kilometres_and_stability(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--system", "cr3bp", "--mass", "JPL-Earth-Moon", "--start", "x=0.9874376", "z=0.00750741", "vy=1.7705017"]
    output = str(tmp_path / "orbit.json")
    assert explore(["orbit", *words, "--period", "6.56days", "--id", "nrho", "-o", output, "--quiet"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    said = {line[2:17].strip(): line[17:].strip() for line in lines}
    assert head == "nrho"
    assert said["state"].startswith("x = 0.987437605721, y = 0, z = 0.00750741042")
    assert said["period"] == "1.47992608539  (6.56 days)"
    assert said["Jacobi constant"].startswith("3.048912828")
    assert said["stability index"] == "1.25523"
    assert said["perilune"].endswith("(2930.06 km)")
    assert all(len(line) <= 80 for line in lines)


def test_an_orbit_of_a_family_is_proved_and_placed_on_a_curve(
    orbits: Path, curve: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "certificates.json"
    words = [str(orbits), "-o", str(output), "--curve", str(curve), "--digits", "10", "--jobs", "1", "--quiet"]
    assert verify(words) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "beta-400: lies on the proved curve falkner-skan" in said
    assert "beta-150: not shown to lie on falkner-skan-part: it lies beyond the ends of all pieces" in said
    found = read_certificates(output)["beta-400"].orbit
    assert found is not None
    assert found.point["beta"] == 400
    assert len(found.stability.parameters) == 1


@pytest.fixture(scope="module")
def placed(orbits: Path, curve: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The certificate of the orbit on the curve, with its place."""
    path = tmp_path_factory.mktemp("placed") / "certificates.json"
    words = [str(orbits), "--only", "beta-400", "-o", str(path), "--curve", str(curve), "--digits", "10"]
    assert verify([*words, "--jobs", "1", "--quiet"]) == 0
    return path


def test_a_place_is_kept_and_checked_with_the_certificate_of_the_curve(
    placed: Path, curve: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (entry,) = json.loads(placed.read_text())["certificates"]
    document = json.loads(curve.read_text())
    assert entry["place"]["rests_on"] == {"id": document["id"], "digest": document["digest"]}
    assert entry["place"]["piece"] in {piece["id"] for piece in document["statement"]["atlas"]["pieces"]}
    assert document["digest"] in entry["place"]["statement"]
    words = ["--recheck", str(placed), "--quiet", "--jobs", "1"]
    assert verify([*words, "--curve", str(curve)]) == 0
    assert "not checked" not in capsys.readouterr().out
    assert verify(words) == 1
    shown = capsys.readouterr().out
    assert "give its certificate as --curve" in shown
    assert document["digest"] in shown
    (alone,) = (recheck(entry) for entry in read_certificates(placed).values())
    assert not alone.stands
    assert alone.stands_without_place
    assert "give its certificate as `curve`" in alone.open_place


@pytest.mark.slow
def test_a_place_stands_when_orbit_and_curve_are_integrated_again(placed: Path, curve: Path) -> None:
    words = ["--recheck", "--integrate", str(placed), "--curve", str(curve), "--quiet", "--jobs", "1"]
    assert verify(words) == 0


def test_an_interrupt_while_the_curve_is_checked_leaves_the_rows(
    placed: Path, curve: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def examined(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(branch_checks, "examined", examined)
    assert verify(["--recheck", str(placed), "--curve", str(curve), "--quiet"]) == INTERRUPTED
    output, errors = capsys.readouterr()
    assert "its place rests on the curve" in output
    assert "interrupted" in errors


def another_s(place: dict[str, Any]) -> None:
    place["s"]["rad"] = "0x1p-200"


def test_a_forged_place_does_not_stand(placed: Path, curve: Path, tmp_path: Path) -> None:
    (entry,) = read_certificates(placed).values()
    place = entry.to_json()["place"]
    another_s(place)
    forged = tmp_path / "forged.json"
    write_certificates(forged, [entry.with_place(place)])
    assert verify(["--recheck", str(forged), "--curve", str(curve), "--quiet", "--jobs", "1"]) == 1


def test_a_place_of_an_orbit_that_is_not_on_the_curve_does_not_stand(
    orbits: Path, placed: Path, curve: Path, tmp_path: Path
) -> None:
    path = tmp_path / "off.json"
    words = [str(orbits), "--only", "beta-150", "-o", str(path), "--curve", str(curve), "--digits", "10"]
    assert verify([*words, "--jobs", "1", "--quiet"]) == 0
    (off,), (on,) = (read_certificates(each).values() for each in (path, placed))
    assert "place" not in off.to_json()
    write_certificates(path, [off.with_place(on.to_json()["place"])])
    assert verify(["--recheck", str(path), "--curve", str(curve), "--quiet", "--jobs", "1"]) == 1


def test_a_place_on_a_curve_whose_certificate_does_not_stand_does_not_stand(
    placed: Path, curve: Path, tmp_path: Path
) -> None:
    """The curve's certificate says more than it has shown; its digest is right, and so is that in the place."""
    document = json.loads(curve.read_text())
    document["results"][1]["deviation"] = document["results"][1]["slope_deviation"] = ["0x1p-300"]
    document["digest"] = digest(document)
    changed = tmp_path / "changed.json"
    changed.write_text(json.dumps(document))
    (entry,) = read_certificates(placed).values()
    place = entry.to_json()["place"]
    place["rests_on"]["digest"] = document["digest"]
    place["statement"] = place["statement"].replace(json.loads(curve.read_text())["digest"], document["digest"])
    path = tmp_path / "placed.json"
    write_certificates(path, [entry.with_place(place)])
    assert verify(["--recheck", str(path), "--curve", str(changed), "--quiet", "--jobs", "1"]) == 1


def test_a_place_is_not_shown_by_the_check_of_another_curve(placed: Path, curve: Path) -> None:
    (entry,) = read_certificates(placed).values()
    given, check = read_certificate(curve, "atlas-certificate"), recheck(entry)
    own = recheck(given)
    shown = recheck_place(given, own, entry, check)
    assert (shown.stands, shown.level) == (True, Level.CONCLUSION)
    other = {**given.document, "computation": {"intervals": 2, "seconds": 0.0}}
    changed = replace(given, document=other)
    for which, examined in ((given, replace(own, digest=digest(other))), (changed, own)):
        with pytest.raises(ValueError, match="not of the curve"):
            recheck_place(which, examined, entry, check)
    # An orbit is integrated again, its curve is not.
    deeper = replace(check, level=Level.INTEGRATION)
    assert recheck_place(given, own, entry, deeper).level is Level.CONCLUSION


def test_a_run_goes_on_with_what_is_refined_already(orbits: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = orbits.read_text()
    words = ["orbit", "--from-family", str(FAMILY), "--at", "beta=150", "--digits", "25", "--id", "beta-150"]
    assert explore([*words, "-o", str(orbits)]) == 0
    assert "1 of 1 orbits are in" in capsys.readouterr().err
    assert {each.id for each in read_candidates(orbits)} == {"beta-400", "beta-150"}
    assert len(orbits.read_text()) == len(before)


def test_rows_of_a_catalogue_are_proved_near_their_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    candidates, certificates = tmp_path / "rows.json", tmp_path / "certificates.json"
    words = ["orbit", "--from-catalogue", str(CATALOGUE)]
    assert explore([*words, "--catalogue-orbit", "4", "6", "--digits", "20", "-o", str(candidates), "--quiet"]) == 0
    assert [each.id for each in read_candidates(candidates)] == ["row-0004", "row-0006"]
    assert verify([str(candidates), "-o", str(certificates), "--digits", "5", "--jobs", "1", "--quiet"]) == 0
    capsys.readouterr()
    assert explore([*words, "--certificates", str(certificates)]) == 0
    *_, last = capsys.readouterr().out.splitlines()
    assert last.startswith("2 of 2 certificates say that an orbit near its row is proved, at most ")
    assert float(last.split("at most ")[1].split()[0]) < 1e-9


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["--family", "L2-halo", "--mass", "0.01"], "--period, --level or --at"),
        (["--family", "L2-halo", "--mass", "0.01", "--period", "1", "--level", "3"], "--period, --level or --at"),
        (["--family", "L2-halo", "--mass", "0.01", "--period", "-1"], "--period -1"),
        (["--family", "L2-halo", "--mass", "0.01", "--period", "month"], "--period month"),
        (["--family", "L2-halo", "--mass", "0.01", "--at", "y=0"], "--at y"),
        (["--family", "L9-halo", "--mass", "0.01", "--period", "1"], "no family of cr3bp; give L1-halo"),
        (["--every", "3", "--mass", "0.01"], "--every"),
        (["--from-catalogue", str(CATALOGUE), "--mass", "0.01"], "--mass"),
        (["--from-catalogue", str(CATALOGUE), "--catalogue-orbit", "99"], "--catalogue-orbit 99"),
        (["--from-catalogue", str(CATALOGUE), "--certificates", str(CATALOGUE)], "catalogue-halo.json"),
        (["--system", "falkner-skan", "--start", "beta=400", "y=0.9", "--level", "1"], "--level"),
        (["--from-family", str(FAMILY), "--at", "beta=400", "--tori"], "--tori: orbits of falkner-skan have n = 1"),
        (["--from-family", str(FAMILY), "--at", "beta=400", "--tori", "--stable"], "--tori"),
        (["--system", "falkner-skan", "--start", "beta=400", "y=0.94", "--stable"], "--period, --level or --at"),
        (["--from-family", str(FAMILY), "--extrema", "--stable"], "--stable"),
        (["--from-family", str(FAMILY), "--extrema", "--tori"], "--tori"),
    ],
)
def test_bad_input_is_named(words: list[str], named: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert explore(["orbit", *words, "-o", str(tmp_path / "out.json"), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert named in error
    assert "Traceback" not in error
    assert not (tmp_path / "out.json").exists()


def test_half_periods_that_go_round_twice_and_guesses_that_are_moved_are_told(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["orbit", "--mass", "jpl-earth-moon", "--system", "cr3bp", "--start", "x=1.1380985", "z=-0.166164"]
    assert explore([*words, "vy=-0.22405", "--half-period", "3.0905736"]) == 0
    found = capsys.readouterr()
    assert "the half period given is 2 times that of the orbit" in found.err
    assert "half period      1.545286" in found.out
    assert explore([*words, "vy=-0.2128"]) == 0
    assert "the orbit that was found starts" in capsys.readouterr().err


@pytest.mark.parametrize("times", [13, 34])
def test_the_least_half_period_is_found_of_any_multiple(times: int, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "orbit",
        "--system",
        str(DATA.parents[1] / "docs" / "examples" / "henon-heiles.py"),
        "--start",
        "y=0.0939044893",
        "vx=0.10355806157",
    ]
    assert explore([*words, "--half-period", str(3.131862672256 * times)]) == 0
    found = capsys.readouterr()
    assert f"the half period given is {times} times that of the orbit" in found.err
    assert "half period      3.1318626722" in found.out
    assert "1 in the half period" in found.out


def test_a_period_that_no_orbit_has_is_not_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["orbit", "--from-family", str(FAMILY), "--period", "7", "-o", str(tmp_path / "out.json"), "--quiet"]
    assert explore(words) == 1
    assert "no orbit with the period 7" in capsys.readouterr().err


def test_months_are_those_of_the_moon_and_not_known_elsewhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert float(MONTHS["sidereal_month"]) == 2 * pi
    assert abs(float(MONTHS["synodic_month"]) / (2 * pi) - 29.530588853 / 27.321661547) < 1e-15
    # From new moon to new moon the Moon makes one turn more than the Earth about the Sun, in 365.25636 days.
    assert abs(float(MONTHS["synodic_month"] / MONTHS["sidereal_month"]) - 1 / (1 - 27.321661547 / 365.25636)) < 1e-7
    words = ["orbit", "--from-family", str(FAMILY), "--period", "synodic_month", "-o", str(tmp_path / "out.json")]
    assert explore(words) == 2
    assert "--period synodic_month: no number" in capsys.readouterr().err


def test_an_orbit_is_found_and_proved_to_be_stable_for_ever(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found, proved = tmp_path / "stable.json", tmp_path / "certificates.json"
    words = ["orbit", "--from-family", str(FAMILY), "--at", "beta=400", "--digits", "20", "-o", str(found), "--quiet"]
    assert explore([*words, "--stable"]) == 0
    (candidate,) = read_candidates(found)
    assert candidate.kind == "stable_orbit"
    # The same orbit without this claim is another one, and is refined again.
    assert explore(words) == 0
    assert read_candidates(found)[0].kind == "orbit"
    assert explore([*words, "--stable"]) == 0
    assert verify([str(found), "-o", str(proved), "--quiet"]) == 0
    assert "  stable orbit\n" in capsys.readouterr().out
    (certificate,) = read_certificates(proved).values()
    assert "stable for ever" in (certificate.theorem or "")
