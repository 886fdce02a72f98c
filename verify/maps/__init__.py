"""Flows and Poincare maps of any system on sets of initial values, and their fixed points (section 23)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
