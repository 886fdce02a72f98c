"""One certified orbit, integrated in double precision from its certificate, with what is proved of it marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from flint import arb
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from orbitproof.explore.orbits import PeriodicSolution
from orbitproof.figures.orbits import Array
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, unit_of
from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import completed
from orbitproof.verify.orbit import OrbitResults
from orbitproof.verify.reversor_breaking import BreakingResults

_WIDTH = 7.2
_SAMPLES = 4000
_DOT: Mapping[str, Any] = {"linestyle": "none", "markersize": 5.0, "zorder": 4}
_RING: Mapping[str, Any] = {"markerfacecolor": "none", "markersize": 9.0}


def draw_orbit(candidate: Candidate, found: OrbitResults) -> Figure:
    """The orbit from two sides, or in time, with its points on Fix(R) and those of extremal distance."""
    solution = solution_of(candidate, found)
    figure = plt.figure(figsize=(_WIDTH, 3.5))
    grid = figure.add_gridspec(1, 2, left=0.1, right=0.985, top=0.97, bottom=0.3, wspace=0.28)
    panels = [figure.add_subplot(grid[0, column]) for column in (0, 1)]
    names = list(candidate.system.state)
    times = np.linspace(0.0, solution.period, _SAMPLES)
    states = solution.states(times)
    if _is_in_space(names, states):
        pairs: Sequence[tuple[int | None, int]] = [(names.index(name), names.index("z")) for name in ("x", "y")]
    else:
        pairs = [(0, 1), (None, 0)]
    marks = _marks(solution, found)
    for axes, (first, second) in zip(panels, pairs, strict=True):

        def across(states: Array, times: Array, first: int | None = first) -> Array:
            return times if first is None else states[:, first]

        axes.plot(across(states, times), states[:, second], color=CURVE, linewidth=1.2)
        for label, (marker, colour, when) in marks.items():
            there = solution.states(when)
            style = {**_DOT, **(_RING if colour == SECOND_CURVE else {})}
            axes.plot(across(there, when), there[:, second], marker=marker, color=colour, label=label, **style)
        axes.set_xlabel(
            f"time{unit_of(candidate.system)}" if first is None else label_of(candidate.system, names[first])
        )
        axes.set_ylabel(label_of(candidate.system, names[second]))
        if first is not None and names[second] in ("y", "z"):
            axes.set_aspect("equal", adjustable="datalim")
        _body(axes, candidate, first, states)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncols=3, frameon=False)
    return figure


def solution_of(candidate: Candidate, found: OrbitResults | BreakingResults) -> PeriodicSolution:
    """The orbit through the middle of its enclosures."""
    system = candidate.system
    point = {name: float(ball.mid()) for name, ball in found.point.items()}
    parameters = {name: float(value) for name, value in candidate.parameters.items()} | point
    state = np.zeros(len(system.state))
    for index in system.fixed_coordinates:
        state[index] = point[system.state[index]]
    values = [parameters[name] for name in system.parameters]
    start = np.array(completed(system, state.tolist(), values))
    return PeriodicSolution.symmetric(system, values, start, float(found.period.mid()))


def _is_in_space(names: Sequence[str], states: Array) -> bool:
    return {"x", "y", "z"} <= set(names) and bool(np.abs(states[:, names.index("z")]).max() > 0)


def _marks(solution: PeriodicSolution, found: OrbitResults) -> dict[str, tuple[str, str, Array]]:
    """What is marked, by its label: marker, colour, times."""
    half = float(found.half_period.mid())
    marks = {"$x$, start": ("o", INK, np.array([0.0])), "$P(x)$, half a period later": ("s", INK, np.array([half]))}
    extrema = [("least", "v", found.least), ("greatest", "^", found.greatest)]
    for word, marker, extremum in extrema:
        if extremum is not None:
            once = _floats(extremum.times)
            # Extremal distances are taken at the image under R as well.
            times = np.unique(np.concatenate([once, (solution.period - once) % solution.period]))
            marks[f"{word} distance from {found.distance_name}"] = (marker, SECOND_CURVE, times)
    return marks


def _floats(times: Sequence[arb]) -> Array:
    return np.array([float(time.mid()) for time in times])


def _body(axes: Axes, candidate: Candidate, across: int | None, states: Array) -> None:
    """The smaller primary of the CR3BP, seen along with a coordinate, where it is close to the orbit."""
    if candidate.system.state[:3] != ("x", "y", "z") or "mu" not in candidate.parameters or across is None:
        return
    place = np.array([1.0 - float(candidate.parameters["mu"]), 0.0, 0.0])
    space = states[:, :3]
    size = float(np.ptp(space, axis=0).max())
    if np.all(space.min(axis=0) - size < place) and np.all(place < space.max(axis=0) + size):
        axes.plot([place[across]], [0.0], marker="x", color=INK, label="smaller primary", **_DOT)
