"""Zeros, steps along a curve, Newton's method in double precision and with many digits."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
