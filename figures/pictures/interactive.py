"""Interactive pictures in space, each one self-contained HTML file: families, proved loops, tori. Needs plotly.

Certified orbits are drawn blue and thick, numerical ones grey and thin. What the mouse points at says which it is, with
the Jacobi constant, the period and the stability index. Verdicts are copied from files. Lines are double precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from textwrap import wrap
from typing import Any

import numpy as np

from orbitproof.explore.invariants import ToriRecord
from orbitproof.explore.orbits import correct_batch, stability_index
from orbitproof.figures.certified import Curve, heading_of
from orbitproof.figures.model import MarkedPoint, SampledFamily, level_of
from orbitproof.figures.orbits import Array, OrbitNotClosed, symmetric_orbit
from orbitproof.shared.systems import ReversibleSystem, shown

SHOWN = 60
"""Orbits of a family or loop that are drawn, at most."""

_NEAR = 0.25
"""A primary is shown if it is at most this part of the picture's extent outside of it."""

_NUMERICAL = "numerical, not proved"
_COLOURS = {True: "#3c6e91", False: "#8a8a8a"}


@dataclass(frozen=True)
class Line:
    """An orbit in space: its places, shape (N, 3), its verdict, and what the mouse shows."""

    places: Array
    proved: bool
    label: str


def family_lines(family: SampledFamily, marks: Sequence[MarkedPoint]) -> list[Line]:
    """Orbits along a traced family, and those of its marked points with their verdicts."""
    chosen = np.unique(np.linspace(0, len(family.arclength) - 1, SHOWN).round().astype(int))
    lines = []
    for index in chosen:
        places = _orbit(family.system, family.parameters, family.points[index])
        if places is not None:
            facts = _facts(family.levels[index], family.periods[index], np.roots(family.coefficients[index]))
            lines.append(Line(places, False, f"orbit {index + 1} of {family.name}<br>{facts}<br>{_NUMERICAL}"))
    # Between the orbits of the file by cubic interpolation: good to five digits.
    fine = family.refined() if marks else family
    for mark in marks:
        places = _orbit(family.system, family.parameters, mark.point)
        if places is None:
            continue
        place = fine.place(mark).arclength
        period = float(np.interp(place, fine.arclength, fine.periods))
        row = [np.interp(place, fine.arclength, column) for column in fine.coefficients.T]
        said = f"k = {mark.k}: the certificate says proved" if mark.certified else f"k = {mark.k}: {_NUMERICAL}"
        label = f"{escape(shown(mark.candidate.id))}<br>{_facts(mark.level, period, np.roots(row), 5)}<br>{said}"
        lines.append(Line(places, mark.certified, label))
    return lines


def curve_lines(curve: Curve) -> list[Line]:
    """Orbits along a curve from its certificate; each has the verdict of its piece."""
    points = np.concatenate([stretch.points for stretch in curve.stretches])
    proved = np.concatenate([[stretch.is_proved] * len(stretch.points) for stretch in curve.stretches])
    chosen = np.unique(np.linspace(0, len(points) - 1, SHOWN).round().astype(int))
    places = [_orbit(curve.system, curve.parameters, points[index]) for index in chosen]
    kept = [(index, rows) for index, rows in zip(chosen, places, strict=True) if rows is not None]
    halves = [0.5 * _period(curve.system, curve.parameters, points[index]) for index, _ in kept]
    values = {name: float(value) for name, value in curve.parameters.items()}
    starts = np.column_stack([points[[index for index, _ in kept]], halves])
    # Many at once are corrected with a free level only.
    batch = None if curve.system.fixed_level else correct_batch(curve.system, values, starts, symmetry=None)
    lines = []
    for number, (index, rows) in enumerate(kept):
        level = level_of(curve.system, curve.parameters, list(points[index]))
        if batch is not None and batch.converged[number]:
            facts = _facts(level, 2 * float(batch.unknowns[number, -1]), batch.stability[number])
        else:
            facts = _facts(level, float("nan"), [])
        verdict = "on a piece that the certificate says is proved" if proved[index] else "on a piece that is not proved"
        lines.append(Line(rows, bool(proved[index]), f"{escape(heading_of(curve.atlas))}<br>{facts}<br>{verdict}"))
    return lines


def _orbit(system: ReversibleSystem, parameters: Any, point: Array) -> Array | None:
    try:
        return symmetric_orbit(system, parameters, list(point))[:, :3]
    except OrbitNotClosed:
        return None


def _period(system: ReversibleSystem, parameters: Any, point: Array) -> float:
    """About the period: the length of the orbit over its speed, a guess that is corrected."""
    rows = symmetric_orbit(system, parameters, list(point))
    speeds = np.linalg.norm(rows[:, 3:], axis=1)
    return float(np.sum(2 * np.linalg.norm(np.diff(rows[:, :3], axis=0), axis=1) / (speeds[1:] + speeds[:-1])))


