"""Symmetric periodic orbits through points of Fix(R), for drawing."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
