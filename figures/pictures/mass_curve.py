"""Symmetry-breaking points of L1, L2, L3 as functions of the mass parameter: one column for each.

Above, where the orbits cross the axis; in the middle, the Jacobi constant; below, its derivative in mu along the curve,
whose zeros are the minima and maxima of the Jacobi constant. Everything is read from a mass-curve file.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator
from numpy.typing import NDArray

from orbitproof.explore.three_body.masses import CurveRecord, PointRecord, read_curves
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import CR3BP

Array = NDArray[np.float64]

_WIDTH, _HEIGHT = 7.2, 6.3
_ROW_TITLES = ("{} : crossings of the axis", "{} : Jacobi constant", "{} : its derivative")
_MINIMUM, _MAXIMUM = "v", "^"
_LABEL_DISTANCE = 0.18
"""Smallest distance of two labelled points, in units of the size of both curves."""


def read_mass_curves(path: Path) -> list[CurveRecord]:
    """The curves of a file. Raises `InputError`, also for a curve of fewer than two points."""
    curves = read_curves(path)
    if not curves:
        raise InputError(f"{path}: field curves: empty; write the file again with orbitproof explore mass-curve")
    for index, curve in enumerate(curves):
        if len(curve.points) < 2:
            raise InputError(f"{path}: field curves[{index}].points: one point is no curve; trace at least two")
    return curves


def draw_mass_curves(curves: list[CurveRecord]) -> Figure:
    """The figure, one text width wide; at least one curve."""
    figure = plt.figure(figsize=(_WIDTH, _HEIGHT))
    grid = figure.add_gridspec(
        3, len(curves), left=0.085, right=0.985, top=0.955, bottom=0.125, wspace=0.34, hspace=0.46
    )
    for column, curve in enumerate(curves):
        axes = [figure.add_subplot(grid[row, column]) for row in range(3)]
        _crossings(axes[0], curve)
        _against_mass(axes[1], curve, lambda point: point.jacobi_constant)
        _against_mass(axes[2], curve, _slope_of(curve))
        axes[2].axhline(0.0, color=INK, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
        axes[2].margins(y=0.12)
        _mark_extrema(axes, curve)
        for row, panel in enumerate(axes):
            letter = "abcdefghi"[row * len(curves) + column]
            panel.set_title(f"({letter})  " + _ROW_TITLES[row].format(curve.libration).replace(" :", ":"), color=INK)
        axes[2].set_ylabel(
            r"$\mu^{1/3}\,\mathrm{d}C/\mathrm{d}\mu$" if _hill(curve) else r"$\mathrm{d}C/\mathrm{d}\mu$"
        )
        axes[1].set_ylabel("$C$")
        for panel in axes[1:]:
            panel.set_xlabel(label_of(CR3BP, "mu"))
    _legend(figure, curves)
    return figure


def _hill(curve: CurveRecord) -> bool:
    """Whether lengths on the curve scale with Hill's radius as mu tends to 0."""
    return curve.libration != "L3"


def _slope_of(curve: CurveRecord) -> Callable[[PointRecord], float]:
    # Near the smaller mass C - 3 is of order mu^(2/3): this factor keeps its slope bounded.
    power = 1.0 / 3.0 if _hill(curve) else 0.0
    return lambda point: float(point.mu**power) * point.jacobi_derivative


def _crossings(axes: Axes, curve: CurveRecord) -> None:
    first = np.array([(point.x, point.vy) for point in curve.points])
    second = np.array([point.second for point in curve.points])
    axes.plot(second[:, 0], second[:, 1], color=SECOND_CURVE)
    axes.plot(first[:, 0], first[:, 1], color=CURVE)
    axes.margins(x=0.17, y=0.17)
    axes.set_xlabel(label_of(CR3BP, "x"))
    axes.set_ylabel(label_of(CR3BP, "vy", unit=False))
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.autoscale_view()
    if curve.precise:
        axes.plot(
            [float(row.x) for row in curve.precise], [float(row.vy) for row in curve.precise], **_hollow("o", 3.6)
        )
    _label_masses(axes, _decades(curve), first, second)


