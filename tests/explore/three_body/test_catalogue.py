"""Files of the JPL three-body periodic orbit catalogue: format, correction of their orbits, families from them."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orbitproof.explore.__main__ import main
from orbitproof.explore.families import Family, Limits, continue_both_ways
from orbitproof.explore.flow import flow_of
from orbitproof.explore.orbits import stability_index
from orbitproof.explore.records import read_families
from orbitproof.explore.three_body.catalogues import (
    Catalogue,
    CorrectedCatalogue,
    correct_catalogue,
    read_catalogue,
    write_catalogue_csv,
    write_catalogue_json,
)
from orbitproof.explore.three_body.families import trace_family
from orbitproof.shared import InputError
from orbitproof.shared.formats import decimal_text
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

HERE = Path(__file__).resolve().parents[2]
OWN = {form: HERE / "data" / f"catalogue-halo.{form}" for form in ("json", "csv")}
DATA = Path(os.environ.get("ORBITPROOF_DATA", HERE.parents[1] / "shared" / "data"))
PUBLISHED = DATA / "jpl_earth_moon_L2_halo_south.json"

published = pytest.mark.skipif(not PUBLISHED.is_file(), reason="the published catalogue file is not here")


@pytest.fixture(scope="module")
def small() -> CorrectedCatalogue:
    return correct_catalogue(read_catalogue(OWN["json"]))


@pytest.fixture(scope="module")
def corrected() -> CorrectedCatalogue:
    return correct_catalogue(read_catalogue(PUBLISHED))


def test_both_forms_hold_the_same_orbits() -> None:
    left, right = read_catalogue(OWN["json"]), read_catalogue(OWN["csv"])
    assert np.array_equal(left.columns, right.columns)
    assert left.mass_ratio == right.mass_ratio == Fraction("0.01215")
    assert (left.title, right.title) == ("L1-halo-N", "orbits")


def test_what_was_written_reads_back(tmp_path: Path) -> None:
    catalogue = read_catalogue(OWN["json"])
    path = tmp_path / "a.json"
    write_catalogue_json(path, catalogue, {"L1": [0.8, 0.0, 0.0]})
    again = read_catalogue(path)
    assert np.array_equal(again.columns, catalogue.columns)
    assert (again.title, again.mass_ratio, again.system) == (catalogue.title, catalogue.mass_ratio, catalogue.system)
    write_catalogue_csv(tmp_path / "a.csv", catalogue)
    assert np.array_equal(read_catalogue(tmp_path / "a.csv").columns, catalogue.columns)


def test_what_a_file_says_about_the_system_and_the_family_is_kept(tmp_path: Path) -> None:
    document = json.loads(OWN["json"].read_text())
    about = {"lunit": 389703.264829278, "tunit": "382981.289129055", "radius_secondary": 1737.1, "name": "Earth-Moon"}
    document["system"] |= about
    document["resonance"] = "2:1"
    path = tmp_path / "a.json"
    path.write_text(json.dumps(document))
    result = correct_catalogue(read_catalogue(path)).result
    assert result is not None
    again = tmp_path / "b.json"
    write_catalogue_json(again, result, {"L1": [0.5, 0.0, 0.0]})
    written = json.loads(again.read_text())
    assert {name: written["system"][name] for name in about} == about
    assert written["system"]["L1"] == document["system"]["L1"]
    assert all(written[name] == document[name] for name in ("resonance", "family", "branch", "libration_point"))
    assert read_catalogue(again).tunit == 382981.289129055
    assert Fraction(written["system"]["mass_ratio"]) == Fraction(document["system"]["mass_ratio"])


def test_orbits_that_are_not_corrected_leave_the_numbers_of_the_others_as_they_are(
    small: CorrectedCatalogue, tmp_path: Path
) -> None:
    states = small.catalogue.states.copy()
    states[1, 3] = 0.1
    result = correct_catalogue(replace(small.catalogue, states=states)).result
    assert result is not None
    write_catalogue_csv(tmp_path / "a.csv", result)
    numbers = [line.split(",")[0] for line in (tmp_path / "a.csv").read_text().splitlines()[1:]]
    assert numbers == ["1", "3", "4", "5", "6", "7"]


def test_mass_ratio_is_written_with_all_its_digits() -> None:
    for value in MASS_PARAMETERS.values():
        assert Fraction(decimal_text(value)) == value
    with pytest.raises(ValueError, match="no decimal"):
        decimal_text(Fraction(1, 3))


def test_headers_in_the_style_of_the_web_page_are_read(tmp_path: Path) -> None:
    """Quoted names with a space behind them, a column more, spaces around numbers, a byte order mark."""
    lines = OWN["csv"].read_text().splitlines()
    names = ",".join(f'"{name} "' for name in lines[0].split(",")) + ',"Period (days) "'
    rows = [", ".join(line.split(",")) + ",1" for line in lines[1:]]
    path = tmp_path / "web.csv"
    path.write_text("\ufeff" + "\r\n".join([names, *rows]) + "\r\n", encoding="utf-8")
    assert np.array_equal(read_catalogue(path).columns, read_catalogue(OWN["csv"]).columns)


def test_stability_index_is_that_of_the_largest_multiplier() -> None:
    multipliers = (7.0, -11.0, complex(3.0, 4.0))
    for multiplier in multipliers:
        s = (multiplier + 1 / multiplier) / 2
        size = abs(multiplier)
        assert stability_index([0.3, s]) == pytest.approx((size + 1 / size) / 2, rel=1e-14)
    assert stability_index([0.3, -0.9]) == pytest.approx(1.0, abs=1e-14)


def test_orbits_that_are_orbits_already_are_not_moved(small: CorrectedCatalogue) -> None:
    assert np.all(small.corrected)
    differences = small.differences
    assert np.max(differences.state) < 1e-11
    assert np.max(differences.jacobi_constant) < 1e-11
    assert np.max(differences.period) < 1e-10
    assert np.max(differences.stability_index) < 1e-8


def test_perturbed_orbits_are_corrected_and_hopeless_ones_reported(small: CorrectedCatalogue) -> None:
    states = small.catalogue.states.copy()
    states[2, 0] += 1e-5
    states[4] = (0.9, 0.0, 0.3, 0.0, 3.0, 0.0)
    states[5, 3] = 0.1
    c = small.catalogue
    moved = Catalogue(c.mass_ratio, states, c.jacobi_constants, c.periods, c.stability_indices)
    result = correct_catalogue(moved)
    assert [bool(failure) for failure in result.failures] == [False, False, False, False, True, True, False]
    assert "Fix(R)" in result.failures[5]
    assert 1e-7 < result.differences.state[2] < 1e-4
    assert np.isnan(result.differences.period[4])


def test_orbit_that_starts_on_the_x_axis_is_taken_where_it_meets_fix_r(small: CorrectedCatalogue) -> None:
    """The point of a vertical orbit a quarter of a period before its highest point."""
    family = trace_family(CR3BP, "L1-vertical", small.problem.parameters, Limits(max_orbits=4))
    orbit, mass = family.orbits[-1], [float(small.catalogue.mass_ratio)]
    axis = flow_of(CR3BP).derivative(family.problem.initial_state(orbit.unknowns), -0.25 * orbit.period, mass).state
    assert np.max(np.abs(axis[[1, 2, 3]])) < 1e-9
    one = np.ones(1)
    catalogue = Catalogue(
        small.catalogue.mass_ratio,
        axis[None],
        orbit.first_integral * one,
        orbit.period * one,
        stability_index(orbit.stability) * one,
    )
    result = correct_catalogue(catalogue)
    assert result.corrected[0]
    assert result.batch.unknowns[0] == pytest.approx(orbit.unknowns, abs=1e-9)
    assert result.differences.stability_index[0] < 1e-7


def test_axial_orbits_are_written_read_and_corrected_about_the_x_axis(tmp_path: Path) -> None:
    path = tmp_path / "axial.json"
    words = ["--system", "cr3bp-axial", "--mass", "jpl-earth-moon", "--family", "L2-axial", "--max-orbits", "6"]
    assert main(["family", *words, "--jobs", "1", "-o", str(tmp_path / "f.json"), "--catalogue", str(path)]) == 0
    catalogue = read_catalogue(path)
    assert (catalogue.title, catalogue.system) == ("L2-axial", "Earth-Moon")
    result = correct_catalogue(catalogue)
    assert np.all(result.corrected)
    assert np.max(result.differences.state) < 1e-10


def on_family(family: Family, unknowns: np.ndarray) -> float:
    """Distance, in the family's units, of an orbit from the one on the family in the hyperplane through it."""
    scales = family.problem.scales
    places = np.array([orbit.unknowns for orbit in family.orbits]) / scales
    start, step = places[:-1], np.diff(places, axis=0)
    lengths = np.sum(step * step, axis=1)
    along = np.clip(np.sum((unknowns / scales - start) * step, axis=1) / lengths, 0.0, 1.0)
    i = int(np.argmin(np.linalg.norm(unknowns / scales - start - along[:, None] * step, axis=1)))
    left, right = family.arclengths[i : i + 2]
    orbit = family.orbit_at(left + along[i] * (right - left))
    return float(np.linalg.norm((orbit.unknowns - unknowns) / scales))


