"""The two pictures of proved branches: the atlas along the curve, and the curve itself on Fix(R)."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.certified import Curve, Stretch, heading_of
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.family import covered_by, crowds, free_corner
from orbitproof.figures.pictures.legends import legend_below, legend_height, legend_row
from orbitproof.figures.pictures.marks import draw_point, show_around
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, unit_of
from orbitproof.verify.poincare import PHYSICAL

_WIDTH = 7.2
_REGULARISED = "#d8b070"
_UNPROVED = "#b2182b"
_LIGHT = "#9dbdd3"
_MANY = 100.0
"""A parameter that grows by more than this factor has a logarithmic axis."""
_CHARACTERS = 90
"""That fit into a line of a picture."""


def draw_pieces(curve: Curve) -> Figure:
    """The pieces along the curve: their widths and coordinates, the tube and how much of it the proof needs."""
    figure = plt.figure(figsize=(_WIDTH, 4.6))
    claims = [(mark.k, mark.kind) for mark in curve.marks]
    foot = (0.62 + legend_height(claims, [True] * bool(claims))) / figure.get_figheight()
    grid = figure.add_gridspec(2, 1, left=0.1, right=0.97, top=0.9, bottom=foot, hspace=0.24, height_ratios=(1.5, 1.0))
    widths = figure.add_subplot(grid[0, 0])
    tubes = figure.add_subplot(grid[1, 0], sharex=widths)
    axis = Along(curve)
    for stretch in curve.stretches:
        height = axis.half_width(stretch)
        _bar(widths, axis.ends(stretch), height, stretch)
        for start, _ in stretch.intervals[1:]:
            if stretch.is_proved and stretch.s[0] < start < stretch.s[-1]:
                widths.plot([axis.at(stretch, start)] * 2, [0.0, height], color="white", linewidth=0.8)
        ends = axis.ends(stretch)
        tubes.plot(ends, [stretch.tube] * 2, color=INK)
        if stretch.deviation:
            tubes.plot(ends, [stretch.deviation] * 2, color=CURVE)
    heights = {stretch.piece: axis.half_width(stretch) for stretch in curve.stretches}
    for mark in curve.marks:
        stretch = next(stretch for stretch in curve.stretches if stretch.piece == mark.piece)
        draw_point(widths, (axis.at(stretch, mark.s), heights[mark.piece]), mark.k, True, mark.id, mark.kind)
    for axes in (widths, tubes):
        axes.set_yscale("log")
        axes.grid(visible=False, axis="x")
    if axis.is_logarithmic:
        widths.set_xscale("log")
    widths.margins(x=0.015)
    lowest = min(heights.values())
    widths.set_ylim(lowest / 3, max(heights.values()) * 2.5)
    widths.set_ylabel("half-width of the piece")
    tubes.set_ylabel("across the curve")
    tubes.set_xlabel(axis.label)
    widths.tick_params(labelbottom=False)
    proved = sum(stretch.is_proved for stretch in curve.stretches)
    number = sum(len(_own(stretch)) for stretch in curve.stretches)
    many = f" ({number} intervals)" if number > proved else ""
    count = f"{proved} of {len(curve.stretches)} pieces proved{many}"
    figure.text(0.1, 0.965, _lines(heading_of(curve.atlas), 1), color=INK, fontweight="bold", va="center")
    widths.set_title(f"(a)  {count}", color=INK)
    tubes.set_title("(b)  the tube, and the proved distance from the polynomial", color=INK)
    handles: list[Any] = [*_coordinate_handles(curve.stretches), *_tube_handles(curve.stretches)]
    _legend(figure, handles, claims)
    return figure


def draw_curves(curves: Sequence[Curve]) -> Figure:
    """The curves on Fix(R) from their polynomials, piece after piece in two shades, with the certified points."""
    figure = plt.figure(figsize=(_WIDTH, 4.6 if len(curves) > 1 else 5.2))
    claims = sorted({(mark.k, mark.kind) for curve in curves for mark in curve.marks})
    foot = (0.62 + legend_height(claims, [True] * bool(claims))) / figure.get_figheight()
    grid = figure.add_gridspec(1, len(curves), left=0.09, right=0.985, top=0.92, bottom=foot, wspace=0.2)
    handles: dict[str, Line2D] = {}
    for number, curve in enumerate(curves):
        axes = figure.add_subplot(grid[0, number])
        handles |= _draw_curve(axes, curve)
        letter = f"({'abcdefgh'[number % 8]})  " if len(curves) > 1 else ""
        axes.set_title(letter + _lines(heading_of(curve.atlas), len(curves)), color=INK)
    _legend(figure, list(handles.values()), claims)
    return figure


def _draw_curve(axes: Axes, curve: Curve) -> dict[str, Line2D]:
    """One panel; returns the legend's handles by label."""
    names = curve.coordinates
    axis = Along(curve)
    handles = {}
    for number, stretch in enumerate(curve.stretches):
        colour = (CURVE, _LIGHT)[number % 2] if stretch.is_proved else _UNPROVED
        label = "proved, piece after piece" if stretch.is_proved else "not proved"
        (line,) = axes.plot(stretch.points[:, 0], stretch.points[:, 1], color=colour, linewidth=1.6, label=label)
        handles.setdefault(label, line)
        if curve.signs is not None and (curve.signs < 0).any():
            image = stretch.points * curve.signs
            style: Any = (0, (4, 1.5))
            (line,) = axes.plot(image[:, 0], image[:, 1], color=colour, linewidth=1.2, linestyle=style)
            line.set_label(f"image under ${curve.atlas.claim.symmetry}$")
            handles.setdefault(str(line.get_label()), line)
    for mark in curve.marks:
        draw_point(axes, curve.place_of(mark)[1][:2], mark.k, True, mark.id, mark.kind)
    if curve.atlas.is_of_symmetric_orbits and names[:2] == ("x", "z"):
        handles |= _draw_primaries(axes, curve)
        axes.axhline(0.0, color=SECOND_CURVE, linewidth=0.6, zorder=1)
        axes.set_aspect("equal", adjustable="datalim")
        axes.apply_aspect()
    if curve.atlas.claim.is_closed and curve.atlas.claim.is_of_symmetric_curve:
        _magnify(axes, curve)
    if axis.is_logarithmic:
        axes.set_xscale("log")
    axes.set_xlabel(label_of(curve.system, names[0]))
    if axes.get_xscale() == "linear":
        axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.set_ylabel(label_of(curve.system, names[1]))
    return handles


