"""Pictures of bifurcations of periodic orbits without symmetry: what is beside them is where closed forms have it."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from support import periodic_bifurcation_cases as cases
from support import torus_cases as tori
from support.picture_texts import unreadable
from support.within import within

from orbitproof import figures
from orbitproof.figures.__main__ import main
from orbitproof.figures.commands.report import main as report
from orbitproof.figures.orbits import OrbitNotClosed, new_orbits, returning_orbit, torus_points
from orbitproof.figures.pictures import draw_periodic_bifurcation
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import PeriodicBifurcation, write_candidates
from orbitproof.verify.certificate import Limits, certify, write_certificates

style = within(lambda: use_style())


def beside(claim: PeriodicBifurcation, side: str | None = None) -> tuple[float, list[np.ndarray]]:
    """The value at which the new orbits are found, and their first points."""
    crossings = 2 if claim.system is cases.HALF_A_PERIOD else 1
    orbit = returning_orbit(claim, [float(value) for value in claim.centre], crossings)
    found = new_orbits(claim, orbit, [float(value) for value in claim.values], side)
    return found.value, [each.states[0] for each in found.orbits]


def labels(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.slow
def test_both_orbits_of_a_fold_are_found_at_one_value() -> None:
    a, points = beside(cases.folding(c=4, b=0), "above")
    assert [x * x + y * y - 1 for x, y in points] == pytest.approx([2 * a**0.5, -2 * a**0.5])
    h, points = beside(cases.level_fold(), "above")
    assert sorted(u for _, _, u in points) == pytest.approx([-((h - 1) ** 0.5), (h - 1) ** 0.5])


@pytest.mark.slow
def test_the_new_orbit_of_a_doubling_is_beside_the_old_one() -> None:
    a, ((x, _, u, v),) = beside(cases.doubling(c=-1), "below")
    assert (x, u * u, v) == pytest.approx((1, -a, 0), abs=1e-7)
    h, ((x, _, u, v),) = beside(cases.levels(), "above")
    assert (x * x, v) == pytest.approx((h, 0), abs=1e-7)
    assert u * u == pytest.approx(5 / 4 * (h - 1), rel=0.1)


@pytest.mark.parametrize("claim", [cases.breaking(c=2), cases.half_a_period(c=2)])
def test_the_new_orbits_of_a_pitchfork_are_mirror_images(claim: PeriodicBifurcation) -> None:
    a, (one, other) = beside(claim, "above")
    place = 2 if claim.system.name == "breaking" else 3
    assert (one[place] ** 2, one[place]) == pytest.approx((a / 2, -other[place]))


def test_orbits_on_another_side_than_the_certificate_states_are_not_drawn() -> None:
    with pytest.raises(OrbitNotClosed, match="not below"):
        beside(cases.breaking(), "below")


def test_the_iterates_of_a_torus_lie_on_it() -> None:
    """Of `PRODUCT` the torus is u^2 + v^2 = a, and with d = 1 it is u^2 + v^2 = -a and repels."""
    for d, k in ((Fraction(-1), Fraction(1, 4)), (Fraction(1), Fraction(-1, 4))):
        claim = tori.product_claim(d=d, k=k)
        orbit = returning_orbit(claim, [float(value) for value in claim.centre])
        speed = 2 * np.pi
        found = torus_points(claim, orbit, [float(value) for value in claim.values], speed, float(d) * speed)
        radii = found.states[:, 2] ** 2 + found.states[:, 3] ** 2
        assert radii == pytest.approx(np.full(len(radii), -float(d) * found.value), rel=1e-2)
        assert found.states[:, 0] == pytest.approx(np.ones(len(radii)))
        assert found.backwards == (d > 0)


def test_a_torus_that_attracts_in_no_direction_of_time_is_not_drawn() -> None:
    claim = tori.product_claim(d=Fraction(1))
    drawn = draw_periodic_bifurcation(claim, certify(claim, Limits(digits=5)).results)
    assert not drawn.is_complete
    assert "neither" in drawn.beside
    assert labels(drawn.figure) == ["orbit at the bifurcation, in double precision", "section", "the point, enclosed"]
    close(drawn.figure)


def test_only_what_is_proved_is_filled_and_the_rest_is_called_numerical() -> None:
    claim = cases.breaking()
    for found, word, face in (
        (certify(claim, Limits(digits=5)).results, "the point, enclosed", "#222222"),
        (None, "the point, numerical", "white"),
    ):
        drawn = draw_periodic_bifurcation(claim, found)
        lines = {str(line.get_label()): line for line in drawn.figure.axes[0].get_lines()}
        assert lines[word].get_markerfacecolor() == face
        assert sum(text.startswith(("first orbit at $a$", "second orbit at $a$")) for text in labels(drawn.figure)) == 2
        assert all("numerical" in text for text in labels(drawn.figure) if "at $a$" in text)
        shown = {name for axes in drawn.figure.axes for name in (axes.get_xlabel(), axes.get_ylabel())}
        assert shown == {"$x$", "$y$", "$u$"}
        assert "at $a$ = 0" in drawn.figure.texts[0].get_text()
        assert unreadable(drawn.figure) == []
        close(drawn.figure)


@pytest.mark.slow
def test_command_and_report_draw_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    claims, proofs, out = tmp_path / "claims.json", tmp_path / "proofs.json", tmp_path / "out"
    torus = tori.product_claim()
    write_candidates(claims, [torus])
    pitchfork, born = (certify(claim, Limits(digits=5)) for claim in (cases.breaking(), torus))
    write_certificates(proofs, [pitchfork])
    assert main(["periodic", str(proofs), "-o", str(out), "--format", "png"]) == 0
    assert {path.name for path in out.iterdir()} == {"bifurcation-periodic-pitchfork.png"}
    write_certificates(proofs, [pitchfork, born])
    assert report([str(proofs), "-o", str(tmp_path / "report.html"), "--quiet"]) == 0
    told = (tmp_path / "report.html").read_text()
    for words in (r"0\.0\d+ two orbits beside it", r"0\.0576 points of the map of the section after 40 iterations"):
        assert re.search(f"Numerical, and not proved: at a = {words}", told), words
    capsys.readouterr()
    drawn = figures.draw_periodic([claims], tmp_path / "again")
    assert list(drawn.not_drawn) == ["bifurcation-torus"]
    assert "what is born there" in drawn.not_drawn["bifurcation-torus"]
    assert len(drawn.paths) == 2
