"""What to try next about a claim, with how many bits, on which box (section 10.3); nothing is proved by it."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
