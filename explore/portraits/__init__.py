"""Phase portraits of reversible planar maps at their resonances."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
