"""The Poincare map and its derivatives on a box: section, crossings, returns (sections 5, 6, 14)."""

from orbitproof.verify.poincare.coordinates import PHYSICAL, Coordinates, coordinates_of, physical
from orbitproof.verify.poincare.crossing import Arrival, CrossingCounter, InTime, range_of, stays_positive, wide_parts
from orbitproof.verify.poincare.derivatives import derivative_table, table_of
from orbitproof.verify.poincare.early_end import EarlyEnd, HalfReturns
from orbitproof.verify.poincare.functions import defined_values
from orbitproof.verify.poincare.half_orbit import check_half_orbit
from orbitproof.verify.poincare.half_orbits import WIDE_PARTS, HalfOrbits, WideOracle, WideOrbits
from orbitproof.verify.poincare.half_return import Derivatives, HalfReturn, enclose_half_return, named
from orbitproof.verify.poincare.iterates import (
    BOX_RATIO,
    Box,
    Enclosures,
    Integration,
    IntegratorSettings,
    box_of,
    check_size,
    enclose_iterates,
    grade_bits,
    grading_for,
)
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.regularised import is_regularised
from orbitproof.verify.poincare.returns import (
    MOST_STEPS,
    REGULARISED,
    Orbits,
    Returns,
    default_order,
    first_integral,
    initial_values,
    kernel_components,
)
from orbitproof.verify.poincare.sheets import on_sheet
from orbitproof.verify.poincare.without_time import at_start
