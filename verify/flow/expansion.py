"""The door for approximate solutions (section 3.2): whatever they are, `verify.flow.step` bounds their defect."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, inf, log2
from typing import Protocol

from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow.field_along import FieldAlong

_STEP_BITS = 12
_LEAST_STEP = 1e-8


class Expansion(Protocol):
    """The solutions from one state, expanded in time, before a step is chosen. Nothing here carries proof.

    Attributes:
        step_size: a step that suits the format.
    """

    step_size: float

    def shortened(self, step: Fraction) -> Fraction:
        """The step, or less of it where its last terms are much larger than the first ones say that they are."""

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """The first zero of a component of the centre's orbit in (0, step], as a fraction of the step, dyadic."""

    def solve(self, along: FieldAlong, step: Fraction) -> None:
        """Give all monomials of a solution over a step, which starts at the known parts of the state exactly."""


def rough(values: Sequence[int], bits: int) -> list[float]:
    """Fixed-point numbers in float64. Raises `IntegrationFailure`."""
    try:
        return [value / (1 << bits) for value in values]
    except OverflowError:
        raise IntegrationFailure(
            "size", "the orbit leaves the range of floating-point numbers", "give another centre"
        ) from None


def dyadic_below(size: float) -> Fraction:
    """A dyadic number just below `size` with few bits."""
    exponent = floor(log2(size)) - _STEP_BITS
    return Fraction(floor(size / 2.0**exponent)) * Fraction(2) ** exponent


def planned_step(size: float, share: float, time: float) -> Fraction:
    """A dyadic part of a step that suits the format. Raises `IntegrationFailure` where that is too small.

    Args:
        share: about which part.
        time: at which this is, for the message.
    """
    if not _LEAST_STEP <= size < inf:
        raise IntegrationFailure(
            "singularity",
            f"at time {time:.9g} the Taylor expansions allow only a step of {size:.1e}",
            "the orbit comes too close to a singularity of the vector field, or grows without bound: give another "
            "centre",
        )
    return dyadic_below(size * share)
