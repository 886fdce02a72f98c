"""Periodic orbits of vector fields without symmetry: existence, least period, multipliers (section 24)."""

from orbitproof.verify.periodic.box import (
    SectionCoordinates,
    check_coordinates,
    check_functions_of,
    check_integral,
    check_transversal,
    functions_at_start,
    gradient_on,
    section_coordinates,
    section_of,
    slopes_along,
    state_on_box,
    whole_state,
)
from orbitproof.verify.periodic.enclosures import Linearised, PeriodicEnclosures, SectionReturn, stops_of
from orbitproof.verify.periodic.following import enclose_periodic
from orbitproof.verify.periodic.force import PeriodsOfForce, of_orbit, periods_of_force
from orbitproof.verify.periodic.multipliers import Multipliers, eigenvalues_of, multipliers_of, on_level
from orbitproof.verify.periodic.proved_periodic import (
    PeriodicResults,
    PeriodicTheorem,
    check_periodic_exactly,
    prove_periodic,
)
