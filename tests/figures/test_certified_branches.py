"""Pictures of proved branches show what their certificates say, and nothing more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from support.chain_cases import Case, certificate, circle_point, concluded, parabola, parabola_piece, symmetric_loop
from support.stored import values
from support.within import within

from orbitproof.figures.__main__ import main
from orbitproof.figures.certified import Curve, heading_of
from orbitproof.figures.pictures import draw_curves, draw_pieces, draw_surface, interactive, lines, surface_of
from orbitproof.figures.scripting.documents import _curve_in_space as page_of_curve
from orbitproof.figures.style import close, use_style
from orbitproof.shared.claims import Atlas, Claim, SurfacePiece
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, HILL_VARIED
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.certificate import Certificate, write_certificate

ANGLE = 0.7
POINT = certificate(circle_point(ANGLE), name="on the circle")
IMAGE = certificate(circle_point(-ANGLE), name="on its image")
BESIDE = certificate({**circle_point(1.5), "vy": circle_point(1.5)["vy"] + 1}, name="beside")


def document_of(case: Case, *bifurcations: Certificate, regularised: Sequence[str] = ()) -> dict[str, Any]:
    atlas, results = case
    for result in results:
        result.pop("reason", None)
        name = "Kustaanheimo-Stiefel" if result["piece"] in regularised else "physical"
        result["computation"] = {"seconds": 1.0, "steps": 3, "coordinates": name}
    return make_atlas_certificate(atlas, values(results), told(concluded((atlas, results), *bifurcations)))


def curve(case: Case, *bifurcations: Certificate, regularised: Sequence[str] = ()) -> Curve:
    return Curve.of(Certificate(document_of(case, *bifurcations, regularised=regularised)))


style = within(lambda: use_style())


def bars(figure: Figure) -> list[Rectangle]:
    return [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]


def marks(figure: Figure) -> dict[str, tuple[float, float]]:
    lines = [line for axes in figure.axes for line in axes.lines if str(line.get_gid()).startswith("candidate")]
    return {
        str(line.get_gid()).removeprefix("candidate "): (line.get_xdata()[0], line.get_ydata()[0])  # type: ignore[index]
        for line in lines
    }


def test_the_curve_is_followed_once_from_one_symmetric_point_to_the_other() -> None:
    half = curve(symmetric_loop())
    points = np.concatenate([stretch.points for stretch in half.stretches])
    angles = np.arctan2(points[:, 1], points[:, 0])
    assert np.allclose(np.hypot(points[:, 0], points[:, 1]), 1.0, atol=1e-9)
    assert angles[0] == pytest.approx(0.0, abs=1e-9)
    assert angles[-1] == pytest.approx(math.pi)
    assert (np.diff(angles) > -1e-9).all()
    # sqrt(dx^2 + dz^2 + dvy^2) = sqrt(1 + sin^2) da
    grid = (np.arange(10000) + 0.5) * math.pi / 10000
    length = float(np.sqrt(1 + np.sin(grid) ** 2).mean() * math.pi)
    assert half.stretches[-1].arclength[-1] == pytest.approx(length, rel=1e-4)


def test_points_on_the_curve_are_marked_where_they_are_and_others_are_not() -> None:
    figure = draw_curves([curve(symmetric_loop(), POINT, IMAGE, BESIDE)])
    found = marks(figure)
    assert set(found) == {"on the circle", "on its image"}
    assert found["on the circle"] == pytest.approx((math.cos(ANGLE), math.sin(ANGLE)), abs=1e-6)
    assert found["on its image"] == pytest.approx((math.cos(ANGLE), -math.sin(ANGLE)), abs=1e-6)
    close(figure)


def test_a_point_of_a_piece_that_is_not_drawn_is_not_marked() -> None:
    """Such are the pieces of births: their orbits are no part of the curve."""
    atlas, results = symmetric_loop()
    document = document_of((atlas, results), POINT, IMAGE)
    born, other = document["conclusion"]["bifurcations"]
    born["piece"] = "birth"
    drawn = Curve.of(Certificate(document))
    assert [mark.id for mark in drawn.marks] == [other["id"]]


def test_images_under_the_symmetry_are_dashed_and_close_the_loop() -> None:
    figure = draw_curves([curve(symmetric_loop())])
    lines = [line for line in figure.axes[0].lines if len(line.get_xdata()) > 5]  # type: ignore[arg-type]
    solid = [line for line in lines if line.get_linestyle() == "-"]
    dashed = [line for line in lines if line.get_linestyle() == "--"]
    assert len(solid) == len(dashed) == 6
    for line, image in zip(solid, dashed, strict=True):
        assert np.array_equal(line.get_xdata(), image.get_xdata())
        assert np.array_equal(np.asarray(line.get_ydata()), -np.asarray(image.get_ydata()))
    close(figure)


def test_a_curve_without_symmetry_has_no_image() -> None:
    figure = draw_curves([curve(parabola())])
    assert all(line.get_linestyle() == "-" for line in figure.axes[0].lines)
    close(figure)


def test_bars_have_the_width_of_a_piece_and_the_look_of_its_coordinates() -> None:
    found = curve(symmetric_loop(), regularised=["p002"])
    figure = draw_pieces(found)
    shown = bars(figure)
    assert [bar.get_height() for bar in shown] == pytest.approx(
        [0.4 * math.sqrt(1 + math.sin(n * math.pi / 5) ** 2) for n in range(6)]
    )
    assert [bool(bar.get_hatch()) for bar in shown] == [False, False, True, False, False, False]
    assert shown[2].get_facecolor() != shown[1].get_facecolor()
    for bar, stretch in zip(shown, found.stretches, strict=True):
        assert bar.get_x() == pytest.approx(stretch.arclength[0])
        assert bar.get_x() + bar.get_width() == pytest.approx(stretch.arclength[-1])
    labels = [text.get_text() for text in figure.legends[-1].get_texts()]
    assert "Kustaanheimo-Stiefel coordinates" in labels
    assert "6 of 6 pieces proved" in figure.axes[0].get_title(loc="left")
    close(figure)


def test_marks_on_the_bars_stand_at_the_arclength_of_their_points() -> None:
    found = curve(symmetric_loop(), POINT)
    figure = draw_pieces(found)
    x, y = marks(figure)["on the circle"]
    grid = (np.arange(10000) + 0.5) * ANGLE / 10000
    assert x == pytest.approx(float(np.sqrt(1 + np.sin(grid) ** 2).mean() * ANGLE), rel=1e-3)
    assert y == pytest.approx(0.4 * math.sqrt(1 + math.sin(math.pi / 5) ** 2))
    close(figure)


@pytest.mark.parametrize("interval", [None, ["-0x1", "0x1p-1"]], ids=["no result", "a part"])
def test_a_piece_that_is_not_proved_on_all_of_its_way_is_hollow(interval: list[str] | None) -> None:
    atlas, results = symmetric_loop()
    results = [result for result in results if result["piece"] != "p003" or interval]
    for result in results:
        if result["piece"] == "p003":
            result["interval"] = interval
    found = curve((atlas, results))
    assert not found.is_proved
    figure = draw_pieces(found)
    assert [to_hex(bar.get_facecolor()) == "#ffffff" for bar in bars(figure)] == [False] * 3 + [True] + [False] * 2
    assert "5 of 6 pieces proved" in figure.axes[0].get_title(loc="left")
    assert "not proved" in [text.get_text() for text in figure.legends[-1].get_texts()]
    close(figure)


def test_the_parts_of_a_piece_that_was_split_are_told_apart() -> None:
    atlas, results = parabola()
    first, second = {**results[1], "interval": ["-0x1", "0x1p-5"]}, {**results[1], "interval": ["-0x1p-5", "0x1"]}
    figure = draw_pieces(curve((atlas, [results[0], first, second, results[2]])))
    white = [line for line in figure.axes[0].lines if line.get_color() == "white"]
    assert len(white) == 1
    assert "3 of 3 pieces proved (4 intervals)" in figure.axes[0].get_title(loc="left")
    close(figure)


def test_a_parameter_that_grows_over_decades_has_a_logarithmic_axis() -> None:
    pieces = tuple(parabola_piece(n, Fraction(3) ** (n + 1), Fraction(3) ** (n + 1) * 3 / 5) for n in range(6))
    atlas = Atlas("wide", "a wide parabola", FALKNER_SKAN, {}, Claim("arc"), pieces)
    figure = draw_pieces(curve((atlas, [])))
    assert figure.axes[0].get_xscale() == "log"
    assert bars(figure)[0].get_x() == pytest.approx(float(Fraction(3) * 2 / 5))
    assert [bar.get_height() for bar in bars(figure)] == pytest.approx([float(piece.half_width) for piece in pieces])
    close(figure)
    figure = draw_pieces(curve(parabola()))
    assert figure.axes[0].get_xscale() == "linear"
    assert bars(figure)[0].get_x() == pytest.approx(1.0)
    close(figure)


def write(path: Path, document: dict[str, Any]) -> str:
    write_certificate(path, document)
    return str(path)


def test_the_command_writes_pieces_and_curves_and_says_whether_all_is_proved(
    tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    arc = write(tmp_path / "arc.json", document_of(parabola()))
    assert main(["atlas", arc, "-o", str(tmp_path / "out")]) == 0
    files = {f"{stem}.{suffix}" for stem in ("atlas-parabola", "curves-falkner-skan-arc") for suffix in ("pdf", "png")}
    assert {path.name for path in (tmp_path / "out").iterdir()} == files
    assert len(capsys.readouterr().out.splitlines()) == len(files)

    saved: list[str] = []
    monkeypatch.setattr("orbitproof.figures.collection.proved.save", lambda figure, stem: saved.append(stem.name) or [])
    atlas, results = parabola()
    partly = write(tmp_path / "partly.json", document_of((replace(atlas, id="partly"), results[:2])))
    loop = write(tmp_path / "loop.json", document_of(symmetric_loop()))
    assert main(["atlas", arc, partly, loop, "-o", str(tmp_path / "out")]) == 1
    assert saved[:3] == ["atlas-parabola", "atlas-partly", "atlas-circle"]
    assert saved[3:] == ["curves-falkner-skan-arc", "curves-cr3bp-symmetric-loop"]


def surface_certificate(results: Sequence[dict[str, Any]]) -> Certificate:
    """Two pieces over mu from 1/8 to 3/8 and from 3/8 to 5/8; x = 1 + mu, vy = 2."""
    unit = tuple(tuple(Fraction(i == j) for j in range(3)) for i in range(3))
    tall = (unit[0], (Fraction(0), Fraction(2), Fraction(0)), unit[2])
    pieces = tuple(
        SurfacePiece(
            id=name,
            parameters={"mu": (middle, Fraction(1, 8))},
            centre=((1 + middle, Fraction(1, 8)), (Fraction(0),), (Fraction(2),)),
            frame=tall,
            kernel_frame=tuple(row[:2] for row in unit[:2]),
            radii=(Fraction(1, 100),) * 3,
        )
        for name, middle in (("m1", Fraction(1, 4)), ("m2", Fraction(1, 2)))
    )
    atlas = Atlas("surface", "a surface", CR3BP, {}, Claim("symmetry-breaking-surface", "S"), pieces)
    return Certificate(make_atlas_certificate(atlas, values(results), None))


def test_pieces_of_a_surface_stand_over_their_parameters_as_high_as_their_orbits_reach(tmp_path: Path) -> None:
    part = {"point": [], "side": "above", "hypotheses": {}}
    parts = [{"interval": ends, **part} for ends in (["-0x1", "0x0"], ["0x0", "0x1"])]
    result = {
        "piece": "m1",
        "interval": ["-0x1", "0x1"],
        "verdict": "proved",
        "parts": parts,
        "computation": {"seconds": 1},
    }
    found = surface_of(surface_certificate([result]))
    figure = draw_surface(found)
    first, second = bars(figure)
    assert (first.get_x(), first.get_width(), first.get_height()) == pytest.approx((0.125, 0.25, 0.02))
    assert (second.get_x(), second.get_width(), second.get_height()) == pytest.approx((0.375, 0.25, 0.02))
    assert to_hex(first.get_facecolor()) != to_hex(second.get_facecolor()) == "#ffffff"
    assert found.sheets[0].borders == pytest.approx((0.25,))
    assert "1 of 2 pieces proved, in 2 parts" in figure.axes[0].get_title(loc="left")
    for line, value in zip(figure.axes[1].lines[:2], (lambda mu: 1 + mu, lambda mu: 2 + 0 * mu), strict=True):
        assert np.allclose(line.get_ydata(), value(np.asarray(line.get_xdata())))
    close(figure)
    path = write(tmp_path / "surface.json", dict(surface_certificate([]).document))
    assert main(["atlas", path, "-o", str(tmp_path / "out")]) == 1
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"surface-surface.pdf", "surface-surface.png"}


LIE = "PROVED: infinitely many bifurcations lie on it"


def test_no_picture_is_headed_by_the_title_of_a_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """It is anybody's words; id, kind and system are what the certificate is checked for."""
    atlas, results = symmetric_loop()
    entitled = replace(atlas, title=LIE), results
    figures = [draw_pieces(curve(entitled)), draw_curves([curve(entitled)]), draw_curves([curve(entitled)] * 2)]
    heads = [figures[0].texts[0].get_text(), *(axes.get_title(loc="left") for axes in figures[1].axes[:1])]
    assert set(heads) == {"circle: symmetric closed curve of cr3bp"}
    surface = replace(surface_certificate([]).atlas, title=LIE)
    figures.append(draw_surface(surface_of(Certificate(make_atlas_certificate(surface, [], None)))))
    assert figures[-1].texts[0].get_text() == "surface: surface of cr3bp"
    titles: list[str] = []
    monkeypatch.setattr(lines, "curve_lines", lambda found: [])
    monkeypatch.setattr(interactive, "orbits_figure", lambda title, *rest: titles.append(title))
    path = write(tmp_path / "curve.json", document_of(entitled))
    page_of_curve(Path(path))
    assert titles == heads[:1]
    assert heading_of(replace(atlas, id="it is proved")) == '"it is proved": symmetric closed curve of cr3bp'
    doublings = replace(atlas, system=HILL_VARIED, claim=replace(atlas.claim, kind="arc"))
    assert heading_of(doublings) == "circle: curve of period doublings over the mass (cr3bp-hill-varied)"
    for figure in figures:
        assert not [text for text in figure.findobj(Text) if "PROVED" in text.get_text()]
        close(figure)


def test_bad_input_is_one_line(tmp_path: Path, capsys: Any) -> None:
    def refused(*arguments: str) -> str:
        assert main(["atlas", *arguments, "-o", str(tmp_path / "out")]) == 2
        errors = str(capsys.readouterr().err)
        assert errors.startswith("error: ")
        assert errors.count("\n") == 1
        return errors

    arc = write(tmp_path / "arc.json", document_of(parabola()))
    assert "give each atlas once" in refused(arc, arc)
    assert "cannot be read" in refused(str(tmp_path / "none.json"))
    (tmp_path / "arc.json").write_text((tmp_path / "arc.json").read_text().replace("parabola", "Parabola"))
    assert "digest" in refused(arc)
