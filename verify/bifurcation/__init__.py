"""Lyapunov-Schmidt reduction, conditions and theorems (sections 8, 9, 11)."""

from orbitproof.verify.bifurcation.conditions import (
    Problem,
    check_enclosures,
    check_family,
    check_reduced_function,
    check_reduction,
    check_transversality,
    locate,
    narrowed_zero,
)
from orbitproof.verify.bifurcation.counsel import Counsel, Failure, silent
from orbitproof.verify.bifurcation.fold import FoldTheorem, TurningCurve, check_curve, check_fold
from orbitproof.verify.bifurcation.level_forms import (
    check_own_box,
    coordinates_in_box,
    enclose_first_integral,
    in_box,
    level_form,
    level_spread,
)
from orbitproof.verify.bifurcation.on_the_way import check_half_returns
from orbitproof.verify.bifurcation.proved_bifurcation import (
    BifurcationResults,
    BifurcationTheorem,
    check_exactly,
    parameter_name,
    prepare,
)
from orbitproof.verify.bifurcation.reduction import (
    BifurcationFunction,
    DoublySymmetricFamily,
    Family,
    PeriodTwoFamily,
    ReducedFunction,
    reduced_function,
)
from orbitproof.verify.bifurcation.refusals import prove_by
from orbitproof.verify.bifurcation.theorems import TheoremInBox, prove, theorem_of
