"""Pictures of orbits for scripts and notebooks, by matplotlib; all of it is numerical, and nothing is judged."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.three_body.seeds import primaries

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_INK, _GREY = "#1f4e79", "#888888"


def draw_orbits(
    title: str, states: Sequence[Matrix], names: Sequence[str], mass: float | None, length: float | None = None
) -> Figure:
    """Orbits in two projections; with a mass parameter the primaries that are near enough to be in the picture.

    Arguments:
        states: of each orbit, shape (N, m).
        names: of the coordinates.
        mass: `None` for other systems than the three-body problem in space.
        length: the distance of the primaries in km, if it is known; the axes are then in 1000 km.
    """
    size, unit = (1.0, "distance of the primaries") if length is None else (length / 1000, "1000 km")
    plt: Any = import_module("matplotlib.pyplot")
    flat = max(float(np.abs(each[:, 2]).max()) for each in states) == 0 if len(names) > 2 else True
    pairs = [(0, 1)] if flat else [(0, 1), (0, 2)]
    figure, panels = plt.subplots(1, len(pairs), figsize=(4.2 * len(pairs), 3.6), squeeze=False, layout="constrained")
    for axes, (first, second) in zip(panels[0], pairs, strict=True):
        for number, each in enumerate(states):
            shade = 0.25 + 0.75 * (number + 1) / len(states)
            axes.plot(size * each[:, first], size * each[:, second], color=_INK, alpha=shade, linewidth=1.0)
        for put, name in ((axes.set_xlabel, names[first]), (axes.set_ylabel, names[second])):
            put(name if mass is None else f"{name} ({unit})")
        if mass is not None:
            axes.set_aspect("equal", adjustable="datalim")
            _bodies(axes, states, (first, second), mass, size)
    figure.suptitle(f"{title} (numerical)", fontsize="medium")
    return figure  # type: ignore[no-any-return]


def _bodies(axes: Any, states: Sequence[Matrix], pair: tuple[int, int], mass: float, size: float) -> None:
    all_states = np.vstack(states)[:, :3]
    low, high = all_states.min(axis=0), all_states.max(axis=0)
    reach = float(np.max(high - low))
    for place, name in zip(primaries(mass), ("larger primary", "smaller primary"), strict=True):
        if np.all(place >= low - reach) and np.all(place <= high + reach):
            axes.plot(size * place[pair[0]], size * place[pair[1]], "o", color=_GREY, markersize=5, label=name)
            axes.legend(fontsize="small", frameon=False)


def draw_family(title: str, levels: Vector, level_name: str, periods: Vector, indices: Vector) -> Figure:
    """Period and stability index along a family, over its level or parameter."""
    plt: Any = import_module("matplotlib.pyplot")
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6), layout="constrained")
    left.plot(levels, periods, ".-", color=_INK, linewidth=1.0, markersize=3)
    right.semilogy(levels, indices, ".-", color=_INK, linewidth=1.0, markersize=3)
    for axes, name in ((left, "period"), (right, "stability index")):
        axes.set_xlabel(level_name)
        axes.set_ylabel(name)
    figure.suptitle(f"{title} (numerical)", fontsize="medium")
    return figure  # type: ignore[no-any-return]
