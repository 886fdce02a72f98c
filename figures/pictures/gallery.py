"""A gallery of the orbits of a family: a grid of orbits in space, each with its Jacobi constant and period."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orbitproof.figures.model import SampledFamily
from orbitproof.figures.orbits import Array, symmetric_orbits
from orbitproof.figures.pictures.halo_plane import family_title, mass_title
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.space import bounds_of, set_box
from orbitproof.figures.style import CURVE, INK

_WIDTH = 7.2
_COLUMNS, _ROWS = 4, 3
_SHADOW = "#b9c4cb"


def draw_gallery(family: SampledFamily) -> Figure:
    """Orbits spread evenly over the family, from its first to its last, each in a box with equal scales."""
    indices = _evenly(family, _COLUMNS * _ROWS)
    orbits = symmetric_orbits(family.system, family.parameters, family.points[indices], 0.5 * family.periods[indices])
    bottom, cell, picture = 0.5, 2.15, 1.62
    height = _ROWS * cell + 0.3 + bottom
    figure = plt.figure(figsize=(_WIDTH, height))
    figure.text(
        0.012, 1 - 0.2 / height, f"{mass_title(family)}: {family_title(family)}", fontsize=8.5, color=INK, va="bottom"
    )
    for number, (index, orbit) in enumerate(zip(indices, orbits, strict=True)):
        row, column = divmod(number, _COLUMNS)
        left, base = column / _COLUMNS, (bottom + (_ROWS - 1 - row) * cell) / height
        axes = figure.add_axes((left, base, 1 / _COLUMNS, picture / height), projection="3d", computed_zorder=False)
        _draw(axes, family, orbit)
        size = " × ".join(f"{extent:.3g}" for extent in np.ptp(orbit[:, :3], axis=0))
        figure.text(
            left + 0.5 / _COLUMNS,
            base + (picture + 0.01) / height,
            f"$C={family.levels[index]:.5f}$\n$T={family.periods[index]:.5f}$\n{size}",
            fontsize=7,
            ha="center",
            va="bottom",
            color=INK,
            linespacing=1.2,
        )
    handles = [
        Line2D([], [], color=CURVE, linewidth=1.0, label="orbit"),
        Line2D([], [], color=_SHADOW, linewidth=0.8, label="its shadow on the floor"),
        Line2D([], [], linestyle="none", marker="x", color=INK, markersize=3, label="smaller primary"),
    ]
    legend_row(figure, handles, 0.25)
    text = (
        f"$C$ {family.system.first_integral_name}, $T$ period, third line: extent in $x$, $y$, $z$; nondimensional. "
        "Arrow on the floor: direction of $x$."
    )
    figure.text(0.5, 0.07 / height, text, ha="center", va="bottom", fontsize=7, color=INK)
    return figure


def _draw(axes: Any, family: SampledFamily, orbit: Array) -> None:
    primary = 1.0 - float(family.parameters["mu"])
    low, high = bounds_of([orbit, np.array([[primary, 0.0, 0.0]])])
    # A flat box would otherwise be drawn larger, beyond the picture.
    zoom = 1.22 * float(np.linalg.norm(high - low) / (np.sqrt(3.0) * (high - low).max()))
    set_box(axes, family.system, low, high, view=(20, -58), ticks=False, zoom=zoom)
    axes.set_axis_off()
    floor = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]), (low[0], low[1])]
    axes.plot(*np.array(floor).T, low[2], color="#dddddd", linewidth=0.6)
    axes.quiver(
        low[0],
        low[1],
        low[2],
        0.25 * (high[0] - low[0]),
        0.0,
        0.0,
        color="#888888",
        linewidth=0.8,
        arrow_length_ratio=0.35,
    )
    axes.plot(orbit[:, 0], orbit[:, 1], np.full(len(orbit), low[2]), color=_SHADOW, linewidth=0.6)
    axes.plot(*orbit[:, :3].T, color=CURVE, linewidth=1.0)
    axes.plot([primary], [0.0], [0.0], linestyle="none", marker="x", color=INK, markersize=3)


def _evenly(family: SampledFamily, count: int) -> Array:
    """Indices of `count` orbits, evenly spaced by how far both points on Fix(R) and the period move."""
    columns = np.hstack([family.points[:, :2], family.second_points[:, :2], 0.3 * family.periods[:, None]])
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(columns, axis=0), axis=1)))
    return np.searchsorted(length, np.linspace(0.0, length[-1], count)).clip(0, len(length) - 1)
