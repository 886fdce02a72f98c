"""First approximations of orbits: libration points with their linear orbits, the limit of Falkner-Skan's."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
