"""What is claimed, as values: boxes with a bifurcation or an orbit, curves and surfaces in pieces."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
