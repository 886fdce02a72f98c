"""What counts as shown: comparisons of balls, hypotheses with their enclosures, outcomes."""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
