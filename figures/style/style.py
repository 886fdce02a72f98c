"""The look of the pictures: style sheet, markers by multiplicity, labels with units."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib import resources
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from orbitproof.explore.names import resonant_values
from orbitproof.figures.model import MarkedPoint
from orbitproof.shared.formats import FOLD
from orbitproof.shared.systems import ReversibleSystem

INK = "#222222"
CURVE = "#3c6e91"
SECOND_CURVE = "#a8a8a8"
_LEGEND_ROW, _LEGEND_FOOT, _LABEL_HEIGHT = 0.2, 0.05, 0.44
_MARKERS = {1: "^", 2: "s", 3: "D", 4: "o", 5: "p", 6: "h"}
_COLOURS = {1: "#111111", 2: "#b2182b", 3: "#e08214", 4: "#1b7837", 5: "#762a83", 6: "#2166ac"}
_FOLD_MARKER = "v"
_KINDS = {
    "symmetry_breaking": "symmetry breaking",
    "fold": "fold",
    "period_tupling": "period tupling",
    "touch_and_go": "touch-and-go",
}
_TEX = {
    "vx": r"\dot{x}",
    "vy": r"\dot{y}",
    "vz": r"\dot{z}",
    "beta": r"\beta",
    "mu": r"\mu",
    "nu": r"\nu",
    "eps": r"\varepsilon",
    "xi": r"\xi",
    "zeta": r"\zeta",
    "veta": r"\dot{\eta}",
}


def use_style() -> Any:
    """The style sheet as a context manager."""
    return plt.style.context(str(resources.files("orbitproof.figures.style").joinpath("orbitproof.mplstyle")))


def marker_of(k: int, kind: str = "") -> tuple[str, str]:
    """Marker and colour of multiplicity k, or of a fold. The shape alone tells k, so that grey prints stay readable."""
    return _FOLD_MARKER if kind == FOLD else _MARKERS.get(k, "*"), _COLOURS.get(k, "#8c510a")


def draw_mark(axes: Axes, position: Sequence[float] | NDArray[np.float64], mark: MarkedPoint) -> Line2D:
    """Draw one bifurcation, in two or three dimensions: filled if certified, hollow if numerical."""
    return draw_point(axes, position, mark.k, mark.certified, mark.candidate.id, mark.candidate.kind)


def draw_point(
    axes: Axes,
    position: Sequence[float] | NDArray[np.float64],
    k: int,
    certified: bool,
    identifier: str,
    kind: str = "",
) -> Line2D:
    """As `draw_mark`, for a point that is known by its multiplicity, verdict, id and perhaps kind only."""
    marker, colour = marker_of(k, kind)
    coordinates = [[value] for value in position]
    (line,) = axes.plot(
        *coordinates,
        marker=marker,
        linestyle="none",
        color=colour,
        markeredgecolor=colour,
        markerfacecolor=colour if certified else "white",
        markersize=_size(marker),
        clip_on=False,
        zorder=6,
        # A thin white rim, so that markers that touch can be told apart.
        path_effects=[withStroke(linewidth=1.9, foreground="white")],
    )
    line.set_gid(f"candidate {identifier}")
    return line


def _size(marker: str) -> float:
    return {"D": 4.9, "s": 5.2, "*": 8.0, "o": 5.4}.get(marker, 6.2)


def legend_handles(claims: Iterable[tuple[int, str]]) -> list[Line2D]:
    """One legend entry for each claim (k, kind), by k."""
    handles = []
    for k, kind in sorted(set(claims)):
        marker, colour = marker_of(k, kind)
        label = f"$k={k}$, " + _KINDS[kind]
        handles.append(
            Line2D([], [], marker=marker, color=colour, linestyle="none", markersize=_size(marker), label=label)
        )
    return handles


def verdict_handles(certified: Sequence[bool]) -> list[Line2D]:
    """Legend entries that say what filled and hollow markers mean, for the verdicts that occur."""
    meanings = {True: ("#666666", "filled: certified"), False: ("white", "hollow: numerical only")}
    return [
        Line2D([], [], marker="o", color="#666666", markerfacecolor=face, linestyle="none", label=label)
        for verdict, (face, label) in meanings.items()
        if verdict in certified
    ]


def legend_below(
    figure: Figure, claims: Iterable[tuple[int, str]], certified: Sequence[bool], curves: Sequence[Line2D] = ()
) -> None:
    """Legend below all axes, where it cannot hide data: curves, multiplicities, then what filled and hollow mean."""
    for number, row in enumerate(_legend_rows(claims, certified, curves)):
        legend_row(figure, row, _LEGEND_FOOT + number * _LEGEND_ROW)


def legend_row(figure: Figure, handles: Sequence[Any], height: float, **look: Any) -> None:
    """One row of a legend in the middle of a figure, `height` inches above its foot."""
    place = (0.5, height / figure.get_figheight())
    figure.legend(
        handles=handles, loc="lower center", ncols=len(handles), borderaxespad=0.0, bbox_to_anchor=place, **look
    )


def legend_height(claims: Iterable[tuple[int, str]], certified: Sequence[bool], curves: Sequence[Line2D] = ()) -> float:
    """Height in inches that `legend_below` takes at the foot of a figure."""
    return _LEGEND_FOOT + _LEGEND_ROW * len(_legend_rows(claims, certified, curves))


def bottom_margin(
    height: float, claims: Iterable[tuple[int, str]], certified: Sequence[bool], curves: Sequence[Line2D] = ()
) -> float:
    """Part of a figure of `height` inches below its axes: for their labels and for `legend_below`."""
    return (_LABEL_HEIGHT + legend_height(claims, certified, curves)) / height


def _legend_rows(
    claims: Iterable[tuple[int, str]], certified: Sequence[bool], curves: Sequence[Line2D]
) -> list[list[Line2D]]:
    """The rows from the lowest one up; more than four multiplicities take two."""
    handles = legend_handles(claims)
    half = len(handles) if len(handles) <= 4 else (len(handles) + 1) // 2
    return [row for row in (verdict_handles(certified), handles[half:], handles[:half], list(curves)) if row]


def label_of(name: str, unit: bool = True) -> str:
    """Axis label of a state coordinate or parameter; all are nondimensional."""
    text = f"${_TEX.get(name, name)}$"
    return f"{text}  (nondimensional)" if unit else text


def level_label(system: ReversibleSystem) -> str:
    """Axis label of the bifurcation parameter: first integral or family parameter."""
    if system.family_parameter is not None:
        return label_of(system.family_parameter)
    return f"{system.first_integral_name or 'first integral'}  (nondimensional)"


def resonances(multiplicities: Sequence[int]) -> dict[int, tuple[float, ...]]:
    """Values of the stability parameter in 1:k resonance, by k."""
    return {k: resonant_values(k) for k in sorted(set(multiplicities))}


def draw_resonance(axes: Axes, k: int, value: float, named: bool = True) -> None:
    """The line of a resonant value across axes of stability parameters, named 1:k on their right."""
    axes.axhline(value, color=marker_of(k)[1], linewidth=0.7, linestyle=(0, (4, 3)), zorder=1.5)
    if named:
        where = {"xycoords": ("axes fraction", "data"), "xytext": (4, 0), "textcoords": "offset points"}
        axes.annotate(f"1:{k}", (1.0, value), va="center", fontsize=7, color=INK, **where)


def show_around(axes: Axes, inset: Axes, points: NDArray[np.float64], margin: float, ticks: tuple[int, int]) -> None:
    """Let an inset show the surroundings of points, shape (N, 2), and mark in `axes` what it shows.

    `margin` is a part of what the points span, `ticks` the largest numbers of intervals on the two axes.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    pad = margin * (high - low)
    inset.set_xlim(low[0] - pad[0], high[0] + pad[0])
    inset.set_ylim(low[1] - pad[1], high[1] + pad[1])
    inset.tick_params(labelsize=6, pad=1.5, length=2)
    for axis, number in zip((inset.xaxis, inset.yaxis), ticks, strict=True):
        axis.set_major_locator(MaxNLocator(number))
    for side in ("top", "right"):
        inset.spines[side].set_visible(True)
    axes.indicate_inset_zoom(inset, edgecolor="#888888", linewidth=0.6)


def close(figure: Figure) -> None:
    """Release a figure that is saved."""
    plt.close(figure)
