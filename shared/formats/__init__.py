"""JSON formats: claims and other documents, read, checked against their schema, and written."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
