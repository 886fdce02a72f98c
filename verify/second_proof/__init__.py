"""A second proof of a certified bifurcation that shares no code with the rest: see README.md of this folder."""

from .jets import CannotFollow
from .proof import NotProved, Proved, second_proof
from .statement import BadCertificate, read_statement

__all__ = ["BadCertificate", "CannotFollow", "NotProved", "Proved", "read_statement", "second_proof"]
