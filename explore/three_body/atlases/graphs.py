"""Pieces of curves that are graphs over a parameter of their equations, from orbits that are corrected more precisely.

Where the half return grows by some thousands across a curve, its coefficients show the errors of orbits that are found
one by one in float64. Here they are corrected once more, many at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev

from orbitproof.explore.atlases import LANES, Chart, ExpansionFailure, HalfReturns, LibrationFailure, newton_on_curve
from orbitproof.explore.flow import FlowFailure, Vector
from orbitproof.explore.three_body.atlases.lyapunov import OrbitsOfSizes, decay, graph_piece
from orbitproof.shared.formats import Piece

NOISE = 1e-14
"""Size, relative to the other coordinates, below which Chebyshev coefficients are rounding."""
DEGREE = 14
"""Degree of the polynomials: a family is much smoother than the half return; more coefficients are rounding."""
LEAST_DECAY = 3.6
"""The Taylor coefficients of the half return in s decay by this factor on a piece: so that degree 40 is enough."""
SHRINK, NARROWEST, OVERLAP = 0.8, 1e-3, 0.03


class Graph(OrbitsOfSizes, Protocol):
    """A curve over the last parameter of its equations, whose other parameters are fixed."""

    @property
    def returns(self) -> HalfReturns:
        """Half returns of its equations."""

    def start(self, place: float) -> Sequence[float]:
        """Coordinates of the orbit over a value of the parameter, and its half period. Raises `LibrationFailure`."""


def expansion(graph: Graph, low: float, high: float) -> list[Vector]:
    """Chebyshev coefficients of the other coordinates on [low, high], those above the rounding.

    Raises `LibrationFailure`.
    """
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    size = len(graph.system.centre_coordinates)
    count = LANES // size
    nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    known = np.array([graph.start(middle + half * node) for node in nodes]).T
    centre = np.array([middle, *known[:-1].mean(axis=1)])
    chart = Chart(centre, np.eye(size), half, 1.0)
    try:
        across, _ = newton_on_curve(graph.returns, chart, nodes, known[:-1] - centre[1:, None], known[-1])
    except (ExpansionFailure, FlowFailure) as error:
        raise LibrationFailure(f"at {graph.system.family_parameter} = {middle:.6g}: {error}") from None
    rows = [np.asarray(chebyshev.chebfit(nodes, row, DEGREE)) for row in across + centre[1:, None]]
    return [row[: np.flatnonzero(np.abs(row) > NOISE * np.abs(row).max())[-1] + 1] for row in rows]


def pieces_of(graph: Graph, low: float, high: float, tube: float, widest: float = 1.0) -> tuple[Piece, ...]:
    """Pieces over [low, high] from left to right, none wider than a share of it. Raises `LibrationFailure`."""
    pieces: list[Piece] = []
    begin, width = low, high - low
    while True:
        width = min(high - begin, width / SHRINK**2, widest * (high - low))
        coefficients = expansion(graph, begin, begin + width)
        while decay(graph, begin, begin + width, coefficients) < LEAST_DECAY:
            width *= SHRINK
            if width < NARROWEST * (high - low):
                where = f"{graph.system.family_parameter} = {begin:.6g}"
                raise LibrationFailure(f"at {where}: no piece is narrow enough (near a singularity)")
            coefficients = expansion(graph, begin, begin + width)
        name, end = f"p{len(pieces) + 1:03d}", begin + width
        pieces.append(graph_piece(name, begin + 0.5 * width, 0.5 * width, coefficients, tube))
        if high - end < 1e-12 * (high - low):
            return tuple(pieces)
        begin = end - OVERLAP * width
