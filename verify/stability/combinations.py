"""Combination resonances of two pairs of multipliers as zeros of functions along the curve (section 18.13)."""

from __future__ import annotations

from collections.abc import Iterator

from flint import arb

from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.stability.kinds import Kind
from orbitproof.verify.stability.list_entries import Segment


def combination_functions(segment: Segment) -> Iterator[tuple[Kind, BoundedFunction]]:
    """What vanishes at a combination resonance of each kind, n = 2 (Lemma 18.10); none for another n."""
    if len(segment.characteristic) != 2:
        return
    trace, determinant = segment.characteristic
    square = determinant * determinant
    power = trace * trace
    # Sums of the squares and of the fourth powers of the stability parameters.
    squares = power - determinant.scaled(arb(2))
    fourth = squares * squares - square.scaled(arb(2))
    yield (
        Kind.TWO_TO_ONE,
        (
            square.scaled(arb(4))
            + determinant.scaled(arb(5))
            + (trace * determinant).scaled(arb(6))
            - (power * trace).scaled(arb(2))
            - power.scaled(arb(2))
            + trace
        ).shifted(arb(1)),
    )
    yield (
        Kind.THREE_TO_ONE,
        (
            (square * determinant).scaled(arb(16))
            - (determinant * squares).scaled(arb(12))
            - fourth.scaled(arb(4))
            + determinant.scaled(arb(10))
            + squares.scaled(arb(3))
        ),
    )
    yield Kind.OPPOSITE, trace
