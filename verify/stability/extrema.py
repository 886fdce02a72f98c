"""Extrema of the stability parameters that are close to the resonant values (section 18.10)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.verify.evidence import enclose, excludes_zero, is_below, is_inside
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.stability.list_entries import Segment
from orbitproof.verify.stability.zeros import between, zeros_on

BAND = Fraction(11, 10)
"""Values farther from 0 are not close to a resonant one."""
_PARTS = 64
_SMALLEST = Fraction(1, 2**20)

Turn = tuple[arb, arb]
"""tau of an extremum, and the value there."""
Part = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class _Stationary:
    """A function of tau that vanishes where a stability parameter is stationary, for n = 1 and n = 2 (18.8)."""

    trace: BoundedFunction
    second: BoundedFunction | None

    def value(self, part: arb) -> arb:
        """Values on a part of the interval."""
        slope = self.trace.slope(part)
        if self.second is None:
            return slope
        other = self.second.slope(part)
        return other * other - self.trace.value(part) * slope * other + self.second.value(part) * slope * slope

    def slope(self, part: arb) -> arb:
        """Derivatives on a part of the interval."""
        bend = self.trace.curvature(part)
        if self.second is None:
            return bend
        slope, other, other_bend = self.trace.slope(part), self.second.slope(part), self.second.curvature(part)
        mixed = self.trace.value(part) * (bend * other + slope * other_bend)
        return 2 * other * other_bend - mixed + 2 * self.second.value(part) * slope * bend

    def over_square(self, part: arb) -> arb:
        """For even functions: this function divided by tau^2, on [0, tau] with `part` around it."""
        bend = self.trace.curvature(part)
        if self.second is None:
            # The trace's slope divided by tau.
            return bend
        other = self.second.curvature(part)
        return other * other - self.trace.value(part) * bend * other + self.second.value(part) * bend * bend

    def parameter(self, part: arb) -> arb:
        """The stability parameter, at points of the part at which it is stationary; not finite if not known."""
        if self.second is None:
            return self.trace.value(part)
        slope = self.trace.slope(part)
        return self.second.slope(part) / slope if excludes_zero(slope) else arb("nan")

    def may_turn(self, part: arb) -> bool:
        """Whether there may be a stationary value in the band on a part."""
        if excludes_zero(self.value(part)):
            return False
        value = self.parameter(part)
        return not (value.is_finite() and is_below(enclose(BAND), abs(value)))


def extrema_on(segment: Segment, at_end: int) -> tuple[list[Turn], list[Part]]:
    """The extrema of stability parameters with values in [-BAND, BAND], and the parts on which that is not decided.

    For n <= 2. Those with enclosures that meet the band are there too: see `is_in_band`.

    `at_end` is -1 or 1 if the segment begins or ends at a symmetric point, which is not counted.
    """
    trace, *others = segment.characteristic
    function = _Stationary(trace, others[0] if others else None)
    first, start, end = (segment.tau(s) for s in (segment.start, segment.entered, segment.end))
    found: list[Turn] = []
    undecided: list[Part] = []
    if first < start and function.may_turn(between(first, start)):
        undecided.append((first, start))
    if at_end:
        beside = _free_beside_zero(function, end if at_end < 0 else start)
        start, end = (beside, end) if at_end < 0 else (start, beside)
        if not beside:
            undecided.append((Fraction(0), end) if at_end < 0 else (start, Fraction(0)))
    for low, high in _where_it_may_turn(function, start, end):
        zeros = zeros_on(function, low, high)
        undecided += [part for part in zeros.undecided if function.may_turn(between(*part))]
        for zero in zeros.zeros:
            value = function.parameter(zero.place)
            discriminant = segment.discriminant
            apart = discriminant is None or excludes_zero(discriminant.value(zero.place))
            if not (apart and value.is_finite()):
                undecided.append((zero.lower, zero.upper))
            elif not is_below(enclose(BAND), abs(value)):
                found.append((zero.place, value))
    return found, undecided


def is_in_band(value: arb) -> bool:
    """Whether a value certainly is in the band, its ends not included."""
    return is_inside(value, BAND)


def _free_beside_zero(function: _Stationary, far: Fraction) -> Fraction:
    """A number up to which, from 0 on, nothing but the symmetric point is stationary; 0 if that is not shown."""
    end = far
    while abs(end) > _SMALLEST:
        if excludes_zero(function.over_square(between(*sorted((Fraction(0), end))))):
            return end
        end /= 2
    return Fraction(0)


def _where_it_may_turn(function: _Stationary, start: Fraction, end: Fraction) -> list[Part]:
    """Parts of an interval outside of which there is no stationary value in the band; neighbours are one part."""
    result: list[Part] = []
    for number in range(_PARTS):
        low, high = (start + (end - start) * Fraction(i, _PARTS) for i in (number, number + 1))
        if low < high and function.may_turn(between(low, high)):
            if result and result[-1][1] == low:
                low = result.pop()[0]
            result.append((low, high))
    return result
