"""The picture of a complete list shows the points, bounds and stable intervals of the certificate, and no others."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from support.conclusions import with_lasting
from support.picture_texts import unreadable
from support.stability_cases import DATA, atlas, listed, results
from support.stored import values
from support.within import within

from orbitproof.figures.__main__ import main
from orbitproof.figures.certified import CertifiedStability, ListedPoint
from orbitproof.figures.certified.twist import _twist
from orbitproof.figures.pictures import draw_certified_stability
from orbitproof.figures.pictures.certified_branches import Along
from orbitproof.figures.style import close, use_style
from orbitproof.shared import parse_exact
from orbitproof.verify.branches import make_atlas_certificate
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.certificate import Certificate, write_certificate
from orbitproof.verify.curve import conclude

style = within(lambda: use_style())


def document(**changes: Any) -> dict[str, Any]:
    conclusion = listed(results())
    return make_atlas_certificate(
        atlas(), values(results()), {**conclusion, "complete": {**conclusion["complete"], **changes}}
    )


def stability(**changes: Any) -> CertifiedStability:
    found = CertifiedStability.of(Certificate(document(**changes)))
    assert found is not None
    return found


def test_the_picture_shows_the_points_and_stable_intervals_of_the_list() -> None:
    complete = listed(results())["complete"]
    figure = draw_certified_stability(stability())
    upper = figure.axes[0]
    drawn = [line for line in upper.lines if str(line.get_gid()).startswith("listed")]
    assert len(drawn) == len(complete["points"])
    for line, point in zip(drawn, complete["points"], strict=True):
        beta = float(parse_exact(point["level"]["mid"]))
        assert line.get_xdata()[0] == pytest.approx(beta, rel=1e-4)
        assert line.get_ydata()[0] == pytest.approx(np.cos(2 * np.pi * point["j"] / point["k"]))
        assert line.get_markerfacecolor() == line.get_color() != "white", "what is proved is filled"
    (span,) = [patch for patch in upper.patches if patch.get_gid() == "stable"]
    assert span.get_x() == pytest.approx(340.1875, abs=0.01)
    close(figure)


def test_the_picture_is_headed_by_the_id_and_not_by_the_title_of_the_file() -> None:
    entitled = replace(atlas(), title="PROVED: all of them are stable")
    told = document()
    told["statement"]["atlas"]["title"] = entitled.title
    found = CertifiedStability.of(Certificate(told))
    assert found is not None
    figure = draw_certified_stability(found)
    assert figure.texts[0].get_text() == f"{atlas().id}: curve of falkner-skan"
    assert not [text for text in figure.findobj(Text) if "PROVED" in text.get_text()]
    close(figure)


def test_what_the_certificate_does_not_say_is_not_drawn() -> None:
    figure = draw_certified_stability(stability(stable=[], points=[]))
    upper = figure.axes[0]
    assert not [line for line in upper.lines if str(line.get_gid()).startswith("listed")]
    assert not upper.patches
    assert "linearly stable" not in words(figure)
    close(figure)


def test_a_panel_without_a_curve_says_where_the_curve_is() -> None:
    found = stability(points=[])
    assert "outside of this panel" not in words(draw_certified_stability(found))
    parts = tuple(replace(part, parameters=part.parameters + 700) for part in found.parts)
    figure = draw_certified_stability(replace(found, parts=parts))
    assert "outside of this panel: real parts from about 69" in words(figure)
    assert unreadable(figure) == []
    close(figure)


def words(figure: Figure) -> str:
    entries = (text.get_text() for legend in figure.legends for text in legend.get_texts())
    return " ".join([*entries, *(text.get_text() for text in figure.axes[0].texts)])


def test_the_curve_lies_on_the_drawn_resonances() -> None:
    found = stability()
    for point in found.points:
        (part,) = [part for part in found.parts if part.stretch.piece == point.piece]
        near = np.interp(point.s, part.stretch.s, part.parameters[:, 0].real)
        assert near == pytest.approx(point.value, abs=1e-3)
    assert all(np.nanmax(part.bounds) < 1e-6 for part in found.parts)


def test_a_certificate_without_a_list_has_no_such_picture() -> None:
    plain = make_atlas_certificate(atlas(), values(results()), told(conclude(atlas(), values(results()))))
    assert CertifiedStability.of(Certificate(plain)) is None


@pytest.mark.parametrize("with_list", [True, False])
def test_the_command_draws_it_if_there_is_a_list(with_list: bool, tmp_path: Path) -> None:
    path, folder = tmp_path / "curve.json", tmp_path / "pictures"
    plain = make_atlas_certificate(atlas(), values(results()), told(conclude(atlas(), values(results()))))
    write_certificate(path, document() if with_list else plain)
    assert main(["atlas", str(path), "-o", str(folder)]) == 0
    assert bool(list(folder.glob("stability-*.png"))) is with_list


def test_orbits_that_are_stable_for_ever_are_filled_by_the_sign_of_their_twist_and_twistless_ones_are_lines() -> None:
    complete = listed(results())["complete"]
    begin, *_, end = complete["points"]
    whole = complete["stable"][0]
    third = {**whole["to"], "piece": "p015", "interval": [end["s"]["mid"], end["s"]["mid"]]}
    lasting = {
        "stable": [{**whole, "to": third, "twist": "negative"}, {**whole, "from": third, "twist": "positive"}],
        "exceptions": [{**begin, "kind": "twistless"}, begin],
    }
    figure = draw_certified_stability(stability(lasting=lasting))
    for axes in figure.axes:
        first, second = (patch for patch in axes.patches if patch.get_gid() == "lasting")
        assert first.get_facecolor() != second.get_facecolor()
        assert bool(first.get_hatch()) is not bool(second.get_hatch()), "in grey the two fills are one"
        assert first.get_x() + first.get_width() == pytest.approx(second.get_x())
        assert len([line for line in axes.lines if line.get_gid() == "twistless"]) == 1
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert {"stable for ever, twist negative", "stable for ever, twist positive", "no twist"} <= set(labels)
    assert "proved linearly stable" not in labels, "nothing of that colour is to be seen"
    assert unreadable(figure) == []
    close(figure)


def points_at(*parts: float) -> tuple[ListedPoint, ...]:
    """Listed points at such parts of the axis of `stability()`."""
    curve = stability().curve
    axis = Along(curve)
    begin, end = axis.ends(curve.stretches[0])[0], axis.ends(curve.stretches[-1])[1]
    found = []
    for part in parts:
        x = begin + part * (end - begin)
        stretch = next(each for each in curve.stretches if axis.ends(each)[0] <= x <= axis.ends(each)[1])
        s = float(np.interp(x, axis.values(stretch), stretch.s))
        found.append(ListedPoint(stretch.piece, s, 7, 2, "", x, 0.2, False))
    return tuple(found)


def test_stretches_with_many_points_are_drawn_again_until_their_points_are_apart() -> None:
    crowd, dense = (0.4 + 0.01 * i for i in range(10)), (0.412 + 0.0001 * i for i in range(12))
    spots = sorted((0.1, *crowd, *dense, 0.8))
    figure = draw_certified_stability(replace(stability(), points=points_at(*spots)))
    whole, _, first, second = figure.axes
    axis = Along(stability().curve)
    begin, end = (axis.ends(stability().curve.stretches[place])[place] for place in (0, -1))
    assert [axes.get_title(loc="left")[:3] for axes in figure.axes] == ["(a)", "(b)", "(c)", "(d)"]
    for axes, marked, low, high in ((first, whole, 0.4, 0.49), (second, first, 0.412, 0.4131)):
        left, right = axes.get_xlim()
        (bar,) = (line for line in marked.lines if str(line.get_gid()).startswith("stretch"))
        assert tuple(bar.get_xdata()) == (left, right)
        assert left < begin + low * (end - begin) < begin + high * (end - begin) < right
        shown = [line for line in axes.lines if str(line.get_gid()).startswith("listed")]
        assert len(shown) == len(spots)
    assert np.ptp(second.get_xlim()) < 0.25 * np.ptp(first.get_xlim()) < 0.1 * np.ptp(whole.get_xlim())
    assert unreadable(figure) == []
    close(figure)


@pytest.mark.parametrize("spots", [(0.1, 0.2, 0.2001, 0.9), tuple(0.05 + 0.02 * i for i in range(45))])
def test_few_points_and_points_all_over_the_curve_have_no_panel_of_their_own(spots: tuple[float, ...]) -> None:
    figure = draw_certified_stability(replace(stability(), points=points_at(*spots)))
    assert len(figure.axes) == 2
    close(figure)


def test_the_twist_is_drawn_as_it_is_proved_of_one_orbit() -> None:
    """-3296.33067 at beta = 400 (section 28.7), by other functions than the stored ones."""
    found = json.loads((DATA / "lasting-falkner-skan.json").read_text())
    document = make_atlas_certificate(atlas(), values(found), with_lasting(atlas(), found))
    stability = CertifiedStability.of(Certificate(document))
    assert stability is not None
    beta, twist = (np.concatenate(rows) for rows in zip(*(
        (part.stretch.points[:, 0], part.twist) for part in stability.parts
    ), strict=True))  # fmt: skip
    assert np.interp(400.0, beta, twist) == pytest.approx(-3296.33067, rel=1e-3)
    assert np.isnan(twist[beta < 340.18]).all()
    figure = draw_certified_stability(stability)
    (panel,) = [axes for axes in figure.axes if axes.get_title(loc="left").startswith("(c)")]
    lines = [line for line in panel.lines if line.get_gid() == "twist"]
    assert [line.get_ydata().tolist() for line in lines] == [
        pytest.approx(part.twist.tolist(), nan_ok=True) for part in stability.parts
    ]
    assert {line.get_gid() for line in panel.lines} >= {"twist 3", "twist 4"}
    assert not unreadable(figure)
    close(figure)


def test_what_is_stored_of_odd_maps_has_no_factor_that_is_divided_out() -> None:
    """(29.5) and (29.9)."""

    def constant(value: int) -> SimpleNamespace:
        return SimpleNamespace(coefficients=[Fraction(value, 10)])

    stability: Any = SimpleNamespace(characteristic=[constant(-3)])
    found = [
        _twist(stability, cast(Any, SimpleNamespace(twist=constant(2), exchanged=constant(5), odd=odd)), np.zeros(1))
        for odd in (True, False)
    ]
    assert found[0] == pytest.approx(0.4 * found[1])
