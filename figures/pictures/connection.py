"""A homoclinic orbit from its periodic orbit and back, and the manifolds where they cross."""

from __future__ import annotations

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orbitproof.figures.orbits import Array, connection_of
from orbitproof.figures.pictures.periodic_orbit import DOT
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, is_built_in, label_of
from orbitproof.shared.claims import HomoclinicOrbit

_SIZE = (7.2, 3.7)
_STABLE = "#b2182b"


def draw_connection(claim: HomoclinicOrbit, certified: bool = False) -> Figure:
    """The orbits of a claim in two coordinates, and the manifolds in the section; all of it numerical.

    Arguments:
        certified: whether a certificate encloses the point on Fix(R), which is filled then.

    Raises `OrbitNotClosed`.
    """
    found, system = connection_of(claim), claim.system
    figure = plt.figure(figsize=_SIZE)
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.985, top=0.97, bottom=0.27, wspace=0.32)
    axes = figure.add_subplot(grid[0, 0])
    first, second = 0, 1
    axes.plot(found.orbit[:, first], found.orbit[:, second], color=CURVE, linewidth=0.9, label="homoclinic orbit")
    axes.plot(found.periodic[:, first], found.periodic[:, second], color=INK, linewidth=1.6, label="periodic orbit")
    _point(axes, found.meeting[[first, second]], certified)
    if is_built_in(system) and "mu" in claim.parameters and system.state[:2] == ("x", "y"):
        mu = float(claim.parameters["mu"])
        axes.plot([-mu, 1 - mu], [0.0, 0.0], color=INK, linestyle="none", marker="x", markersize=5, label="primaries")
        axes.set_aspect("equal", adjustable="datalim")
    section = figure.add_subplot(grid[0, 1])
    p, q = (system.state.index(name) for name in (claim.along, claim.across))
    unstable = found.unstable[:, [p, q]]
    section.plot(*unstable.T, color=CURVE, linestyle=(0, (6, 2)), linewidth=1.3, label="unstable manifold")
    section.plot(unstable[:, 0], -unstable[:, 1], color=_STABLE, linewidth=1.3, label="stable manifold")
    section.axhline(0.0, color=SECOND_CURVE, linewidth=0.8, linestyle=(0, (4, 3)), label="Fix(R)")
    _point(section, found.meeting[[p, q]], certified)
    for panel, (across, up) in ((axes, (first, second)), (section, (p, q))):
        panel.set_xlabel(label_of(system, system.state[across]))
        panel.set_ylabel(label_of(system, system.state[up]))
    known = {str(line.get_label()): line for panel in figure.axes for line in panel.get_lines()}
    figure.legend(list(known.values()), list(known), loc="lower center", ncols=4, frameon=False)
    return figure


def _point(axes: Axes, place: Array, certified: bool) -> None:
    label = "in Fix(R), enclosed" if certified else "in Fix(R), numerical"
    face = INK if certified else "white"
    axes.plot(*place, color=INK, markerfacecolor=face, label=label, clip_on=False, **DOT)
