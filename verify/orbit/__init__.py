"""One symmetric orbit, singled out by a further equation: existence, multipliers, distances (section 19)."""

from orbitproof.verify.orbit.distance import Approach, DistanceAlong
from orbitproof.verify.orbit.following import Distance, OrbitEnclosures, enclose_orbit
from orbitproof.verify.orbit.full_return import full_return_jets, half_return_jets, inverse_jets, jets_on_level
from orbitproof.verify.orbit.multipliers import STABLE, UNDECIDED, UNSTABLE, Stability, stability_from, stability_of
from orbitproof.verify.orbit.proved_orbit import Extremum, OrbitResults, OrbitTheorem, check_orbit, prove_orbit
from orbitproof.verify.orbit.rates import distance_rates, rates_along
