"""Orbits among bodies that move as kernels for SPICE say: carried over from the restricted problem. Not rigorous."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
