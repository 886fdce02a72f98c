"""Periodic orbits of systems without symmetry: found, refined, continued."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
