"""Pictures of tori and tubes: what the files say, and that it is numerical."""

from __future__ import annotations

import gzip
import json
import re
from base64 import b64decode
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from plotly.offline import get_plotlyjs
from support.picture_texts import unreadable
from support.within import within

from orbitproof.explore.three_body.invariants import (
    Plane,
    manifold_of,
    read_manifold,
    read_tori,
    trace_tori,
    write_manifold,
    write_tori,
)
from orbitproof.explore.three_body.trajectories import Choice, SourceOrbit, find_orbit, trajectory_of
from orbitproof.figures.__main__ import main
from orbitproof.figures.model import read_families
from orbitproof.figures.pictures import draw_manifold, draw_tori
from orbitproof.figures.pictures.distances import draw_distances
from orbitproof.figures.pictures.plotly_script import for_lines_in_space
from orbitproof.figures.style import close, use_style
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import CR3BP

MASS = Fraction("1.215058560962404e-2")
HALO = [1.1380985313, -0.1661640169, -0.2240501116, 1.5452867791]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("invariants")
    halo = trajectory_of(SourceOrbit(CR3BP, {"mu": MASS}, np.array(HALO), "a halo orbit", "not proved"))
    write_tori(folder / "tori.json", halo, trace_tori(halo.orbit, float(MASS), most=3), surfaces=1)
    tube = manifold_of(halo.solution, float(MASS), kind="unstable", side=-1, plane=Plane(0, 0.98785), count=5)
    write_manifold(folder / "tube.json", halo, tube)
    return folder / "tori.json", folder / "tube.json"


style = within(lambda: use_style())


def texts(figure: Figure) -> str:
    legend = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    return " ".join(legend + [text.get_text() for text in figure.texts])


def test_pictures_of_tori_say_that_nothing_is_proved_and_show_every_curve(files: tuple[Path, Path]) -> None:
    record = read_tori(files[0])
    figure = draw_tori(record)
    assert "nothing proved" in texts(figure)
    section = next(axes for axes in figure.axes if "invariant curves" in axes.get_title(loc="left"))
    shown = [np.asarray(line.get_xydata()) for line in section.lines if len(line.get_xydata()) > 1]
    assert len(shown) == 3
    assert shown[2][0] == pytest.approx(record.tori[2].curve.points(np.zeros(1))[0, :2])
    markers = [line for axes in figure.axes for line in axes.lines if line.get_marker() == "o" and axes.name != "3d"]
    assert all(line.get_markerfacecolor() == "white" for line in markers)
    assert unreadable(figure) == []
    close(figure)


def test_pictures_of_tubes_end_where_the_file_says(files: tuple[Path, Path]) -> None:
    record = read_manifold(files[1])
    figure = draw_manifold(record)
    assert "nothing proved" in texts(figure)
    (line,) = figure.axes[1].lines
    assert np.asarray(line.get_xydata())[:5] == pytest.approx(record.manifold.ends[:, [1, 4]])
    assert line.get_markerfacecolor() == "white"
    close(figure)


