"""What a candidate claims: symmetries, frames, the level of the first integral as parameter (sections 1, 12)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
