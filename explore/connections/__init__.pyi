from .claims import homoclinic_claim as homoclinic_claim
from .homoclinic import ConnectionFailure as ConnectionFailure
from .homoclinic import Homoclinic as Homoclinic
from .homoclinic import Hyperbolic as Hyperbolic
from .homoclinic import OnLevel as OnLevel
from .homoclinic import closer as closer
from .homoclinic import homoclinic_orbits as homoclinic_orbits
from .homoclinic import hyperbolic_orbit as hyperbolic_orbit