def test_family_traced_both_ways_from_one_orbit_passes_through_the_others(small: CorrectedCatalogue) -> None:
    family = continue_both_ways(small.seed(3), Limits(coordinate_max={"z": 0.075}))
    assert family.reason.startswith(("limit z = 0.075", "the family returns to Fix(S)"))
    assert family.beginning is not None
    ends = {family.reason[:14], family.beginning.reason[:14]}
    assert ends == {"limit z = 0.07", "the family ret"}
    assert all(on_family(family, unknowns) < 1e-9 for unknowns in small.batch.unknowns)


def test_command_starts_from_a_catalogue_and_writes_one(tmp_path: Path, capsys: Any) -> None:
    files = {name: tmp_path / name for name in ("family.json", "out.csv", "out.json")}
    arguments = ["--from-catalogue", str(OWN["csv"]), "--catalogue-orbit", "2", "--max-orbits", "5", "--jobs", "1"]
    arguments += ["-o", str(files["family.json"]), "--csv", str(files["out.csv"])]
    assert main(["family", *arguments, "--catalogue", str(files["out.json"])]) == 0
    output, _ = capsys.readouterr()
    assert "7 of 7 orbits corrected, mass ratio 1.215e-2" in output
    assert "Jacobi constant" in output
    (record,) = read_families(files["family.json"])
    assert len(record.orbits) == 5
    assert record.beginning is not None
    written = read_catalogue(files["out.json"])
    assert np.array_equal(written.columns, read_catalogue(files["out.csv"]).columns)
    assert written.columns[:, :8] == pytest.approx(read_catalogue(OWN["csv"]).columns[:, :8], abs=1e-10)
    assert main(["family", *arguments[:3], "9", *arguments[4:]]) == 2
    assert "--catalogue-orbit 9" in capsys.readouterr().err


