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
import spiceypy
from astropy.time import TimeDelta
from oem import OrbitEphemerisMessage
from scipy.integrate import solve_ivp
from support import krein_cases

from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.names import NoOrbit
from orbitproof.explore.orbits import multipliers, stability_index
from orbitproof.explore.three_body.masses import CurveRecord, PointRecord, write_curves
from orbitproof.explore.three_body.trajectories import (
    Choice,
    Frame,
    TooFine,
    Trajectory,
    find_orbit,
    largest_error,
    sample,
    trajectory_of,
)
from orbitproof.shared.formats import InputError, write_candidates
from orbitproof.shared.systems import CR3BP

DATA = Path(__file__).resolve().parents[2] / "data"
CANDIDATES, CERTIFICATES = DATA / "figures-candidates.json", DATA / "figures-certificates.json"
FALKNER_SKAN = DATA / "figures-falkner-skan-family.json"
FAMILY, CATALOGUE = DATA / "figures-halo-family.json", DATA / "catalogue-halo.json"
HALO = next(entry["id"] for entry in json.loads(CANDIDATES.read_text())["candidates"] if entry["system"] == "cr3bp")


def with_units(tmp_path: Path) -> Path:
    """The catalogue of the test data, with units of length and time."""
    document = json.loads(CATALOGUE.read_text())
    document["system"] |= {"name": "Earth-Moon", "lunit": 389703.264829278, "tunit": "382981.289129055"}
    path = tmp_path / "units.json"
    path.write_text(json.dumps(document))
    return path


def orbit_of(path: Path, choice: Choice) -> Trajectory:
    return trajectory_of(find_orbit(path, choice))


@pytest.mark.parametrize(
    ("path", "choice"),
    [
        (CANDIDATES, Choice(identifier=HALO)),
        (CERTIFICATES, Choice(identifier=HALO)),
        (FAMILY, Choice(number=9)),
        (CATALOGUE, Choice(number=4)),
        (DATA / "orbit-candidates.json", Choice()),
        (DATA / "known-folds.json", Choice(identifier="earth-moon-L1-halo-fold-1")),
        (DATA / "orbit-vertical.json", Choice()),
        (DATA / "atlas-vertical.json", Choice()),
        (DATA / "orbits-without-reversor.json", Choice(identifier="earth-moon-L1-loss-orbit28")),
        (DATA / "double-resonance.json", Choice()),
    ],
)
def test_states_are_those_of_the_flow_and_come_back(path: Path, choice: Choice) -> None:
    found = orbit_of(path, choice)
    mass = [found.parameters["mu"]]
    times = np.linspace(0.0, 1.25 * found.period, 9)
    states = found.states(times)
    for time, state in zip(times[:4], states[:4], strict=True):
        expected = flow_of(CR3BP).derivative(found.start, time, mass).state
        assert state == pytest.approx(expected, abs=1e-8)
    assert found.states([found.period])[0] == pytest.approx(found.start, abs=1e-10)
    assert flow_of(CR3BP).derivative(found.start, found.period, mass).state == pytest.approx(found.start, abs=1e-6)
    assert found.drift is not None
    assert found.drift < 1e-10


@pytest.mark.parametrize("name", ["double-resonance", "krein-collision"])
def test_orbits_of_claims_of_which_no_branch_begins_have_the_multipliers_that_are_claimed(
    name: str, tmp_path: Path
) -> None:
    path = DATA / f"{name}.json"
    if name == "krein-collision":
        path = tmp_path / "claim.json"
        write_candidates(path, [krein_cases.halo()])
    found = orbit_of(path, Choice()).multipliers
    assert found is not None
    if name == "double-resonance":
        # Two 1:4 resonances.
        assert min(abs(value - 1j) for value in found) < 1e-9
    else:
        pairs = [abs(a - b) for i, a in enumerate(found) for b in found[:i]]
        assert sorted(pairs)[1] < 1e-3


