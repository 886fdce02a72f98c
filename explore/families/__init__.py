"""Families of symmetric orbits: continuation, names, detection of resonances, files."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
