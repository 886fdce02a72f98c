"""What can be asked for: families by name, resonances, exact numbers as they are given."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
