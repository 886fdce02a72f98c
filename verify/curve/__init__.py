"""Curves of symmetric orbits in pieces: tubes, gluing, bifurcations on the curve (sections 15 and 16)."""

from orbitproof.verify.curve.conclusion import Conclusion, Ends
from orbitproof.verify.curve.conditions import hypotheses_of as curve_hypotheses
from orbitproof.verify.curve.piece import PieceLimits, prove_piece
from orbitproof.verify.curve.piece_result import Account, Interval, PieceResult, attempt, interval_to_json
from orbitproof.verify.curve.theorem import conclude

__all__ = [
    "Account",
    "Conclusion",
    "Ends",
    "Interval",
    "PieceLimits",
    "PieceResult",
    "attempt",
    "conclude",
    "curve_hypotheses",
    "interval_to_json",
    "prove_piece",
]
