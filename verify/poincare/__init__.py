"""The Poincare map and its derivatives on a box: section, crossings, returns (sections 5, 6, 14)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
