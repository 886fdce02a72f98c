"""Interactive pictures in space, each one self-contained HTML file: orbits, families, proved loops, tori, tubes.

Needs plotly. Colours are Jacobi constants; certified orbits are drawn thick, numerical ones thin. What the mouse points
at says which it is. Verdicts are copied from files. Lines are double precision.
"""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from collections.abc import Sequence
from html import escape
from math import ceil, floor, log10
from textwrap import wrap
from typing import Any

import numpy as np

from orbitproof.explore.three_body.invariants import ManifoldRecord, ToriRecord
from orbitproof.explore.three_body.names import units_of_system
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.lines import NUMERICAL, Line, tube_lines
from orbitproof.figures.pictures.plotly_script import for_lines_in_space

_NEAR = 0.25
"""A primary is shown if it is at most this part of the picture's extent outside of it."""

_FLAT = 0.02
"""What is less high than this part of its extent is looked at from above."""

_SCALE = "Viridis"
_ORBIT = "#222222"
_TUBE = {"unstable": "#b2182b", "stable": "#1b7837"}


def orbits_figure(title: str, lines: Sequence[Line], mass: float) -> Any:
    """A figure of orbits in space, in the colours of their Jacobi constants."""
    from plotly import graph_objects

    figure = graph_objects.Figure()
    levels = np.array([line.level for line in lines])
    for line, colour in zip(lines, _colours(levels), strict=True):
        style = {"color": colour, "width": 7 if line.proved else 2.5}
        figure.add_trace(_trace(line.places, line.label, line=style))
    if len(set(levels[np.isfinite(levels)].tolist())) > 1:
        figure.add_trace(_bar(levels))
    note = "thick: certified, thin: numerical" if any(line.proved for line in lines) else NUMERICAL
    return _finished(figure, title, mass, note)


def tori_figure(record: ToriRecord) -> Any:
    """A figure of the tori that have places stored, from small to large, in colours from dark to light."""
    from plotly import graph_objects

    figure = graph_objects.Figure()
    stored = [torus for torus in record.tori if torus.surface is not None]
    colours = _colours(np.array([torus.curve.amplitude for torus in stored]))
    for torus, colour in zip(stored, colours, strict=True):
        curve = torus.curve
        label = (
            f"torus, amplitude {curve.amplitude:.4g}<br>Jacobi constant {curve.jacobi_constant:.10g}<br>"
            f"time of return {np.mean(curve.times):.8g}<br>rotation {curve.rotation:.8g}<br>"
            f"error of invariance {curve.error:.1e}<br>{NUMERICAL}"
        )
        assert torus.surface is not None
        closed = np.concatenate([torus.surface, torus.surface[:1]])
        rows = [*closed[:-1:2], *np.swapaxes(closed, 0, 1)[::6]]
        gap = np.full((1, 3), np.nan)
        places = np.concatenate([np.concatenate([row, gap]) for row in rows])
        figure.add_trace(_trace(places, label, line={"color": colour, "width": 2}))
    return _finished(figure, f"Tori around {record.title}", record.mass, NUMERICAL)


def tube_figure(record: ManifoldRecord) -> Any:
    """A figure of a tube, and of the periodic orbit that it leaves or leads to."""
    from plotly import graph_objects

    figure = graph_objects.Figure()
    orbit, lines = tube_lines(record)
    for line in lines:
        figure.add_trace(_trace(line.places, line.label, line={"color": _TUBE[record.manifold.kind], "width": 1.5}))
    figure.add_trace(_trace(orbit.places, orbit.label, line={"color": _ORBIT, "width": 4}))
    return _finished(figure, f"{record.manifold.kind.capitalize()} manifold of {record.title}", record.mass, NUMERICAL)


def _colours(values: Array) -> list[str]:
    """From dark to light with the value; the darkest for what is not known."""
    from plotly.colors import sample_colorscale

    known = values[np.isfinite(values)]
    low, size = (known.min(), np.ptp(known)) if len(known) else (0.0, 0.0)
    parts = np.nan_to_num((values - low) / size) if size > 0 else np.zeros(len(values))
    # The lightest colours are too pale on white.
    return [str(colour) for colour in sample_colorscale(_SCALE, (0.85 * parts).tolist())]


def _bar(levels: Array) -> Any:
    """A trace without places, for the scale of colours."""
    from plotly import graph_objects
    from plotly.colors import sample_colorscale

    low, high = float(np.nanmin(levels)), float(np.nanmax(levels))
    scale = [[part, sample_colorscale(_SCALE, [0.85 * part])[0]] for part in np.linspace(0, 1, 11)]
    bar = {
        "title": {"text": "Jacobi constant", "side": "top", "font": {"size": 12}}, "orientation": "h", "len": 0.7,
        "thickness": 10, "x": 0.5, "y": 0.0, "yanchor": "top", "nticks": 5,
    }  # fmt: skip
    marker = {"color": [low, high], "cmin": low, "cmax": high, "colorscale": scale, "colorbar": bar, "size": 0.1}
    nowhere = dict.fromkeys("xyz", (None, None))
    return graph_objects.Scatter3d(mode="markers", marker=marker, hoverinfo="skip", showlegend=False, **nowhere)


def _trace(places: Array, label: str, **look: Any) -> Any:
    from plotly import graph_objects

    x, y, z = places.T
    return graph_objects.Scatter3d(
        x=x, y=y, z=z, mode="lines", text=label, hovertemplate="%{text}<extra></extra>", showlegend=False, **look
    )


