"""From an approximate bifurcation to fifty digits and a box (Appendix B of the paper)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
