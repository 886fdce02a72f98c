"""Systems: vector field, symmetries, section, parameters, as values and as straight-line programs."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
