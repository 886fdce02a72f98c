"""Orbits about L4 and L5: their first approximations, and both families from the command to the proof."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from orbitproof.explore.__main__ import main
from orbitproof.explore.three_body.seeds import TRIANGULAR, triangular_orbit
from orbitproof.shared import EARTH_MOON
from orbitproof.verify.__main__ import main as verify
from orbitproof.verify.certificate import read_certificates

MASS = float(EARTH_MOON)


@pytest.mark.parametrize("name", TRIANGULAR)
@pytest.mark.parametrize("mass", [MASS, 1e-3, 0.0385])
def test_the_linear_orbit_closes_after_its_period(name: str, mass: float) -> None:
    start, period = triangular_orbit(mass, name, 1e-3)
    side = 1 if name.startswith("L4") else -1
    mixed = side * 3 * sqrt(3) / 4 * (1 - 2 * mass)
    matrix = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [0.75, mixed, 0, 2], [mixed, 2.25, -2, 0]])
    away = [start["x"] - 0.5 + mass, start["y"] - side * sqrt(3) / 2, start["vx"], start["vy"]]
    assert expm(matrix * period) @ away == pytest.approx(np.array(away), abs=1e-12)
    assert expm(matrix * period / 2) @ away == pytest.approx(-np.array(away), abs=1e-12)
    assert np.hypot(*away[:2]) <= 1e-3
    assert (start["z"], start["vz"]) == (0, 0)
    s = 2 * pi / period
    assert s**4 - s**2 + 27 / 4 * mass * (1 - mass) == pytest.approx(0, abs=1e-12)


def test_there_are_none_above_the_mass_of_routh() -> None:
    with pytest.raises(ValueError, match="Routh"):
        triangular_orbit(0.0386, "L4-short")
    with pytest.raises(ValueError, match="there are L4-short"):
        triangular_orbit(MASS, "L1-short")


def test_wrong_systems_and_masses_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (
        ["--system", "cr3bp", "--parameter", "mu=1/10", "--triangular", "L4-short"],
        ["--system", "falkner-skan", "--parameter", "beta=2", "--triangular", "L4-short"],
    ):
        assert main(["periodic", *words]) == 2
        assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "period"), [("L4-short", 6.5826), ("L5-long", 21.07)])
def test_orbits_about_triangular_points_are_found_and_proved(name: str, period: float, tmp_path: Path) -> None:
    claims, proofs = tmp_path / "claims.json", tmp_path / "proofs.json"
    system = ["--system", "cr3bp", "--parameter", "mu=1.215058560962404e-2"]
    assert main(["periodic", *system, "--triangular", name, "-o", str(claims), "--quiet"]) == 0
    assert verify([str(claims), "-o", str(proofs), "--quiet"]) == 0
    (proof,) = read_certificates(proofs).values()
    assert proof.periodic is not None
    assert float(proof.periodic.period.mid()) == pytest.approx(period, abs=2e-3)
    assert proof.periodic.level_name == "Jacobi constant"
    assert json.loads(claims.read_text())["candidates"][0]["level"]


@pytest.mark.slow
def test_a_published_orbit_of_the_short_period_family(tmp_path: Path) -> None:
    """D. Grebow (2006), as a public program quotes him: T = 6.582664326977796, x at the height of L4."""
    claims, proofs = tmp_path / "claims.json", tmp_path / "proofs.json"
    start = [
        "x=0.497653463566241",
        "y=0.866025403784439",
        "z=0",
        "vx=0.006195078418070",
        "vy=-0.008234243375973",
        "vz=0",
    ]
    words = ["--system", "cr3bp", "--parameter", "mu=1.215058560962404e-2", "--start", *start, "--period", "6.58"]
    section = ["--section", "y=0.866025403784439", "--direction", "-"]
    assert main(["periodic", *words, *section, "-o", str(claims), "--quiet"]) == 0
    assert verify([str(claims), "-o", str(proofs), "--quiet"]) == 0
    (proof,) = read_certificates(proofs).values()
    assert proof.periodic is not None
    assert float(proof.periodic.period.mid()) == pytest.approx(6.582664326977796, abs=1e-8)
    assert float(proof.periodic.point["x"].mid()) == pytest.approx(0.497653463566241, abs=2e-9)
