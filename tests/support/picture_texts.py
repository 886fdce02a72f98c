"""Whether all that is written in a picture can be read: nothing cut off, covered or upon another text."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text


def unreadable(figure: Figure) -> list[str]:
    """What cannot be read, in words; empty if all can. Tick labels of 3D axes are not looked at."""
    figure.canvas.draw()
    axes = list(_axes(figure))
    texts = [(text, None) for text in (*figure.texts, *(t for each in figure.legends for t in each.get_texts()))]
    texts += [(text, each) for each in axes for text in _texts(each)]
    boxes = [(text.get_text(), text.get_window_extent(), own) for text, own in texts if text.get_text().strip()]
    whole = figure.bbox.padded(1)
    found = [f"{name} is cut off" for name, box, _ in boxes if not _inside(box, whole)]
    for name, box, own in boxes:
        later = axes if own is None else axes[axes.index(own) + 1 :]
        found += [f"{name} is covered" for each in later if _opaque(each) and _meet(box, each.get_window_extent())]
    found += [f"{a[0]} meets {b[0]}" for a, b in combinations(boxes, 2) if _meet(a[1], b[1])]
    return found


def _axes(figure: Figure) -> Iterator[Axes]:
    """In the order in which they are drawn."""
    yield from figure.axes
    for each in figure.axes:
        yield from each.child_axes


def _texts(axes: Any) -> Iterator[Text]:
    yield from (axes._left_title, axes.title, *axes.texts)
    if axes.name == "3d":
        return
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        yield from (text for text in (axis.label, *(tick.label1 for tick in ticks)) if text.get_visible())


def _opaque(axes: Axes) -> bool:
    return bool(axes.patch.get_visible() and axes.patch.get_facecolor()[3] > 0)


def _inside(box: Any, other: Any) -> bool:
    return bool(other.x0 <= box.x0 and box.x1 <= other.x1 and other.y0 <= box.y0 and box.y1 <= other.y1)


def _meet(box: Any, other: Any) -> bool:
    wide, high = min(box.x1, other.x1) - max(box.x0, other.x0), min(box.y1, other.y1) - max(box.y0, other.y0)
    return bool(wide > 1 and high > 1)
