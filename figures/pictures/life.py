"""Whole lives: a curve of equilibria, the periodic orbits born on it, and what happens to them, over a parameter.

Curves are numerical. A point is filled where a certificate of it says "proved".
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orbitproof.explore.periodic import LifeRecord
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, symbol
from orbitproof.shared.systems import shown

_WIDTH = 7.2
_MARKS = {
    "Hopf": ("o", "#111111"),
    "fold": ("v", "#111111"),
    "branch point": ("^", "#8c510a"),
    "pitchfork": ("P", "#01665e"),
    "period doubling": ("s", "#b2182b"),
    "Neimark-Sacker": ("D", "#762a83"),
}
_UNSTABLE = (0, (3, 2))
_CERTIFIED = 1e-8
"""A point is that of a certificate if their values of the parameter agree so far."""


@dataclass(frozen=True)
class CertifiedPoint:
    """What a certificate says is proved: of which system, the kind of point, and the value of its parameter."""

    system: str
    kind: str
    parameter: str
    value: float


def draw_life(record: LifeRecord, certified: Sequence[CertifiedPoint] = ()) -> Figure:
    """(a) the first coordinate of equilibria, and its extrema on the orbits; (b) the period of these."""
    figure = plt.figure(figsize=(_WIDTH, 3.8))
    grid = figure.add_gridspec(1, 2, left=0.09, right=0.985, top=0.86, bottom=0.25, wspace=0.25)
    left, right = (figure.add_subplot(grid[0, column]) for column in (0, 1))
    values = np.array([each.value for each in record.equilibria])
    heights = np.array([each.point[0] for each in record.equilibria])
    _drawn(left, values, heights, [each.unstable == 0 for each in record.equilibria], CURVE)
    for family in record.families:
        values, stable = np.array([each.value for each in family.orbits]), [each.stable for each in family.orbits]
        for row in ([each.low[0] for each in family.orbits], [each.high[0] for each in family.orbits]):
            _drawn(left, values, np.array(row), stable, SECOND_CURVE)
        _drawn(right, values, np.array([each.period for each in family.orbits]), stable, SECOND_CURVE)
    for point in record.special:
        _mark(left, point.kind, point.value, [point.point[0]], record, certified)
    for family in record.families:
        for passed in family.passed:
            orbit = passed.orbit
            _mark(left, passed.kind, orbit.value, [orbit.low[0], orbit.high[0]], record, certified)
            _mark(right, passed.kind, orbit.value, [orbit.period], record, certified)
    left.set_ylabel(f"${symbol(record.state[0])}$")
    left.set_title("(a)  equilibria and extrema of the orbits", color=INK)
    right.set_ylabel("period")
    right.set_title("(b)  periods", color=INK)
    for axes in (left, right):
        axes.set_xlabel(f"${symbol(record.name)}$")
    legend_row(figure, _handles(record), 0.06)
    fixed = ", ".join(f"${symbol(name)}$ = {value}" for name, value in record.parameters.items())
    head = f"Equilibria and orbits of {shown(record.system)}{': ' if fixed else ''}{fixed}"
    figure.text(0.09, 0.955, head, color=INK, fontweight="bold", va="center", fontsize=8)
    return figure


def _drawn(axes: Axes, values: np.ndarray, heights: np.ndarray, stable: Sequence[bool], colour: str) -> None:
    """A curve: solid where it is stable, dashed where it is not."""
    first = 0
    for last in range(1, len(values) + 1):
        if last == len(values) or stable[last] != stable[first]:
            part = slice(first, last + 1)
            axes.plot(
                values[part], heights[part], color=colour, linewidth=1.2,
                linestyle="solid" if stable[first] else _UNSTABLE,
            )  # fmt: skip
            first = last


def _mark(
    axes: Axes,
    kind: str,
    value: float,
    heights: Sequence[float],
    record: LifeRecord,
    certified: Iterable[CertifiedPoint],
) -> None:
    filled = any(
        (each.system, each.kind, each.parameter) == (record.system, kind, record.name)
        and abs(each.value - value) <= _CERTIFIED * (1 + abs(value))
        for each in certified
    )
    for height in heights:
        axes.plot([value], [height], zorder=5, **_look(kind, filled))


def _look(kind: str, filled: bool) -> dict[str, Any]:
    marker, colour = _MARKS[kind]
    return {
        "marker": marker,
        "color": colour,
        "markerfacecolor": colour if filled else "white",
        "linestyle": "none",
        "markersize": 5.5,
    }


def _handles(record: LifeRecord) -> list[Line2D]:
    kinds = {each.kind for each in record.special} | {each.kind for family in record.families for each in family.passed}
    handles = [Line2D([], [], color=CURVE, label="equilibria")]
    if record.families:
        handles.append(Line2D([], [], color=SECOND_CURVE, label="periodic orbits"))
    handles.append(Line2D([], [], color=INK, linestyle=_UNSTABLE, label="unstable"))
    handles += [Line2D([], [], label=kind, **_look(kind, False)) for kind in _MARKS if kind in kinds]
    return [*handles, Line2D([], [], label="filled: proved", **_look("Hopf", True))]
