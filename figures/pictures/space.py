"""Axes in three dimensions: equal scales, a quiet box, labels with units."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator

from orbitproof.figures.orbits import Array
from orbitproof.figures.style import INK, label_of
from orbitproof.shared.systems import ReversibleSystem

_MOST_TICKS = 4
_FLAT = 0.02
"""A box that is so flat has room for one tick."""
_CORNER = 0.03
"""No tick is closer to a corner than this part of the box's extent."""
_NEAR = 0.25
"""A primary is shown if it is at most this part of the box's extent outside the box."""


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
    # Its rectangle reaches over the labels of its neighbours.
    axes.patch.set_visible(False)
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
        getattr(axes, f"set_{letter}label")(label_of(system, name, unit=False), labelpad=9 if letter == "z" else 1)
        axis.set_major_locator(FixedLocator(_ticks(float(low[i]), float(high[i]), float(extent.max()))))
        axes.tick_params(axis=letter, pad=3 if letter == "z" else 0, labelsize=6.5)


def _ticks(low: float, high: float, size: float) -> list[float]:
    """Ticks from `low` to `high` in a box of that size, none so near a corner that labels of two axes meet there."""
    if high - low < _FLAT * size:
        return [(low + high) / 2]
    number = max(2, round(_MOST_TICKS * (high - low) / size))
    free = _CORNER * size
    while number < 20:
        ticks = [tick for tick in MaxNLocator(number).tick_values(low, high) if low + free <= tick <= high - free]
        if ticks:
            return [float(tick) for tick in ticks]
        number += 1
    return [(low + high) / 2]


_PRIMARY: dict[str, Any] = {
    "marker": "o", "color": "#666666", "markersize": 3.6, "linestyle": "none", "markeredgecolor": INK
}  # fmt: skip


def primary_handle() -> Line2D:
    """The legend entry of what `show_primaries` draws; their size is not to scale."""
    return Line2D([], [], label="primaries (not to scale)", **_PRIMARY)


def show_primaries(axes: Any, mass: float, low: Array, high: Array) -> tuple[Array, Array]:
    """Mark the primaries that are in the box from `low` to `high` or close to it; returns a box with them inside."""
    near = _NEAR * float((high - low).max())
    for x in (-mass, 1.0 - mass):
        place = np.array([x, 0.0, 0.0])
        if np.all(place >= low - near) and np.all(place <= high + near):
            axes.plot(*place[:, None], **_PRIMARY, zorder=5)
            low, high = np.minimum(low, place), np.maximum(high, place)
    return low, high


def mark_primaries(axes: Any, mass: float, rows: Array) -> None:
    """The primaries in the plane z = 0 of a flat axes, for what is drawn at `rows`, shape (N, 3); its limits stay."""
    low, high = rows[:, :2].min(axis=0), rows[:, :2].max(axis=0)
    near = _NEAR * float((high - low).max())
    for x in (-mass, 1.0 - mass):
        if np.all(np.array([x, 0.0]) >= low - near) and np.all(np.array([x, 0.0]) <= high + near):
            axes.plot(x, 0.0, **_PRIMARY, zorder=5)


def bounds_of(orbits: list[Array]) -> tuple[Array, Array]:
    """The smallest and largest x, y, z of orbits, each of shape (N, m)."""
    rows = np.vstack([orbit[:, :3] for orbit in orbits])
    return rows.min(axis=0), rows.max(axis=0)
