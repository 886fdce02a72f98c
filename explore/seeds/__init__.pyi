from .equilibria import EquilibriumFailure as EquilibriumFailure
from .equilibria import small_orbits as small_orbits
from .falkner_skan import limit_orbit as limit_orbit
from .first_orbit import FirstOrbit as FirstOrbit