def test_multipliers_are_eigenvalues_of_the_monodromy_matrix() -> None:
    found = orbit_of(CATALOGUE, Choice(number=4))
    mass = [float(found.source.parameters["mu"])]
    monodromy = flow_of(CR3BP).derivative(found.start, found.period, mass).state_transition
    expected = sorted(np.linalg.eigvals(monodromy), key=abs)
    assert found.multipliers is not None
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
    equal = ["--orbit", "4", "--points", "50"]
    assert main(["trajectory", str(path), *equal, "-o", str(plain)]) == 0
    assert main(["trajectory", str(path), *equal, "-o", str(scaled), "--units", "km"]) == 0
    units = ["--units", "km", "--lunit", "384400", "--tunit", "375200"]
    assert main(["trajectory", str(path), *equal, "-o", str(own), *units]) == 0
    length, time = 389703.264829278, 382981.289129055
    comments, rows = rows_of(scaled)
    assert any("389703.264829278 km" in line and "382981.289129055 s" in line for line in comments)
    assert rows == pytest.approx(rows_of(plain)[1] * [time, *[length] * 3, *[length / time] * 3], rel=1e-6, abs=1e-4)
    comments, rows = rows_of(own)
    assert any("384400 km" in line and "375200 s, given by the user" in line for line in comments)
    units = [375200, *[384400] * 3, *[384400 / 375200] * 3]
    assert rows == pytest.approx(rows_of(plain)[1] * units, rel=1e-6, abs=1e-4)
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
    assert (fields.pop("INTERPOLATION"), fields.pop("INTERPOLATION_DEGREE")) == ("HERMITE", "7")
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
        ([str(CATALOGUE), "--orbit", "2"], "-o, --oem, --spk: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--oem", "a.oem"], "--oem: its lengths are km"),
        ([str(CATALOGUE), "--orbit", "2", "--units", "km", "-o", "a.csv"], "--lunit, --tunit: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--units", "km", "--lunit", "3", "-o", "a.csv"], "--tunit: missing"),
        ([str(CATALOGUE), "--orbit", "2", "--epoch", "soon", "-o", "a.csv"], "--epoch soon: no date"),
        ([str(CATALOGUE), "--orbit", "2", "--spk", "a.bsp"], "--spk: .*add --frame inertial"),
        ([str(CATALOGUE), "--orbit", "2", "--points", "9", "--error", "1", "-o", "a.csv"], "--points: --error says"),
        ([str(CATALOGUE), "--orbit", "2", "--error", "1e-19", "-o", "a.csv"], "--error: the error stays at"),
        ([str(CATALOGUE), "--orbit", "-2", "-o", "a.csv"], "--orbit -2: .*only branches have two sides"),
        ([str(CATALOGUE), "--orbit", "2", "--origin", "venus", "-o", "a.csv"], "--origin venus: unknown; give one of"),
        ([str(FALKNER_SKAN), "--orbit", "2", "--frame", "inertial", "-o", "a.csv"], "--frame: .*no orbits in space"),
        ([str(DATA / "atlas-lyapunov.json"), "-o", "a.csv"], "its pieces are no tubes"),
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


def test_a_point_of_a_mass_curve_is_an_orbit(tmp_path: Path) -> None:
    x, vy, half_period = 0.835141279809, 0.119257812388, 1.381819167
    point = PointRecord(0.01, x, vy, (x, vy), (0.0, 0.0), half_period, 3.15519206858753, 0.0, 0.0)
    path = tmp_path / "curves.json"
    write_curves(path, [CurveRecord("L1", "complete", "ends", (point,))])
    found = orbit_of(path, Choice())
    assert "birth of halo orbits about L1" in found.source.title
    assert found.start == pytest.approx([x, 0, 0, 0, vy, 0], abs=1e-9)
    # S breaks there: a pair of multipliers is 1.
    assert any(abs(value - 1) < 1e-4 for value in found.multipliers or ())
    with pytest.raises(InputError, match="--family: no 'L2'"):
        find_orbit(path, Choice(family="L2"))


def test_numbers_of_eight_digits_are_corrected_and_it_is_said(tmp_path: Path) -> None:
    document = json.loads(FAMILY.read_text())
    row = document["families"][0]["orbits"][8]
    row["point"] = [round(value, 8) for value in row["point"]]
    path = tmp_path / "rounded.json"
    path.write_text(json.dumps(document))
    found = orbit_of(path, Choice(number=9))
    assert 1e-10 < found.moved < 1e-7
    assert found.defect < 1e-11
    assert orbit_of(FAMILY, Choice(number=9)).moved == 0


def test_states_are_dense_where_the_orbit_is_fast_and_interpolated_as_well_as_stated() -> None:
    found = orbit_of(DATA / "tori-candidates.json", Choice())
    for wanted in (1e-6, 1e-9):
        dense = sample(found, error=wanted)
        assert dense.error is not None
        assert 0.05 * wanted < dense.error <= wanted
        steps = np.diff(dense.times)
        near = np.linalg.norm(dense.states[:-1, :3] - [1 - found.parameters["mu"], 0, 0], axis=1)
        assert steps[near.argmax()] > 5 * steps[near.argmin()]
        equal = sample(found, count=len(dense.times))
        assert equal.error is not None
        assert equal.error > 1000 * wanted
    with pytest.raises(TooFine, match="stays at"):
        sample(found, error=1e-18)


