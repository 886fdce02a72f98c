"""When Newton's method has arrived, and when it is lost.

Its steps become smaller until what is left of them is rounding. How large that is depends on the orbit: near a
collision a half return amplifies the rounding of its start by many orders of magnitude. So a step below a fixed
tolerance is good, and one that is little shorter than the one before is as good as it gets, if it is not too long.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

STALLED = 0.25
"""A step longer than this part of the last one is rounding: far from it Newton's method squares them."""

DIVERGES = 2.0
"""A step longer than so many times the last one leads away."""


@dataclass(frozen=True)
class NewtonRule:
    """The rule for one set of equations.

    Attributes:
        tolerance: length of a step at which a solution is found.
        accepted: length up to which a step counts that no further one makes shorter.
        steps: how many are tried.
    """

    tolerance: float
    accepted: float
    steps: int

    def judge(self, size: Any, last: Any, *, accepted: Any = None, exact: Any = True) -> tuple[Any, Any]:
        """Whether a step of length `size`, after one of length `last`, is the end, and whether the method is lost.

        Arguments:
            size, last: numbers, or arrays of many iterations at once; `last` is infinite before the first step.
            accepted: in place of the rule's, where lengths are to be measured by something else.
            exact: what has to hold besides for a step below the tolerance.
        """
        accepted = self.accepted if accepted is None else accepted
        found = ((size < self.tolerance) & exact) | ((size < accepted) & (size > STALLED * last))
        going = (size < inf) & ((size <= DIVERGES * last) | (size <= accepted))
        return found, (found | going) ^ True


SHOOTING = NewtonRule(tolerance=1e-12, accepted=1e-10, steps=8)
"""For a half return from the last orbit of a family: predictions are good, and more steps mean another family."""

SEGMENTS = NewtonRule(tolerance=1e-13, accepted=1e-9, steps=12)
"""For several half returns at once, relative to each unknown: the rounding of all of them adds up."""

ALONG = NewtonRule(tolerance=1e-10, accepted=1e-7, steps=10)
"""For an orbit without symmetry on its curve, relative to the scales of the curve."""

AT_REST = NewtonRule(tolerance=1e-11, accepted=1e-8, steps=10)
"""For equilibria on their curve, of which nothing is integrated."""

CLOSING = NewtonRule(tolerance=1e-13, accepted=1e-9, steps=40)
"""For an orbit without symmetry from a guess that may be far away; relative to the size of the orbit."""

BREAKING = NewtonRule(tolerance=1e-13, accepted=1e-9, steps=10)
"""For an orbit together with its symmetry breaking: the second derivatives are known to fewer digits."""