def test_a_mass_that_has_a_name_gives_it_to_the_family(tmp_path: Path) -> None:
    rows, family = HERE.parent / "docs" / "examples" / "gateway-rows.json", tmp_path / "family.json"
    assert main(["family", "--from-catalogue", str(rows), "--max-orbits", "3", "-o", str(family), "--quiet"]) == 0
    (record,) = read_families(family)
    assert (record.label, record.name) == ("jpl-earth-moon", "L2-halo-S")


def test_family_is_not_traced_from_the_orbit_at_which_it_is_born(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "family.json"
    arguments = ["--from-catalogue", str(OWN["json"]), "--catalogue-orbit", "1", "-o", str(path), "--jobs", "1"]
    assert main(["family", *arguments]) == 1
    output, errors = capsys.readouterr()
    assert "7 of 7 orbits corrected" in output
    assert "--catalogue-orbit 1: no family is traced from it: it lies in the plane" in errors
    assert not path.exists()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fields": ["x"] * 9}, "fields"),
        ({"fields": ["x", "y", "z", "vx", "vy", "vz", "jacobi", "period", "index"]}, "'stability'"),
        ({"count": "6"}, "count"),
        ({"system": {"name": "nowhere"}}, "mass_ratio"),
        ({"system": {"mass_ratio": "1.5"}}, "(0, 1)"),
        ({"system": {"mass_ratio": "0x1p-3"}}, "mass_ratio"),
        ({"data": []}, "data"),
        ({"data": [[1.0] * 8]}, "data[0]"),
        ({"data": [[1.0] * 10], "count": 1}, "data[0]"),
        ({"data": [[1.0] * 7 + ["abc", 1.0]], "count": 1}, "data[0]"),
        ({"data": [[1.0] * 7 + ["1e999", 1.0]], "count": 1}, "data[0][7]"),
        ({"data": [[1.0] * 7 + [-2.0, 1.0]], "count": 1}, "data[0][7]"),
    ],
)
def test_damaged_json_is_refused_in_one_line(change: dict[str, Any], words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(json.loads(OWN["json"].read_text()) | change))
    with pytest.raises(InputError) as error:
        read_catalogue(path)
    assert str(path) in str(error.value)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Stability index", "Stability", "'Stability index'"),
        (",1.215e-2\n3,", ",1.216e-2\n3,", "line 3, column 'Mass ratio'"),
        (",1.215e-2\n3,", "\n3,", "line 3: 10 cells"),
        ("2.7445507290437297e+00", "soon", "line 3, column 'Period (TU)'"),
        ("2.7445507290437297e+00", "nan", "line 3, column 'Period (TU)'"),
        (",1.215e-2", ",heavy", "'heavy' is no number"),
    ],
)
def test_damaged_csv_is_refused_in_one_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    text = OWN["csv"].read_text()
    assert old in text
    path = tmp_path / "bad.csv"
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError) as error:
        read_catalogue(path)
    assert str(path) in str(error.value)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"", b"\n", b"{", b"\xff\xfe\x00", b"Id,x0 (LU)\n1,2\n", None])
