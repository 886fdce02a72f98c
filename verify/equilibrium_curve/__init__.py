"""Curves of equilibria over a parameter, with their folds and the sides of their eigenvalues (section 37)."""

from orbitproof.verify.equilibrium_curve.counted import SidedPart, Sides
from orbitproof.verify.equilibrium_curve.folds import Fold
from orbitproof.verify.equilibrium_curve.piece import EquilibriumLimits, prove_equilibrium_piece
from orbitproof.verify.equilibrium_curve.proved_curve import (
    EquilibriumCurveTheorem,
    ProvedEquilibriumCurve,
    conclude_equilibria,
)
