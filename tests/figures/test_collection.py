"""All pictures from one data folder: what is missing is said, what is drawn shows what the data say."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from support.picture_texts import unreadable
from support.refusals import refused
from support.within import within

import orbitproof.figures.scripting.data as data_files
import orbitproof.verify.run.branch_command
import orbitproof.verify.run.row_command
from orbitproof import figures
from orbitproof.explore.commands.arguments import parser as explore_parser
from orbitproof.figures.__main__ import main
from orbitproof.figures.collection import PICTURES, STEPS, DataFolder, MissingData, Step, step_of
from orbitproof.figures.model import MarkedPoint, SampledFamily, assign, mark_candidates, read_families
from orbitproof.figures.orbits import OrbitNotClosed, symmetric_orbit, symmetric_orbits
from orbitproof.figures.pictures import (
    draw_closed_curves,
    draw_crossings,
    draw_gallery,
    draw_geometry,
    draw_marks,
    draw_resonant_families,
    draw_resonant_orbits,
    draw_torus,
)
from orbitproof.figures.pictures.halo_plane import spots_on
from orbitproof.figures.style import close, use_style
from orbitproof.shared import InputError
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN

DATA = Path(__file__).parents[1] / "data"
CANDIDATES, CERTIFICATES = DATA / "figures-candidates.json", DATA / "figures-certificates.json"
HALO, FALKNER = DATA / "figures-halo-family.json", DATA / "figures-falkner-skan-family.json"

style = within(lambda: use_style(), "module")


@pytest.fixture(scope="module")
def marks() -> list[MarkedPoint]:
    return mark_candidates(read_candidates(CANDIDATES), CERTIFICATES, CANDIDATES)


@pytest.fixture(scope="module")
def halo() -> SampledFamily:
    return read_families(HALO)[0]


@pytest.fixture(scope="module")
def falkner() -> SampledFamily:
    return read_families(FALKNER)[0]


@pytest.fixture(scope="module")
def halo_marks(halo: SampledFamily, marks: list[MarkedPoint]) -> list[MarkedPoint]:
    return assign([halo.refined()], marks)[0][0]


@pytest.fixture(scope="module")
def falkner_marks(falkner: SampledFamily, marks: list[MarkedPoint]) -> list[MarkedPoint]:
    return assign([falkner.refined()], marks)[0][0]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data folder that holds what two of the pictures need."""
    folder = tmp_path / "data"
    folder.mkdir()
    for source, name in ((CANDIDATES, "candidates"), (CERTIFICATES, "certificates"), (FALKNER, "falkner-skan")):
        shutil.copy(source, folder / f"{name}.json")
    return folder


def drawn_marks(figure: Figure) -> list[Line2D]:
    """The bifurcation markers of a figure, those in insets included."""
    axes = [axes for outer in figure.axes for axes in (outer, *outer.child_axes)]
    return [line for one in axes for line in one.lines if str(line.get_gid()).startswith("candidate ")]


def verdicts_drawn(figure: Figure) -> dict[str, set[bool]]:
    """For each candidate id, whether its markers are filled."""
    result: dict[str, set[bool]] = {}
    for line in drawn_marks(figure):
        filled = line.get_markerfacecolor() == line.get_markeredgecolor() != "white"
        result.setdefault(str(line.get_gid()).removeprefix("candidate "), set()).add(bool(filled))
    return result


def test_every_file_of_a_picture_is_made_by_a_step_after_what_the_step_needs() -> None:
    products: list[str] = []
    for step in STEPS:
        assert set(step.needs) <= set(products)
        assert set(step.products) & set(step.command)
        products += step.products
    assert len(products) == len(set(products))
    assert {name for picture in PICTURES for name in picture.data} | {"certificates.json"} <= set(products)
    assert all(
        "candidates.json" in picture.data or "branches.json" in picture.data for picture in PICTURES if picture.marked
    )
    with pytest.raises(KeyError):
        step_of("unheard-of.json")


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.products[0])
def test_commands_of_the_steps_are_accepted_and_write_into_the_folder(step: Step) -> None:
    package, *rest = step.words(Path("some data"))
    if rest[0] == "atlas" and package == "verify":
        package, rest = "verify atlas", rest[1:]
    parsers = {
        "explore": explore_parser,
        "verify": orbitproof.verify.run.row_command._parser,
        "verify atlas": orbitproof.verify.run.branch_command._parser,
    }
    parser = parsers[package]()
    options = parser.parse_args(rest)
    assert options.output == Path("some data") / step.products[-1 if "families.json" in step.products else 0] or (
        options.family_output == Path("some data") / step.products[0]
    )
    assert "'some data/" in step.text(Path("some data"))


