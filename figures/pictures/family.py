"""The two pictures: a family on energy levels (halo orbits), and a family in a parameter (Falkner-Skan)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.model import MarkedPoint, Placement, SampledFamily
from orbitproof.figures.orbits import Array, OrbitNotClosed, state_on_fixed_set, symmetric_orbit
from orbitproof.figures.pictures.legends import bottom_margin, legend_below
from orbitproof.figures.pictures.marks import draw_mark, draw_resonance, resonances, show_around
from orbitproof.figures.pictures.space import bounds_of, primary_handle, set_box, show_primaries
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, level_label, marker_of, unit_of
from orbitproof.shared.systems import THREE_BODY

_ORBITS_SHOWN = 6
_SPATIAL = 6
"""From how many state coordinates on three of them are shown: position in space and its velocity."""
_WIDTH = 7.2
_STABILITY_SHOWN = 1.35
_LINE_STYLES = {2: "solid", 3: (0, (5, 2)), 4: (0, (1.5, 1.2))}


def draw_family(family: SampledFamily, marks: Sequence[MarkedPoint]) -> Figure:
    """The picture of a family with its marked points, one text width wide.

    Fix(R), the bifurcation parameter, the stability parameters with the resonances, and orbits. The
    layout depends on whether energy (first integral) or a parameter varies along the family.
    """
    placements = [family.place(mark) for mark in marks]
    if family.system.family_parameter is None:
        return _energy_figure(family, placements)
    return _parameter_figure(family, placements)


def _energy_figure(family: SampledFamily, placements: Sequence[Placement]) -> Figure:
    figure = plt.figure(figsize=(_WIDTH, 6.0))
    three_body = family.system in THREE_BODY
    curves = (*_CURVES, primary_handle()) if three_body else _CURVES
    bottom = _bottom(figure, placements, curves)
    grid = figure.add_gridspec(2, 2, left=0.085, right=0.945, top=0.955, bottom=bottom, wspace=0.26, hspace=0.3)
    fixed, level = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    stability = figure.add_subplot(grid[1, 1], sharex=level)
    _fixed_plane(fixed, family, placements)
    if len(family.system.state) < _SPATIAL or _is_planar(family):
        _family_in_plane(figure.add_subplot(grid[1, 0]), family, placements)
    else:
        # A 3D axes draws its box well inside its rectangle, so the rectangle reaches beyond the grid cell.
        place = (0.02, bottom - 0.02, 0.44, 0.4)
        _orbits_in_space(figure.add_axes(place, projection="3d", computed_zorder=False), family, placements)
    level.plot(family.arclength, family.levels, color=CURVE)
    for placement in placements:
        draw_mark(level, (placement.arclength, placement.mark.level), placement.mark)
    level.set_ylabel(level_label(family.system))
    _stability_curves(stability, family, placements, family.arclength)
    stability.set_xlabel(f"arclength along the family{unit_of(family.system)}")
    level.tick_params(labelbottom=False)
    _title(fixed, "a", "where the orbits meet Fix($R$)")
    _title(level, "b", family.system.first_integral_name or "first integral")
    _title(stability, "d", "stability parameters and resonances")
    size = float(stability.title.get_fontsize())
    top = stability.get_position().y1 + size * 0.6 / (72 * figure.get_figheight())
    unit = "  (unit: distance of the primaries)" if three_body else unit_of(family.system)
    side = "" if family.branch is None else f"{family.branch}ern "
    figure.text(0.085, top, f"(c)  {side}orbits{unit}", fontsize=size, color=INK)
    _legend(figure, placements, curves)
    return figure


def _parameter_figure(family: SampledFamily, placements: Sequence[Placement]) -> Figure:
    figure = plt.figure(figsize=(_WIDTH, 3.1))
    grid = figure.add_gridspec(
        2, 3, left=0.105, right=0.985, top=0.91, bottom=_bottom(figure, placements), wspace=0.5, hspace=0.12
    )
    first = figure.add_subplot(grid[0, 0])
    second = figure.add_subplot(grid[1, 0], sharex=first)
    stability, orbits = figure.add_subplot(grid[:, 1]), figure.add_subplot(grid[:, 2])
    # The two crossings differ by orders of magnitude in how much they move: one scale would show one of them flat.
    _fixed_line(first, family, placements, second=False)
    _fixed_line(second, family, placements, second=True)
    first.tick_params(labelbottom=False)
    second.set_xlabel(level_label(family.system))
    _stability_curves(stability, family, placements, family.levels)
    bounded = family.levels[(np.abs(family.stability) < _STABILITY_SHOWN).any(axis=1)]
    parameter_scale(stability, bounded if bounded.size > 1 else family.levels)
    stability.set_xlabel(level_label(family.system))
    _orbits_in_plane(orbits, family, placements)
    _title(first, "a", "crossings of Fix($R$)")
    _title(stability, "b", "stability parameter")
    _title(orbits, "c", "marked orbits")
    figure.align_ylabels([first, second])
    _legend(figure, placements)
    return figure


def draw_marks(marks: Sequence[MarkedPoint]) -> Figure:
    """Marked points of one system without a traced family: Fix(R) and the bifurcation parameter."""
    system = marks[0].candidate.system
    names = system.centre_coordinates
    figure = plt.figure(figsize=(_WIDTH, 3.2))
    placements = [Placement(mark, False, 0.0, 0.0) for mark in marks]
    bottom = _bottom(figure, placements)
    grid = figure.add_gridspec(1, 2, left=0.115, right=0.965, top=0.91, bottom=bottom, wspace=0.3)
    fixed, level = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    for mark in marks:
        draw_mark(fixed, mark.point[:2], mark)
        draw_mark(level, (mark.point[1], mark.level), mark)
    for axes, x, y in (
        (fixed, label_of(system, names[0]), label_of(system, names[1])),
        (level, label_of(system, names[1]), level_label(system)),
    ):
        axes.margins(0.08)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.set_xlabel(x)
        axes.set_ylabel(y)
    _title(fixed, "a", "marked points on Fix($R$)")
    integral = system.first_integral_name or "first integral"
    _title(level, "b", integral if system.family_parameter is None else "family parameter")
    _legend(figure, placements)
    return figure


def _title(axes: Axes, letter: str, text: str) -> None:
    axes.set_title(f"({letter})  {text}", color=INK)


def _legend(figure: Figure, placements: Sequence[Placement], curves: Sequence[Line2D] = ()) -> None:
    legend_below(figure, *_claims(placements), curves)


def _bottom(figure: Figure, placements: Sequence[Placement], curves: Sequence[Line2D] = ()) -> float:
    return bottom_margin(figure.get_figheight(), *_claims(placements), curves)


def _claims(placements: Sequence[Placement]) -> tuple[set[tuple[int, str]], list[bool]]:
    return {(p.mark.k, p.mark.candidate.kind) for p in placements}, [p.mark.certified for p in placements]


def _columns(family: SampledFamily) -> list[int]:
    """Which two coordinates on Fix(R) are shown: the first, and the next one that is not 0 along the family."""
    points = np.concatenate([family.points, family.second_points])
    varying = [column for column in range(1, points.shape[1]) if np.abs(points[:, column]).max() > _FLAT]
    return [0, *varying, 1][:2]


def _is_planar(family: SampledFamily) -> bool:
    """Whether z is 0 along the family, where it is a coordinate on Fix(R)."""
    names = family.system.centre_coordinates
    return "z" in names and names.index("z") not in _columns(family)


_FLAT = 1e-9


def _fixed_plane(axes: Axes, family: SampledFamily, placements: Sequence[Placement]) -> None:
    columns = _columns(family)
    names = [family.system.centre_coordinates[column] for column in columns]
    axes.plot(*family.second_points[:, columns].T, color=SECOND_CURVE)
    axes.plot(*family.points[:, columns].T, color=CURVE)
    for placement in placements:
        draw_mark(axes, placement.mark.point[columns], placement.mark)
    axes.margins(0.07)
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.set_xlabel(label_of(family.system, names[0]))
    axes.set_ylabel(label_of(family.system, names[1]))
    _magnify(axes, family, placements)


def _magnify(axes: Axes, family: SampledFamily, placements: Sequence[Placement]) -> None:
    """Insets around the points that hide one another most, in the emptiest places of the axes."""
    if not placements:
        return
    columns = _columns(family)
    lines = [family.second_points[:, columns], family.points[:, columns]]
    curves = np.concatenate(lines)
    places = np.array([placement.mark.point[columns] for placement in placements])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    size = np.array([right - left, high - low])
    origin = np.array([left, low])
    # Where all marks are the same point, magnifying shows no more.
    hidden = [members for members in crowds(places / size) if np.ptp(places[members], axis=0).any()]
    hidden.sort(key=lambda members: float(np.ptp(places[members] / size, axis=0).max()))
    taken = (np.concatenate([curves, np.repeat(places, 40, axis=0)]) - origin) / size
    for members in hidden[:_INSETS]:
        centre = (places[members].mean(axis=0) - origin) / size
        corner, _ = free_corner(axes, taken, _INSET, centre)
        inset = axes.inset_axes((*corner, *_INSET))
        taken = np.concatenate([taken, covered_by(axes, corner, _INSET)])
        for line, colour in zip(lines, (SECOND_CURVE, CURVE), strict=True):
            inset.plot(*line.T, color=colour)
        for index in members:
            draw_mark(inset, places[index], placements[index].mark)
        show_around(axes, inset, _with_extent(places[members], size), margin=0.35, ticks=(1, 2))
        low_x, high_x = inset.get_xlim()
        # Labels this small stand beside one another only where every second one is left out.
        inset.set_xticks([tick for tick in inset.get_xticks() if low_x <= tick <= high_x][::2])


_INSET = np.array([0.25, 0.24])
_INSETS = 2
_GRID = np.stack(np.meshgrid(np.linspace(0, 1, 40), np.linspace(0, 1, 40)), axis=-1).reshape(-1, 2)
_HIDDEN = 0.03
"""Markers closer than this part of the axes hide one another."""


def crowds(places: Array) -> list[list[int]]:
    """Groups of points that hang together by distances below `_HIDDEN`, places in parts of the axes."""
    groups: list[list[int]] = []
    for index in range(len(places)):
        near = [group for group in groups if np.linalg.norm(places[group] - places[index], axis=1).min() < _HIDDEN]
        groups = [group for group in groups if group not in near] + [[*chain(*near), index]]
    return groups


def free_corner(axes: Axes, taken: Array, size: Array, near: Array) -> tuple[Array, int]:
    """The lower left corner of an inset that hides the fewest points, then is nearest to a place; and how many it does.

    All in parts of the axes: the points to be seen, shape (N, 2), the inset's size, the place, the corner.
    """
    labels, rim = _label_room(axes), np.array([0.02, 0.03])
    corners = [
        np.array([x, y])
        for x in np.linspace(labels[0], 0.98 - size[0], 20)
        for y in np.linspace(labels[1], 0.98 - size[1], 18)
    ]

    def hidden(corner: Array) -> int:
        inside = (taken > corner - labels) & (taken < corner + size + rim)
        return int(np.count_nonzero(np.all(inside, axis=1)))

    best = min(corners, key=lambda corner: (hidden(corner), float(np.linalg.norm(corner + 0.5 * size - near))))
    return best, hidden(best)


def covered_by(axes: Axes, corner: Array, size: Array) -> Array:
    """Places all over an inset and its tick labels, in parts of the axes, shape (N, 2)."""
    labels = _label_room(axes)
    return corner - labels + _GRID * (size + labels)


def _label_room(axes: Axes) -> Array:
    """Width and height of an inset's tick labels, in parts of the axes."""
    inches = axes.get_figure().get_size_inches() * axes.get_position().size
    return np.array([0.36, 0.2]) / inches


