"""Tight enclosures of derivatives on parts of the box (section 7.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.verify.evidence import (
    MAX_ORDER,
    DerivativeTable,
    MultiIndex,
    index_factorial,
    indices_of_degree,
    indices_up_to,
    meet,
    total,
)
from orbitproof.verify.newton.jets import plus, unit


@dataclass(frozen=True)
class BoxFunction:
    """A scalar function on the box |p_i| <= R_i, known by its table of derivatives.

    Taylor's theorem about the centre, with derivatives at the centre below some order m and over the
    box at order m, encloses a derivative on a part of the box; m = 0 is the table itself. All m that
    the table allows are used and the results intersected.
    """

    table: DerivativeTable

    def derivative(self, index: MultiIndex, where: Sequence[arb]) -> arb:
        """Enclosure of the derivative at every point of the box with p_i in where[i]."""
        centre, box = self.table.centre, self.table.box
        size = len(index)

        def terms(source: Mapping[MultiIndex, arb], degree: int) -> arb:
            return total(_term(source[plus(index, shift)], where, shift) for shift in indices_of_degree(size, degree))

        result, below = box[index], arb(0)
        for degree in range(1, MAX_ORDER - sum(index) + 1):
            below = below + terms(centre, degree - 1)
            result = meet(result, below + terms(box, degree))
        return result

    def derivatives(self, where: Sequence[arb]) -> dict[MultiIndex, arb]:
        """Enclosures of all derivatives up to order 3 at every point of the box with p_i in where[i]."""
        return {index: self.derivative(index, where) for index in indices_up_to(len(where), MAX_ORDER)}

    def value(self, where: Sequence[arb]) -> arb:
        """Enclosure of the values."""
        return self.derivative((0,) * len(where), where)

    def gradient(self, where: Sequence[arb], start: int) -> list[arb]:
        """Enclosures of the first derivatives in the coordinates p_start, p_start+1, ..."""
        size = len(where)
        return [self.derivative(unit(size, position), where) for position in range(start, size)]


def _term(derivative: arb, where: Sequence[arb], shift: MultiIndex) -> arb:
    # Repeated multiplication: arb(0, 1) ** 2 is nan.
    result = derivative / index_factorial(shift)
    for ball, power in zip(where, shift, strict=True):
        for _ in range(power):
            result = result * ball
    return result
