"""Where two resonances meet, from a certificate: the stability parameter along the families, to leading order."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.marks import draw_point
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, marker_of
from orbitproof.shared.formats import Candidate
from orbitproof.verify.double_resonance import ResonanceResults

_WIDTH = 7.2
_FARTHEST = 0.01
"""How far from the point the coordinate y is drawn."""
_SHARE = 0.4
"""How far the values of the parameter are, of those that the resonances take within what is drawn."""


def draw_double_resonance(candidate: Candidate, found: ResonanceResults) -> Figure:
    """(a) s - c along the families of three values of the parameter; (b) the parameter where resonances are."""
    system = candidate.system
    figure = plt.figure(figsize=(_WIDTH, 3.2))
    grid = figure.add_gridspec(1, 2, left=0.12, right=0.98, top=0.86, bottom=0.29, wspace=0.36)
    families, resonances = (figure.add_subplot(grid[0, column]) for column in (0, 1))
    slope, curvature, opening = (float(ball.mid()) for ball in (found.slope, found.curvature, found.opening))
    colour = marker_of(candidate.k, candidate.kind)[1]
    y = np.linspace(-_FARTHEST, _FARTHEST, 201)
    away = _SHARE * opening * _FARTHEST**2
    name = label_of(system, found.parameter_name, unit=False)
    lines = []
    for change, shade, style, words in (
        (-away, SECOND_CURVE, "--", "no resonance"),
        (0.0, INK, "-", "at the point"),
        (away, CURVE, "-", "two resonances"),
    ):  # fmt: skip
        values = slope * change + curvature / 2 * y**2
        lines += families.plot(y, values, color=shade, linestyle=style, label=f"{name}: {words}")
    families.axhline(0.0, color=colour, linewidth=0.8)
    reach = np.sqrt(_SHARE) * _FARTHEST
    families.plot([-reach, reach], [0.0, 0.0], color=colour, marker=".", linestyle="none")
    draw_point(families, (0.0, 0.0), candidate.k, True, candidate.id, candidate.kind)
    along = label_of(system, found.along, unit=False)
    families.set_ylabel(f"$s-\\cos(2\\pi\\cdot{found.turn}/{candidate.k})$")
    families.set_title("(a)  along the family", color=INK)
    (curve,) = resonances.plot(opening * y**2, y, color=colour, label=f"$k={candidate.k}$ resonances")
    draw_point(resonances, (0.0, 0.0), candidate.k, True, candidate.id, candidate.kind)
    resonances.set_xlabel(f"{name} $-$ its value there")
    resonances.set_title("(b)  where they are", color=INK)
    resonances.ticklabel_format(axis="x", style="sci", scilimits=(0, 0))
    families.set_xlabel(f"{along} $-$ its value there")
    resonances.set_ylabel(f"{along} $-$ its value there")
    legend_row(figure, [*lines, curve], 0.06)
    return figure