def _facts(level: float, period: float, stability: Any, digits: int = 8) -> str:
    index = f"{stability_index(stability):.{min(digits, 6)}g}" if len(stability) else "unknown"
    time = f"{period:.{digits}g}" if np.isfinite(period) else "unknown"
    return f"Jacobi constant {level:.10g}<br>period {time}<br>stability index {index}"


def orbits_figure(title: str, lines: Sequence[Line], mass: float) -> Any:
    """A figure of orbits in space."""
    from plotly import graph_objects

    figure = graph_objects.Figure()
    for line in lines:
        style = {"color": _COLOURS[line.proved], "width": 5 if line.proved else 1.5}
        figure.add_trace(_trace(line.places, line.label, line=style))
    return _finished(figure, title, mass)


def tori_figure(record: ToriRecord) -> Any:
    """A figure of the tori that have places stored, from small to large."""
    from plotly import graph_objects

    figure = graph_objects.Figure()
    for torus in record.tori:
        if torus.surface is None:
            continue
        curve = torus.curve
        label = (
            f"torus, amplitude {curve.amplitude:.4g}<br>Jacobi constant {curve.jacobi_constant:.10g}<br>"
            f"time of return {np.mean(curve.times):.8g}<br>rotation {curve.rotation:.8g}<br>"
            f"error of invariance {curve.error:.1e}<br>{_NUMERICAL}"
        )
        closed = np.concatenate([torus.surface, torus.surface[:1]])
        rows = [*closed[:-1:2], *np.swapaxes(closed, 0, 1)[::6]]
        gap = np.full((1, 3), np.nan)
        places = np.concatenate([np.concatenate([row, gap]) for row in rows])
        figure.add_trace(_trace(places, label, line={"color": _COLOURS[False], "width": 1.5}))
    return _finished(figure, f"Tori around {record.title}", record.mass)


def _trace(places: Array, label: str, **look: Any) -> Any:
    from plotly import graph_objects

    x, y, z = places.T
    return graph_objects.Scatter3d(
        x=x, y=y, z=z, mode="lines", text=label, hovertemplate="%{text}<extra></extra>", showlegend=False, **look
    )


def _finished(figure: Any, title: str, mass: float) -> Any:
    from plotly import graph_objects

    rows = np.concatenate([np.column_stack([trace.x, trace.y, trace.z]) for trace in figure.data])
    low, high = np.nanmin(rows, axis=0), np.nanmax(rows, axis=0)
    near = _NEAR * float((high - low).max())
    names = {
        name: x
        for name, x in (("larger primary", -mass), ("smaller primary", 1 - mass))
        if np.all(np.array([x, 0, 0]) >= low - near) and np.all(np.array([x, 0, 0]) <= high + near)
    }
    figure.add_trace(
        graph_objects.Scatter3d(
            x=list(names.values()), y=[0] * len(names), z=[0] * len(names), mode="markers",
            marker={"size": 4, "color": "#222222"},
            text=[f"{name} (not to scale)" for name in names], hovertemplate="%{text}<extra></extra>",
            showlegend=False,
        )
    )  # fmt: skip
    note = "blue and thick: certified, grey: numerical<br>unit of length: the distance of the primaries"
    axis = {"backgroundcolor": "white", "gridcolor": "#e4e4e4", "color": "#222222"}
    figure.update_layout(
        title={"text": f"{'<br>'.join(wrap(escape(title), 44))}<br><sub>{note}</sub>", "font": {"size": 14}},
        scene={"aspectmode": "data", **{f"{name}axis": {"title": {"text": name}, **axis} for name in "xyz"}},
        margin={"l": 0, "r": 0, "t": 110, "b": 0},
        paper_bgcolor="white",
    )
    return figure


_HEAD = (
    '<head><meta name="viewport" content="width=device-width, initial-scale=1" />'
    "<style>body {margin: 0; overflow: hidden}</style>"
)
_FIT = """
const page = document.getElementById("{plot_id}");
const fit = () => {
  const away = 1.25 * Math.max(1, page.clientHeight / page.clientWidth);
  Plotly.relayout(page, {"scene.camera.eye": {x: away, y: away, z: away}});
};
fit();
window.addEventListener("resize", fit);
"""
"""In a window that is higher than wide the picture would be cut off at its sides: it is seen from farther away."""


def html_of(figure: Any) -> str:
    """The figure as one HTML page that needs nothing else, for wide and narrow windows."""
    page = figure.to_html(
        include_plotlyjs=True,
        full_html=True,
        div_id="figure",
        default_height="100vh",
        config={"responsive": True},
        post_script=_FIT,
    )
    return str(page).replace("<head>", _HEAD, 1)
