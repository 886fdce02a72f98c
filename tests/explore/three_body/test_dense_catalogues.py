"""Dense catalogues of families: rows, distances, filters, files."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from orbitproof import explore
from orbitproof.explore.__main__ import main
from orbitproof.explore.flow import flow_of
from orbitproof.explore.names import time_given
from orbitproof.explore.orbits import PeriodicSolution, ShootingProblem, stability_index
from orbitproof.explore.three_body.catalogues import (
    Catalogue,
    MadeCatalogue,
    correct_catalogue,
    dense,
    making,
    read_catalogue,
)
from orbitproof.explore.three_body.catalogues.columns import ALTITUDE, CLOSING, HITS
from orbitproof.shared import InputError
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, MASS_PARAMETERS

MU = float(MASS_PARAMETERS["jpl-earth-moon"])


@pytest.fixture(scope="module")
def halo() -> Catalogue:
    return explore.catalogue("l2-halo", "jpl-earth-moon", rows=40, max_orbits=40, hits=True, quiet=True)


def test_rows_are_equally_far_apart_and_orbits(halo: Catalogue) -> None:
    steps = np.linalg.norm(np.diff(halo.states, axis=0), axis=1)
    assert len(halo) == 40
    assert np.max(steps) < 4 * np.median(steps)
    again = correct_catalogue(halo)
    assert np.all(again.corrected)
    assert np.max(again.differences.state) < 1e-9


def test_rows_are_the_orbits_that_are_found_one_at_a_time(halo: Catalogue) -> None:
    problem = ShootingProblem(CR3BP, {"mu": MASS_PARAMETERS["jpl-earth-moon"]})
    for index in range(1, len(halo), 3):
        state, period = halo.states[index], halo.periods[index]
        row = np.array([*state[[0, 2, 4]], period / 2])
        _, jacobian, _ = problem.evaluate(row)
        along = problem.tangent(jacobian, np.ones(4))
        aside = np.array([1e-5, -1e-5, 2e-5, 1e-5])
        orbit = problem.orbit(problem.correct(row + aside - (aside @ along) * along, along))
        assert orbit.unknowns == pytest.approx(row, abs=1e-11)
        assert orbit.first_integral == pytest.approx(halo.jacobi_constants[index], abs=1e-12)
        assert stability_index(orbit.stability) == pytest.approx(halo.stability_indices[index], rel=1e-9)
        end = flow_of(CR3BP).derivative(state, period, [MU]).state
        assert halo.more[CLOSING][index] == pytest.approx(np.linalg.norm(end - state), abs=1e-10)


def test_states_beside_periodic_orbits_do_not_close(halo: Catalogue) -> None:
    problem = ShootingProblem(CR3BP, {"mu": MASS_PARAMETERS["jpl-earth-moon"]})
    assert dense._closing(problem, halo.states, halo.periods)[1].all()
    for shift, periods in ((1e-5, halo.periods), (0.0, 1.00001 * halo.periods), (0.0, 0.0 * halo.periods)):
        assert not dense._closing(problem, halo.states + shift, periods)[1].any()


def test_rows_that_are_left_out_are_counted_with_the_reasons(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    told = MadeCatalogue(None, "", Counter({"it does not close": 2, "another orbit was found": 9})).left_out
    assert told == "11 rows not found, left out (9: another orbit was found, 2: it does not close)"
    monkeypatch.setattr(dense, "CLOSES", 0.0)
    asked = ["catalogue", "--family", "L2-halo", "--mass", "jpl-earth-moon", "--rows", "7", "--max-orbits", "5"]
    assert main([*asked, "-o", str(tmp_path / "none.csv")]) == 1
    assert "7 rows not found, left out (7: it does not close)" in capsys.readouterr().err
    assert not (tmp_path / "none.csv").exists()


@pytest.mark.parametrize(
    ("altitudes", "ends", "told"),
    [
        (
            (2.0, 1.0, 3.0, -1.0),
            (0.0, 3.5),
            "at arclengths beyond 3.5 of 4 hit the smaller primary and are left out, 1 row",
        ),
        ((-1.0, 1.0, 3.0, 5.0), (0.5, 4.0), "at arclengths up to 0.5 of 4 hit"),
        ((None, 1.0, 3.0, None), (1.0, 2.0), "at arclengths up to 1 and beyond 2 of 4 hit"),
        ((-1.0, -1.0, None, -1.0), (0.0, 4.0), ""),
        ((1.0, -1.0, -1.0, 1.0), (0.0, 4.0), ""),
    ],
)
def test_ends_of_a_family_that_hit_the_body_have_no_rows(
    altitudes: tuple[float | None, ...], ends: tuple[float, float], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    family = SimpleNamespace(arclengths=(0.0, 1.0, 2.0, 4.0), orbits=[SimpleNamespace(crossings=1)] * 4)
    monkeypatch.setattr(dense, "catalogue_of", lambda *_: None)
    monkeypatch.setattr(dense, "with_distances", lambda *_: SimpleNamespace(more={ALTITUDE: altitudes}))
    found = dense.between_hits(SimpleNamespace(name="", label="", family=family))  # type: ignore[arg-type]
    assert found == ends
    words = making._hitting(*found, 4.0, 8)
    assert told in words
    assert bool(told) == bool(words)


def test_orbits_that_are_corrected_one_at_a_time_are_refused_for_a_gpu(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["catalogue", "--family", "L4-short", "--mass", "jpl-earth-moon", "--device", "gpu", "-o", "none.csv"]
    assert main([*asked, "--quiet"]) == 2
    assert "--device gpu: the orbits of L4-short are corrected one at a time; leave it out" in capsys.readouterr().err


def test_a_gpu_is_used_or_refused_and_nothing_else_in_its_place(tmp_path: Path) -> None:
    asked = ["explore", "catalogue", "--family", "L2-halo", "--mass", "jpl-earth-moon", "--rows", "9"]
    out = tmp_path / "gpu.csv"
    command = [sys.executable, "-m", "orbitproof", *asked, "--max-orbits", "9", "--device", "gpu", "-o", str(out)]
    environment = {name: value for name, value in os.environ.items() if name != "JAX_PLATFORMS"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    if done.returncode:
        remedy = (
            "error: --device gpu: JAX finds none; pip install 'jax[cuda13]' beside a driver of NVIDIA, or leave it out"
        )
        assert (done.returncode, done.stderr.splitlines()[-1]) == (2, remedy)
        assert not out.exists()
    else:
        assert "9 rows corrected by the GPU" in done.stderr
        here = explore.catalogue("L2-halo", "jpl-earth-moon", rows=9, max_orbits=9, hits=True, quiet=True)
        assert read_catalogue(out).columns == pytest.approx(here.columns, rel=1e-9, abs=1e-11)


def test_distances_are_those_of_a_finely_sampled_orbit(halo: Catalogue) -> None:
    for index in (0, 17, 39):
        solution = PeriodicSolution.symmetric(CR3BP, [MU], halo.states[index], float(halo.periods[index]))
        states = solution.states(np.linspace(0, halo.periods[index], 20001))[:, :3]
        near = np.linalg.norm(states - [1 - MU, 0, 0], axis=1)
        assert halo.more["least_distance"][index] == pytest.approx(near.min(), abs=1e-6)
        assert halo.more["greatest_distance"][index] == pytest.approx(near.max(), abs=1e-6)
        altitude = near.min() * 389703.264829278 - 1737.1
        assert halo.more["altitude_km"][index] == pytest.approx(altitude, abs=1)
        assert halo.more["hits"][index] == ("yes" if altitude < 0 else "no")


def test_filters_take_units(halo: Catalogue) -> None:
    days = halo.periods * 382981.289129055 / 86400
    assert len(halo.by_period("0d", "14d")) == np.count_nonzero(days <= 14)
    kept = halo.by_perilune("45000km", "inf")
    assert 0 < len(kept) < len(halo)
    assert min(kept.more["least_distance"]) * 389703.264829278 >= 45000
    assert len(kept.by_stability(0, 1e9)) == len(kept)
    for wrong in (("3km", "4km"), ("4", "3"), ("x", "4")):
        with pytest.raises(InputError):
            halo.by_period(*wrong)
    with pytest.raises(InputError, match="no units"):
        replace(halo, system_details={}).by_period("1d", "2d")


def test_a_time_may_have_a_unit_where_the_system_has_one() -> None:
    assert time_given("--period", "6.5d", 382981.289129055) == Fraction(13 * 43200) / Fraction("382981.289129055")
    assert time_given("--period", "12h", 43200.0) == time_given("--period", "12 hours", 43200.0) == 1
    assert time_given("--period", "6.5days", 86400.0) == Fraction(13, 2)
    assert time_given("--period", "3/2", None) == Fraction(3, 2)
    with pytest.raises(InputError, match="units of this system are not known"):
        time_given("--period", "6.5d", None)
    with pytest.raises(InputError, match="no number"):
        time_given("--period", "d", 1.0)


@pytest.mark.parametrize("form", ["json", "csv"])
def test_further_columns_come_back_from_files(halo: Catalogue, form: str, tmp_path: Path) -> None:
    path = tmp_path / f"halo.{form}"
    halo.write(path)
    again = read_catalogue(path)
    assert np.array_equal(again.columns, halo.columns)
    assert set(again.more) == set(halo.more)
    assert len(again.by_perilune(0.05, 1)) == len(halo.by_perilune(0.05, 1))


def test_parquet_has_the_columns_and_says_what_is_proved(halo: Catalogue, tmp_path: Path) -> None:
    parquet = import_module("pyarrow.parquet")
    halo.write(tmp_path / "halo.parquet")
    table = parquet.read_table(tmp_path / "halo.parquet")
    assert table.num_rows == len(halo)
    assert table.column("x").to_pylist() == halo.states[:, 0].tolist()
    assert set(table.column("proved").to_pylist()) == {"no: double precision"}
    assert table.schema.metadata[b"lunit"] == b"389703.264829278"


def test_a_catalogue_prints_a_short_table_with_days_and_distances(halo: Catalogue) -> None:
    head, titles, *rows = repr(halo).splitlines()
    assert head == "L2-halo-S of Earth-Moon: 40 orbits"
    assert titles.split() == [
        "Jacobi",
        "constant",
        "period",
        "days",
        "stability",
        "index",
        "least_distance",
        "altitude_km",
    ]
    assert [row.split()[0] for row in rows] == ["1", "2", "3", "38", "39", "40"]
    days = float(rows[0].split()[3])
    assert days == pytest.approx(halo.periods[0] * 382981.289129055 / 86400, rel=1e-6)
    assert repr(halo.chosen(np.array([], dtype=int))) == "L2-halo-S of Earth-Moon: 0 orbits"
    assert halo.to_dataframe()["period_days"].iloc[0] == pytest.approx(days, rel=1e-6)


def test_from_python_rows_that_hit_the_body_are_left_out_and_counted(
    halo: Catalogue, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    hits = tuple("yes" if number < 3 else "no" for number in range(len(halo)))
    made = MadeCatalogue(replace(halo, more={**halo.more, HITS: hits}), "")
    monkeypatch.setattr("orbitproof.explore.three_body.catalogues.scripting.catalogue_task", lambda *_: made)
    assert len(explore.catalogue("L2-halo", "jpl-earth-moon")) == 37
    assert "3 of 40 rows hit the smaller primary and are left out; hits=True keeps them" in capsys.readouterr().err
    assert len(explore.catalogue("L2-halo", "jpl-earth-moon", hits=True)) == 40
    assert "left out" not in capsys.readouterr().err


def test_rows_that_are_not_between_the_limits_are_counted(
    halo: Catalogue, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    halo.write(tmp_path / "halo.json")
    kept = len(halo.by_perilune("45000km", "inf"))
    out = str(tmp_path / "part.csv")
    assert main(["catalogue", str(tmp_path / "halo.json"), "--perilune", "45000km", "inf", "-o", out]) == 0
    assert f"{40 - kept} of 40 rows left out by --perilune" in capsys.readouterr().err


@pytest.mark.slow
def test_axial_orbits_are_corrected_with_their_own_symmetry_whatever_the_file_calls_them(tmp_path: Path) -> None:
    made = explore.catalogue("L1-axial", "jpl-earth-moon", rows=6, max_orbits=8, quiet=True)
    made.to_csv(tmp_path / "axial.csv")
    corrected = correct_catalogue(read_catalogue(tmp_path / "axial.csv"))
    assert corrected.problem.system is CR3BP_AXIAL
    assert np.all(corrected.corrected)


@pytest.mark.slow
def test_orbits_without_symmetry_are_rows_too() -> None:
    made = explore.catalogue("L4-short", "jpl-earth-moon", rows=4, quiet=True)
    assert (made.title, len(made)) == ("L4-short", 4)
    # The point is at the distance 1 from both primaries.
    assert abs(made.more["least_distance"][0] - 1) < 0.05


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_families_made_by_a_cluster_are_those_made_here(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import distributed

    asked = [
        "catalogue",
        "--family",
        "dro",
        "L4-short",
        "--mass",
        "sun-earth",
        "--rows",
        "5",
        "--max-orbits",
        "6",
        "--quiet",
    ]
    options = {"n_workers": 2, "threads_per_worker": 2, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(**options) as cluster:
        there = [*asked, "-o", str(tmp_path / "there.csv"), "--scheduler", cluster.scheduler_address]
        assert main(there) == 0
    with distributed.LocalCluster(**{**options, "n_workers": 0}) as cluster:
        assert main([*there[:-1], cluster.scheduler_address]) == 2
    assert "has no workers" in capsys.readouterr().err
    assert main([*asked, "-o", str(tmp_path / "here.csv"), "--jobs", "1"]) == 0
    for name in ("dro", "L4-short"):
        made = [(tmp_path / f"{place}-sun-earth-{name}.csv").read_text() for place in ("here", "there")]
        assert made[0] == made[1]


def test_a_command_writes_the_rows_between_limits(halo: Catalogue, tmp_path: Path) -> None:
    halo.write(tmp_path / "halo.json")
    out = tmp_path / "part.csv"
    arguments = ["catalogue", str(tmp_path / "halo.json"), "--perilune", "45000km", "inf", "-o", str(out), "--quiet"]
    assert main(arguments) == 0
    assert len(read_catalogue(out)) == len(halo.by_perilune("45000km", "inf"))
    assert main([*arguments, "--jacobi", "9", "10"]) == 1
    assert main([*arguments, "--scheduler", "127.0.0.1:1"]) == 2
    assert main(["catalogue", "--family", "zzz", "--mass", "jpl-earth-moon", "-o", str(out)]) == 2
    assert main(["catalogue", str(tmp_path / "halo.json"), "-o", str(tmp_path / "a.txt")]) == 2


def test_rows_that_hit_the_body_are_left_out_and_counted(
    halo: Catalogue, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    hits = tuple("yes" if number < 3 else "no" for number in range(len(halo)))
    path, out = tmp_path / "halo.json", tmp_path / "part.json"
    replace(halo, more={**halo.more, HITS: hits}).write(path)
    assert main(["catalogue", str(path), "-o", str(out)]) == 0
    assert len(read_catalogue(out)) == len(halo) - 3
    assert (
        f"3 of {len(halo)} rows hit the smaller primary and are left out; --all keeps them" in capsys.readouterr().err
    )
    assert main(["catalogue", str(path), "--all", "-o", str(out)]) == 0
    assert len(read_catalogue(out)) == len(halo)
    assert "left out" not in capsys.readouterr().err
