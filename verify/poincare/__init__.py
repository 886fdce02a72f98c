"""The Poincare map and its derivatives on a box: section, crossings, returns (sections 5, 6, 14)."""

from orbitproof.verify.poincare.coordinates import PHYSICAL
from orbitproof.verify.poincare.derivatives import MAX_ORDER, DerivativeTable, MultiIndex, multi_indices, table_of
from orbitproof.verify.poincare.iterates import (
    Enclosures,
    IntegratorSettings,
    default_order,
    enclose_first_integral,
    enclose_iterates,
)
from orbitproof.verify.poincare.returns import REGULARISED, Returns, evaluate

__all__ = [
    "MAX_ORDER",
    "PHYSICAL",
    "REGULARISED",
    "DerivativeTable",
    "Enclosures",
    "IntegratorSettings",
    "MultiIndex",
    "Returns",
    "default_order",
    "enclose_first_integral",
    "enclose_iterates",
    "evaluate",
    "multi_indices",
    "table_of",
]
