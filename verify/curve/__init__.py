"""Curves of symmetric orbits in pieces: tubes, gluing, bifurcations on the curve (sections 15 and 16)."""

from orbitproof.verify.curve.piece import PieceLimits, prove_piece, recentred
from orbitproof.verify.curve.theorem import conclude

__all__ = [
    "PieceLimits",
    "conclude",
    "prove_piece",
    "recentred",
]
