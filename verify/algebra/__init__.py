"""Power series on the polydisc with one error bound per grade (section 2)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
