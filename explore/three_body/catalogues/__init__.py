"""The JPL catalogue of periodic orbits, in and out."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
