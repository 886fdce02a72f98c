"""Bifurcating branches: the family with all of them, and each one with its new orbits.

Everything is drawn from branch files and family files; the pieces of an orbit between its crossings of the
section are integrated from the states in the file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.explore.branches import BranchRecord, read_branches
from orbitproof.figures.files import check_folder, save
from orbitproof.figures.model import SampledFamily, read_families
from orbitproof.figures.orbits import Array, OrbitNotClosed, loop_through, orbit_through, state_on_fixed_set
from orbitproof.figures.pictures.branch_curves import (
    curve_of,
    is_certified,
    nearest_curve,
    origin_of,
    shown_orbit,
    widest_coordinate,
)
from orbitproof.figures.pictures.family import parameter_scale
from orbitproof.figures.pictures.legends import legend_below, legend_handles, legend_row, verdict_handles
from orbitproof.figures.pictures.marks import draw_point
from orbitproof.figures.pictures.space import bounds_of, set_box
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of, level_label, marker_of, use_style

_WIDTH = 7.2
_NEAR = 1e-2
_BASE = "#8a8a8a"
_HYPERBOLIC = (0, (3, 1.6))
_IMAGE = (0, (1, 1.2))


def write(branches: Path, families: Sequence[Path], folder: Path) -> list[Path]:
    """Write a picture of each family with its branches, and one of each branch, as PDF and PNG.

    Raises `InputError` for bad files.
    """
    records = read_branches(branches)
    traced = [family.refined() for path in families for family in read_families(path)]
    members = [[record for record in records if distance(family, record) < _NEAR] for family in traced]
    check_folder(folder)
    written: list[Path] = []
    with use_style():
        for family, own in zip(traced, members, strict=True):
            if any(record.sides for record in own):
                figure = draw_overview(family, own)
                written += save(figure, folder / _name(f"branches-{family.system.name}-{family.name}"))
        for record in records:
            if record.sides:
                figure = draw_branch(record, _family_of(record, traced))
                written += save(figure, folder / _name(f"branch-{record.system.name}-{record.id}"))
    return written


def draw_overview(family: SampledFamily, branches: Sequence[BranchRecord]) -> Figure:
    """A family with all its branches.

    On energy levels: the first integral against a coordinate of Fix(R), and Fix(R). With a family parameter: the
    two points on Fix(R) against it.
    """
    names = family.system.centre_coordinates
    figure = plt.figure(figsize=(_WIDTH, 3.5))
    grid = figure.add_gridspec(1, 2, left=0.085, right=0.975, top=0.92, bottom=0.265, wspace=0.26)
    left, right = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    if family.system.family_parameter is None:
        left.plot(family.second_points[:, 1], family.levels, color=SECOND_CURVE, lw=1.0)
        left.plot(family.points[:, 1], family.levels, color=CURVE, lw=1.0)
        right.plot(*family.second_points[:, :2].T, color=SECOND_CURVE, lw=1.0)
        right.plot(*family.points[:, :2].T, color=CURVE, lw=1.0)
        for branch in branches:
            _add(left, branch, lambda points, levels: (points[:, 1], levels))
            _add(right, branch, lambda points, levels: (points[:, 0], points[:, 1]))
        left.set_xlabel(label_of(family.system, names[1]))
        left.set_ylabel(level_label(family.system))
        right.set_xlabel(label_of(family.system, names[0]))
        right.set_ylabel(label_of(family.system, names[1]))
        titles = ("bifurcation parameter", "where the orbits start on Fix($R$)")
    else:
        for axes, curve, colour in ((left, family.points, CURVE), (right, family.second_points, SECOND_CURVE)):
            axes.plot(curve[:, 0], curve[:, 1], color=colour, lw=1.0)
            for branch in branches:
                if nearest_curve(family, branch)[0] is curve:
                    _add(axes, branch, lambda points, levels: (levels, points[:, 1]))
            axes.set_xlabel(level_label(family.system))
            axes.set_ylabel(label_of(family.system, names[1]))
            parameter_scale(axes, curve[:, 0])
        titles = ("starting points on Fix($R$)", "the other points on Fix($R$)")
    for axes, letter, title in ((left, "a", titles[0]), (right, "b", titles[1])):
        if family.system.family_parameter is None:
            axes.margins(x=0.06)
        axes.margins(y=0.06)
        axes.set_title(f"({letter})  {title}", color=INK)
    _legend(figure, branches)
    return figure


def _add(axes: Axes, branch: BranchRecord, select: Callable[[Array, Array], tuple[Array, Array]]) -> None:
    """Draw a branch and its bifurcation point; `select` takes points and levels to what is plotted."""
    if branch.sides:
        curve = curve_of(branch)
        axes.plot(
            *select(curve.points, branch.level + curve.differences), color=marker_of(branch.k, branch.kind)[1], lw=1.2
        )
    place = select(branch.point[None], np.array([branch.level]))
    draw_point(axes, [float(value[0]) for value in place], branch.k, is_certified(branch), branch.id, branch.kind)


def draw_branch(branch: BranchRecord, family: SampledFamily | None) -> Figure:
    """One branch: bifurcation diagram, starting points, and a new orbit beside the resonant one."""
    spatial = branch.system.family_parameter is None
    figure = plt.figure(figsize=(_WIDTH, 3.1))
    grid = figure.add_gridspec(1, 3, left=0.105, right=0.985, top=0.9, bottom=0.29, wspace=0.52)
    _diagram(figure.add_subplot(grid[0, 0]), branch, family)
    if branch.loses_reversor:
        _beside(figure.add_subplot(grid[0, 1]), branch, family)
    elif spatial:
        _starts(figure.add_subplot(grid[0, 1]), branch, family)
    else:
        _section(figure.add_subplot(grid[0, 1]), branch)
    if spatial:
        axes = figure.add_axes((0.66, 0.235, 0.31, 0.69), projection="3d", computed_zorder=False)
    else:
        axes = figure.add_subplot(grid[0, 2])
    _orbits(axes, branch, 3 if spatial else 2)
    top = figure.axes[0].get_position().y1 + 3.4 / (72 * figure.get_figheight())
    title = "(c)  two new orbits" if branch.loses_reversor else "(c)  a new orbit"
    figure.text(0.69 if spatial else axes.get_position().x0, top, title, fontsize=8.5, color=INK, va="bottom")
    _branch_legend(figure, branch, family is not None)
    return figure


def _diagram(axes: Axes, branch: BranchRecord, family: SampledFamily | None) -> None:
    """Bifurcation parameter against the coordinate of the start that changes most along the branch.

    Where R is lost that is one that R negates; it is 0 on the family.
    """
    system, loop = branch.system, branch.loses_reversor
    place = widest_coordinate(branch, system.kernel_coordinates if loop else system.fixed_coordinates)
    colour = marker_of(branch.k, branch.kind)[1]
    curve = curve_of(branch)
    x, y = curve.starts[:, place], curve.differences
    _new_orbits(axes, x, y, curve.elliptic, colour)
    if family is not None:
        points, levels = nearest_curve(family, branch)
        column = 0 * levels if loop else points[:, system.centre_coordinates.index(system.state[place])]
        axes.plot(column, levels - branch.level, color=CURVE, linewidth=1.2, zorder=1.8, scalex=False, scaley=False)
    draw_point(axes, (float(origin_of(branch)[place]), 0.0), branch.k, is_certified(branch), branch.id, branch.kind)
    axes.set_xlabel(f"start {'beside' if loop else 'on'} Fix($R$): {label_of(system, system.state[place])}")
    name = system.family_parameter
    quantity = label_of(system, name, unit=False) if name else system.first_integral_name or "first integral"
    axes.set_ylabel(f"{quantity} ${'-' if branch.level > 0 else '+'}$ {abs(branch.level):.7g}")
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.set_title("(a)  bifurcation diagram", color=INK)


def _new_orbits(axes: Axes, x: Array, y: Array, elliptic: Array, colour: str) -> None:
    """The curve of new orbits, dashed where they are hyperbolic in the new pair of multipliers."""
    axes.plot(x, np.where(elliptic, np.nan, y), color=colour, linestyle=_HYPERBOLIC, linewidth=1.2)
    axes.plot(x, np.where(elliptic, y, np.nan), color=colour, linewidth=1.8)
    _limits(axes, x, y)


def _beside(axes: Axes, branch: BranchRecord, family: SampledFamily | None) -> None:
    """The section where R is lost: starts of new orbits beside Fix(R), where the symmetric ones start."""
    system, curve = branch.system, curve_of(branch)
    shown = [widest_coordinate(branch, each) for each in (system.fixed_coordinates, system.kernel_coordinates)]
    rows, last = curve.starts[:, shown], shown_orbit(branch).crossings[0][shown]
    _new_orbits(axes, *rows.T, curve.elliptic, marker_of(branch.k, branch.kind)[1])
    if family is not None:
        points, _ = nearest_curve(family, branch)
        column = points[:, system.centre_coordinates.index(system.state[shown[0]])]
        axes.plot(column, 0 * column, color=CURVE, linewidth=1.2, zorder=1.8, scalex=False, scaley=False)
    axes.plot([last[0]] * 2, [last[1], -last[1]], marker=".", color=INK, markersize=6, linestyle="none", zorder=5)
    draw_point(axes, (float(origin_of(branch)[shown[0]]), 0.0), branch.k, is_certified(branch), branch.id, branch.kind)
    axes.set_xlabel(label_of(system, system.state[shown[0]]))
    axes.set_ylabel(label_of(system, system.state[shown[1]]))
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.set_title("(b)  in the section", color=INK)


def _starts(axes: Axes, branch: BranchRecord, family: SampledFamily | None) -> None:
    """Fix(R): where new orbits start and where they are half a period later, near the point."""
    names = branch.system.centre_coordinates
    colour = marker_of(branch.k)[1]
    curve = curve_of(branch)
    rows = curve.points
    shown = (0, 1) if np.ptp(rows[:, 1]) >= 0.2 * np.ptp(rows[:, 2]) else (0, 2)
    _new_orbits(axes, rows[:, shown[0]], rows[:, shown[1]], curve.elliptic, colour)
    if family is not None:
        points, _ = nearest_curve(family, branch)
        axes.plot(
            points[:, shown[0]], points[:, shown[1]], color=CURVE, linewidth=1.2, zorder=1.8, scalex=False, scaley=False
        )
    orbit = shown_orbit(branch)
    ends = [orbit.point] + ([orbit.second_point] if branch.k % 2 == 0 else [])
    for end in ends:
        axes.plot(end[shown[0]], end[shown[1]], marker=".", color=INK, markersize=6, zorder=5)
    draw_point(
        axes, (float(branch.point[shown[0]]), float(branch.point[shown[1]])), branch.k, is_certified(branch), branch.id
    )
    axes.set_xlabel(label_of(branch.system, names[shown[0]]))
    axes.set_ylabel(label_of(branch.system, names[shown[1]]))
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.set_title("(b)  on Fix($R$)", color=INK)


def _section(axes: Axes, branch: BranchRecord) -> None:
    """The section near the point: crossings of new orbits, in the coordinates that are not the section's."""
    system = branch.system
    kept = [i for i in range(len(system.state)) if i != system.section_index][:2]
    signs = np.array(system.reversing_symmetry, dtype=float)
    colour = marker_of(branch.k)[1]
    centre = np.array(state_on_fixed_set(system, branch.parameters, list(branch.point)))[kept]
    for side in branch.sides:
        rows = []
        for orbit in side.orbits:
            ends = (orbit.point, orbit.second_point)
            first, last = (np.array(state_on_fixed_set(system, branch.parameters, list(end))) for end in ends)
            half = np.vstack([first[None], orbit.crossings, last[None]])
            # Every second crossing is near the point; the way back crosses at the images under R.
            near = list(half[::2]) + [state * signs for state in half[2::2]]
            rows.append(np.array(near)[:, kept])
        for index in range(len(rows[0])):
            axes.plot(*np.array([row[index] for row in rows]).T, color=colour, linewidth=1.2)
        if side is branch.sides[1]:
            axes.plot(*rows[-1].T, linestyle="none", marker=".", color=INK, markersize=6, zorder=5)
    axes.axvline(0.0, color=_BASE, linewidth=1.0, linestyle=(0, (1, 1.5)), zorder=1.8)
    axes.annotate(
        "Fix($R$)",
        (0.0, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(3, -2),
        textcoords="offset points",
        fontsize=7,
        color=INK,
        va="top",
    )
    draw_point(axes, [float(v) for v in centre], branch.k, is_certified(branch), branch.id)
    axes.set_xlabel(label_of(system, system.state[kept[0]]))
    axes.set_ylabel(label_of(system, system.state[kept[1]]))
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.margins(0.12)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    if right - left < 1e-9 * (high - low):
        # All points have the same first coordinate, but for rounding.
        middle, half = 0.5 * (left + right), 0.5 * (high - low)
        axes.set_xlim(middle - half, middle + half)
    axes.set_title("(b)  in the section", color=INK)


def _orbits(axes: Any, branch: BranchRecord, dimension: int) -> None:
    """The resonant orbit and the last new orbit, with the points in which they meet Fix(R)."""
    colour = marker_of(branch.k, branch.kind)[1]
    orbit = shown_orbit(branch)
    drawn = []
    none = np.zeros((0, len(branch.system.state)))
    signs = np.array(branch.system.reversing_symmetry, dtype=float)
    shapes: list[tuple[Callable[[], Array], dict[str, Any]]] = [
        (lambda: orbit_through(branch.system, branch.parameters, list(branch.point), none), {"color": _BASE, "lw": 1.6})
    ]
    if branch.loses_reversor:
        shapes += [
            (lambda: loop_through(branch.system, branch.parameters, list(orbit.point), orbit.crossings),
             {"color": colour, "lw": 0.9}),
            (lambda: signs * loop_through(branch.system, branch.parameters, list(orbit.point), orbit.crossings),
             {"color": colour, "lw": 0.9, "linestyle": _IMAGE}),
        ]  # fmt: skip
        marked = [sign * orbit.crossings[0] for sign in (1.0, signs)]
    else:
        shapes.append(
            (lambda: orbit_through(branch.system, branch.parameters, list(orbit.point), orbit.crossings),
             {"color": colour, "lw": 0.9})
        )  # fmt: skip
        ends = (orbit.point, orbit.second_point)
        marked = [np.array(state_on_fixed_set(branch.system, branch.parameters, list(end))) for end in ends]
    for shape, style in shapes:
        try:
            rows = shape()
        except OrbitNotClosed:
            continue
        axes.plot(*rows[:, :dimension].T, **style)
        drawn.append(rows)
    for state in marked:
        axes.plot(
            *[[value] for value in state[:dimension]], marker=".", color=INK, markersize=6, linestyle="none", zorder=7
        )
    if dimension == 3:
        low, high = bounds_of(drawn or [none + 1.0])
        set_box(axes, branch.system, low, high, zoom=0.8)
        return
    axes.set_xlabel(label_of(branch.system, branch.system.state[0]))
    axes.set_ylabel(label_of(branch.system, branch.system.state[1]))
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.margins(0.06)


def _branch_legend(figure: Figure, branch: BranchRecord, with_family: bool) -> None:
    colour, loop = marker_of(branch.k, branch.kind)[1], branch.loses_reversor
    base = "symmetric orbit" if loop else "resonant orbit"
    lines = [
        *([Line2D([], [], color=CURVE, linewidth=1.2, label="family")] if with_family else []),
        Line2D([], [], color=_BASE, linewidth=1.6, label=base),
        Line2D([], [], color=colour, linewidth=1.8, label="new orbits, elliptic in the new pair"),
        Line2D([], [], color=colour, linestyle=_HYPERBOLIC, linewidth=1.2, label="hyperbolic"),
    ]
    if loop:
        lines.append(Line2D([], [], color=colour, linestyle=_IMAGE, linewidth=0.9, label="mirror image"))
    where = "those of (c) there" if loop else "the orbit of (c) there"
    points = [
        *legend_handles([(branch.k, branch.kind)]),
        *verdict_handles([is_certified(branch)]),
        Line2D([], [], color=INK, marker=".", linestyle="none", markersize=6, label=where),
    ]
    for row, height in ((lines, 0.25), (points, 0.06)):
        legend_row(figure, row, height)


def _legend(figure: Figure, branches: Sequence[BranchRecord]) -> None:
    legend_below(figure, ((b.k, b.kind) for b in branches), [is_certified(b) for b in branches])


def _limits(axes: Axes, x: Array, y: Array) -> None:
    """Limits around a curve; what else is drawn is cut off there."""
    for values, set_limits in ((x, axes.set_xlim), (y, axes.set_ylim)):
        pad = 0.12 * max(float(np.ptp(values)), 1e-12)
        set_limits(float(values.min()) - pad, float(values.max()) + pad)


def _family_of(branch: BranchRecord, families: Sequence[SampledFamily]) -> SampledFamily | None:
    """The nearest family from which the branch may start; a broken symmetry is that of its orbits."""
    odd: list[int] = []
    if branch.symmetry is not None:
        signs = branch.system.symmetries[branch.symmetry]
        odd = [i for i, state in enumerate(branch.system.fixed_coordinates) if signs[state] == -1]
    fitting = [family for family in families if not np.any(family.points[:, odd])]
    nearest = min(fitting, key=lambda family: distance(family, branch), default=None)
    return nearest if nearest is not None and distance(nearest, branch) < _NEAR else None


def distance(family: SampledFamily, branch: BranchRecord) -> float:
    """Distance of the bifurcation point from the curves of a family, in units of the branch's `scale`."""
    if family.system.name != branch.system.name or dict(family.parameters) != dict(branch.parameters):
        return np.inf
    curve, _ = nearest_curve(family, branch)
    return float(np.linalg.norm((curve - branch.point) / branch.scale, axis=1).min())


def _name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9.]+", "-", text).strip("-.")