def _decades(curve: CurveRecord) -> list[tuple[float, float, float]]:
    """Largest mass and powers of ten with their points (mu, x, vy), interpolated; good enough for a label."""
    masses = np.log10([point.mu for point in curve.points])
    places = [(curve.points[0].mu, curve.points[0].x, curve.points[0].vy)]
    for exponent in range(int(np.ceil(masses[0])) - 1, int(np.floor(masses.min())) - 1, -1):
        inside = np.flatnonzero((masses[:-1] >= exponent) & (masses[1:] < exponent))
        for index in inside[:1]:
            weight = (exponent - masses[index]) / (masses[index + 1] - masses[index])
            a, b = curve.points[index], curve.points[index + 1]
            places.append((10.0**exponent, a.x + weight * (b.x - a.x), a.vy + weight * (b.vy - a.vy)))
    return places


def _label_masses(axes: Axes, places: list[tuple[float, float, float]], first: Array, second: Array) -> None:
    """The masses of the points that are far enough apart for a label each, on the side with more room."""
    both = np.vstack([first, second])
    size = np.ptp(both, axis=0)
    shown: list[Array] = []
    for mu, x, vy in places:
        exponent = float(np.log10(mu))
        is_round = abs(exponent - round(exponent)) < 1e-9
        position = np.array([x, vy]) / size
        near = any(float(np.linalg.norm(position - other)) < _LABEL_DISTANCE for other in shown)
        if near:
            continue
        axes.plot(x, vy, marker=".", markersize=3.5, color=CURVE, linestyle="none", zorder=3)
        shown.append(position)
        index = int(np.argmin(np.linalg.norm(first / size - position, axis=1)))
        along = (first[min(index + 4, len(first) - 1)] - first[max(index - 4, 0)]) / size
        across = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        room = {
            sign: float(np.linalg.norm(both / size - position - 0.12 * sign * across, axis=1).min())
            for sign in (1.0, -1.0)
        }
        # Nearly equal room: to the right, so that the labels of one panel stand on one side.
        rightwards = 1.0 if across[0] > 0 else -1.0
        room[rightwards] += 0.02
        across = across * max(room, key=lambda sign: room[sign])
        text = rf"$10^{{{round(exponent)}}}$" if is_round else rf"$\mu$ = {mu:g}"
        axes.annotate(
            text,
            (x, vy),
            xytext=(5 * across[0], 9 * across[1]),
            textcoords="offset points",
            ha="left" if across[0] > 0 else "right",
            va="center",
            fontsize=7,
            color=INK,
        )


def _against_mass(axes: Axes, curve: CurveRecord, value: Callable[[PointRecord], float]) -> None:
    masses = np.array([point.mu for point in curve.points])
    axes.plot(masses, [value(point) for point in curve.points], color=CURVE)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(numticks=6))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_locator(MaxNLocator(5))


def _mark_extrema(axes: list[Axes], curve: CurveRecord) -> None:
    for row in curve.extrema:
        marker = _MINIMUM if row.kind == "minimum" else _MAXIMUM
        mu, level = float(row.mu), float(row.jacobi_constant)
        axes[0].plot(float(row.x), float(row.vy), **_hollow(marker, 5.0))
        axes[1].plot(mu, level, **_hollow(marker, 5.0))
        axes[2].plot(mu, 0.0, **_hollow(marker, 5.0))
        axes[1].annotate(
            rf"$\mu$ = {mu:.6g}",
            (mu, level),
            xytext=(-9, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=7,
            color=INK,
        )


def _hollow(marker: str, size: float) -> dict[str, Any]:
    return {
        "marker": marker,
        "markersize": size,
        "linestyle": "none",
        "color": INK,
        "markerfacecolor": "white",
        "markeredgewidth": 0.9,
        "zorder": 6,
        "clip_on": False,
    }


def _legend(figure: Figure, curves: list[CurveRecord]) -> None:
    handles = [
        Line2D([], [], color=CURVE, label="first crossing"),
        Line2D([], [], color=SECOND_CURVE, label="half a period later"),
    ]
    if any(curve.precise for curve in curves):
        digits = min(row.digits for curve in curves for row in curve.precise)
        handles.append(Line2D([], [], **_hollow("o", 3.6), label=f"located to {digits} digits"))
    for kind, marker in (("minimum", _MINIMUM), ("maximum", _MAXIMUM)):
        if kind in {row.kind for curve in curves for row in curve.extrema}:
            handles.append(Line2D([], [], **_hollow(marker, 5.0), label=f"{kind} of the Jacobi constant"))
    figure.legend(handles=handles[2:], loc="lower center", ncols=3, bbox_to_anchor=(0.5, 0.0))
    figure.legend(handles=handles[:2], loc="lower center", ncols=2, bbox_to_anchor=(0.5, 0.027))
