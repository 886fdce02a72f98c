"""The geometry of both bifurcations, from the normal forms: curves of symmetric periodic points in (nu, x).

A drawing of the definitions, not of data: the zeros of x (nu - x^2) and of x (nu - x), sheared, so that the
branch that is followed is no straight line.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from orbitproof.figures.orbits import Array
from orbitproof.figures.style import CURVE, INK

_WIDTH = 7.2
_BRANCH = "#b2182b"
_HALF = 1.0


def draw_geometry() -> Figure:
    """Two panels: period tupling (left) and touch-and-go (right)."""
    figure = plt.figure(figsize=(_WIDTH, 2.9))
    grid = figure.add_gridspec(1, 2, left=0.075, right=0.985, top=0.9, bottom=0.15, wspace=0.22)
    left, right = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    nu = np.linspace(-_HALF, _HALF, 401)
    x = np.linspace(-1.0, 1.0, 401)

    _frame(left, nu)
    left.plot(x**2, _followed(x**2) + 0.7 * x, color=_BRANCH)
    left.annotate(r"$x_{b_1}(\nu)$", (0.22, 0.66), color=_BRANCH, fontsize=10)
    left.annotate(r"$x_{b_2}(\nu)$", (0.42, -0.68), color=_BRANCH, fontsize=10)
    left.set_title("(a)  period tupling", color=INK)

    _frame(right, nu)
    right.plot(nu, _followed(nu) + 0.68 * nu, color=_BRANCH)
    right.annotate(r"$x_b(\nu)$", (0.2, 0.5), color=_BRANCH, fontsize=10)
    right.set_title("(b)  touch-and-go", color=INK)
    return figure


def _followed(nu: Array) -> Array:
    """The branch of points of the lower period."""
    return 0.16 * nu + 0.05 * nu**2


def _frame(axes: Axes, nu: Array) -> None:
    """The box V, the branch that is followed, the bifurcation point and the names."""
    axes.grid(False)
    axes.add_patch(Rectangle((-_HALF, -0.95), 2 * _HALF, 1.9, facecolor="#f2f4f6", edgecolor="#9aa5ad", linewidth=0.8))
    axes.annotate(r"$[\nu_1,\nu_2]\times U$", (0.96, -0.9), ha="right", color="#5c6b75", fontsize=9, va="bottom")
    axes.plot(nu, _followed(nu), color=CURVE)
    axes.annotate(r"$x_{fp}(\nu)$", (-0.85, 0.0), color=CURVE, fontsize=10, va="bottom")
    axes.vlines(0.0, -1.1, 0.0, color="#777777", linewidth=0.7, linestyle=(0, (3, 3)))
    axes.hlines(0.0, -1.2, 0.0, color="#777777", linewidth=0.7, linestyle=(0, (3, 3)))
    axes.plot(0.0, 0.0, marker="o", color=INK, markersize=5, zorder=6)
    axes.set_xlim(-1.2, 1.2)
    axes.set_ylim(-1.1, 1.1)
    axes.set_xticks([-_HALF, 0.0, _HALF], [r"$\nu_1$", r"$\nu^*$", r"$\nu_2$"], fontsize=10)
    axes.set_yticks([0.0], ["$x^*$"], fontsize=10)
    axes.set_xlabel(r"parameter $\nu$")
    axes.set_ylabel("point on Fix($R$)")
