"""Curves of periodic orbits from the equilibrium at which they are born on (section 38)."""

from orbitproof.verify.birth_curve.piece import BirthLimits, prove_birth_curve_piece
from orbitproof.verify.birth_curve.proved_curve import (
    BirthCurveTheorem,
    ProvedBirthCurve,
    conclude_births,
)
