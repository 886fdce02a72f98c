"""One style for all pictures: sheet, colours, markers, labels."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
