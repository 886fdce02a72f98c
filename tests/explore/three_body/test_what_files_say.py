"""What files and starts say of an orbit, beside its state, is compared with the orbit that is found."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.names import Contradiction
from orbitproof.explore.orbits import Numbers, contradictions, fallen
from orbitproof.explore.three_body.catalogues import correct_catalogue, read_catalogue
from orbitproof.explore.three_body.names import given_parameters
from orbitproof.explore.three_body.trajectories import Choice, find_orbit, trajectory_of
from orbitproof.shared.formats import InputError, read_candidates
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, FALKNER_SKAN, MASS_PARAMETERS

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "tests" / "data"
ROWS = ROOT / "docs" / "examples" / "gateway-rows.json"
COLUMN = {"x": 0, "z": 2, "vy": 4, "jacobi": 6, "period": 7, "stability": 8}

SMALL = {"x": 1.0039864423894023, "z": 4.3e-6, "vy": 0.0046152661248332135}
SMALL_PERIOD = 3.0914791465446096
"""A halo orbit next to the planar ones, Sun-Mars, as a certificate encloses it."""


def with_row(tmp_path: Path, **changes: Any) -> Path:
    """The rows of the Gateway's page, the second with other numbers."""
    document = json.loads(ROWS.read_text())
    for name, value in changes.items():
        document["data"][1][COLUMN[name]] = value
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(document))
    return path


COMMANDS: dict[str, list[str]] = {
    "trajectory": ["trajectory", "FILE", "--orbit", "2", "-o"],
    "tori": ["tori", "FILE", "--orbit", "2", "--curves", "1", "-o"],
    "orbit": ["orbit", "--from-catalogue", "FILE", "--catalogue-orbit", "2", "--digits", "16", "-o"],
    "family by row": ["family", "--from-catalogue", "FILE", "--catalogue-orbit", "2", "--max-orbits", "3", "-o"],
    "family by orbit": ["family", "--from-orbit", "FILE", "--orbit", "2", "--max-orbits", "3", "-o"],
    "distances": ["catalogue", "FILE", "--distances", "--period", "6", "7", "-o"],
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_row_with_its_period_in_days_is_told_with_both_numbers_and_nothing_is_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, output = with_row(tmp_path, period=6.5607), tmp_path / "out.json"
    words = [str(path) if word == "FILE" else word for word in COMMANDS[name]]
    assert main([*words, str(output)]) == 1
    errors = capsys.readouterr().err
    assert "period 6.5607 was given, 6.2758" in errors
    assert "Jacobi constant 3.048908589 was given, 3.0423" in errors
    assert "stability index 1.255353282 was given, 18.56" in errors
    assert "--accept" in errors
    assert not output.exists()


@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "tori"])
def test_such_an_orbit_is_taken_if_the_user_accepts_it(name: str, tmp_path: Path) -> None:
    path, output = with_row(tmp_path, period=6.5607), tmp_path / "out.json"
    words = [str(path) if word == "FILE" else word for word in COMMANDS[name]]
    assert main([*words, str(output), "--accept"]) == 0
    assert output.exists()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"jacobi": 3.04919}, "Jacobi constant 3.04919 was given, 3.0489"),
        ({"jacobi": "3.0479"}, "Jacobi constant 3.0479 was given, 3.0489"),
        ({"stability": 1.5}, "stability index 1.5 was given, 1.2553"),
        ({"period": 1.492}, "period 1.492 was given"),
        ({"z": -0.18}, "another orbit was found"),
        ({"vy": -0.0985}, "another orbit was found"),
    ],
)
def test_every_number_of_a_row_is_compared(change: dict[str, Any], told: str, tmp_path: Path) -> None:
    path = with_row(tmp_path, **change)
    corrected = correct_catalogue(read_catalogue(path))
    assert [bool(reason) for reason in corrected.reasons] == [False, True, False]
    assert told in corrected.reasons[1]
    with pytest.raises(Contradiction, match="another orbit was found"):
        explore.read_orbit(path, number=2)
    assert explore.read_orbit(path, number=2, accept=True).period > 1.4


@pytest.mark.parametrize(
    ("change", "told"),
    [({"branch": "N"}, "branch N was given, S found"), ({"libration_point": "1"}, "libration point L1 was given, L2")],
)
def test_the_side_and_the_libration_point_of_halo_orbits_are_compared(
    change: dict[str, str], told: str, tmp_path: Path
) -> None:
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(json.loads(ROWS.read_text()) | change))
    assert all(told in reason for reason in correct_catalogue(read_catalogue(path)).reasons)


