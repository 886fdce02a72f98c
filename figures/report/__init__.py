"""Reports: what certificates prove, as one document to read, to print and to cite."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
