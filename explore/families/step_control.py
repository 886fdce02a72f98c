"""Steps and tolerances of the continuation of a family, and how long its stability is sampled."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.explore import numerics
from orbitproof.explore.numerics import SHOOTING


@dataclass(frozen=True)
class StepControl(numerics.StepControl):
    """Arclength steps, in scaled unknowns.

    The largest grows with the scaled unknowns once these exceed 10, so that the long arcs towards a collision, where
    velocities are large, stay affordable.

    Attributes:
        tolerance: of the correction; see `ShootingProblem.tolerance`.
        until_tangency: whether a family ends where an orbit touches the section, so that the number of its
            crossings changes.
    """

    initial: float = 1e-3
    minimum: float = 1e-7
    maximum: float = 0.02
    turning: float = 0.12
    tolerance: float = SHOOTING.tolerance
    until_tangency: bool = False


DEFAULT = StepControl()

CONTROL = StepControl(initial=2e-3, minimum=1e-8, maximum=0.1, turning=0.12)
"""For tracing families by name: coordinates are measured in the distance of the libration point from a primary."""

SAMPLING_TIMEOUT = 600.0
"""Seconds for sampling the stability along a family, unless told otherwise; options are declared with it."""
