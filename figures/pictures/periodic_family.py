"""Families of periodic orbits without symmetry: period and multipliers over what varies. Numerics, and labelled so."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orbitproof.explore.periodic import BifurcationRecord, PeriodicFamilyRecord
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, symbol
from orbitproof.shared.systems import shown

_WIDTH = 7.2
_MARKS = {
    "fold": ("v", "#111111"),
    "branch point": ("^", "#8c510a"),
    "pitchfork": ("P", "#01665e"),
    "period doubling": ("s", "#b2182b"),
    "Neimark-Sacker": ("D", "#762a83"),
}
_LINEAR = 4.0
"""Up to which stability parameters are shown linearly."""
_SHADES = (CURVE, "#e08214", "#1b7837", "#762a83")


def draw_periodic_family(record: PeriodicFamilyRecord) -> Figure:
    """(a) the period, (b) the multipliers along a family, with the points where they meet the unit circle, hollow."""
    figure = plt.figure(figsize=(_WIDTH, 3.6))
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.985, top=0.86, bottom=0.23, wspace=0.3)
    values = np.array([each.value for each in record.orbits])
    label = f"{record.name}" if record.over_levels else f"${symbol(record.name)}$"
    left, right = (figure.add_subplot(grid[0, column]) for column in (0, 1))
    left.plot(values, [each.period for each in record.orbits], color=CURVE, linewidth=1.2)
    left.set_ylabel("period")
    left.set_title("(a)  period", color=INK)
    _multipliers(right, record, values)
    for axes in (left, right):
        axes.set_xlabel(label)
    for each in record.bifurcations:
        _mark(left, each, each.orbit.period)
        _mark(right, each, _height(record, complex(*each.multiplier)))
    kinds = [kind for kind in _MARKS if kind in {each.kind for each in record.bifurcations}]
    handles = [Line2D([], [], label=kind, **_look(kind)) for kind in kinds]
    numerical = Line2D([], [], color=CURVE, label="double precision, nothing proved")
    legend_row(figure, [numerical, *handles], 0.06)
    fixed = ", ".join(f"${symbol(name)}$ = {value}" for name, value in record.parameters.items())
    head = f"Periodic orbits of {shown(record.system)}{': ' if fixed else ''}{fixed}"
    figure.text(0.1, 0.955, head, color=INK, fontweight="bold", va="center", fontsize=8)
    return figure


def _multipliers(axes: Axes, record: PeriodicFamilyRecord, values: Array) -> None:
    """The absolute values, or with a first integral, where they come in pairs, the stability parameters."""
    count = max(len(each.multipliers) for each in record.orbits)
    heights_of = np.full((len(values), count), np.nan)
    for row, each in zip(heights_of, record.orbits, strict=True):
        heights = sorted((_height(record, complex(*pair)) for pair in each.multipliers), reverse=True)
        row[: len(heights)] = heights
    # With a first integral both multipliers of a pair have one stability parameter.
    step = 2 if record.conservative and count % 2 == 0 else 1
    for number, column in enumerate(heights_of.T[::step]):
        axes.plot(values, column, color=_SHADES[number % len(_SHADES)], linewidth=1.2)
    if record.conservative:
        axes.set_title(r"(b)  $(\lambda+1/\lambda)/2$, real part", color=INK)
        axes.set_ylabel("stability parameter")
        if np.nanmax(np.abs(heights_of)) > _LINEAR:
            axes.set_yscale("symlog", linthresh=_LINEAR)
    else:
        axes.set_title("(b)  absolute values of the multipliers", color=INK)
        axes.set_ylabel(r"$|\lambda|$")
        axes.set_yscale("log")
    for goal in (1.0, -1.0) if record.conservative else (1.0,):
        axes.axhline(goal, color=SECOND_CURVE, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)


def _height(record: PeriodicFamilyRecord, multiplier: complex) -> float:
    if not record.conservative:
        return abs(multiplier)
    return float(((multiplier + 1 / multiplier) / 2).real) if multiplier else float("nan")


def _look(kind: str) -> dict[str, Any]:
    marker, colour = _MARKS[kind]
    return {"marker": marker, "color": colour, "markerfacecolor": "white", "linestyle": "none", "markersize": 5.5}


def _mark(axes: Axes, each: BifurcationRecord, height: float) -> None:
    axes.plot([each.orbit.value], [height], zorder=5, **_look(each.kind))
