"""The Falkner-Skan family: where its orbits meet Fix(R), its period, and the orbits in 1:2, 1:3, 1:4 resonance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orbitproof.figures.model import MarkedPoint, SampledFamily
from orbitproof.figures.orbits import Array, symmetric_orbit
from orbitproof.figures.pictures.legends import legend_below
from orbitproof.figures.pictures.marks import draw_mark
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, level_label, marker_of
from orbitproof.shared.systems import FALKNER_SKAN

_WIDTH = 7.2
_LINE_STYLES = {2: "solid", 3: (0, (5, 2)), 4: (0, (1.5, 1.2))}
_PANELS = ((0, 1), (0, 2), (1, 2))


def draw_crossings(family: SampledFamily, marks: Sequence[MarkedPoint]) -> Figure:
    """Both points on Fix(R), and the period, as functions of the family parameter."""
    figure = plt.figure(figsize=(_WIDTH, 3.1))
    grid = figure.add_gridspec(1, 2, left=0.085, right=0.985, top=0.91, bottom=0.28, wspace=0.24)
    crossings, periods = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    crossings.plot(family.levels, family.points[:, -1], color=CURVE, label="starting point")
    crossings.plot(family.levels, family.second_points[:, -1], color=SECOND_CURVE, label="half a period later")
    periods.plot(family.levels, family.periods, color=CURVE)
    periods.set_yscale("log")
    for mark in marks:
        found = family.place(mark)
        draw_mark(crossings, (mark.level, mark.point[-1]), mark)
        period = float(np.interp(found.arclength, family.arclength, family.periods))
        draw_mark(periods, (mark.level, period), mark)
    for axes in (crossings, periods):
        axes.set_xscale("log")
        axes.set_xlim(1.0, float(family.levels.max()) * 1.3)
        axes.set_xlabel(level_label(family.system))
    crossings.set_ylim(-2.2, 1.25)
    crossings.set_ylabel(label_of(family.system, family.system.centre_coordinates[-1]))
    crossings.legend(loc="center right", handlelength=1.8)
    periods.set_ylabel("period  (nondimensional)")
    crossings.set_title("(a)  the two crossings of Fix($R$)", color=INK)
    periods.set_title("(b)  the period", color=INK)
    legend_below(figure, ((m.k, m.candidate.kind) for m in marks), [m.certified for m in marks])
    return figure


def draw_resonant_orbits(marks: Sequence[MarkedPoint]) -> Figure:
    """The orbits in resonance, in the three coordinate planes; solid 1:2, dashed 1:3, dotted 1:4.

    Their points on Fix(R) are too close to each other to be told apart: an inset magnifies them.
    """
    marks = sorted(marks, key=lambda item: item.k)
    system = marks[0].candidate.system
    figure = plt.figure(figsize=(_WIDTH, 3.0))
    grid = figure.add_gridspec(1, 3, left=0.075, right=0.985, top=0.91, bottom=0.29, wspace=0.36)
    panels = [figure.add_subplot(grid[0, j]) for j in range(3)]
    inset = panels[0].inset_axes((0.455, 0.34, 0.23, 0.32))
    for mark in marks:
        rows = symmetric_orbit(system, mark.candidate.parameters, list(mark.point), longest_step=2e-4)
        for axes, (i, j) in [*zip(panels, _PANELS, strict=True), (inset, _PANELS[0])]:
            axes.plot(rows[:, i], rows[:, j], color=marker_of(mark.k)[1], linestyle=_style(mark.k), linewidth=1.1)
        draw_mark(inset, (0.0, mark.point[-1]), mark)
    for letter, axes, (i, j) in zip("abc", panels, _PANELS, strict=True):
        _label(axes, (i, j), letter)
    _magnify(panels[0], inset, np.array([mark.point[-1] for mark in marks]))
    claims = [(mark.k, mark.candidate.kind) for mark in marks]
    legend_below(figure, claims, [mark.certified for mark in marks])
    for line in figure.legends[-1].get_lines():
        for k in {k for k, _ in claims}:
            if line.get_marker() == marker_of(k)[0]:
                line.set_linestyle(_style(k))
    return figure


def _magnify(axes: Axes, inset: Axes, heights: Array) -> None:
    """Limits of the inset around the points on Fix(R), and the lines that tie it to the picture."""
    spread = max(float(np.ptp(heights)), 1e-6)
    low, high = float(heights.min()) - 0.4 * spread, float(heights.max()) + 0.4 * spread
    inset.set_ylim(low, high)
    inset.set_xlim(-0.002, 0.002)
    inset.set_xticks([0.0])
    inset.set_yticks([round(low + 0.25 * (high - low), 5), round(high - 0.25 * (high - low), 5)])
    inset.tick_params(labelsize=6, pad=1.5, length=2)
    inset.grid(False)
    inset.set_title("at Fix($R$)", fontsize=6.5, loc="center", pad=2)
    for side in ("top", "right"):
        inset.spines[side].set_visible(True)
    axes.annotate(
        "",
        xy=(0.0, float(heights.max())),
        xytext=(0.5, 0.76),
        textcoords="axes fraction",
        arrowprops={"arrowstyle": "-|>", "linewidth": 0.6, "color": INK, "shrinkA": 0, "mutation_scale": 6},
    )


def _style(k: int) -> Any:
    return _LINE_STYLES.get(k, "dashdot")


def _label(axes: Axes, shown: tuple[int, int], letter: str) -> None:
    x, y = (FALKNER_SKAN.state[index] for index in shown)
    axes.set_xlabel(label_of(FALKNER_SKAN, x))
    axes.set_ylabel(label_of(FALKNER_SKAN, y), labelpad=1)
    axes.set_title(f"({letter})  ${x}$ and ${y}$", color=INK)
    axes.margins(0.08)
