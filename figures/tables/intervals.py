"""Closed intervals with exact rational ends, read from the notations in which papers print them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

_NUMBER = r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]{1,4})?"
_COMMON_DIGITS = re.compile(r"(-?[0-9]+\.[0-9]*)\[([0-9]+),\s*([0-9]+)\]\Z")
_ENDS = re.compile(rf"\[({_NUMBER}),\s*({_NUMBER})\]\Z")
_AROUND = re.compile(rf"({_NUMBER})\s*(?:\+-|±)\s*({_NUMBER})\Z")


@dataclass(frozen=True)
class Interval:
    """All real numbers from `lower` to `upper`. Raises `ValueError` if there is none."""

    lower: Fraction
    upper: Fraction

    def __post_init__(self) -> None:
        if self.lower > self.upper:
            raise ValueError("the lower end lies above the upper end")

    @property
    def middle(self) -> Fraction:
        """The midpoint."""
        return (self.lower + self.upper) / 2

    @property
    def width(self) -> Fraction:
        """Upper end minus lower end."""
        return self.upper - self.lower

    def inside(self, other: Interval) -> bool:
        """Whether every point of this interval lies in the closed interval `other`."""
        return other.lower <= self.lower and self.upper <= other.upper

    def distance(self, other: Interval) -> Fraction:
        """Distance of the two sets: zero exactly if they have a point in common."""
        return max(Fraction(0), other.lower - self.upper, self.lower - other.upper)


def parse_interval(text: str) -> Interval:
    """The interval that is printed as ``3.0216[6,8]``, ``[3.0, 3.1]`` or ``3.05 +- 1e-9``, exactly.

    In the first form the digits in brackets follow the common ones, for negative numbers as well; the end
    that is larger in magnitude may stand first or last. Raises `ValueError` for anything else.
    """
    text = text.strip()
    if match := _COMMON_DIGITS.match(text):
        stem, first, second = match.groups()
        if len(first) != len(second):
            raise ValueError(f"{text!r}: both ends need the same number of digits")
        ends = Fraction(stem + first), Fraction(stem + second)
        return Interval(min(ends), max(ends))
    if match := _ENDS.match(text):
        return Interval(Fraction(match[1]), Fraction(match[2]))
    if match := _AROUND.match(text):
        centre, radius = Fraction(match[1]), Fraction(match[2])
        return Interval(centre - radius, centre + radius)
    raise ValueError(f"{text!r} is not an enclosure (3.0216[6,8], [lower, upper] or centre +- radius)")
