"""Curves of periodic orbits of any vector field, in pieces, over a parameter or the levels of an integral (26)."""

from orbitproof.verify.periodic_curve.characteristic import (
    MultiplierFunctions,
    PeriodicIntervalResult,
    unconfirmed_multipliers,
)
from orbitproof.verify.periodic_curve.conditions import require_piece
from orbitproof.verify.periodic_curve.counted import CountedPart, Counts, number_of_multipliers
from orbitproof.verify.periodic_curve.piece import PeriodicLimits, PeriodicTubeTheorem, prove_periodic_piece
from orbitproof.verify.periodic_curve.proved_curve import PeriodicCurveTheorem, ProvedPeriodicCurve, conclude_periodic
from orbitproof.verify.periodic_curve.turns import Turn
