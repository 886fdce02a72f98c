from .families import OrbitFamily as OrbitFamily
from .orbits import Orbit as Orbit
from .orbits import level_text as level_text
from .orbits import orbit_value as orbit_value
from .orbits import read_orbit as read_orbit
