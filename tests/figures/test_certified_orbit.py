"""The picture of one certified orbit: what is drawn is the orbit of the certificate, marked where it is enclosed."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from orbitproof.explore.refinement import OrbitTask, refine_orbit
from orbitproof.figures.commands.report import main as report
from orbitproof.figures.pictures import draw_orbit, solution_of
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import COORDINATE, Equation, read_candidates
from orbitproof.shared.systems import FALKNER_SKAN
from orbitproof.verify.certificate import Certificate, Limits, certify, write_certificates

CANDIDATES = Path(__file__).resolve().parents[1] / "data" / "orbit-candidates.json"


@pytest.fixture(scope="module")
def orbits() -> dict[str, Certificate]:
    """A halo orbit and one of the Falkner-Skan equation, proved."""
    (halo,) = read_candidates(CANDIDATES)
    at_400 = OrbitTask("beta-400", FALKNER_SKAN, {}, Equation(COORDINATE, Fraction(400), "beta"), (400.0, 0.94), 20, {})
    return {claim.system.name: certify(claim, Limits(digits=5)) for claim in (halo, refine_orbit(at_400))}


@pytest.mark.parametrize("name", ["cr3bp", "falkner-skan"])
def test_the_orbit_that_is_drawn_has_the_certified_points(name: str, orbits: dict[str, Certificate]) -> None:
    entry = orbits[name]
    assert entry.orbit is not None
    solution = solution_of(entry.candidate, entry.orbit)
    assert solution.defect < 1e-9
    state = solution.states(solution.period / 2)[0]
    for index in entry.candidate.system.fixed_coordinates:
        ball = entry.orbit.other_point[entry.candidate.system.state[index]]
        assert state[index] == pytest.approx(float(ball.mid()), abs=1e-9)


def test_extremal_distances_are_marked_where_they_are(orbits: dict[str, Certificate]) -> None:
    found = orbits["cr3bp"].orbit
    assert found is not None
    assert found.least is not None
    claim = orbits["cr3bp"].candidate
    solution = solution_of(claim, found)
    body = np.array([1.0 - float(claim.parameters["mu"]), 0.0, 0.0])
    away = np.linalg.norm(solution.states(np.linspace(0.0, solution.period, 2000))[:, :3] - body, axis=1)
    assert float(found.least.distance.mid()) == pytest.approx(away.min(), rel=1e-4)
    before = plt.get_fignums()
    with use_style():
        figure = draw_orbit(claim, found)
        labels = [line.get_label() for line in figure.axes[0].get_lines()]
        assert f"least distance from {found.distance_name}" in labels
        (line,) = [line for line in figure.axes[0].get_lines() if str(line.get_label()).startswith("least distance")]
        x, z = (np.asarray(values, dtype=float) for values in line.get_data())
        time = float(found.least.times[0].mid())
        assert np.isclose(x, solution.states(time)[0][0]).any()
        assert np.isclose(z, solution.states(time)[0][2]).any()
        close(figure)
    assert plt.get_fignums() == before


def test_a_report_shows_the_orbit(orbits: dict[str, Certificate], tmp_path: Path) -> None:
    certificates = tmp_path / "certificates.json"
    write_certificates(certificates, list(orbits.values()))
    assert report([str(certificates), "-o", str(tmp_path / "report.html"), "--quiet"]) == 0
    text = (tmp_path / "report.html").read_text()
    assert all(f"{entry.id}: the orbit, integrated in double precision" in text for entry in orbits.values())
