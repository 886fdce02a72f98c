"""Trajectories: states over time from any file that names an orbit, as CSV and as CCSDS ephemeris message."""

from __future__ import annotations

import csv
import json
import math
import re
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.orbits import multipliers, stability_index
from orbitproof.explore.trajectories import Choice, NoOrbit, Trajectory, find_orbit, trajectory_of
from orbitproof.shared.systems import CR3BP

DATA = Path(__file__).resolve().parents[1] / "data"
CANDIDATES, CERTIFICATES = DATA / "figures-candidates.json", DATA / "figures-certificates.json"
FAMILY, CATALOGUE = DATA / "figures-halo-family.json", DATA / "catalogue-halo.json"
HALO = next(entry["id"] for entry in json.loads(CANDIDATES.read_text())["candidates"] if entry["system"] == "cr3bp")


def with_units(tmp_path: Path) -> Path:
    """The catalogue of the test data, with units of length and time."""
    document = json.loads(CATALOGUE.read_text())
    document["system"] |= {"name": "Earth-Moon", "lunit": 389703.264829278, "tunit": "382981.289129055"}
    path = tmp_path / "units.json"
    path.write_text(json.dumps(document))
    return path


def orbit_of(path: Path, choice: Choice, count: int = 9, periods: float = 1.0) -> Trajectory:
    return trajectory_of(find_orbit(path, choice), count, periods)


@pytest.mark.parametrize(
    ("path", "choice"),
    [
        (CANDIDATES, Choice(identifier=HALO)),
        (CERTIFICATES, Choice(identifier=HALO)),
        (FAMILY, Choice(number=9)),
        (CATALOGUE, Choice(number=4)),
    ],
)
def test_states_are_those_of_the_flow_and_come_back(path: Path, choice: Choice) -> None:
    found = orbit_of(path, choice, periods=1.25)
    mass = [float(found.source.parameters["mu"])]
    for time, state in zip(found.times[:4], found.states[:4], strict=True):
        expected = flow_of(CR3BP).derivative(found.states[0], time, mass).state
        assert state == pytest.approx(expected, abs=1e-8)
    period = found.orbit.period
    again = trajectory_of(found.source, 2, 1.0)
    assert again.states[1] == pytest.approx(again.states[0], abs=1e-10)
    assert found.times[-1] == pytest.approx(1.25 * period)
    assert found.drift is not None
    assert found.drift < 1e-10


def test_multipliers_are_eigenvalues_of_the_monodromy_matrix() -> None:
    found = orbit_of(CATALOGUE, Choice(number=4))
    mass = [float(found.source.parameters["mu"])]
    monodromy = flow_of(CR3BP).derivative(found.states[0], found.orbit.period, mass).state_transition
    expected = sorted(np.linalg.eigvals(monodromy), key=abs)
    assert max(map(abs, found.multipliers)) == pytest.approx(abs(expected[-1]), rel=1e-6)
    assert found.stability_index == pytest.approx(0.5 * (abs(expected[-1]) + 1 / abs(expected[-1])), rel=1e-6)


def test_multipliers_come_in_pairs_and_give_the_stability_parameters_back() -> None:
    parameters = (0.3, -1e6, complex(2.0, 1.0))
    found = multipliers(parameters)
    assert len(found) == 6
    for s in parameters:
        assert min(abs((value + 1 / value) / 2 - s) / abs(s) for value in found) < 1e-14
    assert math.prod(abs(value) for value in found) == pytest.approx(1.0)
    assert stability_index(parameters) == pytest.approx(1e6)


def test_a_certificate_s_verdict_is_copied_and_no_more_is_said() -> None:
    proved = find_orbit(CERTIFICATES, Choice(identifier=HALO)).verdict
    assert '"proved"' in proved
    assert "not checked again" in proved
    assert "not proved" in find_orbit(CANDIDATES, Choice(identifier=HALO)).verdict


def test_a_row_that_is_no_orbit_is_refused(tmp_path: Path) -> None:
    document = json.loads(FAMILY.read_text())
    document["families"][0]["orbits"][8]["half_period"] *= 1.01
    path = tmp_path / "wrong.json"
    path.write_text(json.dumps(document))
    with pytest.raises(NoOrbit, match="no periodic orbit"):
        orbit_of(path, Choice(number=9))
    assert main(["trajectory", str(path), "--orbit", "9", "-o", str(tmp_path / "a.csv")]) == 1
    assert not (tmp_path / "a.csv").exists()


def rows_of(path: Path) -> tuple[list[str], np.ndarray]:
    """The comments and the numbers of a CSV file."""
    lines = path.read_text().splitlines()
    comments = [line for line in lines if line.startswith("#")]
    table = list(csv.reader(lines[len(comments) + 1 :]))
    return comments, np.array(table, dtype=float)


