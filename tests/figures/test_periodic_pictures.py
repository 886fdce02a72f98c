"""Pictures of periodic orbits without symmetry and of their families: what is drawn is what files say."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.periodic_cases import lorenz, oscillators, planar, shifted, turning
from support.picture_texts import unreadable
from support.systems import described
from support.within import within

from orbitproof.explore.periodic import (
    BRANCH,
    DOUBLING,
    FOLD,
    TORUS,
    PeriodicFamilyRecord,
    PeriodicProblem,
    continue_orbit,
    correct,
    read_periodic_family,
    write_periodic_family,
)
from orbitproof.figures.__main__ import main
from orbitproof.figures.commands.report import main as report
from orbitproof.figures.orbits import OrbitNotClosed, returning_orbit
from orbitproof.figures.pictures import draw_periodic_family, draw_periodic_orbit
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import PeriodicOrbit, write_candidates
from orbitproof.verify.certificate import Limits, certify, write_certificates

PITCHFORK = described(
    name="pitchfork",
    state="x y w",
    parameters="strength",
    where={"s": "1 - x**2 - y**2"},
    field={"x": "x*s - y", "y": "x + y*s", "w": "strength*w - w**3"},
)

style = within(lambda: use_style())


@pytest.fixture(scope="module")
def family(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The circles of the pitchfork, whose second multiplier is exp(2 pi strength), as a file."""
    problem = PeriodicProblem(PITCHFORK, {"strength": Fraction(-1, 10)})
    found = continue_orbit(problem, correct(problem, [1, 0, 0], 6.3), "strength", (-0.11, 0.1))
    path = tmp_path_factory.mktemp("family") / "circles.json"
    write_periodic_family(path, found)
    return path


def labels(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize("claim", [lorenz("AAB"), planar(Fraction(3, 2)), oscillators(), turning(Fraction(-1, 9))])
def test_an_orbit_is_followed_to_its_last_crossing(claim: PeriodicOrbit) -> None:
    orbit = returning_orbit(claim, [float(value) for value in claim.centre])
    assert len(orbit.crossings) == claim.crossings
    assert orbit.states[-1] == pytest.approx(orbit.states[0], abs=1e-9 * np.abs(orbit.states).max())
    normal = np.array([float(value) for value in claim.normal])
    assert orbit.crossings @ normal == pytest.approx(np.full(claim.crossings, float(claim.offset)), abs=1e-9)
    assert np.all(np.diff(orbit.times) >= 0)


def test_an_orbit_that_does_not_come_back_is_not_drawn() -> None:
    with pytest.raises(OrbitNotClosed):
        returning_orbit(lorenz("AB"), [1.0, 2.0, 27.0])


def test_only_the_point_of_a_certificate_is_filled() -> None:
    claim = lorenz("AB")
    proved = certify(claim, Limits(digits=5))
    assert proved.periodic is not None
    for point, word, face in (
        (proved.periodic.point, "the point, enclosed", "#222222"),
        (None, "the point, numerical", "white"),
    ):
        figure = draw_periodic_orbit(claim, point)
        assert labels(figure) == ["orbit, in double precision", "further crossings", word, "section"]
        lines = {str(line.get_label()): line for line in figure.axes[0].get_lines()}
        assert lines[word].get_markerfacecolor() == face
        assert lines["further crossings"].get_markerfacecolor() == "white"
        assert np.asarray(lines[word].get_xydata())[0] == pytest.approx([float(v) for v in claim.centre[:2]])
        assert [axes.get_xlabel() for axes in figure.axes] == ["$x$", "$x$"]
        assert unreadable(figure) == []
        close(figure)


def test_coordinates_that_do_not_vary_give_way_to_the_time() -> None:
    figure = draw_periodic_orbit(turning(Fraction(-1, 9)))
    assert [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes] == [("$x$", "$y$"), ("time", "$x$")]
    close(figure)


def test_a_family_is_drawn_as_its_file_says(family: Path) -> None:
    record = read_periodic_family(family)
    assert isinstance(record, PeriodicFamilyRecord)
    assert (record.name, record.over_levels, record.conservative) == ("strength", False, False)
    assert [each.kind for each in record.bifurcations] == ["pitchfork"]
    figure = draw_periodic_family(record)
    left, right = figure.axes
    assert left.get_xlabel() == right.get_xlabel() == r"$\mathrm{strength}$"
    values = np.array([each.value for each in record.orbits])
    assert np.asarray(left.get_lines()[0].get_ydata()) == pytest.approx(np.full(len(values), 2 * np.pi))
    assert np.asarray(right.get_lines()[0].get_ydata()) == pytest.approx(np.exp(2 * np.pi * values), rel=1e-6)
    for axes in (left, right):
        (mark,) = [line for line in axes.get_lines() if line.get_marker() == "P"]
        assert mark.get_markerfacecolor() == "white"
        assert np.asarray(mark.get_xydata())[0, 0] == pytest.approx(0, abs=1e-6)
    assert labels(figure) == ["double precision, nothing proved", "pitchfork"]
    assert unreadable(figure) == []
    close(figure)


def test_families_over_levels_show_stability_parameters(tmp_path: Path) -> None:
    claim = oscillators()
    problem = PeriodicProblem(claim.system, {})
    found = continue_orbit(problem, correct(problem, [1, 0, 0, 0], 6.28), None, (0.9, 1.2))
    path = tmp_path / "family.json"
    write_periodic_family(path, found)
    figure = draw_periodic_family(read_periodic_family(path))
    (curve, *bounds) = figure.axes[1].get_lines()
    assert np.asarray(curve.get_ydata()) == pytest.approx(np.cos(2 * np.pi * 2**0.5), rel=1e-6)
    assert [line.get_ydata()[0] for line in bounds] == [1.0, -1.0]
    assert figure.axes[0].get_xlabel() == "first integral"
    assert labels(figure) == ["double precision, nothing proved"]
    close(figure)


@pytest.mark.parametrize("kind", [FOLD, BRANCH, DOUBLING, TORUS])
def test_every_kind_of_bifurcation_has_a_mark(kind: str, family: Path) -> None:
    record = read_periodic_family(family)
    (found,) = record.bifurcations
    figure = draw_periodic_family(replace(record, bifurcations=(replace(found, kind=kind),)))
    assert labels(figure)[1:] == [kind]
    close(figure)


@pytest.mark.slow
def test_the_command_draws_claims_certificates_and_families(
    family: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    claim = lorenz("AB")
    claims, proofs, out = tmp_path / "claims.json", tmp_path / "proofs.json", tmp_path / "out"
    write_candidates(claims, [claim])
    write_certificates(proofs, [certify(claim, Limits(digits=5))])
    assert main(["periodic", str(claims), str(proofs), str(family), "-o", str(out), "--format", "png"]) == 0
    assert {path.name for path in out.iterdir()} == {"orbit-AB.png", "orbit-AB-2.png", "family-circles.png"}
    assert report([str(proofs), "-o", str(tmp_path / "report.html"), "--quiet"]) == 0
    assert "AB: the orbit, integrated in double precision" in (tmp_path / "report.html").read_text()
    capsys.readouterr()
    other = Path(__file__).parents[1] / "data" / "figures-candidates.json"
    for wrong in (str(other), "nowhere.json"):
        assert main(["periodic", wrong, "-o", str(out)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    write_candidates(claims, [shifted(claim, 0, Fraction(1))])
    assert main(["periodic", str(claims), "-o", str(out)]) == 1
    assert "not drawn" in capsys.readouterr().err
