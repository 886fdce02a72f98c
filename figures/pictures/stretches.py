"""Where many points of a curve lie close together: the stretches that are drawn again, magnified."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

_CLOSE = 0.025
"""Neighbours closer than this part of what is shown belong to one run."""
_MANY = 8
"""Points of a run that is worth a panel."""
_DENSE = 0.015
"""Mean distance of neighbours in such a run, as a part of what is shown: farther apart they can be told apart."""
_WIDEST = 0.3
"""Part of what is shown that a stretch takes at most: otherwise little is gained."""
_BESIDE = 0.06
"""Beside the outermost points, as a part of the run."""
_DEEPEST = 3


def crowded(
    places: Sequence[float], begin: float = 0.0, end: float = 1.0, depth: int = _DEEPEST
) -> Iterator[tuple[float, float]]:
    """Stretches of an axis from `begin` to `end` on which points lie close together, and then the same within these.

    Arguments:
        places: of all points.
        depth: how often a stretch within a stretch is looked for.
    """
    width, shown = end - begin, sorted(place for place in places if begin <= place <= end)
    runs: list[list[float]] = []
    for place in shown:
        if runs and place - runs[-1][-1] < _CLOSE * width:
            runs[-1].append(place)
        else:
            runs.append([place])
    for run in runs:
        extent = run[-1] - run[0]
        low, high = run[0] - _BESIDE * extent, run[-1] + _BESIDE * extent
        dense = extent < _DENSE * width * (len(run) - 1)
        if len(run) >= _MANY and dense and 0 < high - low <= _WIDEST * width:
            yield low, high
            if depth > 1:
                yield from crowded(places, low, high, depth - 1)