def _with_extent(points: Array, size: Array) -> Array:
    """The points, and two more where they span next to nothing in one direction."""
    extent = np.ptp(points, axis=0)
    half = 0.5 * np.maximum(extent, 0.4 * float((extent / size).max()) * size)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return np.vstack([points, middle - half, middle + half])


def _fixed_line(axes: Axes, family: SampledFamily, placements: Sequence[Placement], second: bool) -> None:
    curve = family.second_points if second else family.points
    axes.plot(family.levels, curve[:, 1], color=SECOND_CURVE if second else CURVE)
    for placement in placements:
        if placement.second == second:
            draw_mark(axes, placement.mark.point[:2], placement.mark)
    parameter_scale(axes, family.levels)
    axes.margins(y=0.15)
    axes.set_ylabel(label_of(family.system, family.system.centre_coordinates[1], unit=False))
    axes.annotate(
        "half a period later" if second else "starting point",
        (0.96, 0.9 if second else 0.08),
        xycoords="axes fraction",
        ha="right",
        va="top" if second else "bottom",
        fontsize=7,
        color=INK,
    )


def parameter_scale(axes: Axes, values: Array) -> None:
    """A horizontal axis for values of a parameter: logarithmic where they are positive and far apart."""
    low, high = float(values.min()), float(values.max())
    if low > 0 and high > 20 * low:
        axes.set_xscale("log")
        axes.set_xlim(low / 1.3, high * 1.3)
    else:
        axes.set_xlim(low - 0.06 * (high - low), high + 0.06 * (high - low))
        axes.xaxis.set_major_locator(MaxNLocator(4))


