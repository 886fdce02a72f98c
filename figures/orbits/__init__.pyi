from .fixed_set import Array as Array
from .fixed_set import parameter_values as parameter_values
from .fixed_set import state_on_fixed_set as state_on_fixed_set
from .orbit import OrbitNotClosed as OrbitNotClosed
from .orbit import orbit_through as orbit_through
from .orbit import symmetric_orbit as symmetric_orbit
from .orbit import symmetric_orbits as symmetric_orbits