@pytest.mark.parametrize("digits", [4, 5, 7, 16])
def test_rounded_rows_agree_with_their_orbits(digits: int, tmp_path: Path) -> None:
    document = json.loads(ROWS.read_text())
    document["data"] = [[round(float(value), digits) for value in row] for row in document["data"]]
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(document))
    assert correct_catalogue(read_catalogue(path)).reasons == ("", "", "")


def test_numbers_contradict_as_soon_as_their_digits_do_not_explain_them() -> None:
    values, state = [0.01], np.array([1.1234, 0.0, 0.1, 0.0, 0.2, 0.0])
    found = Numbers(state, 2.0, 3.0, 5.0)

    def told(**said: Any) -> int:
        return len(contradictions(CR3BP, values, Numbers(**({"state": state} | said)), found))

    assert told(period=2.0, level=3.0, stability_index=5.0) == 0
    assert told(period=2.001) == 0
    assert told(period=2.01) == 1
    assert told(level=3.01, stability_index=5.5) == 2
    assert told(level=3.04, rounded=True) == 1
    assert told(period=2.0, level=3.0, stability_index=5.0, state=state + 1e-3) == 1
    assert told(period=float("nan")) == 1


def _changed(path: Path, tmp_path: Path, change: Callable[[dict[str, Any]], None]) -> Path:
    document = json.loads(path.read_text())
    change(document)
    result = tmp_path / "changed.json"
    result.write_text(json.dumps(document))
    return result


def _level_of_a_family(document: dict[str, Any]) -> None:
    document["families"][0]["orbits"][8]["first_integral"] += 0.01


def _stability_of_a_family(document: dict[str, Any]) -> None:
    document["families"][0]["orbits"][8]["stability"] = [[0.0, 0.0], [3.0, 0.0]]


def _level_of_a_candidate(document: dict[str, Any]) -> None:
    document["candidates"][0]["equation"] = {"quantity": "level", "value": "3.0"}


@pytest.mark.parametrize(
    ("file", "choice", "change", "name"),
    [
        ("figures-halo-family.json", Choice(number=9), _level_of_a_family, "Jacobi constant"),
        ("figures-halo-family.json", Choice(number=9), _stability_of_a_family, "stability index"),
        ("tori-candidates.json", Choice(), _level_of_a_candidate, "Jacobi constant"),
    ],
)
def test_other_files_are_compared_with_their_orbits_too(
    file: str, choice: Choice, change: Callable[[dict[str, Any]], None], name: str, tmp_path: Path
) -> None:
    trajectory_of(find_orbit(DATA / file, choice))
    path = _changed(DATA / file, tmp_path, change)
    with pytest.raises(Contradiction, match=rf"{name} .* was given, "):
        trajectory_of(find_orbit(path, choice))
    trajectory_of(find_orbit(path, Choice(choice.identifier, choice.family, choice.number, accept=True)))


def test_a_small_orbit_off_the_plane_is_not_corrected_to_one_in_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "orbit.json"
    words = ["orbit", "--system", "cr3bp", "--mass", "sun-mars", "--start", "x=1.00398", "z=4.3e-6", "vy=0.00461"]
    assert main([*words, "-o", str(output)]) == 1
    errors = capsys.readouterr().err
    assert "the start, z = 4.3e-06, is off the fixed set of the symmetry S, and the orbit found, z = " in errors
    assert "is in it and so another one; keep that coordinate (explore orbit --at)" in errors
    assert not output.exists()


def test_a_small_orbit_off_the_plane_is_found_by_its_height(tmp_path: Path) -> None:
    output = tmp_path / "orbit.json"
    words = ["orbit", "--system", "cr3bp", "--mass", "sun-mars", "--start", "x=1.00398", "z=4.3e-6", "vy=0.00461"]
    assert main([*words, "--at", "z=4.3e-6", "--digits", "20", "-o", str(output)]) == 0
    (found,) = read_candidates(output)
    assert [float(value) for value in found.centre] == pytest.approx(list(SMALL.values()), rel=1e-13)
    assert explore.read_orbit(output).period == pytest.approx(SMALL_PERIOD, abs=1e-8)


