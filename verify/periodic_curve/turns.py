"""Where the parameter certainly changes its direction along a curve (section 26.5)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.verify.curve import Chain, Stretch
from orbitproof.verify.evidence import dot, enclose, sign

_PLACES = 16
"""On each stretch of a piece the direction is looked at in so many places and at its end."""


@dataclass(frozen=True)
class Turn:
    """An extremum of the parameter along a curve, between two places at which it goes in opposite directions.

    Attributes:
        is_maximum: whether it increases before and decreases after it.
        pieces: ids of the pieces of both places.
        between: their s.
        values: enclosures of the parameter at both.
    """

    is_maximum: bool
    pieces: tuple[str, str]
    between: tuple[Fraction, Fraction]
    values: tuple[arb, arb]


def turns_of(chain: Chain) -> tuple[Turn, ...]:
    """The extrema of the first coordinate that follow from its direction at finitely many places, in order."""
    found: list[Turn] = []
    before: tuple[int, Stretch, Fraction] | None = None
    for stretch in chain.stretches:
        for number in range(_PLACES + 1):
            s = stretch.entered + (stretch.leaves - stretch.entered) * Fraction(number, _PLACES)
            direction = sign(_slope(stretch, s))
            if not direction:
                continue
            if before is not None and before[0] != direction:
                _, earlier, place = before
                pieces = earlier.tube.piece.id, stretch.tube.piece.id
                values = earlier.tube.point(earlier.run, place)[0], stretch.tube.point(stretch.run, s)[0]
                found.append(Turn(direction < 0, pieces, (place, s), values))
            before = direction, stretch, s
    return tuple(found)


def _slope(stretch: Stretch, s: Fraction) -> arb:
    """The derivative of the first coordinate at s of a piece."""
    slopes = stretch.tube.local_slope(stretch.run, s)
    return dot([enclose(value) for value in stretch.tube.piece.frame[0]], slopes)
