"""What is stored of distances from a body along the orbits of an interval of a piece (section 20)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, unique
from fractions import Fraction
from typing import Annotated

from orbitproof.shared.stored import rules
from orbitproof.verify.functions import StoredFunction

PARTS = 16
"""An interval is divided into so many parts of equal length."""

SLACK = Fraction(1, 2**9)
"""Stored bounds are weaker by this share of them: another integration has to find bounds inside of them."""

Bounds = tuple[Fraction, Fraction]


@unique
class Where(Enum):
    """Where on an orbit a distance is taken: at one of its two points on Fix(R), or it is not shown to be there."""

    HERE = "this point"
    THERE = "the other point"
    ALONG = "along the orbit"


@dataclass(frozen=True)
class Extremes:
    """The least and the greatest squared distance over each of the orbits of a part of an interval.

    Attributes:
        least, greatest: dyadic bounds from below and above.
        least_at, greatest_at: where on every one of these orbits they are taken, if that is shown.
    """

    least: Bounds
    greatest: Bounds
    least_at: Where
    greatest_at: Where


@dataclass(frozen=True)
class DistanceFunctions:
    """Squared distances on an interval of a piece, as they are stored.

    Attributes:
        here, there: at x(s) and y(s), functions of tau.
        parts: from left to right, of equal length.
    """

    here: StoredFunction
    there: StoredFunction
    parts: Annotated[tuple[Extremes, ...], rules(maxItems=64)]