def test_what_is_no_catalogue_is_refused_in_one_line(content: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "bad"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match="bad") as error:
        read_catalogue(path)
    assert "\n" not in str(error.value)


@published
def test_every_published_orbit_is_corrected_and_agrees_to_the_catalogues_accuracy(
    corrected: CorrectedCatalogue,
) -> None:
    """1e-9 in state, Jacobi constant and period; the stability index to 2e-5, to 1e-7 for nine orbits of ten."""
    assert len(corrected.catalogue) == 1535
    assert np.all(corrected.corrected)
    assert np.all(corrected.batch.crossings == 1)
    differences = corrected.differences
    for values in (differences.state, differences.jacobi_constant, differences.period):
        assert np.max(values) < 1e-9
        assert np.median(values) < 1e-12
    assert np.max(differences.stability_index) < 2e-5
    assert np.quantile(differences.stability_index, 0.9) < 1e-7


@published
@pytest.mark.slow
def test_family_traced_from_one_published_orbit_passes_through_all_of_them(corrected: CorrectedCatalogue) -> None:
    family = continue_both_ways(corrected.seed(700), Limits())
    assert family.beginning is not None
    assert "the family returns to Fix(S)" in family.reason + family.beginning.reason
    orbits = corrected.batch.unknowns.copy()
    # One of them has passed the birth of the family: its mirror image under S is on the southern side.
    assert np.count_nonzero(orbits[:, 1] > 0) == 1
    assert np.max(orbits[:, 1]) < 3e-4
    orbits[:, 1] = -np.abs(orbits[:, 1])
    assert max(on_family(family, unknowns) for unknowns in orbits) < 1e-10