def test_pictures_without_data_are_reported_with_the_command_and_others_are_drawn(tmp_path: Path, capsys: Any) -> None:
    data = tmp_path / "data"
    data.mkdir()
    assert main(["all", str(data), "-o", str(tmp_path / "out")]) == 1
    output, errors = capsys.readouterr()
    assert [Path(line).name for line in output.split()] == ["bifurcation-geometry.pdf", "bifurcation-geometry.png"]
    for picture in PICTURES:
        lines = [line for line in errors.splitlines() if line.startswith(f"{picture.name}: not drawn")]
        assert len(lines) == bool(picture.data)
        for line in lines:
            assert f"make it with: {step_of(picture.data[0]).text(data)}" in line


def test_pictures_whose_data_are_there_are_written_as_pdf_and_png(folder: Path, tmp_path: Path, capsys: Any) -> None:
    names = ["falkner-skan-family", "falkner-skan-orbits"]
    assert main(["all", str(folder), "-o", str(tmp_path), "--only", *names, "--quiet"]) == 0
    output, errors = capsys.readouterr()
    assert errors == ""
    assert [Path(line).name for line in output.split()] == [
        f"{name}{end}" for name in names for end in (".pdf", ".png")
    ]


def test_without_certificates_everything_is_hollow_and_the_exit_code_says_so(
    folder: Path, tmp_path: Path, capsys: Any
) -> None:
    (folder / "certificates.json").unlink()
    assert not any(mark.certified for mark in DataFolder(folder).marks)
    assert main(["all", str(folder), "-o", str(tmp_path), "--only", "falkner-skan-family"]) == 1
    assert "no certificates" in capsys.readouterr().err


def test_damaged_data_are_bad_input_and_do_not_stop_other_pictures(folder: Path, tmp_path: Path, capsys: Any) -> None:
    (folder / "portraits.json").write_text("{")
    names = ["phase-portraits", "bifurcation-geometry"]
    assert main(["all", str(folder), "-o", str(tmp_path), "--only", *names, "--quiet"]) == 2
    output, errors = capsys.readouterr()
    assert "bifurcation-geometry.png" in output
    assert errors.startswith("phase-portraits: not drawn: error: ")
    assert errors.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "word"),
    [(["--only", "nothing", "-o", "out"], "nothing"), ([], "-o"), (["-o", "out"], "no such folder")],
)
def test_wrong_arguments_are_one_line(arguments: list[str], word: str, tmp_path: Path, capsys: Any) -> None:
    folder = tmp_path / "absent"
    assert word in refused(main, ["all", str(folder), *arguments], capsys)


def test_a_family_that_the_file_does_not_hold_is_missing_data(folder: Path) -> None:
    data = DataFolder(folder)
    assert data.family("falkner-skan.json", "odd").system is FALKNER_SKAN
    with pytest.raises(MissingData, match="holds no family earth-moon L1-halo"):
        data.family("falkner-skan.json", "L1-halo", "earth-moon")


