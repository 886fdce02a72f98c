"""The picture of a certified catalogue: its rows, and how far the orbits of the curve are from them at most."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.certified.rows import BOUNDS, bounds_of
from orbitproof.figures.pictures.legends import legend_row, verdict_handles
from orbitproof.figures.style import CURVE, INK
from orbitproof.shared.formats import FIELDS
from orbitproof.verify.branches.catalogue import CertifiedRow
from orbitproof.verify.certificate import Certificate

_WIDTH, _HEIGHT = 7.2, 3.6
_LEVEL, _PERIOD = FIELDS.index("jacobi"), FIELDS.index("period")
_LOOKS = tuple(zip(BOUNDS, ("#111111", "#b2182b", "#1b7837", "#762a83"), "osD^", strict=True))


def draw_rows(certificate: Certificate) -> Figure:
    """Periods over Jacobi constants of all rows, and the bounds of their differences from certified orbits."""
    rows = certificate.rows
    verdicts = [row.orbit is not None for row in rows]
    figure = plt.figure(figsize=(_WIDTH, _HEIGHT))
    grid = figure.add_gridspec(1, 2, left=0.09, right=0.98, top=0.83, bottom=0.29, wspace=0.28)
    _draw_rows(figure.add_subplot(grid[0, 0]), rows, np.array(verdicts))
    _draw_bounds(figure.add_subplot(grid[0, 1]), [row for row in rows if row.orbit is not None])
    title = certificate.document["statement"]["title"]
    words = f"{title}: {sum(verdicts)} of {len(rows)} rows are orbits of the proved curve {certificate.document['id']}"
    figure.text(0.09, 0.945, words, color=INK, fontweight="bold", va="center")
    bounds = [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=3.5, label=name)
        for name, colour, marker in _LOOKS
    ]
    legend_row(figure, verdict_handles(verdicts), 0.28)
    legend_row(figure, bounds, 0.05)
    return figure


def _draw_rows(axes: Axes, rows: tuple[CertifiedRow, ...], certified: np.ndarray) -> None:
    levels, periods = (np.array([float(row.given[index]) for row in rows]) for index in (_LEVEL, _PERIOD))
    style = {"color": CURVE, "marker": "o", "markersize": 2.5, "linestyle": "none"}
    axes.plot(levels[certified], periods[certified], **style)
    axes.plot(levels[~certified], periods[~certified], **style, markerfacecolor="white")
    _label_levels(axes)
    axes.set_ylabel("period  (nondimensional)")
    axes.set_title("(a)  the rows", color=INK)


def _draw_bounds(axes: Axes, rows: list[CertifiedRow]) -> None:
    """Over the same axis; what is exactly 0 is left out of a logarithmic scale."""
    for name, colour, marker in _LOOKS:
        bounds = [(float(row.given[_LEVEL]), bounds_of(row).get(name, 0.0)) for row in rows]
        places = [(level, bound) for level, bound in bounds if bound > 0]
        if places:
            axes.plot(*zip(*places, strict=True), color=colour, marker=marker, markersize=2.0, linestyle="none")
    axes.set_yscale("log")
    _label_levels(axes)
    axes.set_ylabel("difference, at most")
    axes.set_title("(b)  how far the orbits are from them", color=INK)


def _label_levels(axes: Axes) -> None:
    axes.set_xlabel("Jacobi constant  (nondimensional)")
    axes.xaxis.set_major_locator(MaxNLocator(5))
