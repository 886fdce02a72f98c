"""Names of families, branches and units of the restricted three-body problem."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
