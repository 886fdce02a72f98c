"""Exact numbers and intervals in decimals for people (section 10.2)."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from orbitproof.shared.numbers import format_rational
from orbitproof.verify.evidence.decimals import decimal, floor_log10, ten


def exact_interval_text(lower: Fraction, upper: Fraction, digits: int = 9, inward: bool = False) -> str:
    """``[lower, upper]`` in decimals that contain all of an exact interval, or with `inward` nothing beyond it.

    A single point has nothing inside: it is contained, with `inward` too.
    `digits` significant digits are written, and more where it takes them to show two digits of the width.
    """
    size = max(abs(lower), abs(upper))
    places = digits - 1 - floor_log10(size) if size else 0
    if lower < upper:
        places = max(places, 1 - floor_log10(upper - lower))
    down, up = (ceil, floor) if inward and lower < upper else (floor, ceil)
    return f"[{_short(down(lower * ten(places)), places)}, {_short(up(upper * ten(places)), places)}]"


def _short(scaled: int, places: int) -> str:
    """As `decimal`, without zeros at the end."""
    while scaled and scaled % 10 == 0 and places > 0:
        scaled, places = scaled // 10, places - 1
    return decimal(scaled, places)


def exact_text(value: Fraction) -> str:
    """A number exactly: in decimals where these are short, else dyadic with an approximate decimal before it."""
    if value.denominator == 1:
        return str(value.numerator)
    exact = format_rational(value)
    return str(float(value)) if Fraction(str(float(value))) == value else f"{float(value):.17g} (exactly {exact})"