def small_rows(tmp_path: Path) -> Path:
    """A small halo orbit, and a start a little away from it."""
    document = json.loads(ROWS.read_text())
    document["system"] = {"name": "Sun-Mars", "mass_ratio": "3.227154996101724e-7"}
    index, level = 855.992275323, 3.0001868584020356
    document["data"] = [
        [SMALL["x"], 0, SMALL["z"], 0, SMALL["vy"], 0, level, SMALL_PERIOD, index],
        [SMALL["x"] + 1e-5, 0, SMALL["z"], 0, SMALL["vy"] - 1e-5, 0, level, SMALL_PERIOD, index],
    ]
    document["count"] = "2"
    path = tmp_path / "small.json"
    path.write_text(json.dumps(document))
    return path


def test_a_small_orbit_of_a_catalogue_is_its_own_or_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, output = small_rows(tmp_path), tmp_path / "orbit.json"
    found = explore.read_orbit(path, number=1)
    assert found.point[[0, 2, 4]] == pytest.approx(list(SMALL.values()), rel=1e-9)
    assert found.period == pytest.approx(SMALL_PERIOD, rel=1e-10)
    with pytest.raises(Contradiction, match="is off the fixed set of the symmetry S"):
        explore.read_orbit(path, number=2)
    words = ["orbit", "--from-catalogue", str(path), "--catalogue-orbit", "2", "--digits", "16", "-o", str(output)]
    assert main(words) == 1
    assert "row 2: another orbit was found: the start, z = 4.3e-06" in capsys.readouterr().err
    assert not output.exists()
    assert main([*words, "--at", "z=4.3e-6"]) == 0
    assert float(read_candidates(output)[0].centre[0]) == pytest.approx(SMALL["x"], rel=1e-12)


def test_a_bifurcation_point_elsewhere_than_the_one_given_is_told(tmp_path: Path) -> None:
    known = read_candidates(DATA / "known-folds.json")
    fold = next(each for each in known if each.id == "earth-moon-L1-halo-fold-1")
    point = {name: float(value) for name, value in zip(CR3BP.centre_coordinates, fold.centre, strict=True)}
    options: dict[str, Any] = {"parameters": {"mu": "earth-moon"}, "kind": "fold", "digits": 16, "quiet": True}
    rounded = {name: round(value, 5) for name, value in point.items()}
    explore.refine_at(CR3BP, rounded, 1, **options)
    away = point | {"z": point["z"] + 4e-4}
    with pytest.raises(explore.RefinementFailure, match=r"another point was found: .* was given, .* --accept"):
        explore.refine_at(CR3BP, away, 1, **options)
    explore.refine_at(CR3BP, away, 1, accept=True, **options)


@pytest.mark.parametrize("system", [CR3BP, CR3BP_AXIAL, CR3BP_PLANAR])
@pytest.mark.parametrize("by", ["--mass", "--parameter"])
def test_exchanged_primaries_are_refused_with_the_mass_to_give(system: Any, by: str) -> None:
    words = ("0.9", None) if by == "--mass" else (None, ["mu=0.9"])
    with pytest.raises(InputError, match=r"primaries are exchanged; give .* 1 - mu = 1/10"):
        given_parameters(system, *words)
    assert given_parameters(system, "0.5", None) == {"mu": Fraction(1, 2)}


def test_exchanged_primaries_are_refused_by_every_entrance(tmp_path: Path) -> None:
    for call in (
        lambda: explore.trace(CR3BP, "L1-halo", mu=0.9),
        lambda: explore.catalogue("L1-halo", "0.9"),
        lambda: explore.trace_from(CR3BP, {"x": 0.8, "z": 0.0, "vy": 0.1}, parameters={"mu": "0.9"}),
        lambda: explore.refine_at(CR3BP, {"x": 0.8, "z": 0.0, "vy": 0.1}, 2, parameters={"mu": "0.9"}),
    ):
        with pytest.raises(ValueError, match="primaries are exchanged"):
            call()
    document = json.loads(ROWS.read_text())
    document["system"]["mass_ratio"] = "0.98784941439037596"
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="above 1/2, so the primaries are exchanged"):
        read_catalogue(path)


