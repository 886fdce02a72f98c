"""Multiple shooting in float64: an orbit in segments of equal times, whose first states are unknowns of their own.

A segment amplifies errors by its own growth alone, one shot over the whole period by all of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, isfinite, log, log2

import numpy as np

from orbitproof.explore.periodic.flow import Arc, Matrix, Vector, arc_of, stretching
from orbitproof.shared.systems import System

_EVERY = 16
"""Every so many states of an orbit tell how errors grow along it."""
_DIGITS, _MOST = 2.0, 64
"""A segment amplifies errors by about so many digits; there are at most so many of them."""


@dataclass(frozen=True)
class Segments:
    """Segments of an orbit, the image of the last one's end under a linear map closing it.

    Attributes:
        arcs: of all segments, m of them.
        whole: the orbit as one arc over all of them, closed or not.
        gaps: shape (m N,), from the first state of the next segment to the end of each.
        by_nodes: shape (m N, m N), derivatives of the gaps in the first states.
        by_time: shape (m N,), in the time of all segments together.
        by_parameters: shape (m N, P).
    """

    arcs: Sequence[Arc]
    whole: Arc
    gaps: Vector
    by_nodes: Matrix
    by_time: Vector
    by_parameters: Matrix


def shot(system: System, nodes: Matrix, time: float, values: Vector, image: Matrix | None = None) -> Segments:
    """The segments from given states on.

    Arguments:
        nodes: shape (m, N), their first states.
        time: of all together.
        values: shape (P,), all parameters.
        image: shape (N, N), applied to the end of the last one before it is compared; `None` for the identity.

    Raises `FlowFailure` where one of them cannot be integrated.
    """
    m, n = nodes.shape
    arcs = [arc_of(system, node, time / m, values) for node in nodes]
    maps = [np.eye(n)] * (m - 1) + [np.eye(n) if image is None else image]
    by_nodes = np.zeros((m * n, m * n))
    for i, (arc, to) in enumerate(zip(arcs, maps, strict=True)):
        here, after = slice(i * n, (i + 1) * n), (i + 1) % m * n
        by_nodes[here, here] += to @ arc.by_state
        by_nodes[here, after : after + n] -= np.eye(n)
    ends = [to @ arc.end for arc, to in zip(arcs, maps, strict=True)]
    return Segments(
        arcs,
        _joined(arcs),
        np.concatenate(ends) - np.roll(nodes, -1, axis=0).ravel(),
        by_nodes,
        np.concatenate([to @ arc.velocity / m for arc, to in zip(arcs, maps, strict=True)]),
        np.vstack([to @ arc.by_parameters for arc, to in zip(arcs, maps, strict=True)]),
    )


def _joined(arcs: Sequence[Arc]) -> Arc:
    first, *others = arcs
    by_state, by_parameters = first.by_state, first.by_parameters
    for arc in others:
        by_state, by_parameters = arc.by_state @ by_state, arc.by_state @ by_parameters + arc.by_parameters
    samples = np.concatenate([first.samples, *(arc.samples[1:] for arc in others)])[:: len(arcs)]
    return Arc(arcs[-1].end, arcs[-1].velocity, by_state, by_parameters, samples)


def nodes_of(loop: Matrix, number: int, first: int = 0) -> Matrix:
    """First states of so many segments of a closed orbit, about; the first one is a state of the loop.

    Arguments:
        loop: shape (K, N), states at equal times, both ends included.
        first: number of that state.
    """
    last = len(loop) - 1
    places = (first + np.arange(number) * last / number) % last
    return np.column_stack([np.interp(places, np.arange(last + 1), column) for column in loop.T])


def segments_for(system: System, loop: Matrix, period: float, values: Vector) -> int:
    """In how many segments an orbit is shot: a power of 2, 1 where errors hardly grow."""
    digits = stretching(system, loop[::_EVERY], values) * period / log(10)
    return min(_MOST, 2 ** ceil(log2(max(1.0, digits / _DIGITS)))) if isfinite(digits) else 1