def test_the_error_of_an_interpolation_is_that_of_a_polynomial_of_degree_eight() -> None:
    """Between four states a polynomial of degree 8 is off by its leading coefficient times the square of (t - t_i)."""

    def states_at(times: np.ndarray) -> np.ndarray:
        zero = np.zeros_like(times)
        return np.column_stack([times**8, times**7, zero, 8 * times**7, 7 * times**6, zero])

    times = np.array([0.0, 1.0, 1.5, 3.0])
    at = np.array([0.5, 1.25, 2.25])
    expected = np.abs(np.prod(at[:, None] - times, axis=1) ** 2).max()
    assert largest_error(states_at, times, states_at(times)) == pytest.approx(expected, rel=0.2)
    assert (
        largest_error(lambda t: states_at(t) * [0, 1, 1, 0, 1, 1], times, states_at(times) * [0, 1, 1, 0, 1, 1]) < 1e-9
    )


@pytest.mark.parametrize("origin", ["barycentre", "larger", "smaller"])
def test_an_inertial_frame_is_one_in_which_the_bodies_turn(origin: str) -> None:
    """The orbit there solves Newton's equations between two bodies on circles, integrated on their own."""
    found = orbit_of(CATALOGUE, Choice(number=4))
    mass = found.parameters["mu"]
    frame = Frame("inertial", origin)
    times = np.linspace(0.0, found.period, 7)
    states = frame.states(times, found.states(times), mass)
    offset = {"barycentre": None, "larger": -mass, "smaller": 1 - mass}[origin]

    def body(place: float, time: float) -> np.ndarray:
        return place * np.array([np.cos(time), np.sin(time), 0.0])

    def field(time: float, state: np.ndarray) -> np.ndarray:
        centre = np.zeros(3) if offset is None else body(offset, time)
        place = state[:3] + centre
        pull = centre.copy()
        for weight, where in ((1 - mass, -mass), (mass, 1 - mass)):
            gap = place - body(where, time)
            pull = pull - weight * gap / np.linalg.norm(gap) ** 3
        return np.append(state[3:], pull)

    solution = solve_ivp(field, (0, times[-1]), states[0], method="DOP853", rtol=1e-12, atol=1e-12, t_eval=times)
    assert pytest.approx(states, abs=1e-7) == solution.y.T


def test_an_ephemeris_message_is_interpolated_by_another_library_as_well_as_it_says(tmp_path: Path) -> None:
    message = tmp_path / "a.oem"
    words = ["--orbit", "4", "--units", "km", "--frame", "inertial", "--origin", "MOON", "--oem", str(message)]
    assert main(["trajectory", str(with_units(tmp_path)), *words]) == 0
    (segment,) = OrbitEphemerisMessage.open(message).segments
    assert (segment.metadata["CENTER_NAME"], segment.metadata["REF_FRAME"]) == ("MOON", "EARTH-MOON_INERTIAL")
    (stated,) = re.findall(r"off by at most (\S+) km", message.read_text())
    found = sample(
        trajectory_of(find_orbit(with_units(tmp_path), Choice(number=4))),
        frame=Frame("inertial", "smaller"),
        units=find_orbit(with_units(tmp_path), Choice(number=4)).units,
    )
    times = np.linspace(0.001, found.times[-1] - 0.001, 40)
    places = [segment(segment.useable_start_time + TimeDelta(time, format="sec")).position for time in times]
    error = np.linalg.norm(np.array(places) - found.states_at(times)[:, :3], axis=1).max()
    assert 1e-5 < error <= 1.05 * float(stated) + 1e-5 <= 1.1e-3


def test_an_spk_file_gives_the_orbit_back_to_spice(tmp_path: Path) -> None:
    kernel = tmp_path / "a.bsp"
    words = [
        "--orbit",
        "4",
        "--units",
        "km",
        "--frame",
        "inertial",
        "--origin",
        "moon",
        "--epoch",
        "2030-01-01T00:00:00",
    ]
    assert main(["trajectory", str(with_units(tmp_path)), *words, "--spk", str(kernel), "--spk-body", "-77"]) == 0
    source = find_orbit(with_units(tmp_path), Choice(number=4))
    found = sample(trajectory_of(source), frame=Frame("inertial", "smaller"), units=source.units)
    start = (np.datetime64("2030-01-01T00:00:00") - np.datetime64("2000-01-01T12:00:00")) / np.timedelta64(1, "s")
    spiceypy.furnsh(str(kernel))
    try:
        times = np.linspace(0.0, found.times[-1], 50)
        states = np.array([spiceypy.spkgeo(-77, start + time, "ECLIPJ2000", 301)[0] for time in times])
    finally:
        spiceypy.unload(str(kernel))
    gaps = states - found.states_at(times)
    assert np.linalg.norm(gaps[:, :3], axis=1).max() < 1e-3
    assert np.linalg.norm(gaps[:, 3:], axis=1).max() < 1e-5
