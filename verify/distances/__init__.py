"""Distances from a body along the orbits of a curve (section 20)."""

from orbitproof.verify.distances.distances import DistanceAlongCurve
from orbitproof.verify.distances.ranges import (
    Extreme,
    KnownDistances,
    Ranges,
    distance_along,
    is_distance_of_orbits,
    known_distances,
    ranges_between,
    together,
)
from orbitproof.verify.distances.stored_distances import DistanceFunctions, Extremes, Where
