"""Interval Newton, Taylor forms and jets of implicit functions (section 7)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
