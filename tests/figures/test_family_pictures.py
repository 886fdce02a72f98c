"""Pictures show what the certificates say, and nothing more."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from support.picture_texts import unreadable
from support.within import within

from orbitproof.figures.__main__ import main
from orbitproof.figures.model import MarkedPoint, SampledFamily, assign, level_of, mark_candidates, read_families
from orbitproof.figures.orbits import OrbitNotClosed, state_on_fixed_set, symmetric_orbit
from orbitproof.figures.pictures import draw_family, draw_marks
from orbitproof.figures.pictures.marks import resonances
from orbitproof.figures.pictures.space import set_box
from orbitproof.figures.style import close, marker_of, use_style
from orbitproof.shared import InputError
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, MASS_PARAMETERS

DATA = Path(__file__).parents[1] / "data"
CANDIDATES = DATA / "figures-candidates.json"
CERTIFICATES = DATA / "figures-certificates.json"
HALO, FALKNER = DATA / "figures-halo-family.json", DATA / "figures-falkner-skan-family.json"
EARTH_MOON = {"mu": MASS_PARAMETERS["earth-moon"]}


@pytest.fixture(scope="module")
def families() -> list[SampledFamily]:
    return [family.refined() for path in (HALO, FALKNER) for family in read_families(path)]


@pytest.fixture(scope="module")
def marks() -> list[MarkedPoint]:
    return mark_candidates(read_candidates(CANDIDATES), CERTIFICATES, CANDIDATES)


style = within(lambda: use_style(), "module")


@pytest.fixture(scope="module")
def pictures(
    families: list[SampledFamily], marks: list[MarkedPoint]
) -> Iterator[list[tuple[list[MarkedPoint], Figure]]]:
    """The picture of each family, with the marks that belong on it."""
    members, alone = assign(families, marks)
    assert not alone
    drawn = [(own, draw_family(family, own)) for family, own in zip(families, members, strict=True)]
    yield drawn
    for _, figure in drawn:
        close(figure)


def drawn_marks(figure: Figure) -> list[Line2D]:
    """The lines of a figure that are bifurcation markers."""
    return [line for axes in figure.axes for line in axes.lines if str(line.get_gid()).startswith("candidate ")]


def is_filled(line: Line2D) -> bool:
    return bool(line.get_markerfacecolor() == line.get_markeredgecolor() != "white")


def test_stored_data_hold_proved_and_not_proved_points_of_both_systems(marks: list[MarkedPoint]) -> None:
    for system in (CR3BP, FALKNER_SKAN):
        assert {mark.certified for mark in marks if mark.candidate.system is system} == {True, False}


def test_certified_points_are_filled_and_others_hollow(pictures: list[tuple[list[MarkedPoint], Figure]]) -> None:
    for own, figure in pictures:
        for mark in own:
            lines = [line for line in drawn_marks(figure) if line.get_gid() == f"candidate {mark.candidate.id}"]
            assert lines
            assert all(is_filled(line) == mark.certified for line in lines)


def test_without_certificates_no_marker_is_filled(families: list[SampledFamily]) -> None:
    marks = mark_candidates(read_candidates(CANDIDATES), None, CANDIDATES)
    for family, own in zip(families, assign(families, marks)[0], strict=True):
        figure = draw_family(family, own)
        lines = drawn_marks(figure)
        assert lines
        assert not any(is_filled(line) for line in lines)
        close(figure)


def test_not_proved_is_hollow(tmp_path: Path) -> None:
    document = json.loads(CERTIFICATES.read_text())
    proved = [entry["id"] for entry in document["certificates"] if entry["verdict"] == "proved"]
    for entry in document["certificates"]:
        entry.update(verdict="not proved", results=None)
        entry["statement"].pop("theorem", None)
        entry["statement"].pop("in_full", None)
        entry["reason"] = {"condition": "frames", "message": "not regular", "remedy": "refine again"}
    path = tmp_path / "certificates.json"
    path.write_text(json.dumps(document))
    marks = mark_candidates(read_candidates(CANDIDATES), path, CANDIDATES)
    assert proved
    assert not any(mark.certified for mark in marks)


def test_certificate_for_another_claim_is_refused(tmp_path: Path) -> None:
    document = json.loads(CERTIFICATES.read_text())
    path = tmp_path / "certificates.json"
    first = document["certificates"][0]

    def refusal(entries: list[Any]) -> str:
        path.write_text(json.dumps({**document, "certificates": entries}))
        with pytest.raises(InputError) as caught:
            mark_candidates(read_candidates(CANDIDATES), path, CANDIDATES)
        return str(caught.value)

    shifted = copy.deepcopy(first)
    shifted["statement"]["candidate"]["centre"][0] = "0x1p-1"
    assert "differs from" in refusal([shifted])
    empty = copy.deepcopy(first)
    empty["statement"]["candidate"] = {}
    assert "statement.candidate" in refusal([empty])
    assert "no candidate 'unheard of'" in refusal([{**first, "id": "unheard of"}])
    assert "appears twice" in refusal([first, first])


def test_each_multiplicity_has_its_own_marker() -> None:
    shapes = [marker_of(k)[0] for k in (1, 2, 3, 4, 5, 6, 7)]
    assert len(set(shapes)) == len(shapes)


def test_every_axis_of_a_picture_is_labelled(pictures: list[tuple[list[MarkedPoint], Figure]]) -> None:
    for _, figure in pictures:
        for axes in figure.axes:
            assert axes.get_ylabel()
            shared_below = not axes.xaxis.get_tick_params().get("labelbottom", True)
            assert axes.get_xlabel() or shared_below


def test_all_that_is_written_can_be_read(
    pictures: list[tuple[list[MarkedPoint], Figure]], marks: list[MarkedPoint]
) -> None:
    alone = draw_marks([mark for mark in marks if mark.candidate.system.name == "falkner-skan"])
    for figure in (*(figure for _, figure in pictures), alone):
        assert unreadable(figure) == []
    alone.text(-0.02, 0.5, "beside it")
    alone.text(0.5, 0.5, "twice")
    alone.text(0.5, 0.5, "twice")
    alone.axes[1].set_position((0, 0, 1, 1))
    said = unreadable(alone)
    assert {"beside it is cut off", "twice meets twice"} <= set(said)
    assert any(line.endswith("is covered") for line in said)
    close(alone)


def test_legend_lies_below_all_axes(pictures: list[tuple[list[MarkedPoint], Figure]]) -> None:
    for _, figure in pictures:
        figure.draw_without_rendering()
        top = max(legend.get_window_extent().y1 for legend in figure.legends)
        for axes in figure.axes:
            assert axes.get_tightbbox().y0 >= top - 1


def test_points_lie_on_the_curve_of_their_crossing(families: list[SampledFamily], marks: list[MarkedPoint]) -> None:
    halo = families[0]
    assert halo.points.shape[0] > 100
    for second, curve in ((False, halo.points), (True, halo.second_points)):
        point = 0.5 * (curve[4] + curve[5])
        placement = halo.place(replace(marks[0], point=point))
        assert placement.second == second
        assert placement.distance < 1e-12
        assert halo.arclength[4] < placement.arclength < halo.arclength[5]


def test_a_point_of_another_mass_or_far_away_is_on_no_family(
    families: list[SampledFamily], marks: list[MarkedPoint]
) -> None:
    mark = next(mark for mark in marks if mark.candidate.system is CR3BP)
    assert assign(families, [mark])[1] == []
    heavier = replace(mark, candidate=replace(mark.candidate, parameters={"mu": Fraction(1, 2)}))
    moved = replace(mark, point=mark.point + 0.1)
    assert assign(families, [heavier, moved])[1] == [heavier, moved]
    figure = draw_marks([heavier, moved])
    assert len(drawn_marks(figure)) == 4
    close(figure)


def test_families_of_the_stored_data_consist_of_symmetric_periodic_orbits() -> None:
    for family in read_families(HALO) + read_families(FALKNER):
        for i in (0, len(family.points) // 2, len(family.points) - 1):
            orbit = symmetric_orbit(family.system, family.parameters, list(family.points[i]))
            half = orbit[len(orbit) // 2]
            expected = state_on_fixed_set(family.system, family.parameters, list(family.second_points[i]))
            assert half == pytest.approx(expected, abs=1e-5)
            assert orbit[-1] == pytest.approx(orbit[0], abs=1e-12)
            level = level_of(family.system, family.parameters, list(family.points[i]))
            assert level == pytest.approx(family.levels[i], abs=1e-9)


def test_first_integral_is_constant_along_a_drawn_orbit(families: list[SampledFamily]) -> None:
    halo = families[0]
    orbit = symmetric_orbit(CR3BP, EARTH_MOON, list(halo.points[len(halo.points) // 2]))
    mu = float(EARTH_MOON["mu"])
    assert CR3BP.first_integral is not None
    values = [float(CR3BP.first_integral(list(row), [mu])[0]) for row in orbit]
    assert np.ptp(values) < 1e-7


def test_orbit_into_the_primary_is_reported() -> None:
    with pytest.raises(OrbitNotClosed):
        symmetric_orbit(CR3BP, EARTH_MOON, [1 - float(EARTH_MOON["mu"]), 0.0, 0.0])


def test_resonances_are_the_primitive_roots() -> None:
    levels = resonances([1, 2, 3, 4, 5])
    assert levels[1] == (1.0,)
    assert levels[2] == (-1.0,)
    assert levels[3] == pytest.approx([-0.5])
    assert levels[4] == pytest.approx([0.0])
    assert levels[5] == pytest.approx([(-1 + 5**0.5) / 4, (-1 - 5**0.5) / 4])


def test_command_writes_pdf_and_png_of_each_family(tmp_path: Path, capsys: Any) -> None:
    folder = tmp_path / "new" / "pictures"
    arguments = ["family", str(CANDIDATES), str(CERTIFICATES), "--family", str(HALO), str(FALKNER), "-o", str(folder)]
    assert main(arguments) == 0
    output, errors = capsys.readouterr()
    written = sorted(folder.iterdir())
    assert sorted(output.split()) == [str(path) for path in written]
    assert errors == ""
    assert [path.suffix for path in written] == [".pdf", ".png", ".pdf", ".png"]
    for path in written:
        assert path.read_bytes().startswith(b"%PDF" if path.suffix == ".pdf" else b"\x89PNG")
        assert path.suffix == ".pdf" or path.stat().st_size < 300_000


def test_command_without_family_files_draws_the_points_and_says_so(tmp_path: Path, capsys: Any) -> None:
    assert main(["family", str(CANDIDATES), str(CERTIFICATES), "-o", str(tmp_path)]) == 0
    output, errors = capsys.readouterr()
    assert len(output.split()) == 4
    assert "--family" in errors


def test_format_resolution_and_size_are_as_asked_for(tmp_path: Path) -> None:
    words = ["family", str(CANDIDATES), str(CERTIFICATES), "--family", str(FALKNER), "--quiet"]
    sizes = {}
    for width in ("7.2", "9"):
        folder = tmp_path / width
        assert main([*words, "-o", str(folder), "--format", "png", "svg", "--dpi", "100", "--width", width]) == 0
        (drawn,) = folder.glob("family-falkner*.png")
        sizes[width] = int.from_bytes(drawn.read_bytes()[16:20], "big")
        assert drawn.with_suffix(".svg").read_text().startswith("<?xml")
        assert not list(folder.glob("*.pdf"))
    assert sizes == {"7.2": 720, "9": 900}


@pytest.mark.parametrize("words", [["--dpi", "5"], ["--width", "1000"], ["--width", "nan"], ["--format", "bmp"]])
def test_a_size_that_is_none_is_refused_in_one_line(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        code = main(["family", str(CANDIDATES), "-o", str(tmp_path), *words])
    except SystemExit as stop:
        code = stop.code if isinstance(stop.code, int) else -1
    assert code == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert words[0] in lines[0]
    assert not list(tmp_path.iterdir())


def test_points_that_hide_one_another_are_apart_in_an_inset(
    families: list[SampledFamily], marks: list[MarkedPoint]
) -> None:
    """Two claims a hair apart: drawn in the panel over one another, in an inset a fifth of its size apart."""
    halo = families[0]
    own = assign([halo], marks)[0][0]
    near = replace(own[0], candidate=replace(own[0].candidate, id="near"), point=own[0].point * (1 + 1e-4))
    figure = draw_family(halo, [*own, near])
    insets = [child for child in figure.axes[0].child_axes if len(drawn_lines(child)) >= 2]
    assert insets
    places = np.array([line.get_xydata()[0] for line in drawn_lines(insets[0])])
    shown = insets[0].transAxes.inverted().transform(insets[0].transData.transform(places))
    assert np.linalg.norm(shown[0] - shown[1]) > 0.2
    close(figure)


def drawn_lines(axes: Any) -> list[Line2D]:
    return [line for line in axes.lines if str(line.get_gid()).startswith("candidate ")]


def test_stability_curves_go_on_where_parameters_become_complex() -> None:
    """s^2 = a, real for a > 0 and complex below: the real part joins the real branches where they end."""
    a = np.linspace(1.0, -1.0, 41) + 0.01
    one = np.ones(41)
    family = SampledFamily(
        "x", CR3BP, EARTH_MOON, np.zeros((41, 3)), np.zeros((41, 3)), one, one,
        np.column_stack([one, 0 * one, -a]), np.arange(41.0),
    )  # fmt: skip
    real, complex_part = np.isfinite(family.stability).all(axis=1), np.isfinite(family.complex_stability).all(axis=1)
    assert np.all(real | complex_part)
    assert np.count_nonzero(real & complex_part) == 1
    assert np.nanmax(np.abs(family.complex_stability)) < 1e-12
    fine = family.refined()
    last = fine.stability[np.isfinite(fine.stability).all(axis=1)][-1]
    assert 0 < last[1] - last[0] < 1e-2


def test_a_flat_box_has_one_tick_across() -> None:
    """More of them would stand on one another, as those of planar orbits did."""
    for height, ticks in ((0.0, [0.0]), (0.01, [0.0]), (1.0, None)):
        axes = Figure().add_subplot(projection="3d")
        set_box(axes, CR3BP, np.array([-1.0, -1.0, -height]), np.array([1.0, 1.0, height]))
        found = list(axes.get_zticks())
        assert found == ticks if ticks else len(found) > 2


def test_a_family_in_the_plane_fills_its_panels(families: list[SampledFamily]) -> None:
    halo = families[0]
    flat = np.where(np.array(halo.system.centre_coordinates) == "z", 0.0, 1.0)
    planar = replace(halo, points=halo.points * flat, second_points=halo.second_points * flat)
    figure = draw_family(planar, [])
    low, high = figure.axes[0].get_ylim()
    assert low < planar.points[:, 2].min() < planar.points[:, 2].max() < high
    assert not any(hasattr(axes, "get_zlim") for axes in figure.axes)
    close(figure)
