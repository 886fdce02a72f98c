"""Tori around elliptic orbits, and tubes of unstable ones: in space and on the section. Numerics, and labelled so."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.explore.three_body.invariants import ManifoldRecord, ToriRecord
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.space import bounds_of, mark_primaries, primary_handle, set_box, show_primaries
from orbitproof.figures.style import CURVE, INK, label_of
from orbitproof.shared.systems import CR3BP

_WIDTH = 7.2
_FLAT = 1e-6
"""Tori whose z and vz are smaller than this part of their amplitude lie in the plane."""

_NOTE = "double precision, nothing proved"


def draw_tori(record: ToriRecord) -> Figure:
    """The largest stored torus, all invariant curves in two planes, and the error of invariance of each.

    Tori that stay in the plane z = 0 are drawn there, and the rotation number over the amplitude in place of what they
    have none of.
    """
    flat = max(float(np.abs(row).max()) for torus in record.tori for row in (torus.curve.even[1], torus.curve.odd[1]))
    is_flat = flat < _FLAT * max(torus.curve.amplitude for torus in record.tori)
    figure = plt.figure(figsize=(_WIDTH, 6.4))
    grid = figure.add_gridspec(2, 2, left=0.1, right=0.975, top=0.9, bottom=0.15, wspace=0.3, hspace=0.42)
    surface = next(torus.surface for torus in reversed(record.tori) if torus.surface is not None)
    if is_flat:
        plane = figure.add_subplot(grid[0, 0])
        _in_plane(plane, record, surface)
        curves = [(grid[0, 1], (0, 2), "b", "invariant curves, $y=0$")]
    else:
        space: Any = figure.add_axes((0.02, 0.5, 0.44, 0.4), projection="3d", computed_zorder=False)
        _in_space(space, record, surface)
        curves = [
            (grid[0, 1], (0, 1), "b", "invariant curves, $y=0$"),
            (grid[1, 0], (1, 3), "c", "the same, across Fix($R$)"),
        ]
    for place, pair, letter, text in curves:
        _section(figure.add_subplot(place), record, pair, f"({letter})  {text}")
    sizes = [torus.curve.amplitude for torus in record.tori]
    if is_flat:
        turns = _against_amplitude(figure, grid[1, 0], sizes, [torus.curve.rotation for torus in record.tori])
        turns.set_ylabel(r"$\rho$  (radians)")
        turns.set_title("(c)  rotation number", color=INK)
        turns.ticklabel_format(axis="y", useOffset=True)
    errors = _against_amplitude(figure, grid[1, 1], sizes, [torus.curve.error for torus in record.tori])
    errors.set_yscale("log")
    errors.set_ylabel(r"error of $F(u(\theta))=u(\theta+\rho)$")
    errors.set_title("(d)  error of invariance", color=INK)
    title = "(a)  torus  (unit: distance of the primaries)"
    figure.text(0.1, 0.905, title, fontsize=8.5, color=INK)
    _head(figure, f"Tori around {record.title}, $C$ = {record.jacobi_constant:.8g}")
    legend_row(
        figure,
        [
            Line2D([], [], color=CURVE, label=f"numerical: {_NOTE}"),
            Line2D([], [], marker="o", markerfacecolor="white", color=INK, linestyle="none", label="periodic orbit"),
            primary_handle(),
        ],
        0.08,
    )
    return figure


def _in_space(space: Any, record: ToriRecord, surface: Array) -> None:
    for rows, colour, width in _mesh(surface):
        for line in rows:
            space.plot(*line.T, color=colour, linewidth=width)
    low, high = show_primaries(space, record.mass, *bounds_of([surface.reshape(-1, 3)]))
    set_box(space, CR3BP, low, high, zoom=0.92)


def _in_plane(axes: Axes, record: ToriRecord, surface: Array) -> None:
    for rows, colour, width in _mesh(surface):
        for line in rows:
            axes.plot(line[:, 0], line[:, 1], color=colour, linewidth=width)
    axes.set_aspect("equal", adjustable="datalim")
    mark_primaries(axes, record.mass, surface.reshape(-1, 3))
    axes.set_xlabel(label_of(CR3BP, "x", unit=False))
    axes.set_ylabel(label_of(CR3BP, "y", unit=False))


def _mesh(surface: Array) -> list[tuple[Array, str, float]]:
    """Lines on a torus both ways, with colour and width."""
    closed = np.concatenate([surface, surface[:1]])
    return [(closed[:-1:2], CURVE, 0.4), (np.swapaxes(closed, 0, 1)[::6], "#9db4c3", 0.5)]


def _section(axes: Axes, record: ToriRecord, pair: tuple[int, int], title: str) -> None:
    """All invariant curves in two coordinates of the section."""
    angles = np.linspace(0.0, 2 * np.pi, 400)
    for torus in record.tori:
        points = torus.curve.points(angles)
        axes.plot(*points[:, pair].T, color=CURVE, linewidth=0.8)
    centre = record.centre[[*pair]]
    axes.plot(*centre, marker="o", markerfacecolor="white", color=INK, linestyle="none", markersize=5)
    names = [CR3BP.state[index] for index in (0, 2, 3, 5)]
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel(label_of(CR3BP, names[pair[0]]))
    axes.set_ylabel(label_of(CR3BP, names[pair[1]]))
    axes.set_title(title, color=INK)


def _against_amplitude(figure: Figure, place: Any, sizes: Sequence[float], values: Sequence[float]) -> Axes:
    axes = figure.add_subplot(place)
    style: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "linestyle": "none", "markersize": 4}
    axes.plot(sizes, values, color=CURVE, **style)
    axes.set_xlabel("amplitude  (nondimensional)")
    axes.xaxis.set_major_locator(MaxNLocator(4))
    return axes


def draw_manifold(record: ManifoldRecord) -> Figure:
    """The tube in space, and its end on the section."""
    tube = record.manifold
    figure = plt.figure(figsize=(_WIDTH, 3.9))
    space: Any = figure.add_axes((0.02, 0.14, 0.5, 0.74), projection="3d", computed_zorder=False)
    colour = "#b2182b" if tube.kind == "unstable" else "#1b7837"
    for path in tube.paths:
        space.plot(*path.T, color=colour, linewidth=0.4)
    space.plot(*record.orbit.T, color=INK, linewidth=1.2)
    low, high = show_primaries(space, record.mass, *bounds_of([*tube.paths, record.orbit]))
    set_box(space, CR3BP, low, high, zoom=0.92)
    section = figure.add_axes((0.62, 0.24, 0.355, 0.6))
    first = next(index for index in (1, 2, 0) if index != tube.plane.index)
    ends = tube.ends[tube.reached]
    closed = np.concatenate([ends, ends[:1]]) if tube.reached.all() else ends
    section.plot(
        closed[:, first], closed[:, first + 3], color=colour, linewidth=0.7, marker="o", markersize=3,
        markerfacecolor="white",
    )  # fmt: skip
    section.set_xlabel(label_of(CR3BP, CR3BP.state[first]))
    section.set_ylabel(label_of(CR3BP, CR3BP.state[first + 3]))
    section.set_title(f"(b)  where it meets ${'xyz'[tube.plane.index]}$ = {tube.plane.value:.6g}", color=INK)
    figure.text(0.05, 0.895, "(a)  the tube  (unit: distance of the primaries)", fontsize=8.5, color=INK)
    _head(figure, f"{tube.kind.capitalize()} manifold of {record.title}, multiplier {tube.multiplier:.6g}")
    legend_row(
        figure,
        [
            Line2D([], [], color=colour, label=f"numerical: {_NOTE}"),
            Line2D([], [], color=INK, label="periodic orbit"),
            primary_handle(),
        ],
        0.08,
    )
    return figure


def _head(figure: Figure, text: str) -> None:
    figure.text(0.05, 0.965, text, color=INK, fontweight="bold", va="center", fontsize=8)