def _finished(figure: Any, title: str, mass: float, note: str) -> Any:
    from plotly import graph_objects

    drawn = [trace for trace in figure.data if trace.mode == "lines"]
    rows = np.concatenate([np.column_stack([trace.x, trace.y, trace.z]) for trace in drawn])
    low, high = np.nanmin(rows, axis=0), np.nanmax(rows, axis=0)
    near = _NEAR * float((high - low).max())
    places = [
        (name, x)
        for name, x in zip(_bodies(mass), (-mass, 1 - mass), strict=True)
        if np.all(np.array([x, 0, 0]) >= low - near) and np.all(np.array([x, 0, 0]) <= high + near)
    ]
    figure.add_trace(
        graph_objects.Scatter3d(
            x=[x for _, x in places], y=[0] * len(places), z=[0] * len(places), mode="markers+text",
            marker={"size": 4, "color": _ORBIT},
            text=[name for name, _ in places], textposition="top center",
            hovertemplate="%{text} (not to scale)<extra></extra>", showlegend=False,
        )
    )  # fmt: skip
    inside = np.array([[x, 0.0, 0.0] for _, x in places]).reshape(-1, 3)
    low, high = (
        np.minimum(low, inside.min(axis=0, initial=np.inf)),
        np.maximum(high, inside.max(axis=0, initial=-np.inf)),
    )
    middle, size = (low + high) / 2, float((high - low).max())
    half = 0.53 * np.maximum(high - low, 0.1 * size)
    is_flat = bool(high[2] - low[2] < _FLAT * size)
    # Without walls, which would hide what is written beside a primary.
    axis = {"showbackground": False, "gridcolor": "#e4e4e4", "color": _ORBIT}
    axes = {f"{name}axis": {**_axis(name, middle[i], half[i], mass), **axis} for i, name in enumerate("xyz")}
    axes["zaxis"]["visible"] = not is_flat
    ratio = dict(zip("xyz", (half / half.max()).tolist(), strict=True))
    camera = {"eye": {"x": 0, "y": 0, "z": 1.45}, "up": {"x": 0, "y": 1, "z": 0}} if is_flat else {"eye": _ASLANT}
    units = units_of_system(mass)
    unit = "unit of length: the distance of the primaries"
    if units is not None:
        unit = f"the distance of the primaries is {units.length:,.0f} km; the origin is their centre of mass"
    figure.update_layout(
        title={"text": f"{'<br>'.join(wrap(escape(title), 44))}<br><sub>{note}<br>{unit}</sub>", "font": {"size": 14}},
        scene={"aspectmode": "manual", "aspectratio": ratio, "camera": camera, **axes},
        margin={"l": 0, "r": 0, "t": 90, "b": 70},
        paper_bgcolor="white",
    )
    return figure


def _bodies(mass: float) -> Sequence[str]:
    """What the primaries are called, the larger one first."""
    units = units_of_system(mass)
    return ("larger primary", "smaller primary") if units is None else units.name.split("-")


def _axis(name: str, middle: float, half: float, mass: float) -> dict[str, Any]:
    """Title, range and marks of an axis: in thousands of km where the length of the unit is known."""
    found: dict[str, Any] = {"title": {"text": name}, "range": [middle - half, middle + half]}
    units = units_of_system(mass)
    if units is None:
        return found
    low, high = ((middle + sign * half) * units.length / 1000 for sign in (-1, 1))
    power = 10.0 ** floor(log10(high - low))
    step = next(
        power * part for part in (0.2, 0.25, 0.5, 1.0, 2.0, 2.5) if (high - low) / (power * part) <= _MOST_MARKS
    )
    marks = np.arange(ceil(low / step), floor(high / step) + 1) * step
    places = {"tickvals": (marks * 1000 / units.length).tolist(), "ticktext": [f"{mark:g}" for mark in marks]}
    return {**found, **places, "title": {"text": f"{name} (1000 km)"}}


_MOST_MARKS = 5
_ASLANT = {"x": 1.23, "y": -1.48, "z": 0.82}
"""From where the picture is seen: far enough for all of its box."""

_HEAD = (
    '<head><meta name="viewport" content="width=device-width, initial-scale=1" />'
    "<style>body {margin: 0; overflow: hidden}</style>"
)
_FIT = """
const page = document.getElementById("{plot_id}");
const eye = page.layout.scene.camera.eye;
const fit = () => {
  const away = Math.max(1, page.clientHeight / page.clientWidth);
  Plotly.relayout(page, {"scene.camera.eye": {x: away * eye.x, y: away * eye.y, z: away * eye.z}});
};
fit();
window.addEventListener("resize", fit);
"""
"""In a window that is higher than wide the picture would be cut off at its sides: it is seen from farther away."""


_UNPACK = """
const bytes = Uint8Array.from(atob("{packed}"), letter => letter.charCodeAt(0));
const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
const script = document.createElement("script");
script.textContent = await new Response(stream).text();
document.head.append(script);
"""
_SCRIPT = re.compile(r"<script(?: [^>]*)?>(.*?)</script>", re.DOTALL)


def html_of(figure: Any) -> str:
    """The figure as one HTML page that needs nothing else, for wide and narrow windows.

    Of plotly's script it has the part that draws lines in space, packed: with all of it as it is a page has 5 MB.
    """
    from plotly.offline import get_plotlyjs

    page = figure.to_html(
        include_plotlyjs=False,
        full_html=True,
        div_id="figure",
        default_height="100vh",
        config={"responsive": True},
        post_script=_FIT,
    )
    scripts = [for_lines_in_space(get_plotlyjs()), *_SCRIPT.findall(page)]
    packed = b64encode(gzip.compress("\n".join(scripts).encode("utf-8"), 9, mtime=0)).decode("ascii")
    page = _SCRIPT.sub("", str(page)).replace("<head>", _HEAD, 1)
    return page.replace("</body>", f'<script type="module">{_UNPACK.replace("{packed}", packed)}</script></body>')
