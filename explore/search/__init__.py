"""From families to candidates: what ``orbitproof explore`` does when it is asked for bifurcations."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
