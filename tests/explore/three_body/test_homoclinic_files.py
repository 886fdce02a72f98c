"""Homoclinic orbits as files of states: from near the periodic orbit to Fix(R) and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import homoclinic_cases as cases

from orbitproof.explore.__main__ import main
from orbitproof.explore.connections import half_of
from orbitproof.shared.formats import write_candidates


def test_the_states_of_a_homoclinic_orbit_are_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    claims, output = tmp_path / "claims.json", tmp_path / "orbit.csv"
    write_candidates(claims, [cases.wells(), replace(cases.wells(), id="other", arrival=5)])
    command = ["trajectory", str(claims), "--id", "wells", "-o", str(output)]
    assert main([*command, "--points", "101"]) == 0
    text = output.read_text()
    assert "# not periodic: a homoclinic orbit" in text
    assert "# period" not in text
    lines = [line for line in text.splitlines() if line[0] != "#"]
    assert lines[0] == "t,x,y,u,v"
    t, x, y, u, v = np.array([[*map(float, line.split(","))] for line in lines[1:]]).T
    a = float(cases.wells().centre[1])
    assert (x[0], y[0], u[0]) == pytest.approx((1 + a, 0, float(cases.wells().slope) * a), rel=1e-12)
    assert (x[50], y[50], u[50]) == pytest.approx((2.365652526599, 0, 0), abs=1e-10)
    # R changes the signs of y and u.
    assert np.allclose([x, y, u, v], np.array([x, -y, -u, v])[:, ::-1], rtol=0, atol=1e-9)
    energy = (u**2 + v**2) / 2 - (x - 1) ** 2 / 2 + (x - 1) ** 4 / 4 + 2 * y**2 + (x - 1) ** 2 * y**2 / 4
    assert np.abs(energy - 0.5).max() < 1e-12
    assert t[0] == 0
    assert np.ptp(np.diff(t)) < 1e-12
    capsys.readouterr()
    for more, said in (
        (["--periods", "2"], "--periods: a homoclinic orbit does not repeat itself"),
        (["--units", "km"], "--units km: wells has no orbits in space"),
    ):
        assert main([*command, *more]) == 2
        assert said in capsys.readouterr().err
    # What does not come to Fix(R) is no homoclinic orbit, and others want a period.
    assert main(["trajectory", str(claims), "--id", "other", "-o", str(output)]) == 1
    assert "other: no homoclinic orbit" in capsys.readouterr().err
    assert main(["tori", str(claims), "--id", "wells", "-o", str(tmp_path / "tori.json")]) == 1
    assert "give one about an orbit" in capsys.readouterr().err


def test_the_parts_of_an_orbit_begin_at_its_crossings() -> None:
    starts, durations = half_of(cases.wells())
    assert starts.shape == (6, 4)
    assert durations.shape == (6,)
    assert np.abs(starts[:, 1]).max() < 1e-15
    # Near x = 1 the orbits swing with the frequency 2.
    assert durations[0] == pytest.approx(np.pi / 2, abs=1e-6)


@pytest.mark.slow
def test_an_ephemeris_is_that_of_the_orbit_in_space(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("ccsds_ndm")
    claims, csv, oem = tmp_path / "claims.json", tmp_path / "orbit.csv", tmp_path / "orbit.oem"
    write_candidates(claims, [cases.jupiter()])
    units = ["--units", "km", "--lunit", "778e6", "--tunit", "6e7"]
    assert main(["trajectory", str(claims), *units, "-o", str(csv), "--oem", str(oem)]) == 0
    assert "read back, interpolated to" in " ".join(capsys.readouterr().out.split())
    rows = np.array([[*map(float, x.split(","))] for x in csv.read_text().splitlines() if x[0] not in "#t"])
    assert rows[-1, 0] == pytest.approx(2 * 16.8248917519 * 6e7, rel=1e-10)
    assert np.all(rows[:, [3, 6]] == 0)
    assert rows[:, 1].min() >= -0.6481916898 * 778e6
    assert np.allclose(rows[0, 1:], rows[-1, 1:] * [1, -1, 1, -1, 1, -1], rtol=1e-9, atol=1e-6)
