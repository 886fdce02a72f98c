"""Stability along a certified curve: its stability parameters, all resonances, and where it is linearly stable."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter

from orbitproof.figures.certified import CertifiedStability, ListedPoint, Stretch, heading_of
from orbitproof.figures.pictures.certified_branches import Along
from orbitproof.figures.pictures.legends import legend_row
from orbitproof.figures.pictures.marks import draw_resonance, resonances
from orbitproof.figures.pictures.stretches import crowded
from orbitproof.figures.style import CURVE, INK, SECOND_CURVE, level_label, marker_of
from orbitproof.shared.formats import FOLD, REVERSOR_BREAKING
from orbitproof.shared.systems import VERTICAL

_WIDTH, _HEIGHT = 7.2, 6.4
_STABLE = "#d9ead3"
_LASTING: dict[bool, dict[str, Any]] = {
    True: {"facecolor": "#b4d9a6"},
    False: {"facecolor": "#bfd6ef", "edgecolor": "#8fb0d6", "hatch": "////", "linewidth": 0.0},
}
"""By whether the twist is positive; told apart in grey too."""
_TWISTLESS: dict[str, Any] = {"color": INK, "linestyle": (0, (1, 1.5)), "linewidth": 1.0}
_NAMED = 4
"""Resonant values up to 1:4 are drawn as lines."""
_SHOWN = 1.25
_IN_A_ROW = 9
_MANY = 7
"""Multiplicities from here on look alike."""
_ROW, _MAGNIFIED, _PANEL = 0.22, 2.0, 1.35
"""Inches of a row of the legend, and of panels that magnify with and without what is around them."""
_LETTERS = "acdefghij"
"""Letters of the panels with stability parameters: the whole, then stretches, without (c) if that is the twist."""
_TWIST = 1.5
"""Inches of the panel with the twist."""
_DECADE = 10.0
_VISIBLE = 0.995
"""The share of the stable intervals beyond which what is left of them is not seen."""
_GREY = "#666666"
_LOSS = "loss of R"
"""What a list calls such a point."""


def draw_certified_stability(found: CertifiedStability) -> Figure:
    """The stability parameters with their bounds, and the level, along the curve; stable intervals are filled.

    Stretches on which points are crowded are drawn again in panels of their own.
    """
    axis = Along(found.curve)
    stretches = {stretch.piece: stretch for stretch in found.curve.stretches}
    spots = [axis.at(stretches[point.piece], point.s) for point in found.points]
    rows = _legend(found, _shows_linear_stability(found, axis, stretches))
    twisted = any(np.isfinite(part.twist).any() for part in found.parts)
    letters = _LETTERS.replace("c", "") if twisted else _LETTERS
    close = _magnified(axis, found, spots)[: len(letters) - 1]
    height = _HEIGHT + _MAGNIFIED * len(close) + _TWIST * twisted
    figure = plt.figure(figsize=(_WIDTH, height))
    foot = 0.62 + _ROW * len(rows)
    raised = foot + _MAGNIFIED * len(close)
    ratios = (2.2, 1.0, 1.0)[: 2 + twisted]
    grid = figure.add_gridspec(
        len(ratios),
        1,
        left=0.1,
        right=0.95,
        top=1 - 0.58 / height,
        bottom=raised / height,
        hspace=0.2,
        height_ratios=ratios,
    )
    upper = figure.add_subplot(grid[0])
    lower, *twists = (figure.add_subplot(grid[row], sharex=upper) for row in range(1, len(ratios)))
    panels = [
        figure.add_axes((0.1, (raised - _MAGNIFIED * (number + 1)) / height, 0.85, _PANEL / height))
        for number in range(len(close))
    ]
    for axes in (upper, *panels):
        _draw_parameters(axes, found, axis)
    for part in found.parts:
        lower.plot(axis.values(part.stretch), part.half_period if axis.is_parameter else part.level, color=CURVE)
    for axes in twists:
        _draw_twist(axes, found, axis)
        lower.tick_params(labelbottom=False)
    for axes in (upper, lower, *twists, *panels):
        _draw_intervals(axes, found, axis, stretches)
    for point, x_at in zip(found.points, spots, strict=True):
        for axes in (upper, *panels):
            _mark(axes, x_at, point.value, point)
        _mark(lower, x_at, point.half_period if axis.is_parameter else point.level, point)
        for axes in twists:
            if point.k <= _NAMED:
                axes.axvline(
                    x_at, color=_look(point)["color"], linewidth=1.0, linestyle="dashed", gid=f"twist {point.k}"
                )
    values = np.concatenate([part.parameters.ravel() for part in found.parts])
    if not (np.abs(values) <= _SHOWN).any():
        text = f"outside of this panel: real parts from about {values.real.min():.4g} to {values.real.max():.4g}"
        upper.text(0.5, 0.6, text, transform=upper.transAxes, ha="center", color=INK)
    upper.margins(x=0.015)
    upper.tick_params(labelbottom=False)
    time, what = _over(found)
    lower.set_ylabel(time if axis.is_parameter else level_label(found.curve.system).split("  ")[0])
    [lower, *twists, *panels][-1].set_xlabel(axis.label)
    figure.text(0.1, 1 - 0.22 / height, heading_of(found.curve.atlas), color=INK, fontweight="bold", va="center")
    upper.set_title(f"(a)  stability parameters{what}, with all resonances up to 1:{found.order}", color=INK)
    title = time if axis.is_parameter else f"{_parameter(found)} of the orbits"
    lower.set_title(f"(b)  {title}", color=INK)
    for number, axes in enumerate(panels):
        within = [each for each in range(number) if _contains(close[each], close[number])]
        parent = within[-1] + 1 if within else 0
        letter, of = letters[number + 1], letters[parent]
        _magnify((upper, *panels)[parent], axes, letter, of, close[number])
    for number, row in enumerate(rows):
        legend_row(figure, row, 0.06 + _ROW * number)
    return figure


def _over(found: CertifiedStability) -> tuple[str, str]:
    """What the time from Fix(R) to Fix(R) is, and over which time the parameters are, if not over a period."""
    if found.curve.system in VERTICAL.values():
        return "quarter of the period", " of half a period and z -> -z"
    return "half period", ""


def _magnified(axis: Along, found: CertifiedStability, spots: Sequence[float]) -> list[tuple[float, float]]:
    """The ends, on the axis, of the stretches with panels of their own."""
    to, back = (np.log, np.exp) if axis.is_logarithmic else (np.asarray, np.asarray)
    begin, end = (float(to(axis.ends(found.curve.stretches[place])[place])) for place in (0, -1))
    stretches = crowded([(float(to(spot)) - begin) / (end - begin) for spot in spots])
    return [tuple(float(back(begin + (end - begin) * place)) for place in ends) for ends in stretches]


def _draw_parameters(axes: Axes, found: CertifiedStability, axis: Along) -> None:
    """The stability parameters with their bounds and the resonant values."""
    for part in found.parts:
        x = axis.values(part.stretch)
        for values, bounds in zip(part.parameters.T, part.bounds.T, strict=True):
            real = np.where(values.imag == 0, values.real, np.nan)
            axes.fill_between(x, real - bounds, real + bounds, color=CURVE, alpha=0.35, linewidth=0)
            axes.plot(x, real, color=CURVE)
        pairs = np.where((part.parameters.imag != 0).any(axis=1), part.parameters[:, 0].real, np.nan)
        axes.plot(x, pairs, color=SECOND_CURVE, linestyle="dotted")
    for k, values in resonances(range(1, min(found.order, _NAMED) + 1)).items():
        for value in values:
            draw_resonance(axes, k, value)
    if axis.is_logarithmic:
        axes.set_xscale("log")
    axes.set_ylim(-_SHOWN, _SHOWN)
    axes.set_ylabel(r"$(\lambda+1/\lambda)/2$")


def _draw_twist(axes: Axes, found: CertifiedStability, axis: Along) -> None:
    """The twist, which has poles at 1:3, on a scale that is linear near 0."""
    for part in found.parts:
        axes.plot(axis.values(part.stretch), part.twist, color=CURVE, gid="twist")
    values = np.concatenate([part.twist for part in found.parts])
    sizes = np.abs(values[np.isfinite(values)])
    axes.set_yscale("asinh", linear_width=float(np.quantile(sizes, 0.2)) or 1.0)
    largest = int(np.floor(np.log10(sizes.max() or 1.0)))
    powers = 10.0 ** np.array([largest - 2, largest])
    axes.set_yticks([*-powers, 0.0, *powers])
    axes.minorticks_off()
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.set_ylabel("twist")
    axes.set_title("(c)  the twist, and resonances up to 1:4", color=INK)


def _draw_intervals(axes: Axes, found: CertifiedStability, axis: Along, stretches: Mapping[str, Stretch]) -> None:
    """What is proved of whole intervals, and the orbits without twist."""
    for begin, end in found.stable:
        places = [axis.at(stretches[piece], s) for piece, s in (begin, end)]
        axes.axvspan(*places, facecolor=_STABLE, zorder=0, gid="stable")
    for (begin, end), positive in found.lasting:
        places = [axis.at(stretches[piece], s) for piece, s in (begin, end)]
        axes.axvspan(*places, **_LASTING[positive], zorder=0.1, gid="lasting")
    for piece, s in found.twistless:
        axes.axvline(axis.at(stretches[piece], s), **_TWISTLESS, gid="twistless")


def _shows_linear_stability(found: CertifiedStability, axis: Along, stretches: Mapping[str, Stretch]) -> bool:
    """Whether a visible part of the stable intervals is not among those that are stable for ever."""

    def length(intervals: Iterable[tuple[tuple[str, float], ...]]) -> float:
        ends = [[axis.at(stretches[piece], s) for piece, s in interval] for interval in intervals]
        return sum(abs(end - begin) for begin, end in ends)

    stable = length(found.stable)
    return stable > 0 and length(ends for ends, _ in found.lasting) < _VISIBLE * stable


def _contains(whole: tuple[float, float], part: tuple[float, float]) -> bool:
    return whole[0] <= part[0] and part[1] <= whole[1]


def _magnify(whole: Axes, axes: Axes, letter: str, of: str, ends: tuple[float, float]) -> None:
    """Let a panel show a stretch of another one, and mark there where it is."""
    axes.set_xlim(*ends)
    if axes.get_xscale() == "log":
        if ends[1] < _DECADE * ends[0]:
            axes.set_xscale("linear")
        else:
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.xaxis.set_major_formatter("{x:g}")
            axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_title(f"({letter})  a stretch of ({of})", color=INK)
    height = 1.0 + 0.4 * (_SHOWN - 1.0)
    whole.plot(ends, [height] * 2, color=INK, marker="|", markersize=5, linewidth=1.0, gid=f"stretch {letter}")
    middle = np.sqrt(ends[0] * ends[1]) if whole.get_xscale() == "log" else (ends[0] + ends[1]) / 2
    whole.annotate(
        letter, (middle, height), xytext=(0, 1.5), textcoords="offset points", fontsize=7, color=INK, ha="center",
        va="bottom",
    )  # fmt: skip


def _legend(found: CertifiedStability, shows_stable: bool) -> list[list[Any]]:
    """The rows from the lowest one up, of what can be seen."""
    curves: list[Any] = [Line2D([], [], color=CURVE, label="enclosed")]
    if any((part.parameters.imag != 0).any() for part in found.parts):
        curves.append(Line2D([], [], color=SECOND_CURVE, linestyle="dotted", label="complex pair (real part)"))
    if shows_stable:
        curves.append(Patch(facecolor=_STABLE, label="proved linearly stable"))
    for positive in sorted({positive for _, positive in found.lasting}):
        label = f"stable for ever, twist {'positive' if positive else 'negative'}"
        curves.append(Patch(**_LASTING[positive], label=label))
    if found.twistless:
        curves.append(Line2D([], [], **_TWISTLESS, label="no twist"))
    marks = {_label(point): Line2D([], [], label=_label(point), **_look(point)) for point in found.points}
    handles = [marks[name] for name in sorted(marks, key=lambda name: (len(name), name))]
    half = len(handles) if len(handles) <= _IN_A_ROW else (len(handles) + 1) // 2
    meanings = {
        False: (_GREY, "resonance proved"),
        True: (INK, "dark rim: its bifurcation certified too"),
    }
    filled = [
        Line2D([], [], marker="o", color=_GREY, markeredgecolor=rim, linestyle="none", label=label)
        for rim, label in (meanings[verdict] for verdict in sorted({point.certified for point in found.points}))
    ]
    return [row for row in (filled, handles[half:], handles[:half], curves) if row]


def _label(point: ListedPoint) -> str:
    loss = "$R$ is lost" if point.certified else "$R$ may be lost"
    many = f"1:{point.k}" if point.k < _MANY else f"1:{_MANY} and above"
    return {FOLD: FOLD, _LOSS: loss}.get(point.kind, many)


def _look(point: ListedPoint) -> dict[str, Any]:
    marker, colour = marker_of(point.k, {_LOSS: REVERSOR_BREAKING}.get(point.kind, point.kind))
    small = point.k > _NAMED
    return {
        "marker": marker,
        "color": colour,
        "markerfacecolor": colour,
        "markeredgecolor": INK if point.certified else colour,
        "linestyle": "none",
        "markersize": 3.0 if small else 4.4,
        "markeredgewidth": 1.1 if point.certified else 0.7,
        "zorder": 4 if small else 6,
    }


def _mark(axes: Axes, x: float, y: float, point: ListedPoint) -> None:
    axes.plot([x], [y], gid=f"listed {point.k} {point.j}", **_look(point))


def _parameter(found: CertifiedStability) -> str:
    """What orbits are told apart by: the family parameter, or the level of the first integral."""
    return "the parameter" if found.curve.system.family_parameter is not None else "the level"
