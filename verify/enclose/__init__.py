"""Validated flows and Poincare maps of any system, for use: exact numbers in, balls out (section 23).

`box` and `section` are sets, `flow` and `poincare_map` enclose what becomes of a box, `fixed_point_functions` and
`interval_newton` prove fixed points. Each returns what it has shown, or `NotEnclosed` with the reason; exceptions are
for wrong input.
"""

from orbitproof.verify.enclose.maps import fixed_point_functions, flow, interval_newton, poincare_map
from orbitproof.verify.enclose.results import Enclosure, Function, NotEnclosed, Values, Zero
from orbitproof.verify.enclose.sets import Box, Section, box, section

__all__ = [
    "Box",
    "Enclosure",
    "Function",
    "NotEnclosed",
    "Section",
    "Values",
    "Zero",
    "box",
    "fixed_point_functions",
    "flow",
    "interval_newton",
    "poincare_map",
    "section",
]
