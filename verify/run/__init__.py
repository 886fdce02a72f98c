"""Where tasks are done, side by side, and what people see of it."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