def test_kilometres_are_the_units_times_the_numbers_and_named_in_the_file(tmp_path: Path) -> None:
    path = with_units(tmp_path)
    plain, scaled, own = (tmp_path / name for name in ("a.csv", "b.csv", "c.csv"))
    assert main(["trajectory", str(path), "--orbit", "4", "-o", str(plain)]) == 0
    assert main(["trajectory", str(path), "--orbit", "4", "-o", str(scaled), "--units", "km"]) == 0
    units = ["--units", "km", "--lunit", "1000", "--tunit", "10"]
    assert main(["trajectory", str(path), "--orbit", "4", "-o", str(own), *units]) == 0
    length, time = 389703.264829278, 382981.289129055
    comments, rows = rows_of(scaled)
    assert any("389703.264829278 km" in line and "382981.289129055 s" in line for line in comments)
    assert rows == pytest.approx(rows_of(plain)[1] * [time, *[length] * 3, *[length / time] * 3])
    comments, rows = rows_of(own)
    assert any("1000 km" in line and "10 s, given by the user" in line for line in comments)
    assert rows == pytest.approx(rows_of(plain)[1] * [10, *[1000] * 3, *[100] * 3])
    assert not any("unit of length" in line for line in rows_of(plain)[0])


def read_message(path: Path) -> tuple[dict[str, str], list[str], list[tuple[datetime, list[float]]]]:
    """A reader of one-segment ephemeris messages by the standard alone: keywords, comments, states."""
    fields: dict[str, str] = {}
    comments: list[str] = []
    states: list[tuple[datetime, list[float]]] = []
    inside = False
    for line in filter(None, map(str.strip, path.read_text("ascii").splitlines())):
        assert len(line) <= 254
        if line.startswith("COMMENT"):
            comments.append(line.removeprefix("COMMENT").strip())
        elif line in ("META_START", "META_STOP"):
            inside = line == "META_START"
        elif "=" in line:
            key, value = (part.strip() for part in line.split("=", 1))
            assert key.isupper()
            assert inside or key in ("CCSDS_OEM_VERS", "CREATION_DATE", "ORIGINATOR")
            fields[key] = value
        else:
            assert not inside
            date, *numbers = line.split()
            whole, fraction = date.split(".")
            moment = datetime.fromisoformat(whole) + timedelta(seconds=float(f"0.{fraction}"))
            states.append((moment, [float(number) for number in numbers]))
    return fields, comments, states


def test_ephemeris_message_is_read_back_by_an_independent_reader(tmp_path: Path) -> None:
    table, message = tmp_path / "a.csv", tmp_path / "a.oem"
    words = ["--orbit", "4", "--units", "km", "--epoch", "2030-05-06T07:08:09", "--points", "50"]
    assert main(["trajectory", str(with_units(tmp_path)), *words, "-o", str(table), "--oem", str(message)]) == 0
    assert "\n\n\n" not in message.read_text()
    assert re.search(r"\n2030-05-06T.*\n2030-05-06T.*\n2030", message.read_text())
    fields, comments, states = read_message(message)
    wanted = {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM", "START_TIME", "STOP_TIME"}
    assert wanted | {"CCSDS_OEM_VERS", "CREATION_DATE", "ORIGINATOR"} == set(fields)
    assert fields["CENTER_NAME"] == "EARTH-MOON BARYCENTER"
    assert any("389703.264829278 km" in line for line in comments)
    assert any("nothing about these states is proved" in line for line in comments)
    _, rows = rows_of(table)
    assert len(states) == len(rows) == 50
    start = datetime(2030, 5, 6, 7, 8, 9)
    for row, (date, state) in zip(rows, states, strict=True):
        assert (date - start).total_seconds() == pytest.approx(row[0], abs=2e-6)
        assert state == pytest.approx(row[1:], rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([str(CANDIDATES), "-o", "a.csv"], "--id: missing; give one of"),
        ([str(CANDIDATES), "--id", "nobody", "-o", "a.csv"], "--id: no 'nobody'"),
        ([str(CANDIDATES), "--id", HALO, "--orbit", "3", "-o", "a.csv"], "--orbit: .*choose with --id"),
        ([str(FAMILY), "-o", "a.csv"], "--orbit: missing"),
        ([str(FAMILY), "--orbit", "100000", "-o", "a.csv"], "--orbit 100000: .*smaller"),
        (
            [str(FAMILY), "--family", "L7", "--orbit", "1", "-o", "a.csv"],
            "no families of .* 'L7'; give one of",
        ),
        ([str(CATALOGUE), "--orbit", "2"], "-o, --oem: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--oem", "a.oem"], "--oem: its lengths are km"),
        ([str(CATALOGUE), "--orbit", "2", "--units", "km", "-o", "a.csv"], "--lunit, --tunit: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--units", "km", "--lunit", "3", "-o", "a.csv"], "--tunit: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--epoch", "soon", "-o", "a.csv"], "--epoch soon: no date"),
        ([str(DATA / "atlas-lyapunov.json"), "-o", "a.csv"], "holds atlas; give candidates"),
        (["nowhere.json", "-o", "a.csv"], "nowhere.json: cannot be read"),
    ],
)
def test_bad_input_is_one_line_with_its_remedy(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["trajectory", *words]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert re.search(said, lines[0])
    assert not list(tmp_path.iterdir())
