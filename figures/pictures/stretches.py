"""Where many points of a curve lie close together: the stretches that are drawn again, magnified."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

_CLOSE = 0.025
"""Neighbours closer than this part of what is shown belong to one run."""
_MANY = 6
"""Points of a run that is worth a panel."""
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
        beside = _BESIDE * (run[-1] - run[0])
        low, high = run[0] - beside, run[-1] + beside
        if len(run) >= _MANY and 0 < high - low <= _WIDEST * width:
            yield max(low, begin), min(high, end)
            if depth > 1:
                yield from crowded(places, low, high, depth - 1)
