"""Pieces of the planar families over which the halo orbits of L1 and L2 live, over ranges of the mass.

The coordinates are those of `shared.systems.OVER_MASSES`: b, the signed distance of the libration point from the
smaller mass, which determines the mass, and eps, the size of the orbit in units of b. A piece goes over an interval of
b and, for all of them, over one interval of eps from beyond the libration point to beyond the symmetry breaking.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from orbitproof.explore.three_body.atlases.lyapunov import LyapunovFamily
from orbitproof.shared.formats import LibrationPiece
from orbitproof.shared.systems import SIDES, mass_of_distance

NODES, ACROSS = 40, 7
"""Chebyshev nodes in eps, and in b."""

TUBE = 2.0**-16
"""Half-width of the tubes relative to vy."""

BEYOND = 0.05
"""How far pieces go beyond the symmetry breaking and beyond eps = 0, relative to the range between."""

_ROUNDING = 2.0**-20

HALF_WIDTH, GROWTH = 0.0205, -0.1
"""Half-width of a piece in b at b = 0, and how much wider pieces may be further away: times 1 + GROWTH abs(b)."""


def distance_of(point: str, mass: float) -> float:
    """b of the libration point at a mass in [0, 1/2]."""
    if mass == 0.0:
        return 0.0
    family = LyapunovFamily(point, Fraction(mass))
    return family.libration.x - 1 + mass


def pieces_to(
    point: str, first: Fraction, last: Fraction, progress: Callable[[float], None] | None = None
) -> tuple[LibrationPiece, ...]:
    """Pieces for all masses from `first` to `last`, with orbits to the symmetry breaking on the left of the point.

    That is where the surfaces of `atlases.surface` have it. Raises `LibrationFailure` where the family is not
    found.
    """
    low, high = (abs(distance_of(point, float(mass))) for mass in (first, last))
    low, high = low * (1 - _ROUNDING), high * (1 + _ROUNDING)
    ends = np.log1p(GROWTH * np.array([low, high]))
    count = int(np.ceil((ends[1] - ends[0]) / (2 * GROWTH * HALF_WIDTH)))
    places = np.expm1(np.linspace(ends[0], ends[1], count + 1)) / GROWTH
    edges = [
        Fraction(int(np.floor(low * 2**30)), 2**30),
        *(Fraction(int(np.ceil(e * 2**30)), 2**30) for e in places[1:]),
    ]
    result = []
    for number, (near, far) in enumerate(pairwise(edges), start=1):
        result.append(_piece(point, SIDES[point] * (near + far) / 2, (far - near) / 2, f"planar{number:03d}"))
        if progress is not None:
            progress(number / count)
    return tuple(result)


def _piece(point: str, middle: Fraction, half: Fraction, name: str) -> LibrationPiece:
    nodes = np.cos(np.pi * (np.arange(ACROSS) + 0.5) / ACROSS)
    families = [_family(point, float(middle) + float(half) * node) for node in nodes]
    ends = [family.symmetry_breaking(-1) / (SIDES[point] * family.scale) for family in families]
    # The ends move on beyond the nodes.
    furthest = max(ends, key=abs)
    end = furthest + 0.5 * (furthest - min(ends, key=abs))
    low, high = sorted(((1 + BEYOND) * end, -BEYOND * end))
    size = (Fraction(0.5 * (low + high)), Fraction(0.5 * (high - low)))
    places = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    sizes = float(size[0]) + float(size[1]) * places
    values = np.array([[family.speed(eps) for eps in sizes] for family in families])
    in_size = chebyshev.chebfit(places, values.T, NODES - 1)
    kept = 1 + int(np.flatnonzero(np.abs(in_size).max(axis=1) > 1e-13 * abs(in_size[0, 0]))[-1])
    rows = np.array([chebyshev.cheb2poly(column) for column in in_size[:kept].T])
    in_distance = chebyshev.chebfit(nodes, rows, ACROSS - 1)
    matrix = np.array([chebyshev.cheb2poly(column) for column in in_distance.T]).T
    return LibrationPiece(
        id=name,
        point=point,
        distance=(middle, half),
        size=size,
        polynomial=tuple(tuple(Fraction(float(value)) for value in row) for row in matrix),
        tube=Fraction(2.0 ** np.round(np.log2(TUBE * abs(values).max()))),
    )


class _Scaled(LyapunovFamily):
    """The family at one mass with sizes in units of b."""

    @property
    def scale(self) -> float:
        """abs(b)."""
        return abs(self.libration.x - 1 + float(self.mu))

    def speed(self, eps: float) -> float:
        """vy at a size."""
        return self.orbit(eps * SIDES[self.point] * self.scale).vy


def _family(point: str, distance: float) -> _Scaled:
    mass = distance**3 * float(mass_of_distance(SIDES[point], distance))
    return _Scaled(point, Fraction(mass))
