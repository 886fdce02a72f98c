"""Marks of bifurcations, lines of resonances, and insets around them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from orbitproof.explore.names import resonant_values
from orbitproof.figures.model import MarkedPoint
from orbitproof.figures.style import INK, marker_of


def draw_mark(axes: Axes, position: Sequence[float] | NDArray[np.float64], mark: MarkedPoint) -> Line2D:
    """Draw one bifurcation, in two or three dimensions: filled if certified, hollow if numerical."""
    return draw_point(axes, position, mark.k, mark.certified, mark.candidate.id, mark.candidate.kind)


def draw_point(
    axes: Axes,
    position: Sequence[float] | NDArray[np.float64],
    k: int,
    certified: bool,
    identifier: str,
    kind: str = "",
) -> Line2D:
    """The mark of a point of which multiplicity, verdict, id and perhaps the kind are known."""
    marker, colour = marker_of(k, kind)
    coordinates = [[value] for value in position]
    (line,) = axes.plot(
        *coordinates,
        marker=marker,
        linestyle="none",
        color=colour,
        markeredgecolor=colour,
        markerfacecolor=colour if certified else "white",
        markersize=marker_size(marker),
        clip_on=False,
        zorder=6,
        # A thin white rim, so that markers that touch can be told apart.
        path_effects=[withStroke(linewidth=1.9, foreground="white")],
    )
    line.set_gid(f"candidate {identifier}")
    return line


def marker_size(marker: str) -> float:
    """With which all shapes look equally large, in points."""
    return {"D": 4.9, "s": 5.2, "*": 8.0, "o": 5.4}.get(marker, 6.2)


def resonances(multiplicities: Sequence[int]) -> dict[int, tuple[float, ...]]:
    """Values of the stability parameter in 1:k resonance, by k."""
    return {k: resonant_values(k) for k in sorted(set(multiplicities))}


def draw_resonance(axes: Axes, k: int, value: float, named: bool = True) -> None:
    """The line of a resonant value across axes of stability parameters, named 1:k on their right."""
    axes.axhline(value, color=marker_of(k)[1], linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
    if named:
        where = {"xycoords": ("axes fraction", "data"), "xytext": (4, 0), "textcoords": "offset points"}
        axes.annotate(f"1:{k}", (1.0, value), va="center", fontsize=7, color=INK, **where)


def show_around(axes: Axes, inset: Axes, points: NDArray[np.float64], margin: float, ticks: tuple[int, int]) -> None:
    """Let an inset show the surroundings of points, shape (N, 2), and mark in `axes` what it shows.

    `margin` is a part of what the points span, `ticks` the largest numbers of intervals on the two axes.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    pad = margin * (high - low)
    inset.set_xlim(low[0] - pad[0], high[0] + pad[0])
    inset.set_ylim(low[1] - pad[1], high[1] + pad[1])
    inset.tick_params(labelsize=6, pad=1.5, length=2)
    for axis, number in zip((inset.xaxis, inset.yaxis), ticks, strict=True):
        axis.set_major_locator(MaxNLocator(number))
    for side in ("top", "right"):
        inset.spines[side].set_visible(True)
    axes.indicate_inset_zoom(inset, edgecolor="#888888", linewidth=0.6)
