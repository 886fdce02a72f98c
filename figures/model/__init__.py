"""What pictures of families are drawn from: sampled families, their marked points, their stability."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
