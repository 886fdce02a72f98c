"""Trajectories: states of an orbit over time, from what any file says about it, as CSV and as an ephemeris message."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
