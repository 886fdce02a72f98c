"""Lyapunov-Schmidt reduction, conditions and theorems (sections 8, 9, 11)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
