"""Distances from a body along the orbits of a curve (section 20)."""

from orbitproof.verify.distances.distances import DistanceAlongCurve, DistanceFunctions, Extremes, Where
from orbitproof.verify.distances.ranges import (
    Extreme,
    KnownDistances,
    Ranges,
    is_distance_of_orbits,
    known_distances,
    ranges_between,
    together,
)
