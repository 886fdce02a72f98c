"""Which curves of a graph hang together (sections 33.4 and 39.4)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping


def hanging_together(meets: Mapping[str, Iterable[str]]) -> tuple[tuple[str, ...], ...]:
    """Classes of arcs that are joined by chains of arcs with a vertex in common, in order; `meets` by their ids."""
    parts: list[tuple[list[str], set[str]]] = []
    for arc, own in meets.items():
        names, vertices = [arc], set(own)
        joined = [part for part in parts if part[1] & vertices]
        parts = [part for part in parts if not part[1] & vertices]
        for more_names, more_vertices in reversed(joined):
            names, vertices = [*more_names, *names], vertices | more_vertices
        parts.append((names, vertices))
    order = {arc: number for number, arc in enumerate(meets)}
    return tuple(
        sorted((tuple(sorted(names, key=order.__getitem__)) for names, _ in parts), key=lambda part: order[part[0]])
    )
