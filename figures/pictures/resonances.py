"""Stability along a family: why its list of resonances is believed to be complete.

Above, the stability parameters along the whole family with the resonant values and the points found; below,
the same where points crowd, the places where a curve turns close to a resonant value, and how much the
parameters change from one sample to the next.
"""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from orbitproof.explore.records import BAND, ExtremumRecord
from orbitproof.figures.model import BifurcationOnCurve, SampledStability
from orbitproof.figures.pictures.legends import bottom_margin, legend_below
from orbitproof.figures.pictures.marks import draw_mark, draw_resonance, resonances
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, marker_of, unit_of

_WIDTH, _HEIGHT = 7.2, 6.6
_CROWD_GAP = 1.68
_CLOSE = 0.02
_MOST_PANELS = 3


def draw_resonances(curve: SampledStability, places: Sequence[BifurcationOnCurve]) -> Figure:
    """The figure of one family; `places` as from `SampledStability.places`."""
    crowds = _crowds(places)
    close = _close_turns(curve)
    claims, certified = {(item.k, item.kind) for item in places}, [_is_certified(item) for item in places]
    figure = plt.figure(figsize=(_WIDTH, _HEIGHT))
    bottom = bottom_margin(_HEIGHT, claims, certified)
    outer = figure.add_gridspec(3, 1, left=0.09, right=0.945, top=0.955, bottom=bottom, hspace=0.42)
    arclength = curve.family.arclength
    _panel(
        figure.add_subplot(outer[0]), curve, places, (float(arclength[0]), float(arclength[-1])), "a", "whole family"
    )
    middle = outer[1].subgridspec(1, max(1, len(crowds)), wspace=0.28)
    letters = iter("bcdefghij")
    for index, window in enumerate(crowds):
        _panel(
            figure.add_subplot(middle[index]), curve, places, window, next(letters), "where points crowd", index == 0
        )
    lower = outer[2].subgridspec(1, len(close) + 1, wspace=0.42)
    for index, extremum in enumerate(close):
        _turn(figure.add_subplot(lower[index]), curve, places, extremum, next(letters))
    _steps(figure.add_subplot(lower[len(close)]), curve, next(letters))
    legend_below(figure, claims, certified)
    return figure


def _crowds(places: Sequence[BifurcationOnCurve]) -> list[tuple[float, float]]:
    """Windows of arclength around groups of points, with the largest groups first in order along the family."""
    groups: list[list[float]] = []
    for item in places:
        if groups and item.arclength == groups[-1][-1]:
            continue
        if groups and item.arclength <= _CROWD_GAP * groups[-1][-1] + 1e-12:
            groups[-1].append(item.arclength)
        elif item.arclength > 0:
            groups.append([item.arclength])
    groups = sorted((group for group in groups if len(group) > 1), key=len, reverse=True)[:_MOST_PANELS]
    windows = []
    for group in sorted(groups):
        pad = 0.08 * (group[-1] - group[0])
        windows.append((max(0.0, group[0] - pad), group[-1] + pad))
    return windows


def _close_turns(curve: SampledStability) -> list[ExtremumRecord]:
    near = [item for item in curve.extrema if abs(item.stability_parameter - item.level) < _CLOSE]
    near.sort(key=lambda item: abs(item.stability_parameter - item.level))
    return sorted(near[: _MOST_PANELS - 1], key=lambda item: item.arclength)


def _panel(
    axes: Axes,
    curve: SampledStability,
    places: Sequence[BifurcationOnCurve],
    window: tuple[float, float],
    letter: str,
    text: str,
    leftmost: bool = True,
) -> None:
    low, high = window
    arclength = curve.family.arclength
    for column in curve.parameters.T:
        axes.plot(arclength, np.where(column.imag == 0, column.real, np.nan), color=CURVE)
    # A complex pair has left the unit circle and the real axis: shown by its real part, dotted.
    pairs = np.where((curve.parameters.imag != 0).any(axis=1), curve.parameters[:, 0].real, np.nan)
    axes.plot(arclength, pairs, color=SECOND_CURVE, linestyle="dotted")
    for k, values in resonances(sorted({item.k for item in places}) or [2, 3, 4]).items():
        for value in values:
            draw_resonance(axes, k, value, named=high == arclength[-1] or letter == "a")
    for item in sorted(places, key=_is_certified):
        if low <= item.arclength <= high:
            _draw_place(axes, item)
    for extremum in curve.extrema:
        if low <= extremum.arclength <= high:
            axes.plot(extremum.arclength, extremum.stability_parameter, marker="|", color=INK, markersize=5, zorder=4)
    axes.set_xlim(low - 0.01 * (high - low), high + 0.01 * (high - low))
    axes.set_ylim(-1.25, 1.25)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(f"arclength along the family{unit_of(curve.family.system)}" if letter == "a" else "arclength")
    if leftmost:
        axes.set_ylabel(r"$(\lambda+1/\lambda)/2$")
    axes.set_title(f"({letter})  {text}", color=INK)


