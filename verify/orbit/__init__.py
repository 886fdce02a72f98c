"""One symmetric orbit, singled out by a further equation: existence, multipliers, distances (section 19)."""

from orbitproof.verify.orbit.distance import Approach
from orbitproof.verify.orbit.following import Distance, OrbitEnclosures, enclose_orbit
from orbitproof.verify.orbit.multipliers import Stability
from orbitproof.verify.orbit.rates import distance_rates
from orbitproof.verify.orbit.statement import orbit_in_full, orbit_theorem
from orbitproof.verify.orbit.theorem import OrbitResults, prove_orbit
