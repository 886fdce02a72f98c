"""Integration of the vector field in float64, one orbit or many."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
