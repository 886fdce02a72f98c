"""Orbits and families as values for scripts and notebooks: what they are, and what the command line does with them."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
