"""The section through a certified orbit that is stable for ever, with orbits of the return map about it."""

from __future__ import annotations

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from orbitproof.figures.orbits import section_iterates
from orbitproof.figures.style import CURVE, INK, label_of
from orbitproof.shared.formats import Candidate
from orbitproof.verify.twist import StableOrbitResults

_SIZE = (4.6, 4.2)


def draw_section(candidate: Candidate, found: StableOrbitResults) -> Figure:
    """Orbits of the return map on the level, numerical, and the certified fixed point, filled.

    Raises `OrbitNotClosed`.
    """
    rows = section_iterates(candidate, found)
    figure = plt.figure(figsize=_SIZE)
    axes = figure.add_axes((0.18, 0.22, 0.78, 0.75))
    for number, points in enumerate(rows):
        label = "orbits of the return map, numerical" if number == 0 else None
        axes.plot(*points.T, linestyle="none", marker=".", markersize=1.6, color=CURVE, label=label)
    centre = float(found.point[found.twist_coordinate].mid())
    axes.plot(centre, 0.0, linestyle="none", marker="P", markersize=7, color=INK, label="certified orbit", zorder=4)
    axes.set_xlabel(label_of(candidate.system, found.twist_coordinate))
    axes.set_ylabel(label_of(candidate.system, found.twist_momentum))
    axes.ticklabel_format(useOffset=False)
    figure.legend(loc="lower center", ncols=2, frameon=False, markerscale=1.0)
    return figure
