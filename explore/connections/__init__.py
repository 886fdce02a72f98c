"""Connections: orbits that tend to periodic orbits in both directions of time."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
