"""What a new user types first: refused in a line that helps, or done as the file says."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest
from matplotlib.text import Text

from orbitproof.explore.__main__ import main as explore
from orbitproof.explore.records import read_families
from orbitproof.figures.model import read_families as sampled
from orbitproof.figures.pictures import draw_family
from orbitproof.figures.style import close, label_of, use_style
from orbitproof.shared import CR3BP, define_system
from orbitproof.shared.formats import read_candidates

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
MICHELSON = (EXAMPLES / "michelson.py").read_text("utf-8")
START = ["--start", "c=0.1", "y=0.2"]


def changed(folder: Path, old: str, new: str) -> str:
    """Michelson's file with a part of it written otherwise."""
    assert old in MICHELSON
    file = folder / "changed.py"
    file.write_text(MICHELSON.replace(old, new), "utf-8")
    return str(file)


def refused(words: Sequence[str], capsys: pytest.CaptureFixture[str], code: int) -> str:
    """What is said where a command ends with that exit code."""
    assert explore(words) == code
    return capsys.readouterr().err.strip()


@pytest.mark.parametrize(
    ("part", "hint"),
    [("c^2", "a power is written **"), ("tan(c)", "write sin(u)/cos(u)"), ("sinh(c)", "t = tanh(u/2)")],
)
def test_what_is_no_formula_is_refused_with_what_to_write(
    part: str, hint: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused(["orbit", "--system", changed(tmp_path, "c**2", part), *START], capsys, 2)
    assert hint in line
    assert len(line.splitlines()) == 1


def test_a_family_ends_where_the_declared_range_of_its_parameter_does(tmp_path: Path) -> None:
    file = changed(tmp_path, 'parameters = "c"', 'parameters = {"c": ["0.05", "1/5"]}')
    words = ["family", "--system", file, *START, "--jobs", "1", "--quiet", "-o", str(tmp_path / "family.json")]
    assert explore(words) == 0
    (family,) = read_families(tmp_path / "family.json")
    values = [orbit.point[0] for orbit in family.orbits]
    assert all(0.05 < value < 0.2 for value in values[1:-1])
    assert "c = 0.2, where its declared range ends" in family.reason


def test_a_start_outside_the_declared_range_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = changed(tmp_path, 'parameters = "c"', 'parameters = {"c": ["0", "1/5"]}')
    assert "outside (0, 1/5)" in refused(["orbit", "--system", file, "--start", "c=0.4", "y=0.6"], capsys, 2)


@pytest.mark.parametrize(
    ("system", "place"),
    [
        ("beam", ["--parameter", "P=1", "--start", "u=0", "u2=0"]),
        ("beam", ["--parameter", "P=1", "--start", "u=0.01", "u2=0.01", "--half-period", "3"]),
        ("henon-heiles", ["--start", "y=0", "vx=0"]),
        ("michelson", ["--start", "c=0", "y=0"]),
        ("beam-level", ["--start", "P=1", "u=0"]),
    ],
)
def test_an_equilibrium_is_not_called_an_orbit(
    system: str, place: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert explore(["orbit", "--system", str(EXAMPLES / f"{system}.py"), *place]) == 1
    said = capsys.readouterr()
    assert "is an equilibrium, not an orbit" in said.err
    assert said.out == ""


def test_small_orbits_about_an_equilibrium_are_not_looked_for_on_a_fixed_level(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["orbit", "--system", str(EXAMPLES / "beam-level.py"), "--start", "equilibrium", "P=1"]
    assert "other levels" in refused(words, capsys, 2)


def test_columns_of_the_catalogue_are_refused_for_a_family_of_another_system(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    family = str(tmp_path / "family.json")
    michelson = str(EXAMPLES / "michelson.py")
    words = ["family", "--system", michelson, *START, "--max-orbits", "3", "--quiet", "-o", family]
    assert explore(words) == 0
    again = ["family", "--from-family", family, "--csv", str(tmp_path / "f.csv"), "-o", str(tmp_path / "f.json")]
    assert "--csv" in refused(again, capsys, 2)
    assert not (tmp_path / "f.csv").exists()


def test_one_degree_of_freedom_is_refused_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "oscillator.py"
    file.write_text(
        'name = "oscillator"\nstate = "x v"\nfield = {"x": "v", "v": "-x - x**3"}\nR = {"v": -1}\nsection = "v"\n'
        'first_integral = "v**2/2 + x**2/2 + x**4/4"\n',
        "utf-8",
    )
    assert "nothing branches off" in refused(["orbit", "--system", str(file), "--start", "x=1"], capsys, 2)


def test_labels_are_of_the_system_that_is_drawn() -> None:
    own = define_system(
        {
            "name": "own", "state": "vx theta p_theta", "parameters": "alpha",
            "field": {"vx": "theta", "theta": "p_theta", "p_theta": "alpha**2 - theta - vx**2/2"},
            "R": {"vx": -1, "p_theta": -1}, "section": "vx", "family_parameter": "alpha",
        }
    )  # fmt: skip
    assert label_of(own, "alpha") == r"$\alpha$"
    assert label_of(own, "p_theta") == r"$p_{\mathrm{theta}}$"
    assert label_of(own, "vx") == r"$\mathrm{vx}$"
    assert label_of(own, "u12") == r"$u_{\mathrm{12}}$"
    assert label_of(CR3BP, "vx") == r"$\dot{x}$  (nondimensional)"


def test_a_picture_of_ones_own_system_knows_nothing_of_its_units(tmp_path: Path) -> None:
    file = str(EXAMPLES / "michelson.py")
    words = ["family", "--system", file, *START, "--max-orbits", "6", "--quiet", "-o", str(tmp_path / "family.json")]
    assert explore(words) == 0
    (family,) = sampled(tmp_path / "family.json")
    with use_style():
        figure = draw_family(family.refined(), [])
        said = [text.get_text() for text in figure.findobj(Text)]
        close(figure)
    assert not any("nondimensional" in text for text in said)


def test_an_orbit_keeps_the_parameter_that_was_given(capsys: pytest.CaptureFixture[str]) -> None:
    assert explore(["orbit", "--system", str(EXAMPLES / "michelson.py"), *START]) == 0
    assert "point            c = 0.1, y = 0.196593739345" in capsys.readouterr().out


def test_the_box_of_a_claim_may_be_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["refine", "--system", str(EXAMPLES / "michelson.py"), "-k", "3", "--point", "c=0.27634", "y=0.52554"]
    file = tmp_path / "one.json"
    assert explore([*words, "--radii", "1e-19", "1e-18", "--quiet", "-o", str(file)]) == 0
    (claim,) = read_candidates(file)
    assert claim.radii == (Fraction(1e-19), Fraction(1e-18))
    assert "needs 2" in refused([*words, "--radii", "1e-9", "-o", str(file)], capsys, 2)
