"""One symmetric orbit, singled out by a further equation: existence, multipliers, distances (section 19)."""

from orbitproof.verify.orbit.distance import Approach, DistanceAlong
from orbitproof.verify.orbit.following import Distance, OrbitEnclosures, enclose_orbit
from orbitproof.verify.orbit.multipliers import STABLE, UNDECIDED, UNSTABLE, Stability, stability_of
from orbitproof.verify.orbit.proved_orbit import Extremum, OrbitResults, OrbitTheorem, prove_orbit
from orbitproof.verify.orbit.rates import distance_rates, rates_along