_CURVES = (
    Line2D([], [], color=CURVE, label="starting point"),
    Line2D([], [], color=SECOND_CURVE, label="half a period later"),
    Line2D([], [], color=SECOND_CURVE, linestyle="dotted", label="real part of a complex pair"),
)


def _stability_curves(axes: Axes, family: SampledFamily, placements: Sequence[Placement], abscissa: Array) -> None:
    for column in family.complex_stability.T:
        axes.plot(abscissa, column, color=SECOND_CURVE, linestyle="dotted")
    for column in family.stability.T:
        axes.plot(abscissa, column, color=CURVE)
    axes.set_ylim(-_STABILITY_SHOWN, _STABILITY_SHOWN)
    levels = resonances([p.mark.k for p in placements if not p.mark.candidate.is_of_orbit] or [1, 2, 3, 4])
    for k, values in levels.items():
        for value in values:
            draw_resonance(axes, k, value)
    for placement in placements:
        found = family.stability_at(placement.arclength)
        x = float(np.interp(placement.arclength, family.arclength, abscissa))
        if placement.mark.candidate.is_of_orbit:
            for value in found[np.abs(found) < _STABILITY_SHOWN]:
                draw_mark(axes, (x, value), placement.mark)
            continue
        miss = [float(np.nanmin(np.abs(found - value), initial=np.inf)) for value in levels[placement.mark.k]]
        value = levels[placement.mark.k][int(np.argmin(miss))]
        draw_mark(axes, (x, value), placement.mark)
    axes.set_ylabel(r"$(\lambda+1/\lambda)/2$")


