"""The orbits that are born at a bifurcation, followed to both sides."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