def _is_certified(item: BifurcationOnCurve) -> bool:
    """Drawn last: of the two points of one orbit on Fix(R) the certified one is on top."""
    return item.mark is not None and item.mark.certified


def _draw_place(axes: Axes, item: BifurcationOnCurve, height: float | None = None) -> None:
    position = (item.arclength, item.resonant_value if height is None else height)
    if item.mark is not None:
        draw_mark(axes, position, item.mark)
        return
    marker, colour = marker_of(item.k, item.kind)
    axes.plot(*position, marker=marker, color=colour, markerfacecolor="white", linestyle="none", zorder=6)


def _turn(
    axes: Axes, curve: SampledStability, places: Sequence[BifurcationOnCurve], extremum: ExtremumRecord, letter: str
) -> None:
    """A curve that turns close to a resonant value, magnified: the difference from that value."""
    gap = abs(extremum.stability_parameter - extremum.level)
    arclength = curve.family.arclength
    crossings = [item for item in places if item.k == extremum.k and item.resonant_value == extremum.level]
    distances = sorted({abs(item.arclength - extremum.arclength) for item in crossings})[:2]
    half = 2.2 * max([*distances, 1e-6]) if distances and distances[-1] < 0.2 else 0.02
    window = np.abs(arclength - extremum.arclength) <= 3 * half
    if np.count_nonzero(window) < 4:
        nearest = np.argsort(np.abs(arclength - extremum.arclength))[:8]
        window = np.isin(np.arange(len(arclength)), nearest)
    crossings = [item for item in crossings if abs(item.arclength - extremum.arclength) <= 3 * half]
    rows = curve.parameters[window]
    column = int(np.argmin(np.abs(np.median(rows.real, axis=0) - extremum.level)))
    # The samples, the extremum and the crossings, in units of the distance by which the curve turns beyond the value.
    x = np.concatenate([arclength[window], [extremum.arclength], [item.arclength for item in crossings]])
    y = np.concatenate(
        [rows[:, column].real, [extremum.stability_parameter], [item.resonant_value for item in crossings]]
    )
    order = np.argsort(x)
    axes.plot(x[order] - extremum.arclength, (y[order] - extremum.level) / gap, color=CURVE, marker=".", markersize=3)
    axes.axhline(0.0, color=marker_of(extremum.k)[1], linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
    for item in crossings:
        if abs(item.arclength - extremum.arclength) < half:
            _draw_place(axes, _shifted(item, extremum.arclength), 0.0)
    axes.set_xlim(-half, half)
    beyond = extremum.stability_parameter < extremum.level
    axes.set_ylim(*((-2.0, 3.0) if beyond else (-3.0, 2.0)))
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.set_xlabel(f"arclength $-$ {extremum.arclength:.5g}")
    axes.set_ylabel(f"above 1:{extremum.k}  (unit {gap:.2g})")
    axes.set_title(f"({letter})  turns close to 1:{extremum.k}", color=INK)


def _shifted(item: BifurcationOnCurve, origin: float) -> BifurcationOnCurve:
    return BifurcationOnCurve(
        item.k, item.kind, item.side, item.arclength - origin, item.level, item.resonant_value, item.mark
    )


def _steps(axes: Axes, curve: SampledStability, letter: str) -> None:
    changes = curve.changes(BAND)
    shown = np.flatnonzero(changes > 0)
    # Against their number: in arclength the samples crowd where the parameters change fast.
    axes.plot(shown + 1, changes[shown], linestyle="none", marker=".", markersize=1.5, color=CURVE)
    axes.set_yscale("log")
    axes.set_ylim(1e-5, 0.1)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel("sample, along the family")
    axes.set_ylabel("change between samples")
    axes.set_title(f"({letter})  how fine: {len(curve.family.arclength)} samples", color=INK)
