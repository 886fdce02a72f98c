"""Bifurcations of periodic orbits of vector fields: folds, period doublings, pitchforks, tori (section 25)."""

from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures, variables_of
from orbitproof.verify.periodic_bifurcation.following import enclose_periodic_bifurcation
from orbitproof.verify.periodic_bifurcation.proved_periodic_bifurcation import (
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
    check_bifurcation_exactly,
    prove_periodic_bifurcation,
)
from orbitproof.verify.periodic_bifurcation.proved_torus import (
    TorusResults,
    TorusTheorem,
    check_torus_exactly,
    prove_torus,
    without_plane,
)
from orbitproof.verify.periodic_bifurcation.torus_coefficients import TorusCoefficients, coefficients_of_torus
