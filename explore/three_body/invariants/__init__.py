"""What surrounds a periodic orbit: invariant tori of elliptic ones, stable and unstable manifolds. Numerics only."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
