"""Approximations (section 3): whatever comes from this room, nothing false follows."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
