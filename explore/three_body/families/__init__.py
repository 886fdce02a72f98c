"""The families of the restricted three-body problem that have names."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
