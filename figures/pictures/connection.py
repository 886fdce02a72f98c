"""A homoclinic orbit from its periodic orbit and back, the cone at it, and the manifolds where they cross."""

from __future__ import annotations

from math import log10

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.orbits import Array, Connection, connection_of
from orbitproof.figures.pictures.periodic_orbit import DOT
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, is_built_in, label_of
from orbitproof.shared.claims import HomoclinicOrbit

_SIZE = (7.2, 3.1)
_STABLE = "#b2182b"
_CONE = "#c6d7e6"
_INSET = (0.32, 0.4)
_PLACES = ((0.67, 0.6), (0.02, 0.6), (0.34, 0.55), (0.34, 0.05), (0.34, 0.3))
"""Where the inset may be, in parts of the picture; it is where it hides least."""
_AXIS = 50
_SMALL = 0.25
"""A periodic orbit that is smaller, as a part of the homoclinic one, is drawn once more, magnified."""


def draw_connection(claim: HomoclinicOrbit, certified: bool = False) -> Figure:
    """The orbits of a claim in two coordinates, its cone and sliver, and the manifolds where they meet.

    Orbits and manifolds are numerical; the cone is that of the claim.

    Arguments:
        certified: whether a certificate encloses the point on Fix(R), which is filled then.

    Raises `OrbitNotClosed`.
    """
    found, system = connection_of(claim), claim.system
    figure = plt.figure(figsize=_SIZE)
    grid = figure.add_gridspec(1, 3, left=0.075, right=0.99, top=0.92, bottom=0.29, wspace=0.42, width_ratios=(3, 2, 2))
    axes = figure.add_subplot(grid[0, 0])
    first, second = 0, 1
    axes.plot(found.orbit[:, first], found.orbit[:, second], color=CURVE, linewidth=0.9, label="homoclinic orbit")
    axes.plot(found.periodic[:, first], found.periodic[:, second], color=INK, linewidth=1.6, label="periodic orbit")
    _point(axes, found.meeting[[first, second]], certified)
    if is_built_in(system) and "mu" in claim.parameters and system.state[:2] == ("x", "y"):
        mu = float(claim.parameters["mu"])
        axes.plot([-mu, 1 - mu], [0.0, 0.0], color=INK, linestyle="none", marker="x", markersize=5, label="primaries")
        axes.set_aspect("equal", adjustable="datalim")
    if np.ptp(found.periodic[:, :2], axis=0).max() < _SMALL * np.ptp(found.orbit[:, :2], axis=0).max():
        _magnified(axes, found, first, second)
    cone = figure.add_subplot(grid[0, 1])
    _draw_cone(cone, claim)
    section = figure.add_subplot(grid[0, 2])
    p, q = (system.state.index(name) for name in (claim.along, claim.across))
    unstable = found.unstable[:, [p, q]]
    section.plot(*unstable.T, color=CURVE, linestyle=(0, (6, 2)), linewidth=1.3, label="unstable manifold")
    section.plot(unstable[:, 0], -unstable[:, 1], color=_STABLE, linewidth=1.3, label="stable manifold")
    section.axhline(0.0, color=SECOND_CURVE, linewidth=0.8, linestyle=(0, (4, 3)), label="Fix(R)")
    _point(section, found.meeting[[p, q]], certified)
    for panel, (across, up) in ((axes, (first, second)), (section, (p, q))):
        panel.set_xlabel(label_of(system, system.state[across]))
        panel.set_ylabel(label_of(system, system.state[up]))
        panel.xaxis.set_major_locator(MaxNLocator(4))
    for letter, panel in zip("abc", (axes, cone, section), strict=True):
        panel.set_title(f"({letter})", loc="left", fontsize="medium")
    known = {str(line.get_label()): line for panel in figure.axes for line in panel.get_lines()}
    known = {label: line for label, line in known.items() if not label.startswith("_")}
    figure.legend(list(known.values()), list(known), loc="lower center", ncols=5, frameon=False)
    return figure


def _magnified(axes: Axes, found: Connection, first: int, second: int) -> None:
    """The periodic orbit once more, inside the picture."""
    low, high = found.orbit[:, :2].min(axis=0), found.orbit[:, :2].max(axis=0)
    # The primaries are on the axis: what hides its middle counts as well.
    parts = np.vstack([(found.orbit[:, :2] - low) / (high - low), np.tile([0.6, 0.5], (_AXIS, 1))])
    size = np.array(_INSET)
    place = min(_PLACES, key=lambda at: int(np.all((parts > at) & (parts < at + size), axis=1).sum()))
    inset = axes.inset_axes((*place, *_INSET), aspect="equal")
    inset.plot(found.orbit[:, first], found.orbit[:, second], color=CURVE, linewidth=0.7)
    inset.plot(found.periodic[:, first], found.periodic[:, second], color=INK, linewidth=1.2)
    low, high = found.periodic[:, [first, second]].min(axis=0), found.periodic[:, [first, second]].max(axis=0)
    middle, reach = (low + high) / 2, 0.75 * (high - low).max()
    (left, right), (bottom, top) = ((x - reach, x + reach) for x in middle)
    inset.set(xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[])
    inset.spines[:].set_visible(True)
    axes.indicate_inset_zoom(inset, edgecolor=INK, linewidth=0.6)


def _draw_cone(axes: Axes, claim: HomoclinicOrbit) -> None:
    """The box of a claim in its coordinates: the cone that contains the unstable manifold, and where it is left."""
    radius, cone = float(claim.radii[0]), float(claim.cone)
    at = float(claim.centre[1]) / radius
    axes.fill([-1, 0, -1], [-1, 0, 1], color=_CONE, linewidth=0)
    axes.fill([1, 0, 1], [-1, 0, 1], color=_CONE, linewidth=0)
    axes.plot([at, at], [-2 * abs(at), 2 * abs(at)], color=SECOND_CURVE, linewidth=1.6, label="sliver")
    axes.plot([], [], color=_CONE, linestyle="none", marker="s", markersize=7, label="cone")
    axes.plot([0.0], [0.0], color=INK, linestyle="none", marker=".", markersize=4, label="_")
    axes.set(xlim=(-1, 1), ylim=(-2, 2))
    axes.set_xlabel(f"$a$  ({_short(radius)})")
    axes.set_ylabel(f"$s$  ({_short(radius * cone)})")


def _short(value: float) -> str:
    """A positive number with two digits, as a formula."""
    exponent = int(np.floor(log10(value)))
    return rf"in ${value / 10.0**exponent:.1f} \cdot 10^{{{exponent}}}$"


def _point(axes: Axes, place: Array, certified: bool) -> None:
    label = "in Fix(R), enclosed" if certified else "in Fix(R), numerical"
    face = INK if certified else "white"
    axes.plot(*place, color=INK, markerfacecolor=face, label=label, clip_on=False, **DOT)