def _magnify(axes: Axes, curve: Curve) -> None:
    """Insets around the longest run of marks that are close together, and around those that it still hides."""
    places = np.array([curve.place_of(mark)[1][:2] for mark in curve.marks]).reshape(-1, 2)
    extent = np.ptp(np.concatenate([stretch.points[:, :2] for stretch in curve.stretches]), axis=0)
    runs: list[list[int]] = []
    for number in range(len(places)):
        far = number == 0 or np.linalg.norm((places[number] - places[number - 1]) / extent) > _CLOSE
        runs = [*runs, [number]] if far else [*runs[:-1], [*runs[-1], number]]
    crowd = max(runs, key=len, default=[])
    if len(crowd) < _CROWD:
        return
    drawn = np.concatenate([line.get_xydata() for line in axes.get_lines() if line.get_transform() == axes.transData])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    taken = (drawn - (left, low)) / (right - left, high - low)
    hides = _inset(axes, curve, places, crowd, taken)
    # Marks that still hide one another there get an inset of their own.
    groups = crowds(places[crowd] / np.ptp(places[crowd], axis=0))
    hidden = [crowd[member] for member in max(groups, key=len)]
    if len(hidden) > 1:
        _inset(axes, curve, places, hidden, np.concatenate([taken, hides]))


def _inset(axes: Axes, curve: Curve, places: Array, members: Sequence[int], taken: Array) -> Array:
    """An inset around some of the marks, where it hides the fewest of the points that are taken.

    Places in parts of the axes, shape (N, 2); returns such points all over what the inset covers.
    """
    found = [(*free_corner(axes, taken, size, _MIDDLE), size) for size in _SIZES]
    corner, _, size = min(found, key=lambda each: each[1])
    inset = axes.inset_axes((*corner, *size))
    for number, stretch in enumerate(curve.stretches):
        colour = (CURVE, _LIGHT)[number % 2] if stretch.is_proved else _UNPROVED
        inset.plot(stretch.points[:, 0], stretch.points[:, 1], color=colour, linewidth=1.6)
    for index in members:
        mark = curve.marks[index]
        draw_point(inset, places[index], mark.k, True, mark.id, mark.kind)
    show_around(
        axes,
        inset,
        places[members],
        margin=0.12 if len(members) >= _CROWD else 0.4,
        ticks=(3 if size[0] > 0.3 else 2, 4),
    )
    return covered_by(axes, corner, size)


