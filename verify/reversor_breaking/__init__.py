"""Births of orbits that the reversor R does not map to themselves (section 27)."""

from orbitproof.verify.reversor_breaking.equations import Coefficients, Kernel, LossEquations, equations_of
from orbitproof.verify.reversor_breaking.following import (
    BreakingEnclosures,
    across,
    enclose_breaking,
    variables_of,
)
from orbitproof.verify.reversor_breaking.proved_reversor_breaking import (
    BreakingResults,
    BreakingTheorem,
    both_points,
    check_breaking_exactly,
    check_curve,
    check_half_return,
    check_maps_exactly,
    check_sheet,
    not_about_maps,
    parameter_of,
    period_of,
    prove_breaking,
    theorem_of,
)
from orbitproof.verify.reversor_breaking.shifted import is_shifted_by