class Commands:
    """Stands for the commands of the steps: writes their products, or fails where it is told to."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, codes: dict[str, int] | None = None) -> None:
        self.run: list[str] = []
        self.codes = codes or {}
        monkeypatch.setattr(data_files, "_run", self)

    def __call__(self, step: Step, folder: Path, quiet: bool) -> int:
        self.run.append(step.products[0])
        code = self.codes.get(step.products[0], 0)
        if code != 2:
            for name in step.products:
                (folder / name).write_text("{}")
        return code


def test_data_command_makes_what_is_missing_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = Commands(monkeypatch)
    (tmp_path / "lyapunov.json").write_text("mine")
    assert main(["data", str(tmp_path)]) == 0
    assert commands.run == [step.products[0] for step in STEPS if step.products != ("lyapunov.json",)]
    assert (tmp_path / "lyapunov.json").read_text() == "mine"
    commands.run.clear()
    assert main(["data", str(tmp_path)]) == 0
    assert commands.run == []


def test_interrupted_step_is_run_again_although_its_file_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    commands = Commands(monkeypatch, {"certificates.json": 130})
    assert main(["data", str(tmp_path)]) == 130
    assert "go on with" in capsys.readouterr().err
    assert (tmp_path / "certificates.json").exists()
    assert commands.run[-1] == "certificates.json"
    commands.codes.clear()
    commands.run.clear()
    assert main(["data", str(tmp_path)]) == 0
    after = [step.products[0] for step in STEPS]
    assert commands.run == after[after.index("certificates.json") :]
    assert not (tmp_path / "unfinished.txt").exists()


def test_exit_code_one_of_a_step_goes_on_and_a_failure_stops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands = Commands(monkeypatch, {"portraits.json": 1, "l3-halo.json": 2})
    assert main(["data", str(tmp_path)]) == 2
    assert commands.run == ["portraits.json", "lyapunov.json", "l3-halo.json"]
    assert main(["data", str(tmp_path), "--only", "falkner-skan.json"]) == 1
    assert commands.run[-1] == "l3-halo.json"


def test_dry_run_prints_the_missing_commands_and_runs_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    commands = Commands(monkeypatch)
    (tmp_path / "portraits.json").write_text("{}")
    assert main(["data", str(tmp_path), "--dry-run"]) == 0
    assert commands.run == []
    assert capsys.readouterr().out.splitlines() == [step.text(tmp_path) for step in STEPS[1:]]


def test_from_python_the_data_are_made_as_by_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    commands, told = Commands(monkeypatch, {"lyapunov.json": 1, "certificates.json": 2}), list[Path]()
    made = figures.make_data(
        str(tmp_path), only=["lyapunov.json", "l3-*", "branches.json"], told=told.append, quiet=True
    )
    assert commands.run == ["lyapunov.json", "l3-halo.json"]
    assert list(made.paths) == told == [tmp_path / "lyapunov.json", tmp_path / "l3-halo.json"]
    assert made.incomplete == ("lyapunov.json",)
    assert made.not_made == {"branches.json": "not made: certificates.json is missing; ask for it as well"}
    assert not made.failed
    assert capsys.readouterr().err == f"branches.json: {made.not_made['branches.json']}\n"
    made = figures.make_data(tmp_path, quiet=True)
    assert made.failed
    assert "the command ended with code 2" in made.not_made["certificates.json"]
    assert commands.run[-1] == "certificates.json"
    commands.codes["certificates.json"] = 130
    with pytest.raises(KeyboardInterrupt):
        figures.make_data(tmp_path, quiet=True)
    with pytest.raises(InputError, match="no such data file"):
        figures.make_data(tmp_path / "other", only=["halo.json"])
    assert not (tmp_path / "other").exists()


def test_data_command_runs_a_real_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["data", str(tmp_path), "--only", "portraits.json"]) == 0
    document = json.loads((tmp_path / "portraits.json").read_text())
    assert len(document["portraits"]) == 6
    assert main(["all", str(tmp_path), "-o", str(tmp_path / "out"), "--only", "phase-portraits", "--quiet"]) == 0


def test_orbits_side_by_side_are_those_integrated_alone(halo: SampledFamily, falkner: SampledFamily) -> None:
    for family in (halo, falkner):
        indices = np.array([0, len(family.points) // 2, len(family.points) - 1])
        together = symmetric_orbits(
            family.system, family.parameters, family.points[indices], 0.5 * family.periods[indices]
        )
        for index, orbit in zip(indices, together, strict=True):
            alone = symmetric_orbit(family.system, family.parameters, list(family.points[index]))
            assert orbit[0] == pytest.approx(orbit[-1], abs=1e-12)
            assert orbit.min(axis=0) == pytest.approx(alone.min(axis=0), abs=2e-3 * np.ptp(alone))
            assert orbit.max(axis=0) == pytest.approx(alone.max(axis=0), abs=2e-3 * np.ptp(alone))


def test_orbit_of_a_wrong_period_is_not_drawn(halo: SampledFamily) -> None:
    with pytest.raises(OrbitNotClosed):
        symmetric_orbits(halo.system, halo.parameters, halo.points[:2], 0.4 * halo.periods[:2])


def test_points_of_the_falkner_skan_pictures_are_filled_if_certified(
    falkner: SampledFamily, falkner_marks: list[MarkedPoint]
) -> None:
    expected = {mark.candidate.id: {mark.certified} for mark in falkner_marks}
    assert {True} in expected.values()
    assert {False} in expected.values()
    for figure in (draw_crossings(falkner.refined(), falkner_marks), draw_resonant_orbits(falkner_marks)):
        assert verdicts_drawn(figure) == expected
        close(figure)


def test_halo_plane_pictures_mark_each_orbit_once_and_fill_it_if_certified(
    halo: SampledFamily, halo_marks: list[MarkedPoint]
) -> None:
    family = halo.refined()
    spots = spots_on(family, halo_marks)
    verdicts = {spot.mark.candidate.id: {spot.mark.certified} for spot in spots}
    assert len(verdicts) == len(spots) > 2
    by_name = {"L1": family, "L2": family, "L3": family}
    figure = draw_resonant_families(by_name, dict.fromkeys(by_name, halo_marks))
    assert verdicts_drawn(figure) == verdicts
    assert unreadable(figure) == []
    close(figure)
    first = next(mark for mark in halo_marks if mark.k == 1)
    place = family.points[len(family.points) // 3]
    folds = [replace(first, candidate=replace(first.candidate, kind="fold", id="fold"), point=place)]
    figure = draw_resonant_families(by_name, {name: [*halo_marks, *folds] for name in by_name})
    assert unreadable(figure) == []
    close(figure)
    figure = draw_resonant_families(by_name, {name: [] for name in by_name})
    assert verdicts_drawn(figure) == {}
    close(figure)
    figure = draw_closed_curves([family], [halo_marks])
    assert verdicts_drawn(figure) == {
        spot.mark.candidate.id: {spot.mark.certified} for spot in spots if spot.mark.k == 1
    }
    close(figure)


def test_two_candidates_of_one_orbit_share_a_spot(halo: SampledFamily, halo_marks: list[MarkedPoint]) -> None:
    family = halo.refined()
    mark = next(mark for mark in halo_marks if mark.k > 1 and not family.place(mark).second)
    s = family.place(mark).arclength
    other = np.array([np.interp(s, family.arclength, column) for column in family.second_points.T])
    twin = replace(mark, point=other, certified=not mark.certified)
    (both,) = spots_on(family, [twin, mark])
    assert both.mark is mark
    assert not both.elsewhere
    (alone,) = spots_on(family, [twin])
    assert alone.elsewhere
    assert alone.position == pytest.approx(both.position, abs=1e-4)


def test_pictures_in_space_show_each_orbit_of_their_choice(halo: SampledFamily) -> None:
    torus, gallery = draw_torus(halo), draw_gallery(halo)
    assert sum(len(axes.lines) for axes in torus.axes) > 40
    panels = [axes for axes in gallery.axes if hasattr(axes, "get_zlim")]
    assert len(panels) == 12
    texts = " ".join(text.get_text() for text in gallery.texts)
    assert f"$C={halo.levels[0]:.5f}$" in texts
    assert f"$T={halo.periods[-1]:.5f}$" in texts
    close(torus)
    close(gallery)


def test_geometry_shows_the_branch_on_one_side_and_on_both_sides() -> None:
    figure = draw_geometry()
    tupling, touch_and_go = (
        [line.get_xdata() for line in axes.lines if len(line.get_xdata()) > 2] for axes in figure.axes
    )
    assert [float(np.min(x)) for x in tupling] == [-1.0, 0.0]
    assert [float(np.min(x)) for x in touch_and_go] == [-1.0, -1.0]
    close(figure)


def test_legend_of_six_multiplicities_stays_below_the_axes(marks: list[MarkedPoint]) -> None:
    first = next(mark for mark in marks if mark.candidate.system is CR3BP)
    kinds = {1: "symmetry_breaking", 3: "touch_and_go"}
    six = [
        replace(first, candidate=replace(first.candidate, k=k, kind=kinds.get(k, "period_tupling")), certified=k < 4)
        for k in range(1, 7)
    ]
    figure = draw_marks(six)
    figure.draw_without_rendering()
    top = max(legend.get_window_extent().y1 for legend in figure.legends)
    assert sum(len(legend.get_texts()) for legend in figure.legends) == 8
    assert min(axes.get_tightbbox().y0 for axes in figure.axes) >= top
    assert all(legend.get_window_extent().x0 >= 0 for legend in figure.legends)
    close(figure)
