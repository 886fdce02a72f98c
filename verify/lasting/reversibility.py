"""How far what reversibility makes zero is enclosed with zero (section 29.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.verify.evidence import is_below, is_positive
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.lasting.stored import CurveIntervalResult, TwistFunctions, parts_from


@dataclass(frozen=True)
class Reversibility:
    """What the functions D say on the intervals on which they are stored.

    Attributes:
        intervals: how many there are.
        known_part: the largest share of its bound that the known part of one D has: at most 1.
        sharp: on how many intervals the bound of D is less than what |Theta| reaches.
        bound: the largest share of that which the bound has on these; `None` if there are none.
    """

    intervals: int
    known_part: arb
    sharp: int
    bound: arb | None


def reversibility(results: Sequence[CurveIntervalResult]) -> Reversibility | None:
    """What all proved intervals say; `None` without functions. Raises `ValueError` if a D is not enclosed with 0."""
    shares, bounds = [], []
    proved = [result for result in results if result.is_proved and isinstance(result.twist, TwistFunctions)]
    for result in proved:
        assert isinstance(result.twist, TwistFunctions)
        share = result.twist.defect.enclosed.known_share
        if not share <= 1:
            raise ValueError(f"on an interval of {result.piece} what reversibility makes zero is not")
        shares.append(share)
        bound, least = result.twist.defect.enclosed.error, _reached(result.twist.twist.enclosed)
        if is_positive(least) and is_below(bound, least):
            bounds.append((bound / least).upper())
    if not shares:
        return None
    return Reversibility(len(shares), max(shares), len(bounds), max(bounds, default=None))


def _reached(function: BoundedFunction) -> arb:
    """A lower bound of the largest absolute value on the interval."""
    places = [arb(0), *(arb(float(low)) for low, _ in parts_from(-1 / REACH)[1:])]
    return max(function.value(place).abs_lower() for place in places)
