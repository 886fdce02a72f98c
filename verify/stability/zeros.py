"""All zeros of a function on an interval, one by one, or where this is not decided (section 18.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb

from orbitproof.verify.evidence import enclose, exact_value, excludes_zero, hull, is_below, sign

_SMALLEST = Fraction(1, 2**40)
"""Intervals of tau that are shorter are not divided any more."""
_SPLITS = (Fraction(1, 2), Fraction(3, 8), Fraction(5, 8), Fraction(7, 16), Fraction(9, 16), Fraction(1, 3))
"""Where an interval is divided: at the first of these points at which the function has a certain sign."""
_STEPS = 60
_MOST_PARTS = 4096
"""After so many parts of an interval what is left of it is undecided."""


class Enclosed(Protocol):
    """A function of tau with enclosures on parts of the interval."""

    def value(self, part: arb) -> arb:
        """An enclosure of its values."""

    def slope(self, part: arb) -> arb:
        """An enclosure of its derivative."""


class EnclosedTwice(Enclosed, Protocol):
    """A function that is enclosed with its second derivative too."""

    def curvature(self, part: arb) -> arb:
        """An enclosure of its second derivative."""


@dataclass(frozen=True)
class Zero:
    """The only zero of a function in [lower, upper]; the derivative has no zero there.

    Attributes:
        lower, upper: tau; the function has opposite signs at them.
        place: a ball that contains the zero.
    """

    lower: Fraction
    upper: Fraction
    place: arb


@dataclass(frozen=True)
class Zeros:
    """What is known of the zeros of a function on an interval.

    Attributes:
        zeros: each of them, from left to right, outside of `undecided`.
        undecided: intervals on which nothing is known.
    """

    zeros: tuple[Zero, ...]
    undecided: tuple[tuple[Fraction, Fraction], ...]


def zeros_on(function: Enclosed, lower: Fraction, upper: Fraction) -> Zeros:
    """The zeros on [lower, upper], |tau| <= 1/REACH; those at the ends are undecided."""
    zeros: list[Zero] = []
    undecided: list[tuple[Fraction, Fraction]] = []
    pending = [(lower, upper)]
    for _ in range(_MOST_PARTS):
        if not pending:
            break
        first, last = pending.pop()
        part = between(first, last)
        if excludes_zero(function.value(part)):
            continue
        signs = [sign(function.value(enclose(end))) for end in (first, last)]
        if all(signs) and excludes_zero(function.slope(part)):
            if signs[0] != signs[1]:
                zeros.append(Zero(first, last, _narrowed(function, first, last)))
            continue
        middle = _divided(function, first, last) if last - first > _SMALLEST else None
        if middle is None:
            undecided.append((first, last))
        else:
            pending += [(middle, last), (first, middle)]
    return Zeros(tuple(sorted(zeros, key=lambda zero: zero.lower)), _merged([*undecided, *pending]))


def zeros_beside_double_one(function: EnclosedTwice, upper: Fraction) -> tuple[Fraction, Zeros]:
    """For a function with a double zero at 0: its other zeros on [0, upper], or [upper, 0].

    Returns the end of an interval from 0 on on which there is none, and what is known beyond it.
    """
    end = upper
    while abs(end) > _SMALLEST:
        if excludes_zero(function.curvature(between(Fraction(0), end))):
            if end == upper:
                return end, Zeros((), ())
            return end, zeros_on(function, *sorted((end, upper)))
        end /= 2
    low, high = sorted((Fraction(0), upper))
    return Fraction(0), Zeros((), ((low, high),))


def between(lower: Fraction, upper: Fraction) -> arb:
    """A ball that contains an interval."""
    return hull(enclose(lower), enclose(upper))


def _divided(function: Enclosed, lower: Fraction, upper: Fraction) -> Fraction | None:
    for share in _SPLITS:
        middle = lower + share * (upper - lower)
        if sign(function.value(enclose(middle))):
            return middle
    return None


def _narrowed(function: Enclosed, lower: Fraction, upper: Fraction) -> arb:
    """The zero, by interval Newton: each image contains it."""
    place = between(lower, upper)
    for _ in range(_STEPS):
        middle = place.mid()
        slope = function.slope(place)
        if not excludes_zero(slope):
            return place
        image = middle - function.value(middle) / slope
        try:
            narrower = place.intersection(image)
        except ValueError:
            raise ArithmeticError("an interval Newton image misses the zero: a bound is wrong") from None
        if not narrower.is_finite() or not is_below(narrower.rad() * 2, place.rad()):
            return narrower if narrower.is_finite() else place
        place = narrower
    return place


def _merged(intervals: Sequence[tuple[Fraction, Fraction]]) -> tuple[tuple[Fraction, Fraction], ...]:
    """Intervals without common inner points, neighbours as one."""
    result: list[tuple[Fraction, Fraction]] = []
    for first, last in sorted(intervals):
        if result and first <= result[-1][1]:
            result[-1] = (result[-1][0], last)
        else:
            result.append((first, last))
    return tuple(result)


def ends_of(ball: arb) -> tuple[Fraction, Fraction]:
    """Numbers below and above all points of a finite ball."""
    return exact_value(ball.lower()), exact_value(ball.upper())
