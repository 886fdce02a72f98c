"""Lyapunov and halo orbits in space, and the torus that a closed family of halo orbits sweeps out."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orbitproof.figures.model import SampledFamily
from orbitproof.figures.orbits import Array, symmetric_orbits
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.space import bounds_of, set_box
from orbitproof.figures.style import CURVE, INK

_WIDTH = 7.2
_HALO = "#b2182b"
_LYAPUNOV_SHOWN = 14
_HALOS_SHOWN = 12
_TORUS_ORBITS = 90
_UNITS = "$x$, $y$, $z$ nondimensional (unit: distance of the primaries)"


def draw_bifurcation(lyapunov: SampledFamily, halo: SampledFamily) -> Figure:
    """Planar Lyapunov orbits (left) and the halo orbits that branch off from one of them (right).

    The halo family begins at that orbit. Shown are orbits up to three times as wide, and halo orbits, with
    their mirror images, about as tall as the Lyapunov orbits are wide.
    """
    birth = halo.points[0]
    at_birth = int(np.argmin(np.linalg.norm(lyapunov.points - birth, axis=1)))
    last = int(np.searchsorted(lyapunov.arclength, 3.0 * lyapunov.arclength[at_birth]))
    planar = _orbits(lyapunov, _spread(lyapunov, 0, min(last, len(lyapunov.points) - 1), _LYAPUNOV_SHOWN))
    (first,) = _orbits(halo, np.array([0]))
    width = float(np.ptp(np.vstack(planar)[:, 1]))
    top = int(np.argmax(np.abs(halo.points[:, 1]) > 0.35 * width)) or len(halo.points) - 1
    halos = _orbits(halo, _spread(halo, 0, top, _HALOS_SHOWN)[1:])
    mirror = np.array(halo.system.symmetries["S"], dtype=float)
    low, high = bounds_of([*planar, *halos, *(orbit * mirror for orbit in halos)])

    figure = plt.figure(figsize=(_WIDTH, 3.9))
    left = figure.add_axes((-0.02, 0.22, 0.52, 0.77), projection="3d", computed_zorder=False)
    right = figure.add_axes((0.48, 0.22, 0.52, 0.77), projection="3d", computed_zorder=False)
    for orbit in planar:
        left.plot(*orbit[:, :3].T, color=CURVE, linewidth=0.8)
    for orbit in halos:
        right.plot(*orbit[:, :3].T, color=_HALO, linewidth=0.8)
        right.plot(*(orbit * mirror)[:, :3].T, color="#e0a3a0", linewidth=0.8)
    for axes in (left, right):
        axes.plot(*first[:, :3].T, color=INK, linewidth=1.6)
        _primary(axes, halo)
        set_box(axes, halo.system, low, high, view=(22, -55), zoom=1.0)
    figure.text(0.02, 0.95, "(a)  planar Lyapunov orbits", fontsize=8.5, color=INK)
    figure.text(0.52, 0.95, "(b)  halo orbits", fontsize=8.5, color=INK)
    handles = [
        Line2D([], [], color=CURVE, linewidth=0.8, label="Lyapunov orbits"),
        Line2D([], [], color=INK, linewidth=1.6, label="where halo orbits branch off"),
        Line2D([], [], color=_HALO, linewidth=0.8, label="halo orbits"),
        Line2D([], [], color="#e0a3a0", linewidth=0.8, label="their images under $S$"),
        Line2D([], [], linestyle="none", marker="x", color=INK, markersize=4, label="smaller primary"),
    ]
    _legend(figure, handles, _UNITS)
    return figure


def draw_torus(halo: SampledFamily) -> Figure:
    """The surface that a closed halo family and its mirror image sweep out, in space; colour is z on Fix(R)."""
    mirror = np.array(halo.system.symmetries["S"], dtype=float)
    orbits = _orbits(halo, _even(halo, _TORUS_ORBITS))
    heights = np.array([orbit[0, 2] for orbit in orbits])
    figure = plt.figure(figsize=(_WIDTH, 4.9))
    axes = figure.add_axes((-0.02, 0.03, 0.9, 0.99), projection="3d", computed_zorder=True)
    norm, colours = Normalize(-heights.max(), heights.max()), colormaps["viridis"]
    for sign in (1, -1):
        for orbit, height in zip(orbits, heights, strict=True):
            rows = orbit if sign == 1 else orbit * mirror
            axes.plot(*rows[:, :3].T, color=colours(norm(sign * height)), linewidth=0.55, alpha=0.9)
    _primary(axes, halo)
    low, high = bounds_of([*orbits, *(orbit * mirror for orbit in orbits)])
    set_box(axes, halo.system, low, high, view=(18, -62), zoom=1.12)
    bar = figure.add_axes((0.88, 0.27, 0.018, 0.56))
    figure.colorbar(ScalarMappable(norm, colours), cax=bar)
    bar.set_ylabel("$z$ on Fix($R$)  (nondimensional)")
    handle = Line2D([], [], linestyle="none", marker="x", color=INK, markersize=4, label="smaller primary")
    figure.legend(handles=[handle], loc="lower right", bbox_to_anchor=(0.99, 0.08))
    figure.text(0.985, 0.04, _UNITS, ha="right", va="bottom", fontsize=7, color=INK)
    return figure


def _orbits(family: SampledFamily, indices: Array) -> list[Array]:
    return symmetric_orbits(family.system, family.parameters, family.points[indices], 0.5 * family.periods[indices])


def _spread(family: SampledFamily, first: int, last: int, count: int) -> Array:
    """Indices of about `count` orbits, evenly spaced in arclength from `first` to `last`."""
    stops = np.linspace(family.arclength[first], family.arclength[last], count)
    return np.unique(np.clip(np.searchsorted(family.arclength, stops), first, last))


def _even(family: SampledFamily, count: int) -> Array:
    """Indices of about `count` orbits, evenly spaced where both of their points on Fix(R) lie in the (x, z) plane."""
    moved = np.abs(np.diff(family.points[:, :2], axis=0)).sum(axis=1)
    moved += np.abs(np.diff(family.second_points[:, :2], axis=0)).sum(axis=1)
    length = np.append(0.0, np.cumsum(moved))
    return np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], count)).clip(0, len(length) - 1))


def _primary(axes: Any, family: SampledFamily) -> None:
    axes.plot(
        [1.0 - float(family.parameters["mu"])], [0.0], [0.0], linestyle="none", marker="x", color=INK, markersize=4
    )


def _legend(figure: Figure, handles: list[Line2D], text: str) -> None:
    height = figure.get_figheight()
    legend_row(figure, handles, 0.25, columnspacing=1.2)
    figure.text(0.5, 0.07 / height, text, ha="center", va="bottom", fontsize=7, color=INK)