@pytest.mark.parametrize(
    "words",
    [
        ["family", "--system", "cr3bp", "--mass", "0.9", "--family", "L1-halo", "-o", "OUT"],
        ["candidates", "--system", "cr3bp", "--mass", "0.9", "--family", "L1-halo", "-k", "2", "-o", "OUT"],
        ["orbit", "--family", "L2-halo", "--mass", "0.9", "--period", "1.5", "-o", "OUT"],
        ["catalogue", "--family", "L2-halo", "--mass", "0.9", "-o", "OUT"],
        ["atlas", "--system", "cr3bp", "--family", "L1-halo", "--mass", "0.9", "-o", "OUT"],
        ["atlas-libration", "--point", "L1", "--mass", "0.9", "-o", "OUT"],
        ["mass-curve", "--mu-max", "0.9", "-o", "OUT"],
    ],
    ids=lambda words: words[0],
)
def test_exchanged_primaries_are_refused_by_every_command(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "out.json") if word == "OUT" else word for word in words]) == 2
    errors = capsys.readouterr().err
    assert "above 1/2, so the primaries are exchanged" in errors
    assert "1 - mu = 1/10" in errors
    assert not list(tmp_path.iterdir())


def test_a_parameter_of_another_system_may_be_what_it_likes() -> None:
    assert given_parameters(FALKNER_SKAN, None, None) == {}
    assert max(MASS_PARAMETERS.values()) < Fraction(1, 2)


@pytest.mark.parametrize(
    ("length", "time", "fits"),
    [
        ("389703.26", "382981.29", True),
        ("384400", "375190.25", True),
        ("384400", "382981.29", False),
        ("1", "1", False),
    ],
)
def test_units_that_are_not_those_of_the_named_system_are_refused_with_both_numbers(
    length: str, time: str, fits: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "orbit.csv"
    words = ["trajectory", str(DATA / "tori-candidates.json"), "--units", "km", "--lunit", length, "--tunit", time]
    assert main([*words, "-o", str(output)]) == (0 if fits else 2)
    assert fits == output.exists()
    if not fits:
        errors = capsys.readouterr().err
        assert f"{float(length) ** 3 / float(time) ** 2:.6g} km^3/s^2" in errors
        assert "403503 km^3/s^2 for Earth-Moon" in errors


def test_units_in_a_catalogue_that_are_not_those_of_its_system_are_refused(tmp_path: Path) -> None:
    document = json.loads(ROWS.read_text())
    document["system"]["tunit"] = 5022635.34820215
    path = tmp_path / "rows.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"field system: L\^3/T\^2 = .* but 403503 km\^3/s\^2 for Earth-Moon"):
        read_catalogue(path)


def test_a_start_is_off_a_fixed_set_if_it_is_so_beyond_rounding() -> None:
    """Sizes are those of the orbit: small halo orbits are near their planet, and not small beside their height."""
    mars = {"mu": MASS_PARAMETERS["sun-mars"]}
    start, planar = list(SMALL.values()), [SMALL["x"], 1e-20, SMALL["vy"]]
    assert "is off the fixed set of the symmetry S" in str(fallen(CR3BP, mars, start, planar))
    assert fallen(CR3BP, mars, start, start) is None
    assert fallen(CR3BP, mars, [SMALL["x"], 1e-10, SMALL["vy"]], planar) is None
    assert fallen(CR3BP, mars, [0.9, 1e-8, 0.1], [0.9, 0.0, 0.1]) is None
    assert fallen(CR3BP, mars, [0.9, 1e-6, 0.1], [0.9, 0.0, 0.1]) is not None


def test_rows_of_ill_conditioned_orbits_agree_with_themselves() -> None:
    """Close to the Moon double precision knows no multipliers, and the index of a row contradicts nothing."""
    rows = explore.catalogue("dpo", "jpl-earth-moon", rows=6, max_orbits=300, hits=True, quiet=True)
    corrected = correct_catalogue(rows)
    assert corrected.reasons == ("",) * len(rows)
    last = corrected.batch.orbit(len(rows) - 1).derivative
    assert last is not None
    assert last.error > 1


def test_an_index_is_compared_up_to_what_is_known_of_it() -> None:
    state = np.array([1.1234, 0.0, 0.1, 0.0, 0.2, 0.0])
    said = Numbers(state, stability_index=5.5)
    assert contradictions(CR3BP, [0.01], said, Numbers(state, stability_index=5.0, stability_error=0.01))
    assert not contradictions(CR3BP, [0.01], said, Numbers(state, stability_index=5.0, stability_error=0.2))
