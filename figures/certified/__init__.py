"""What certificates say, as it is drawn: boxes with their curves, proved curves, their stability."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
