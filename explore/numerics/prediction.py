"""Hermite prediction of a curve from computed points and tangents on it.

Near a collision Newton's method converges only from predictions as good as the distance to the
primary: steps along the tangent alone would have to be tiny there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbitproof.explore.flow import Matrix, Vector

ALIGNED = 0.5
"""Smallest cosine between a tangent and the direction of prediction for which its point is used."""


def predict(
    points: Sequence[Vector], tangents: Sequence[Vector], direction: Vector, distance: float | Matrix
) -> np.ndarray:
    """The point of the curve at `distance` from `points[0]` along the unit vector `direction`; points for a column.

    The curve is taken as a graph over `direction` and interpolated, or extrapolated, by the polynomial
    that has the given points and tangents. Points where the curve runs across the direction, or back,
    are left out, the first one never.
    """
    base = points[0]
    nodes: list[float] = []
    values: list[Vector] = []
    slopes: list[Vector] = []
    for point, tangent in zip(points, tangents, strict=True):
        cosine = float(tangent @ direction)
        place = float((point - base) @ direction)
        if cosine < ALIGNED or any(abs(place - node) < 1e-9 * (1.0 + np.max(np.abs(distance))) for node in nodes):
            if not nodes:
                return base + distance * direction
            continue
        nodes.append(place)
        values.append(point)
        slopes.append(tangent / cosine)
    return _hermite(nodes, values, slopes, distance)


def _hermite(
    nodes: Sequence[float], values: Sequence[Vector], slopes: Sequence[Vector], place: float | Matrix
) -> np.ndarray:
    """Value at `place` of the polynomial with these values and slopes, by divided differences."""
    twice = [node for node in nodes for _ in range(2)]
    table = [value for value in values for _ in range(2)]
    size = len(twice)
    coefficients = [table[0]]
    column = table
    for order in range(1, size):
        column = [
            slopes[i // 2] if order == 1 and i % 2 == 0 else (column[i + 1] - column[i]) / (twice[i + order] - twice[i])
            for i in range(size - order)
        ]
        coefficients.append(column[0])
    result = np.array(coefficients[-1], dtype=float)
    for coefficient, node in zip(reversed(coefficients[:-1]), reversed(twice[:-1]), strict=True):
        result = result * (place - node) + coefficient
    return result
