"""How near to the smaller primary the orbits of a traced family come, and which of them hit it. Numerical."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, NullFormatter

from orbitproof.explore.three_body.catalogues.distances import PARTS, distances_from_primaries
from orbitproof.figures.model import SampledFamily
from orbitproof.figures.orbits import state_on_fixed_set
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE
from orbitproof.shared.systems import UNITS

_WIDTH = 7.2
_BODY = "#d9d9d9"
_AROUND = 1.3
"""The picture reaches so much farther than the distances, as a factor."""


def draw_distances(family: SampledFamily) -> Figure:
    """Least and greatest distance from the smaller primary along a family of the CR3BP, and the surface of the body.

    With kilometres where the mass is that of a system of the catalogue; there it is marked which orbits hit the body.
    """
    mass = family.parameters["mu"]
    states = np.array([state_on_fixed_set(family.system, family.parameters, point) for point in family.points])
    found = distances_from_primaries(states, family.periods / 2, float(mass), 2 * PARTS)
    figure, axes = plt.subplots(figsize=(_WIDTH, 3.4))
    figure.subplots_adjust(left=0.1, right=0.89, top=0.88, bottom=0.3)
    axes.plot(family.arclength, found.greatest, color=SECOND_CURVE)
    axes.plot(family.arclength, found.least, color=CURVE)
    axes.set_yscale("log")
    low, high = float(np.nanmin(found.least)), float(np.nanmax(found.greatest))
    handles = [
        Line2D([], [], color=SECOND_CURVE, label="greatest"),
        Line2D([], [], color=CURVE, label="least"),
    ]
    units = UNITS.get(mass)
    if units is not None:
        radius = units.radius / units.length
        low = min(low, radius)
        axes.axhspan(low / _AROUND**2, radius, color=_BODY, linewidth=0, zorder=0)
        hits = found.least < radius
        handles.append(Patch(facecolor=_BODY, label=f"inside the body, radius {units.radius:g} km"))
        if hits.any():
            style = {"color": INK, "marker": "x", "markersize": 2.5, "linestyle": "none"}
            axes.plot(family.arclength[hits], found.least[hits], **style)
            handles.append(Line2D([], [], label=f"hits it: {hits.sum()} of {len(hits)} orbits", **style))
        length = units.length
        other = axes.secondary_yaxis("right", functions=(lambda value: value * length, lambda value: value / length))
        other.set_ylabel(f"km  ({units.name})")
        other.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
        other.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(low / _AROUND, high * _AROUND)
    axes.set_xlabel("arclength along the family  (nondimensional)")
    axes.set_ylabel("distance  (nondimensional)")
    axes.set_title(f"Distance from the smaller primary, {family.title}", color=INK)
    legend_row(figure, handles, 0.22)
    figure.text(0.5, 0.02, "double precision, nothing proved", ha="center", fontsize=7, color=INK)
    return figure
