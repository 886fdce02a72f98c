"""Traced families as files hold them; reading them needs neither JAX nor diffrax."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
