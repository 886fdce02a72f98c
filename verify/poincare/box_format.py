"""The format of a box: its part of a polydisc, bits of each grade, and how small it may be (section 6)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, log2, log10

from orbitproof.verify.algebra import Grading
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import LEAST_ERROR

BOX_RATIO = Fraction(1, 4)
"""The box is this fraction of the polydisc on which the orbits are enclosed (section 6)."""

LOSS_DIVISOR = 6
"""A coefficient may lose this part of its bits per grade, and no more."""


def log2_of(value: Fraction) -> float:
    """log2(value), however small or large the value is."""
    return log2(value.numerator) - log2(value.denominator)


def check_size(grading: Grading, scales: Sequence[Fraction]) -> None:
    """Refuse boxes on which the least error of a step (2.3) exceeds what a derivative adds to the top grade."""
    smallest = min(scales[1] ** grading.top, scales[0] * scales[1])
    if smallest < Fraction(LEAST_ERROR):
        raise IntegrationFailure(
            "radii",
            f"errors are bounded by floats of at least 2^{round(log2(LEAST_ERROR))}, more than the derivatives that "
            f"count add up to on a box with R_1 = 10^{log2_of(scales[1] * BOX_RATIO) * log10(2):.0f}",
            "give larger radii: no precision helps",
        )


def grade_bits(grading: Grading, scales: Sequence[Fraction], bits: int) -> tuple[int, int]:
    """Further fractional bits per grade, and the significant bits that a coefficient loses per grade.

    Scaled initial values of a variable of weight w are about 2^-(w s); with s - d further bits per
    grade, grade g keeps about bits - g d significant bits.
    """
    logs = [-log2_of(scale) / weight for scale, weight in zip(scales, grading.weights, strict=True)]
    spare = bits // LOSS_DIVISOR
    size = max(0, floor(max(logs)))
    loss = min(size, spare)
    return size - loss, loss
