"""Axes in three dimensions: equal scales, a quiet box, labels with units."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.model import Array
from orbitproof.figures.style.style import label_of
from orbitproof.shared.systems import ReversibleSystem

_MOST_TICKS = 5


def set_box(
    axes: Any,
    system: ReversibleSystem,
    low: Array,
    high: Array,
    *,
    view: tuple[float, float] = (16, -40),
    ticks: bool = True,
    zoom: float = 1.0,
) -> None:
    """Limits of a 3D axes around the first three coordinates from `low` to `high`, with equal scales.

    `view` is the elevation and azimuth in degrees; without `ticks` only the box remains.
    """
    extent = high - low
    pad = 0.03 * extent.max()
    axes.set_box_aspect(extent + 2 * pad, zoom=zoom)
    axes.view_init(elev=view[0], azim=view[1])
    for i, name in enumerate(system.state[:3]):
        letter = "xyz"[i]
        getattr(axes, f"set_{letter}lim")(low[i] - pad, high[i] + pad)
        axis = getattr(axes, f"{letter}axis")
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.pane.set_edgecolor("#cccccc")
        axis._axinfo["grid"].update(color="#ececec", linewidth=0.4)
        if not ticks:
            axis.set_ticks([])
            continue
        getattr(axes, f"set_{letter}label")(label_of(name, unit=False), labelpad=-4)
        axis.set_major_locator(MaxNLocator(max(2, round(_MOST_TICKS * extent[i] / extent.max()))))
        axes.tick_params(axis=letter, pad=-2, labelsize=6.5)


def bounds_of(orbits: list[Array]) -> tuple[Array, Array]:
    """The smallest and largest x, y, z of orbits, each of shape (N, m)."""
    rows = np.vstack([orbit[:, :3] for orbit in orbits])
    return rows.min(axis=0), rows.max(axis=0)
