"""The Poincare map and its derivatives on a box: section, crossings, returns (sections 5, 6, 14)."""

from orbitproof.verify.poincare.coordinates import PHYSICAL
from orbitproof.verify.poincare.derivatives import table_of
from orbitproof.verify.poincare.iterates import (
    Enclosures,
    IntegratorSettings,
    default_order,
    enclose_first_integral,
    enclose_iterates,
)
from orbitproof.verify.poincare.returns import REGULARISED, Returns, at_start, first_integral, kernel_components

__all__ = [
    "PHYSICAL",
    "REGULARISED",
    "Enclosures",
    "IntegratorSettings",
    "Returns",
    "at_start",
    "default_order",
    "enclose_first_integral",
    "enclose_iterates",
    "first_integral",
    "kernel_components",
    "table_of",
]
