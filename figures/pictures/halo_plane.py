"""Halo families in the (x, z) plane of Fix(R): the closed curves, and the families with their resonances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from orbitproof.figures.model import MarkedPoint, SampledFamily
from orbitproof.figures.orbits import Array
from orbitproof.figures.pictures.legends import legend_below, legend_height, legend_row
from orbitproof.figures.pictures.marks import draw_mark, show_around
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, label_of
from orbitproof.shared.systems import CR3BP, MASS_PARAMETERS

_WIDTH = 7.2
_SAME_ORBIT = 1e-3
_TOUCHING = 0.025
_WHERE = "at $z>0$: period tupling; at $z<0$: touch-and-go, and period tupling near the other crossing of Fix($R$)"
_FAMILY_COLOURS = {"L1": CURVE, "L2": "#b2182b", "L3": "#1b7837"}


@dataclass(frozen=True)
class Spot:
    """A bifurcation at the orbit's starting point on Fix(R).

    Attributes:
        position: (x, z) of the starting point.
        arclength: along the family.
        mark: the candidate with its verdict.
        elsewhere: whether the candidate speaks about the orbit's other point on Fix(R).
    """

    position: Array
    arclength: float
    mark: MarkedPoint
    elsewhere: bool


def spots_on(family: SampledFamily, marks: Sequence[MarkedPoint]) -> list[Spot]:
    """One spot for each orbit and multiplicity; of two candidates at one orbit the one at the starting point."""
    found: list[Spot] = []
    for placement in sorted((family.place(mark) for mark in marks), key=lambda item: item.second):
        k, s = placement.mark.k, placement.arclength
        if any(spot.mark.k == k and abs(spot.arclength - s) < _SAME_ORBIT for spot in found):
            continue
        if placement.second:
            position = np.array([np.interp(s, family.arclength, family.points[:, i]) for i in (0, 1)])
        else:
            position = placement.mark.point[:2]
        found.append(Spot(position, s, placement.mark, placement.second))
    return sorted(found, key=lambda spot: spot.arclength)


def mass_title(family: SampledFamily) -> str:
    """Earth-Moon, Sun-Jupiter, or the mass parameter."""
    for name, value in MASS_PARAMETERS.items():
        if family.parameters.get("mu") == value:
            return "-".join(part.capitalize() for part in name.split("-"))
    return f"$\\mu={float(family.parameters['mu']):.6g}$"


def family_title(family: SampledFamily) -> str:
    """For example southern L1 halo orbits, from the name of the family."""
    side = "" if family.branch is None else f"{family.branch}ern "
    parts = family.name.removesuffix(f"-{family.branch}").split("-")
    first = next((i for i, part in enumerate(parts) if part in ("L1", "L2", "L3")), None)
    if first is None:
        return f"{side}{family.name} orbits"
    return f"{side}$L_{parts[first][1]}$ {' '.join(parts[first + 1 :])} orbits"


def draw_closed_curves(families: Sequence[SampledFamily], marks: Sequence[Sequence[MarkedPoint]]) -> Figure:
    """Each family with its mirror image under S, a closed curve, and where S breaks (k = 1)."""
    figure = plt.figure(figsize=(_WIDTH, 4.5))
    grid = figure.add_gridspec(1, len(families), left=0.085, right=0.985, top=0.93, bottom=0.25, wspace=0.12)
    shown = []
    first: Axes | None = None
    for j, (family, own) in enumerate(zip(families, marks, strict=True)):
        axes = figure.add_subplot(grid[0, j], sharex=first, sharey=first)
        axes.plot(family.points[:, 0], family.points[:, 1], color=CURVE)
        axes.plot(family.points[:, 0], -family.points[:, 1], color=CURVE, linestyle=(0, (4, 1.5)))
        _primaries(axes, family)
        breakings = [spot for spot in spots_on(family, own) if spot.mark.candidate.breaks_symmetry]
        for spot in breakings:
            draw_mark(axes, spot.position, spot.mark)
        shown += [spot.mark for spot in breakings]
        axes.set_aspect("equal")
        axes.set_xlabel(label_of(CR3BP, "x"))
        if j == 0:
            axes.set_ylabel(label_of(CR3BP, "z"))
            first = axes
        else:
            axes.tick_params(labelleft=False)
        axes.set_title(f"({'abcdef'[j]})  {mass_title(family)}: {family_title(family)}", color=INK)
    lines = [
        Line2D([], [], color=CURVE, label="halo orbits on Fix($R$)"),
        Line2D([], [], color=CURVE, linestyle=(0, (4, 1.5)), label="their images under $S$"),
        _primary_handle(),
    ]
    _legend(figure, lines, shown)
    return figure


def draw_resonant_families(halos: Mapping[str, SampledFamily], marks: Mapping[str, Sequence[MarkedPoint]]) -> Figure:
    """The L1, L2, L3 halo families of one mass, and the resonances on those of L2 and L1.

    As in the paper, period tupling (k = 2 squares, k = 4 disks) is marked at z > 0 and touch-and-go (k = 3
    diamonds) at the mirror image, z < 0; so is period tupling whose new orbits appear near the other crossing
    of Fix(R) only, which the paper does not list. Keys are L1, L2, L3.
    """
    figure = plt.figure(figsize=(_WIDTH, 6.5))
    drawn = [mark for own in marks.values() for mark in own]
    foot = legend_height({(m.k, m.candidate.kind) for m in drawn}, [m.certified for m in drawn])
    height = figure.get_figheight()
    bottom = (foot + 0.86) / height
    grid = figure.add_gridspec(2, 2, left=0.09, right=0.985, top=0.955, bottom=bottom, wspace=0.26, hspace=0.3)
    axes = figure.add_subplot(grid[0, 0])
    for name, family in halos.items():
        for sign in (1, -1):
            axes.plot(family.points[:, 0], sign * family.points[:, 1], color=_FAMILY_COLOURS[name])
    _primaries(axes, next(iter(halos.values())))
    axes.legend(
        handles=[Line2D([], [], color=_FAMILY_COLOURS[name], label=f"$L_{name[1]}$") for name in halos],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.9),
        ncols=3,
        columnspacing=1.2,
        handlelength=1.4,
    )
    axes.margins(0.05)
    _finish(axes, "a", f"{mass_title(next(iter(halos.values())))} halo families")

    shown: list[Spot] = []
    second = spots_on(halos["L2"], marks["L2"])
    shown += _resonance_panel(figure.add_subplot(grid[0, 1]), halos["L2"], second, "b", "$L_2$ halo orbits")
    early, late = _parted(spots_on(halos["L1"], marks["L1"]))
    for cell, letter, part, text in ((grid[1, 0], "c", early, "first part"), (grid[1, 1], "d", late, "last part")):
        title = f"$L_1$ halo orbits, {text}"
        shown += _resonance_panel(figure.add_subplot(cell), halos["L1"], part, letter, title)
    _legend(figure, [_primary_handle()], [spot.mark for spot in shown])
    figure.text(0.5, (foot + 0.22) / height, _WHERE, ha="center", va="bottom", fontsize=7.5, color=INK)
    return figure


def _resonance_panel(axes: Axes, family: SampledFamily, spots: Sequence[Spot], letter: str, title: str) -> list[Spot]:
    # Around the spots, or the whole family if there is none.
    places = [spot.arclength for spot in spots] or [float(family.arclength[0]), float(family.arclength[-1])]
    low, high = min(places), max(places)
    pad = max(0.12 * (high - low), 0.01 * float(np.ptp(family.arclength)))
    window = (family.arclength >= low - pad) & (family.arclength <= high + pad)
    for sign in (1, -1):
        axes.plot(family.points[window, 0], sign * family.points[window, 1], color=CURVE)
    _draw_spots(axes, spots)
    crowd = _crowd(spots, np.ptp(family.points[window, :2], axis=0) * np.array([1.0, 2.0]))
    if len(crowd) > 1:
        _magnify(axes, family, crowd)
    axes.axhline(0.0, color=SECOND_CURVE, linewidth=0.6, zorder=1)
    axes.margins(0.08)
    _finish(axes, letter, title)
    return list(spots)


def _draw_spots(axes: Axes, spots: Sequence[Spot]) -> None:
    for spot in spots:
        draw_mark(axes, _shown_at(spot), spot.mark)


def _shown_at(spot: Spot) -> Array:
    below = spot.mark.k > 1 and (spot.mark.k % 2 == 1 or spot.elsewhere)
    return np.array([spot.position[0], (-1.0 if below else 1.0) * abs(spot.position[1])])


def _crowd(spots: Sequence[Spot], extent: Array) -> list[Spot]:
    """The largest group of spots that touch each other in a panel of the given extent."""
    if not spots:
        return []
    places = np.array([_shown_at(spot) for spot in spots]) / extent
    touching = np.linalg.norm(places[:, None] - places[None], axis=2) < _TOUCHING
    groups: list[set[int]] = [{i} for i in range(len(spots))]
    for i, j in np.argwhere(touching):
        if groups[i] is not groups[j]:
            groups[i] |= groups[j]
            for member in groups[j]:
                groups[member] = groups[i]
    return [spots[i] for i in sorted(max(groups, key=lambda group: len(group)))]


def _magnify(axes: Axes, family: SampledFamily, spots: Sequence[Spot]) -> None:
    """An inset around points that touch each other."""
    inset = axes.inset_axes((0.36, 0.35, 0.42, 0.3))
    for sign in (1, -1):
        inset.plot(family.points[:, 0], sign * family.points[:, 1], color=CURVE)
    _draw_spots(inset, spots)
    inset.axhline(0.0, color=SECOND_CURVE, linewidth=0.6, zorder=1)
    show_around(axes, inset, np.array([_shown_at(spot) for spot in spots]), margin=0.25, ticks=(2, 3))


def _parted(spots: Sequence[Spot]) -> tuple[Sequence[Spot], Sequence[Spot]]:
    """The spots before and after the longest stretch without one."""
    if len(spots) < 2:
        return spots, []
    gaps = [after.arclength - before.arclength for before, after in pairwise(spots)]
    cut = int(np.argmax(gaps)) + 1
    return spots[:cut], spots[cut:]


def _finish(axes: Axes, letter: str, title: str) -> None:
    axes.set_xlabel(label_of(CR3BP, "x"))
    axes.set_ylabel(label_of(CR3BP, "z"))
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_title(f"({letter})  {title}", color=INK)


def _primaries(axes: Axes, family: SampledFamily) -> None:
    mu = float(family.parameters["mu"])
    axes.plot([-mu, 1 - mu], [0.0, 0.0], linestyle="none", marker="x", color=INK, markersize=4.5)


def _primary_handle() -> Line2D:
    return Line2D([], [], linestyle="none", marker="x", color=INK, markersize=4.5, label="primaries")


def _legend(figure: Figure, handles: list[Line2D], marks: Sequence[MarkedPoint]) -> None:
    """The usual legend below all axes, with one more row above it."""
    claims, certified = {(m.k, m.candidate.kind) for m in marks}, [m.certified for m in marks]
    legend_below(figure, claims, certified)
    legend_row(figure, handles, legend_height(claims, certified))
