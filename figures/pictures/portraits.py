"""Phase portraits of a reversible planar map before, at and after its 1:4 and 1:3 resonances."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.explore.portraits import Portrait
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.style import CURVE, INK

_WIDTH = 7.2
_MANIFOLD = "#b2182b"
_MARKERS = {True: ("o", 5.4), False: ("s", 4.6)}


def draw_portraits(portraits: Sequence[Portrait]) -> Figure:
    """One row for each resonance, one column for each value of the unfolding parameter."""
    rows: dict[int, list[Portrait]] = {}
    for portrait in portraits:
        rows.setdefault(portrait.k, []).append(portrait)
    columns = max(len(row) for row in rows.values())
    cell = (_WIDTH - 0.75) / columns
    height = len(rows) * (cell + 0.32) + 0.7
    figure = plt.figure(figsize=(_WIDTH, height))
    grid = figure.add_gridspec(
        len(rows),
        columns,
        left=0.088,
        right=0.985,
        top=1 - 0.25 / height,
        bottom=0.85 / height,
        wspace=0.16,
        hspace=0.25,
    )
    letters = iter("abcdefghijklmnop")
    for i, (k, row) in enumerate(rows.items()):
        for j, portrait in enumerate(sorted(row, key=lambda item: item.parameter)):
            axes = figure.add_subplot(grid[i, j])
            _draw(axes, portrait)
            axes.set_title(f"({next(letters)})  1:{k} resonance, $\\nu={portrait.parameter:g}$", color=INK)
            if j == 0:
                axes.set_ylabel("$v$  (nondimensional)")
            else:
                axes.tick_params(labelleft=False)
            if i == len(rows) - 1:
                axes.set_xlabel("$u$  (nondimensional)")
    _legend(figure)
    return figure


def _draw(axes: Axes, portrait: Portrait) -> None:
    axes.grid(False)
    for rows in portrait.orbits:
        # As an image also in PDF: tens of thousands of points.
        axes.plot(
            *rows.T, linestyle="none", marker=".", markersize=0.9, markeredgewidth=0, color=CURVE, rasterized=True
        )
    for rows in portrait.curves:
        axes.plot(*rows.T, color=CURVE, linewidth=0.45)
    for rows in portrait.manifolds:
        axes.plot(*rows.T, color=_MANIFOLD, linewidth=0.9)
    axes.axhline(0.0, color="#777777", linewidth=0.8, linestyle=(0, (5, 3)), zorder=3)
    axes.plot(0.0, 0.0, marker="+", color=INK, markersize=6, zorder=6)
    for orbit in portrait.periodic:
        marker, size = _MARKERS[orbit.elliptic]
        axes.plot(
            *orbit.points.T,
            linestyle="none",
            marker=marker,
            markersize=size,
            color=INK,
            markerfacecolor="white",
            zorder=6,
        )
    axes.set_xlim(-portrait.window, portrait.window)
    axes.set_ylim(-portrait.window, portrait.window)
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4))


def _legend(figure: Figure) -> None:
    def point(elliptic: bool, text: str) -> Line2D:
        marker, size = _MARKERS[elliptic]
        return Line2D(
            [], [], linestyle="none", marker=marker, markersize=size, color=INK, markerfacecolor="white", label=text
        )

    handles = [
        Line2D([], [], linestyle="none", marker="+", color=INK, label="fixed point"),
        point(True, "elliptic orbit of period $k$"),
        point(False, "hyperbolic orbit of period $k$"),
        Line2D([], [], color=_MANIFOLD, linewidth=0.9, label="its stable and unstable manifolds"),
        Line2D([], [], color="#777777", linewidth=0.8, linestyle=(0, (5, 3)), label="Fix($R$)"),
    ]
    height = figure.get_figheight()
    legend_row(figure, handles, 0.25, columnspacing=1.2)
    figure.text(0.5, 0.06 / height, "hollow: numerical only", ha="center", va="bottom", fontsize=7.5, color=INK)
