"""One symmetric orbit, singled out by a further equation: existence, multipliers, distances (section 19)."""

from orbitproof.verify.orbit.distance import Approach
from orbitproof.verify.orbit.following import Distance, OrbitEnclosures, enclose_orbit
from orbitproof.verify.orbit.multipliers import STABLE, UNDECIDED, UNSTABLE, Stability
from orbitproof.verify.orbit.proved_orbit import Extremum, OrbitResults, OrbitTheorem, prove_orbit
from orbitproof.verify.orbit.rates import distance_rates
