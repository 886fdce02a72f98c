"""Where R is lost, from a certificate: the levels of the new orbits to leading order, and the orbit there."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.pictures.certified_orbit import solution_of
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.marks import draw_point
from orbitproof.figures.style import CURVE, INK, label_of, marker_of
from orbitproof.shared.formats import Candidate
from orbitproof.verify.reversor_breaking import BreakingResults

_WIDTH = 7.2
_FARTHEST = 0.01
"""Largest amplitude y that is drawn."""
_SAMPLES = 2000


def draw_reversor_breaking(candidate: Candidate, found: BreakingResults) -> Figure:
    """(a) h - h* = kappa y^2, between the ends of kappa's enclosure, and the family; (b) the orbit of the point."""
    system = candidate.system
    figure = plt.figure(figsize=(_WIDTH, 3.2))
    grid = figure.add_gridspec(1, 2, left=0.14, right=0.98, top=0.86, bottom=0.27, wspace=0.32)
    diagram, orbit = (figure.add_subplot(grid[0, column]) for column in (0, 1))
    colour = marker_of(candidate.k, candidate.kind)[1]
    y = np.linspace(-_FARTHEST, _FARTHEST, 201)
    low, high = float(found.opening.lower()), float(found.opening.upper())
    diagram.fill_between(y, low * y**2, high * y**2, color=colour, alpha=0.3, linewidth=0)
    (new,) = diagram.plot(y, (low + high) / 2 * y**2, color=colour, label="new orbits, to leading order")
    reach = max(abs(low), abs(high)) * _FARTHEST**2
    (family,) = diagram.plot([0.0, 0.0], [-reach, reach], color=CURVE, label="symmetric orbits")
    draw_point(diagram, (0.0, 0.0), candidate.k, True, candidate.id, candidate.kind)
    name = system.family_parameter or system.first_integral_name or "first integral"
    diagram.set_xlabel("y, along w from Fix($R$)")
    diagram.set_ylabel(f"{name} $-$ its value there")
    diagram.xaxis.set_major_locator(MaxNLocator(5))
    diagram.set_title("(a)  what is born", color=INK)
    solution = solution_of(candidate, found)
    states = solution.states(np.linspace(0.0, solution.period, _SAMPLES))
    first, second = np.argsort(-np.ptp(states[:, : len(system.given_state)], axis=0), kind="stable")[:2]
    if {"x", "y", "z"} <= set(system.state):
        first, second = (system.state.index(each) for each in "yz")
        orbit.set_aspect("equal", adjustable="datalim")
    orbit.plot(states[:, first], states[:, second], color=CURVE)
    ends = solution.states(np.array([0.0, solution.period / 2]))
    (dots,) = orbit.plot(ends[:, first], ends[:, second], color=INK, marker=".", linestyle="none", label="on Fix($R$)")
    orbit.set_xlabel(label_of(system, system.state[first]))
    orbit.set_ylabel(label_of(system, system.state[second]))
    orbit.set_title("(b)  the orbit there", color=INK)
    legend_row(figure, [family, new, dots], 0.06)
    return figure
