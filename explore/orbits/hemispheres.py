"""Northern and southern orbits of the CR3BP: where they are farthest from the smaller primary z > 0, or z < 0."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.explore.names import NORTH, SOUTH, Branch
from orbitproof.explore.seeds import primaries

_SAME = 1e-6
"""Both ends of half an orbit so near to one another's mirror image, relative to the distance from the smaller primary,
are those of an orbit that is on both sides."""


def branch_at(places: Sequence[Vector] | Vector, mu: float) -> Branch | None:
    """On which side an orbit is that is symmetric under R.

    Arguments:
        places: shape (N, 3), along half of it, both ends included, which are in the plane y = 0.

    Returns `None` for an orbit in the plane z = 0, and for one that is its own mirror image.
    """
    half = np.asarray(places, dtype=float)[:, :3]
    distances = np.linalg.norm(half - primaries(mu)[1], axis=1)
    image = half[-1] * [1, 1, -1]
    height = half[int(np.argmax(distances)), 2]
    if height == 0 or np.linalg.norm(half[0] - image) <= _SAME * distances.max():
        return None
    return NORTH if height > 0 else SOUTH