def _orbits_in_space(axes: Any, family: SampledFamily, placements: Sequence[Placement]) -> None:
    drawn = _orbits_shown(axes, family, placements, 3)
    for placement in placements:
        draw_mark(
            axes, state_on_fixed_set(family.system, family.parameters, list(placement.mark.point))[:3], placement.mark
        )
    low, high = bounds_of(drawn or [np.zeros((1, 3))])
    if family.system in THREE_BODY:
        low, high = show_primaries(axes, float(family.parameters["mu"]), low, high)
    set_box(axes, family.system, low, high, zoom=0.92)


def _family_in_plane(axes: Axes, family: SampledFamily, placements: Sequence[Placement]) -> None:
    _orbits_shown(axes, family, placements, 2)
    for placement in placements:
        draw_mark(
            axes, state_on_fixed_set(family.system, family.parameters, list(placement.mark.point))[:2], placement.mark
        )
    axes.set_xlabel(label_of(family.system, family.system.state[0]))
    axes.set_ylabel(label_of(family.system, family.system.state[1]))


def _orbits_shown(axes: Any, family: SampledFamily, placements: Sequence[Placement], dimension: int) -> list[Array]:
    """Draw some orbits of the family and the resonant ones; returns their points."""
    stops = np.linspace(family.arclength[0], family.arclength[-1], _ORBITS_SHOWN)
    shown = [family.points[int(np.argmin(np.abs(family.arclength - stop)))] for stop in stops]
    drawn = [_orbit(axes, family, point, dimension, color="#9db4c3", linewidth=0.8) for point in shown]
    for placement in placements:
        k = placement.mark.k
        if k > 1:
            style = {"color": marker_of(k)[1], "linestyle": _LINE_STYLES.get(k, "dashdot"), "linewidth": 1.2}
            drawn.append(_orbit(axes, family, placement.mark.point, dimension, **style))
    return [orbit for orbit in drawn if orbit is not None]


def _orbits_in_plane(axes: Axes, family: SampledFamily, placements: Sequence[Placement]) -> None:
    for placement in placements:
        k = placement.mark.k
        style = {"color": marker_of(k)[1], "linestyle": _LINE_STYLES.get(k, "dashdot"), "linewidth": 1.2}
        _orbit(axes, family, placement.mark.point, 2, **style)
    axes.set_xlabel(label_of(family.system, family.system.state[0]))
    axes.set_ylabel(label_of(family.system, family.system.state[1]))


def _orbit(axes: Any, family: SampledFamily, point: Array, dimension: int, **style: Any) -> Array | None:
    try:
        rows = symmetric_orbit(family.system, family.parameters, list(point))
    except OrbitNotClosed:
        return None
    axes.plot(*rows[:, :dimension].T, **style)
    return rows[:, :dimension]