_SIZES = tuple(map(np.array, ((0.36, 0.28), (0.28, 0.28), (0.24, 0.22))))
_MIDDLE = np.array([0.5, 0.5])


_CLOSE = 0.2
"""Marks closer than this part of the loop's size belong to one run."""
_CROWD = 4


def _draw_primaries(axes: Axes, curve: Curve) -> dict[str, Line2D]:
    """Those near the curve; to show the other one would make the curve small."""
    mu = float(curve.parameters["mu"])
    along = np.concatenate([stretch.points[:, 0] for stretch in curve.stretches])
    near = [x for x in (-mu, 1 - mu) if along.min() - _NEAR < x < along.max() + _NEAR]
    if not near:
        return {}
    label = "primaries" if len(near) > 1 else "smaller primary" if near[0] > 0.5 else "larger primary"
    (line,) = axes.plot(near, [0.0] * len(near), linestyle="none", marker="x", color=INK, markersize=4.5, label=label)
    return {label: line}


_NEAR = 0.2


class Along:
    """The horizontal axis: the family parameter where it increases along the curve, else arclength."""

    def __init__(self, curve: Curve) -> None:
        first = np.concatenate([stretch.points[:, 0] for stretch in curve.stretches])
        self.is_parameter = curve.has_parameter and _increases(first)
        self.is_logarithmic = bool(self.is_parameter and first.min() > 0 and first.max() > _MANY * first.min())
        name = curve.coordinates[0]
        self.label = (
            label_of(curve.system, name) if self.is_parameter else f"arclength along the curve{unit_of(curve.system)}"
        )

    def half_width(self, stretch: Stretch) -> float:
        """Half-width of the piece, in what is drawn."""
        return stretch.first_half_width if self.is_parameter else stretch.half_width

    def values(self, stretch: Stretch) -> Array:
        """Along the stretch, at its s."""
        return stretch.points[:, 0] if self.is_parameter else stretch.arclength

    def at(self, stretch: Stretch, s: float) -> float:
        """At one s."""
        return float(np.interp(s, stretch.s, self.values(stretch)))

    def ends(self, stretch: Stretch) -> tuple[float, float]:
        """At both ends of the stretch."""
        values = self.values(stretch)
        return float(values[0]), float(values[-1])


def _increases(values: Array) -> bool:
    return bool((np.diff(values) >= -1e-9 * np.abs(values[1:])).all())


def _lines(title: str, panels: int) -> str:
    """A title in lines that fit above one of so many panels."""
    return "\n".join(wrap(title, _CHARACTERS // panels))


def _own(stretch: Stretch) -> list[tuple[float, float]]:
    """The proved intervals that the curve runs along."""
    return [(start, end) for start, end in stretch.intervals if end > stretch.s[0] and start < stretch.s[-1]]


def _look(stretch: Stretch) -> dict[str, Any]:
    if not stretch.is_proved:
        return {"facecolor": "white", "edgecolor": _UNPROVED, "hatch": "", "linewidth": 0.9}
    if stretch.coordinates == PHYSICAL:
        return {"facecolor": CURVE, "edgecolor": "white", "hatch": "", "linewidth": 0.4}
    return {"facecolor": _REGULARISED, "edgecolor": "#7a5518", "hatch": "////", "linewidth": 0.4}


def _bar(axes: Axes, ends: tuple[float, float], height: float, stretch: Stretch) -> None:
    axes.bar(ends[0], height, width=ends[1] - ends[0], align="edge", zorder=2, **_look(stretch))


def _coordinate_handles(stretches: Sequence[Stretch]) -> list[Patch]:
    handles: dict[str, Patch] = {}
    for stretch in stretches:
        label = f"{stretch.coordinates} coordinates" if stretch.is_proved else "not proved"
        handles.setdefault(label, Patch(label=label, **_look(stretch)))
    return list(handles.values())


def _tube_handles(stretches: Sequence[Stretch]) -> list[Line2D]:
    handles = [Line2D([], [], color=INK, label="tube")]
    if any(stretch.deviation for stretch in stretches):
        handles.append(Line2D([], [], color=CURVE, label="proved distance"))
    return handles


def _legend(figure: Figure, handles: Sequence[Any], claims: Sequence[tuple[int, str]]) -> None:
    """The usual legend below all axes, with one more row above it."""
    certified = [True] * bool(claims)
    if claims:
        legend_below(figure, claims, certified)
    legend_row(figure, list(handles), legend_height(claims, certified))
