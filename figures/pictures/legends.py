"""Legends below all axes, where they cannot hide data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from orbitproof.figures.pictures.marks import marker_size
from orbitproof.figures.style import marker_of
from orbitproof.verify.certificate.kinds import kind_named

_LEGEND_ROW, _LEGEND_FOOT, _LABEL_HEIGHT = 0.2, 0.05, 0.44
_DASHES = 2.7
"""Length of the sample of a dashed line, in sizes of its letters."""


def legend_handles(claims: Iterable[tuple[int, str]]) -> list[Line2D]:
    """One legend entry for each claim (k, kind), by k; one for those of a k > 1, which look alike."""
    labels: dict[tuple[int, str, str, str], str] = {}
    for k, kind in sorted(set(claims)):
        look = (k, *marker_of(k, kind), kind if k == 1 else "")
        label = _label(kind, k)
        labels[look] = f"{labels[look]} or {label.removeprefix(f'$k={k}$, ')}" if look in labels else label
    return [
        Line2D([], [], marker=marker, color=colour, linestyle="none", markersize=marker_size(marker), label=label)
        for (_, marker, colour, _), label in labels.items()
    ]


def _label(kind: str, k: int) -> str:
    known = kind_named(kind)
    return (known.legend or known.said)(k, kind)


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
    # Dashes have to be told from a whole line.
    if any(isinstance(each, Line2D) and each.is_dashed() for each in handles):
        look = {"handlelength": _DASHES, **look}
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
    """The rows from the lowest one up; more than four multiplicities, or five curves, take two."""
    handles = legend_handles(claims)
    rows = (verdict_handles(certified), *_in_rows(handles, 4), *_in_rows(list(curves), 5))
    return [row for row in rows if row]


def _in_rows(handles: list[Line2D], most: int) -> tuple[list[Line2D], list[Line2D]]:
    """The second row, empty if there is room in one, and the first."""
    half = len(handles) if len(handles) <= most else (len(handles) + 1) // 2
    return handles[half:], handles[:half]
