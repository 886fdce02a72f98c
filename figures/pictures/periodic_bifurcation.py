"""A bifurcation of periodic orbits without symmetry: the orbit there, and beside it what is born, numerically.

Nothing but the marked point and the value at which it is comes from a certificate; orbits and tori beside it are
computed in double precision, on the side that the certificate states.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orbitproof.figures.orbits import (
    NewOrbits,
    OrbitNotClosed,
    ReturningOrbit,
    TorusPoints,
    new_orbits,
    orbit_over,
    returning_orbit,
    torus_points,
)
from orbitproof.figures.pictures.periodic_orbit import DOT, Pair, coordinates_of, label_axes, pairs_of, show_section
from orbitproof.figures.style import CURVE, INK, symbol
from orbitproof.shared.formats import (
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    PeriodicBifurcation,
)
from orbitproof.shared.systems import shown
from orbitproof.verify.periodic_bifurcation import PeriodicBifurcationResults, TorusResults

_SIZE = (7.2, 3.9)
_SAID = {
    PERIODIC_FOLD: "fold",
    PERIODIC_DOUBLING: "period doubling",
    PERIODIC_PITCHFORK: "pitchfork",
    PERIODIC_TORUS: "Neimark-Sacker bifurcation",
}
_SHADES = ("#b2182b", "#e08214")
_ROUNDS = 24
"""How often an orbit on a torus goes around in a picture."""

Results = PeriodicBifurcationResults | TorusResults


@dataclass(frozen=True)
class BifurcationPicture:
    """A bifurcation as it is drawn.

    Attributes:
        figure: with two panels.
        beside: what is drawn beside the orbit, in words with the value of what varies, or why nothing is.
        is_complete: whether something is.
    """

    figure: Figure
    beside: str
    is_complete: bool


def draw_periodic_bifurcation(claim: PeriodicBifurcation, found: Results | None = None) -> BifurcationPicture:
    """The orbit of a claim and what is born there, its point filled where a certificate encloses it.

    Arguments:
        found: the results of a certificate that says "proved".

    Raises `OrbitNotClosed` if the orbit itself cannot be drawn.
    """
    values, start = [float(value) for value in claim.values], [float(value) for value in claim.centre]
    if found is not None:
        start = [float(found.point[name].mid()) for name in claim.system.state]
        if claim.parameter is not None:
            values[list(claim.system.parameters).index(claim.parameter)] = float(found.parameter.mid())
    orbit = _orbit(claim, start, values)
    figure = plt.figure(figsize=_SIZE)
    try:
        if claim.is_torus:
            beside, reason = _torus(claim, orbit, values, found), ""
        else:
            beside, reason = new_orbits(claim, orbit, values, None if found is None else found.side), ""
    except OrbitNotClosed as error:
        beside, reason = None, str(error)
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.985, top=0.9, bottom=0.26, wspace=0.28)
    panels = [figure.add_subplot(grid[0, column]) for column in (0, 1)]
    more = [each.states for each in beside.orbits] if isinstance(beside, NewOrbits) else []
    pairs = pairs_of(np.vstack([orbit.states, *more]))
    at = _at(claim, _value(claim, values, found), None if beside is None else beside.value)
    near = "" if beside is None else _at(claim, beside.value, _value(claim, values, found))
    plain = near if claim.parameter is None else f"{claim.parameter} = {near.partition(' = ')[2]}"
    if isinstance(beside, TorusPoints):
        _torus_panels(panels, claim, orbit, beside, pairs[0], near)
        backwards = ", against the flow" if beside.backwards else ""
        said = (
            f"at {plain} points of the map of the section after {beside.iterations} iterations{backwards}, and an "
            "orbit from one of them"
        )
    else:
        for axes, pair in zip(panels, pairs, strict=False):
            _curves(axes, claim, orbit, beside, pair, near)
        said = reason
        if beside is not None:
            said = f"at {plain} {'an orbit' if len(beside.orbits) == 1 else 'two orbits'} beside it"
    for axes, pair in zip(panels, pairs, strict=False):
        if isinstance(beside, TorusPoints) and axes is panels[1]:
            pair = _section_pair(claim, beside)
        point = coordinates_of(orbit.times[:1], orbit.states[:1], pair)
        axes.plot(
            *point, color=INK, markerfacecolor="white" if found is None else INK, clip_on=False,
            label="the point, numerical" if found is None else "the point, enclosed", **DOT,
        )  # fmt: skip
        label_axes(axes, claim, pair)
        axes.locator_params(axis="x", nbins=6)
    if len(pairs) == 1 and not isinstance(beside, TorusPoints):
        panels[1].remove()
    known = {str(line.get_label()): line for axes in figure.axes for line in axes.get_lines()}
    shown_ones = {name: line for name, line in known.items() if not name.startswith("_")}
    figure.legend(list(shown_ones.values()), list(shown_ones), loc="lower center", ncols=2, frameon=False)
    head = f"{shown(claim.system.name)}: {_SAID[claim.kind]} at {at}{'' if found else ', numerical'}"
    figure.text(0.1, 0.955, head, color=INK, fontweight="bold", va="center", fontsize=8)
    if reason:
        figure.text(0.985, 0.955, "nothing is drawn beside it", color=INK, va="center", ha="right", fontsize=7)
    return BifurcationPicture(figure, said, beside is not None)


def _orbit(claim: PeriodicBifurcation, start: list[float], values: list[float]) -> ReturningOrbit:
    """Over its least period: at a pitchfork twice as many crossings if S moves it by half of it."""
    try:
        return returning_orbit(claim, start, values=values)
    except OrbitNotClosed:
        if not claim.is_mirrored:
            raise
        return returning_orbit(claim, start, 2 * claim.crossings, values)


def _torus(
    claim: PeriodicBifurcation, orbit: ReturningOrbit, values: list[float], found: Results | None
) -> TorusPoints:
    if found is None or not claim.is_torus:
        raise OrbitNotClosed("a torus is drawn of a certificate that says where it is")
    others = found.multipliers
    against = found.criticality == "subcritical"
    if others.undecided or (others.inside if against else others.outside):
        raise OrbitNotClosed("the torus attracts neither with the flow nor against it, so iterating does not find it")
    return torus_points(claim, orbit, values, float(found.speed.mid()), float(found.lyapunov.mid()))


def _value(claim: PeriodicBifurcation, values: list[float], found: Results | None) -> float:
    """Value at the bifurcation of what varies."""
    if found is not None:
        return float(found.parameter.mid())
    if claim.parameter is not None:
        return values[list(claim.system.parameters).index(claim.parameter)]
    assert claim.level is not None
    return float(claim.level)


def _at(claim: PeriodicBifurcation, value: float, other: float | None) -> str:
    """What varies and its value, with as many digits as tell it from another one."""
    apart = 0.0 if other is None else abs(value - other)
    # Four digits of the difference, so that a value next to 0 is 0.
    places = 3 - int(np.floor(np.log10(apart))) if apart else 8
    name = claim.system.first_integral_name or "first integral"
    digits = max(6, places + 4)
    told = name if claim.parameter is None else f"${symbol(claim.parameter)}$"
    return f"{told} = {round(value, places) + 0.0:.{digits}g}"


def _curves(
    axes: Axes, claim: PeriodicBifurcation, orbit: ReturningOrbit, beside: NewOrbits | None, pair: Pair, near: str
) -> None:
    for number, each in enumerate(() if beside is None else beside.orbits):
        which = "" if beside is None or len(beside.orbits) == 1 else ("first ", "second ")[number]
        _line(axes, each, pair, _SHADES[number], 1.0, f"{which or 'new '}orbit at {near}, numerical", zorder=2.5)
        if pair[0] is not None:
            others = each.crossings
            axes.plot(
                *coordinates_of(np.zeros(len(others)), others, pair), linestyle="none", marker="o", markersize=3.0,
                color=_SHADES[number], markerfacecolor="white", zorder=3.5,
            )  # fmt: skip
    _line(axes, orbit, pair, CURVE, 1.3, "orbit at the bifurcation, in double precision", zorder=2.6)
    axes.autoscale_view()
    axes.autoscale(False)
    show_section(axes, claim, pair)


def _line(axes: Axes, orbit: ReturningOrbit, pair: Pair, colour: str, width: float, label: str, **more: Any) -> None:
    axes.plot(*coordinates_of(orbit.times, orbit.states, pair), color=colour, linewidth=width, label=label, **more)


def _torus_panels(
    panels: list[Axes], claim: PeriodicBifurcation, orbit: ReturningOrbit, torus: TorusPoints, pair: Pair, near: str
) -> None:
    """(a) the orbit, with one on the torus around it; (b) the section."""
    left, right = panels
    times, states = orbit_over(claim, torus.states[0], torus.values, _ROUNDS * torus.time, 160 * _ROUNDS)
    left.plot(
        *coordinates_of(times, states, pair), color=_SHADES[1], linewidth=0.4, zorder=1.8,
        label=f"an orbit at {near}, numerical",
    )  # fmt: skip
    _line(left, orbit, pair, CURVE, 1.3, "orbit at the bifurcation, in double precision", zorder=2.6)
    left.autoscale_view()
    left.autoscale(False)
    show_section(left, claim, pair)
    inside = _section_pair(claim, torus)
    right.plot(
        *coordinates_of(np.zeros(len(torus.states)), torus.states, inside), linestyle="none", marker=".",
        markersize=2.5, color=_SHADES[0], label=f"iterates on the section at {near}, numerical",
    )  # fmt: skip
    right.set_title("on the section", color=INK, fontsize=8)


def _section_pair(claim: PeriodicBifurcation, torus: TorusPoints) -> Pair:
    """The two coordinates that vary most on the section, in their order."""
    widths = np.ptp(torus.states, axis=0)
    first, second = sorted(int(i) for i in np.argsort(-widths, kind="stable")[:2])
    return first, second
