"""The flow: defect of an approximation, existence and propagation of errors, step by step (sections 3 and 4)."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
