"""The diagram of a web: arcs from certified polynomials, vertices on them."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from flint import arb
from support.chain_cases import certificate, circle_point, line_in_plane, symmetric_loop
from support.forgeries import atlas_certificate, forged
from support.joined import retrograde_curve, retrograde_web

from orbitproof.figures import draw_web as draw_files
from orbitproof.figures.certified import Curve
from orbitproof.figures.pictures import draw_web, web_page
from orbitproof.figures.pictures.web import (
    STYLES,
    DrawnArc,
    States,
    _between,
    _draw,
    _kind_of,
    _named,
    drawn_arcs,
    in_the_plane,
    names_of,
)
from orbitproof.figures.pictures.web_page import _index_at, _list_in_words
from orbitproof.shared.claims.web import BRANCHES, PASSES, Meeting, Web, WebArc
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import CR3BP, VERTICAL
from orbitproof.verify.branches import certified_web
from orbitproof.verify.branches.listed import ListedEnd, ListedInterval
from orbitproof.verify.branches.web import StoredArc
from orbitproof.verify.certificate import Certificate, Level, Recheck, write_certificate
from orbitproof.verify.stability import IntervalEnd
from orbitproof.verify.web import IndexOnArc

MU = 1 / 80


@cache
def web() -> tuple[Certificate, Certificate]:
    """A circle of halo orbits that branches off in the plane, and a point on it."""
    atlas, results = symmetric_loop()
    curve = Certificate(atlas_certificate(atlas, results))
    at = {"x": arb(1, 2**-80), "z": arb(0), "vy": arb(2, 2**-80)}
    one = certificate(at, name="one", kind="symmetry_breaking", k=1, symmetry="S")
    inside = certificate(circle_point(0.7), name="inside")
    claim = Web("a web", "A web", (WebArc("circle", (Meeting("one", BRANCHES), Meeting("inside", PASSES))),))
    checks = {entry.key: Recheck(entry.id, "proved", 1, (), level=Level.CONCLUSION) for entry in (curve, one, inside)}
    checks["arc", "circle"] = replace(checks["arc", "circle"], digest=curve.document["digest"])
    return Certificate(certified_web(claim, (curve, one, inside), checks)), curve


def level(angle: float) -> float:
    """Of the orbit that starts at a point of the circle."""
    x, z, vy = math.cos(angle), math.sin(angle), 3 - math.cos(angle)
    larger, smaller = math.hypot(x + MU, z), math.hypot(x + MU - 1, z)
    return x**2 + 2 * ((1 - MU) / larger + MU / smaller) - vy**2


def test_arcs_and_vertices_are_drawn_where_they_are_proved() -> None:
    known, curve = web()
    (arc,) = drawn_arcs(known, {"circle": Curve.of(curve)})
    assert arc.kind == "R"
    for (vertex, c, x), angle in zip(arc.marks, (0.0, 0.7), strict=True):
        assert abs(x - math.cos(angle)) < 1e-6, vertex
        assert abs(c - level(angle)) < 1e-6
    drawn = np.concatenate(arc.lines, axis=1)
    for c, x in drawn.T[::50]:
        assert abs(c - level(math.acos(np.clip(x, -1, 1)))) < 1e-5


def test_where_orbits_are_listed_as_stable_is_drawn_between_the_ends_and_nowhere_else() -> None:
    curve = Curve.of(web()[1])
    pieces = [stretch.piece for stretch in curve.stretches]

    def interval(start: tuple[int, int], end: tuple[int, int]) -> ListedInterval:
        ends = (ListedEnd(pieces[number], ("an end",), (Fraction(s, 8), Fraction(s, 8))) for number, s in (start, end))
        return ListedInterval(*ends)

    between = np.concatenate(list(_between(curve, interval((1, 2), (3, -2)))))
    beyond = np.concatenate(list(_between(curve, interval((3, -2), (1, 2)))))
    angles, others = (np.arctan2(points[:, 1], points[:, 0]) for points in (between, beyond))
    # Pieces of the half circle are centred every 36 degrees, as wide as a sine of 0.4.
    low, high = np.pi / 5 + np.arcsin(0.1), 3 * np.pi / 5 - np.arcsin(0.1)
    assert low - 1e-6 < angles.min() < low + 0.02
    assert high - 0.02 < angles.max() < high + 1e-6
    assert others.min() < 0.01 < np.pi - 0.01 < others.max()
    assert not ((others > low + 0.01) & (others < high - 0.01)).any()


def test_the_picture_has_filled_vertices_and_a_legend() -> None:
    known, curve = web()
    figure = draw_web(known, {"circle": Curve.of(curve)})
    (axes,) = figure.axes
    marks = {line.get_gid(): line for line in axes.lines if str(line.get_gid()).startswith("candidate")}
    assert set(marks) == {"candidate one", "candidate inside"}
    assert all(line.get_markerfacecolor() == line.get_color() for line in marks.values())
    labels = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert {"symmetric under R", "filled: certified"} <= set(labels)
    assert [text.get_text() for text in axes.texts] == ["circle"]
    assert "libration point" not in labels


def test_names_stand_on_their_arcs_apart_from_the_others_and_arcs_are_told_apart_in_grey() -> None:
    x = np.linspace(0.0, 1.0, 50)
    low, high = (
        DrawnArc(name, name, (np.array([x, y + 0.1 * x]),), (), ()) for name, y in (("R", 0.0), ("axial", 1.0))
    )
    _, axes = plt.subplots()
    _draw(axes, (low, high), (low, high))
    assert _named(axes, (low, high), (low, high), everything=True) == []
    texts = {text.get_text(): text.xy for text in axes.texts}
    assert texts["R"][1] < 0.3 < 0.7 < texts["axial"][1]
    assert len({str(style) for style in STYLES.values()}) == len(STYLES)


def test_the_page_has_arcs_with_orbits_vertices_and_the_theorem(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_page, "ORBITS", 2)
    known, curve = web()
    changed = forged(known.document, lambda d: d["statement"]["claim"].update(title="</script><b>a & b"))
    page = web_page.page_of(Certificate(changed), {"circle": Curve.of(curve)})
    assert page.count("</script>") == 2
    assert "&lt;/script&gt;&lt;b&gt;a &amp; b" in page
    assert "http" not in page
    assert "@" not in page.replace("@media", "")
    assert all(escape(line) in page for line in (known.theorem or "no theorem").split("\n"))
    data = json.loads(page.partition('type="application/json">')[2].partition("</script>")[0])
    (arc,) = data["arcs"]
    assert arc["beside"] == [0]
    assert arc["meets"] == [["branches off at", 0], ["passes through", 1]]
    one, inside = data["vertices"]
    assert [one["name"], inside["name"]] == ["one", "inside"]
    for vertex, angle in ((one, 0.0), (inside, 0.7)):
        assert vertex["places"] == [[pytest.approx(level(angle), abs=1e-6), pytest.approx(math.cos(angle), abs=1e-6)]]
    for orbit in arc["orbits"]:
        places = np.reshape(orbit["p"], (-1, 3))
        assert np.abs(places[0] - places[-1]).max() < 1e-5
        assert abs(places[0][0] - orbit["x"]) < 1e-5
        assert orbit["m"] >= 1 - 1e-6
        assert orbit["t"] > 0


def test_a_vertex_has_each_place_at_which_arcs_meet_it() -> None:
    known, curve = web()
    (arc,) = drawn_arcs(known, {"circle": Curve.of(curve)})
    first, (vertex, c, x) = arc.marks
    # Another arc meets it at the other point of its orbit, and a third one where the first does, as computed.
    others = (replace(arc, marks=((vertex, c, at),)) for at in (x - 0.5, x + 1e-9))
    one, inside = web_page._vertices(known, (arc, *others))
    assert [place[1] for place in one["places"]] == [pytest.approx(first[2])]
    assert [place[1] for place in inside["places"]] == [pytest.approx(x - 0.5), pytest.approx(x)]


@pytest.mark.parametrize("around", ["planar", "vertical"])
def test_points_in_units_of_orbits_are_states_of_the_three_body_problem(around: str) -> None:
    x_l, size, x, vy = 0.8, 0.04, 0.3, -0.7
    names, point = {
        "planar": (("eps", "vy"), [size, vy]),
        "vertical": (("eps2", "x", "vy"), [size, x, vy]),
    }[around]
    states = States(names, MU, x_l, around)
    wanted = {
        "planar": [x_l + size, 0, 0, 0, size * vy, 0],
        "vertical": [x_l + size * x, 0, 0, 0, size * vy, 0.2],
    }[around]
    assert np.allclose(states.states(np.array([point])), [wanted], rtol=0, atol=1e-15)
    ((found, at),) = states.level_and_x(np.array([point])).T
    larger, smaller = abs(wanted[0] + MU), abs(wanted[0] + MU - 1)
    kinetic = wanted[4] ** 2 + wanted[5] ** 2
    assert found == pytest.approx(wanted[0] ** 2 + 2 * ((1 - MU) / larger + MU / smaller) - kinetic, rel=1e-14)
    assert at == wanted[0]


def test_the_index_is_told_of_the_intervals_for_which_it_is_proved() -> None:
    curve = Curve.of(web()[1])
    pieces = [stretch.piece for stretch in curve.stretches]

    def counted(index: int, begin: tuple[int, int], end: tuple[int, int]) -> IndexOnArc:
        first, last = (
            IntervalEnd(("an end",), pieces[number], (Fraction(s, 8), Fraction(s, 8))) for number, s in (begin, end)
        )
        return IndexOnArc((1, index - 1), pieces[1], Fraction(0), first, last)

    orbits = [counted(2, (0, 0), (1, 2)), counted(3, (1, 3), (5, 0))]
    wanted = {(0, 0.5): 2, (1, 0.25): None, (1, 0.2): 2, (1, 0.3): None, (1, 0.4): 3, (4, -1.0): 3, (5, 0.0): None}
    assert {place: _index_at(place, orbits, curve) for place in wanted} == wanted
    round_the_beginning = [counted(4, (4, 0), (1, 0))]
    assert [_index_at((number, 0.5), round_the_beginning, curve) for number in range(6)] == [4, None, None, None, 4, 4]
    assert _index_at((0, 0.5), [replace(orbits[0], begin=None)], curve) is None


def test_arcs_have_names_for_people_that_stay_different() -> None:
    names = ["lyapunov-l1-earth-moon", "l1-circle-earth-moon", "axial-family-l3-earth-moon"]
    assert names_of(names) == ["L1 Lyapunov", "L1 circle", "L3 axial"]
    assert names_of(["circle"]) == ["circle"]
    for unclear in (["a-moon", "moon"], ["a-family", "a"], ["a-b", "b-a"]):
        assert names_of(unclear) == unclear
    assert names_of(["two words", "a-b"]) == ['"two words"', "a-b"]


def test_the_page_has_titles_a_legend_a_dark_form_and_a_way_back() -> None:
    page = web_page.PAGE
    assert 'fillText("Jacobi constant"' in page
    assert 'fillText("x where the orbit starts"' in page
    assert "prefers-color-scheme: dark" in page
    assert 'id="legend"' in page
    assert "history.back()" in page
    # In a narrow window the picture comes before the buttons.
    assert ".panels { grid-template-columns: 1fr; order: -1; }" in page
    # Colours of the two forms are those of the style alone.
    assert not re.search(r'(?:fill|stroke)Style = "#', page)


def test_the_page_has_the_index_of_the_certificate_of_the_web(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_page, "ORBITS", 4)

    def indices(known: Certificate) -> list[int | None]:
        page = web_page.page_of(known, {"dro": Curve.of(retrograde_curve())})
        (arc,) = json.loads(page.partition('type="application/json">')[2].partition("</script>")[0])["arcs"]
        return [orbit["i"] for orbit in arc["orbits"]]

    told = indices(retrograde_web())
    assert 2 in told
    assert set(told) <= {2, 3, None}
    silent = forged(retrograde_web().document, lambda d: d["arcs"][0].pop("index"))
    assert set(indices(Certificate(silent))) == {None}


def test_what_is_not_proved_is_not_drawn(tmp_path: Path) -> None:
    known, curve = web()
    not_proved = Certificate({**known.document, "verdict": "not proved"})
    with pytest.raises(InputError, match="nothing to draw"):
        drawn_arcs(not_proved, {"circle": Curve.of(curve)})
    files = tmp_path / "web.json", tmp_path / "curve.json"
    changed = forged(known.document, lambda d: [e.update(digest="sha256:" + 64 * "0") for e in d["rests_on"]])

    write_certificate(files[0], changed)
    write_certificate(files[1], curve.document)
    with pytest.raises(InputError, match="give its file"):
        draw_files(files[0], [files[1]], tmp_path)


def test_stability_that_is_proved_of_a_planar_arc_is_told_to_be_in_the_plane() -> None:
    known = StoredArc(id="a", system="a system", kind="arc", meets=(), order=4)
    assert (
        _list_in_words(known, "planar", CR3BP) == "proved intervals of linear stability to variations in the plane: 0"
    )
    assert _list_in_words(known, "R", CR3BP) == "proved intervals of linear stability: 0"
    assert _list_in_words(replace(known, order=None), "planar", CR3BP) == "its certificate has no list"
    ends = [ListedEnd("p", ("a point",), (Fraction(0), Fraction(0)), level) for level in (arb(0.25), None)]
    known = replace(known, stable=(ListedInterval(*ends),))
    assert _list_in_words(known, "vertical", VERTICAL["L1"]).endswith(": 1 (eps2 = 0.25 to a point)")
    assert _list_in_words(known, "R", CR3BP).endswith(": 1 (0.25 to a point)")
    line = np.zeros((2, 2))
    kinds = [_kind_of(atlas) for atlas in (line_in_plane()[0], symmetric_loop()[0])]
    assert kinds == ["planar", "R"]
    told = [in_the_plane([DrawnArc("arc", kind, (line,), (), stable)]) for kind in kinds for stable in ((line,), ())]
    assert told == [", planar ones in the plane", "", "", ""]