def test_command_draws_both_and_refuses_other_files(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [str(path) for path in files]
    assert main(["tori", *words, "-o", str(tmp_path), "--format", "png"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"tori.png", "tube.png"}
    other = Path(__file__).parents[1] / "data" / "figures-candidates.json"
    capsys.readouterr()
    for wrong in (str(other), "nowhere.json"):
        assert main(["tori", wrong, "-o", str(tmp_path)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "catalogue" not in line


def test_the_orbit_of_a_tube_is_read_from_its_file(files: tuple[Path, Path]) -> None:
    found = trajectory_of(find_orbit(files[1], Choice()))
    assert found.start == pytest.approx([HALO[0], 0, HALO[1], 0, HALO[2], 0], abs=1e-6)
    assert found.period == pytest.approx(2 * HALO[3], abs=1e-6)
    document = json.loads(files[1].read_text())
    del document["state"]
    older = files[1].with_name("older.json")
    older.write_text(json.dumps(document))
    with pytest.raises(InputError, match="compute the tube again"):
        find_orbit(older, Choice())


def unpacked(page: Path) -> str:
    """A page with its scripts as they run."""
    text = page.read_text()
    (packed,) = re.findall(r'atob\("([A-Za-z0-9+/=]+)"\)', text)
    return text.replace(packed, "") + gzip.decompress(b64decode(packed)).decode("utf-8")


def test_interactive_pages_need_nothing_else_and_copy_the_verdicts(files: tuple[Path, Path], tmp_path: Path) -> None:
    data = Path(__file__).parents[1] / "data"
    page = tmp_path / "page.html"
    words = [str(data / "figures-halo-family.json"), "--candidates", str(data / "figures-candidates.json")]
    assert main(["interactive", *words, "-o", str(page)]) == 0
    assert page.stat().st_size < 1_000_000
    assert "Plotly.newPlot" not in page.read_text()
    hollow = unpacked(page)
    assert hollow.count("Plotly.newPlot(") == 1
    assert "thick: certified" not in hollow
    assert "x (1000 km)" in hollow
    assert '"Moon"' in hollow
    assert "the certificate says proved" not in hollow
    assert hollow.count("numerical, not proved") >= 20
    assert "stability index" in hollow
    assert "<script src=" not in hollow
    assert hollow.count('name="viewport"') == 1
    assert 'getElementById("figure")' in hollow
    assert (
        main(["interactive", *words, "--certificates", str(data / "figures-certificates.json"), "-o", str(page)]) == 0
    )
    assert "the certificate says proved" in unpacked(page)
    assert "thick: certified" in unpacked(page)
    assert main(["interactive", str(files[0]), "-o", str(page)]) == 0
    assert "error of invariance" in unpacked(page)


def test_of_the_script_what_lines_in_space_need_is_kept() -> None:
    def part(name: str, body: str) -> str:
        return f"var {name}=W(({name}0,{name}1)=>{{{body}}});"

    head, core = "var W=(e,t)=>t;", part("core", "help(); lazy()")
    used = part("help", "1") + part("line", 'name:"scatter3d"; core()') + part("passed", "passed1.exports=line()")
    lazy = "var more=W(e=>{2});function deep(){}var lazy=Ea(()=>{more()});"
    unused = part("map", 'name:"map"; big()') + part("big", "x.help()")
    last = "var all=W((a,b)=>{core();core.register([map(),passed()])});return all()"
    shortened = for_lines_in_space(head + core + used + lazy + unused + last)
    assert shortened == head + core + used + lazy + last.replace("map(),", "")
    for other in ("plain();", head + core + used + last.replace("register", "other"), head + core + unused + last):
        assert for_lines_in_space(other) == other


def test_the_script_of_a_page_is_a_third_of_that_of_plotly() -> None:
    whole = get_plotlyjs()
    part = for_lines_in_space(whole)
    assert len(part) < 0.4 * len(whole)
    assert all(word in part for word in ('name:"scatter3d"', "window.Plotly = Plotly", "newPlot", "relayout"))
    # No part is called that is not there.
    defined = set(re.findall(r"(?<![\w$.])([\w$]+)=W\(", part))
    gone = set(re.findall(r"(?<![\w$.])([\w$]+)=W\(", whole)) - defined
    assert gone & set(re.findall(r"(?<![\w$.])([A-Za-z_$][\w$]*)\(\)", part)) == set()


def test_interactive_pages_show_tubes_single_orbits_and_rows_of_a_catalogue(
    files: tuple[Path, Path], tmp_path: Path
) -> None:
    page, rows = tmp_path / "page.html", Path(__file__).parents[2] / "docs" / "examples" / "gateway-rows.json"
    assert main(["interactive", str(files[1]), "-o", str(page)]) == 0
    assert unpacked(page).count("unstable manifold, orbit") == 5
    for more, count in ((["--orbit", "2"], 1), ([], 3)):
        assert main(["interactive", str(rows), *more, "-o", str(page)]) == 0
        said = unpacked(page)
        assert said.count("least distance from the smaller primary") == count
        assert "the orbit hits it" not in said
    assert main(["interactive", str(files[1]), "--orbit", "2", "-o", str(page)]) == 2


def test_interactive_refuses_what_it_cannot_draw(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page, data = tmp_path / "page.html", Path(__file__).parents[1] / "data"
    for words, said in (
        (["nowhere.json"], "nowhere.json"),
        ([str(files[0]), "--family", "L1"], "holds no families; leave it out"),
        ([str(data / "figures-halo-family.json"), "--family", "L7"], "--family: no 'L7' in"),
        ([str(data / "figures-falkner-skan-family.json")], "has no family of cr3bp or cr3bp-axial"),
    ):
        assert main(["interactive", *words, "-o", str(page)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
    assert not page.exists()


def test_distances_along_a_family_show_which_orbits_hit_the_body(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = Path(__file__).parents[1] / "data"
    record = read_families(data / "figures-halo-family.json")[0]
    known = replace(record, parameters={"mu": MASS})
    figure = draw_distances(known)
    least = figure.axes[0].lines[1].get_ydata()
    ends = np.array([record.points[:, :2], record.second_points[:, :2]]) - [1 - float(MASS), 0]
    # Of halo orbits the least distance is that of one of the points on Fix(R); the mass differs in the fifth digit.
    assert least == pytest.approx(np.linalg.norm(ends, axis=2).min(axis=0), rel=1e-2)
    assert any("radius 1737.1 km" in text.get_text() for text in figure.legends[0].get_texts())
    assert unreadable(figure) == []
    close(figure)
    assert main(["distances", str(data / "figures-falkner-skan-family.json"), "-o", str(tmp_path)]) == 2
    assert "give families of cr3bp" in capsys.readouterr().err
