"""A periodic orbit without symmetry, integrated in double precision: two projections, and its points on the section."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from flint import arb
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orbitproof.figures.orbits import Array, ReturningOrbit, returning_orbit
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, unit_of
from orbitproof.shared.formats import InSection, PeriodicOrbit

_WIDTH = 7.2
_FLAT = 1e-6
"""A coordinate that varies less, relative to the one that varies most, is left out."""
DOT: Mapping[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 5.0, "zorder": 4}

Pair = tuple[int | None, int]
"""What a panel shows: two coordinates, `None` for the time."""


def draw_periodic_orbit(claim: PeriodicOrbit, point: Mapping[str, arb] | None = None) -> Figure:
    """The orbit of a claim, filled where its certificate encloses the point; else all of it is numerical.

    Arguments:
        point: enclosures of the state at the point, by name, from a certificate that says "proved".

    Raises `OrbitNotClosed`.
    """
    start = claim.centre if point is None else [point[name].mid() for name in claim.system.state]
    orbit = returning_orbit(claim, [float(value) for value in start])
    figure = plt.figure(figsize=(_WIDTH, 3.5))
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.985, top=0.97, bottom=0.24, wspace=0.28)
    for column, pair in enumerate(pairs_of(orbit.states)):
        axes = figure.add_subplot(grid[0, column])
        _panel(axes, claim, orbit, pair, point is not None)
    known = {str(line.get_label()): line for axes in figure.axes for line in axes.get_lines()}
    figure.legend(list(known.values()), list(known), loc="lower center", ncols=4, frameon=False)
    return figure


def pairs_of(states: Array) -> Sequence[Pair]:
    """What the two panels show of states, shape (K, N); one if only one coordinate varies."""
    widths = np.ptp(states, axis=0)
    shown = [int(i) for i in np.flatnonzero(widths > _FLAT * widths.max())]
    if len(shown) == 1:
        return [(None, shown[0])]
    if len(shown) == 2:
        return [(shown[0], shown[1]), (None, shown[0])]
    return [(shown[0], shown[1]), (shown[2], shown[3]) if len(shown) > 3 else (shown[0], shown[2])]


def coordinates_of(times: Array, states: Array, pair: Pair) -> tuple[Array, Array]:
    """What a panel shows of states, shape (K, N), at times: abscissas and ordinates."""
    first, second = pair
    return times if first is None else states[:, first], states[:, second]


def label_axes(axes: Axes, claim: InSection, pair: Pair) -> None:
    """The names of the coordinates, as the system has them."""
    system, (first, second) = claim.system, pair
    axes.set_xlabel(f"time{unit_of(system)}" if first is None else label_of(system, system.state[first]))
    axes.set_ylabel(label_of(system, system.state[second]))


def _panel(axes: Axes, claim: PeriodicOrbit, orbit: ReturningOrbit, pair: Pair, certified: bool) -> None:
    curve = coordinates_of(orbit.times, orbit.states, pair)
    axes.plot(*curve, color=CURVE, linewidth=1.1, label="orbit, in double precision")
    axes.autoscale_view()
    axes.autoscale(False)
    show_section(axes, claim, pair)
    if pair[0] is not None and len(orbit.crossings) > 1:
        others = coordinates_of(orbit.times, orbit.crossings[:-1], pair)
        axes.plot(*others, color=INK, markerfacecolor="white", label="further crossings", **DOT)
    axes.plot(
        *coordinates_of(orbit.times[:1], orbit.states[:1], pair), color=INK,
        markerfacecolor=INK if certified else "white",
        label="the point, enclosed" if certified else "the point, numerical", clip_on=False, **DOT,
    )  # fmt: skip
    label_axes(axes, claim, pair)


def show_section(axes: Axes, claim: InSection, pair: Pair) -> None:
    """The line in which the section meets the plane of a panel, where it is perpendicular to it."""
    used = {i for i, value in enumerate(claim.normal) if value != 0}
    if not used <= set(pair):
        return
    first, second = pair
    style: dict[str, Any] = {"color": SECOND_CURVE, "linewidth": 0.8, "linestyle": (0, (4, 3)), "label": "section"}
    across = 0.0 if first is None else float(claim.normal[first])
    up, offset = float(claim.normal[second]), float(claim.offset)
    if up == 0:
        axes.axvline(offset / across, **style)
    else:
        axes.axline((0.0, offset / up), slope=-across / up, **style)
