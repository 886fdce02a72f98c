"""From a candidate to its certificate, and checking a certificate again (sections 10 and 13)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
