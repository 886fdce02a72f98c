"""A second proof of a certified bifurcation that shares no code with the rest: see README.md of this folder."""

from .proof import NotProved, Proved, second_proof
from .runner import Comparison, compare

__all__ = ["Comparison", "NotProved", "Proved", "compare", "second_proof"]
