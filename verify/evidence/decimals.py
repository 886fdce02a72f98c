"""The ends of balls as decimals that are rounded outward (section 10.2)."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from flint import arb

from orbitproof.verify.evidence.comparisons import bounds

_PLAIN = range(-7, 22)
"""Decimal exponents that are written without an exponent."""


def decimal_interval(ball: arb, digits: int = 40) -> str:
    """``[lower, upper]`` in decimals, rounded outward, about two digits of the width visible.

    At most `digits` significant digits are written; balls that are not finite are named.
    """
    if not ball.is_finite():
        return "not finite"
    lower, upper = bounds(ball)
    places = places_of(lower, upper, digits)
    return f"[{decimal(floor(lower * ten(places)), places)}, {decimal(ceil(upper * ten(places)), places)}]"


def decimal_above(ball: arb, digits: int = 2) -> str:
    """The upper end of a finite ball, not negative, with so many significant digits, rounded up."""
    _, upper = bounds(ball)
    places = places_of(upper, upper, digits)
    return decimal(ceil(upper * ten(places)), places)


def ten(places: int) -> Fraction:
    """10^places."""
    return Fraction(10) ** places


def floor_log10(value: Fraction) -> int:
    """floor(log10(value)) for a positive value."""
    guess = int((value.numerator.bit_length() - value.denominator.bit_length()) * 0.30103)
    while ten(guess) > value:
        guess -= 1
    while ten(guess + 1) <= value:
        guess += 1
    return guess


def places_of(lower: Fraction, upper: Fraction, digits: int) -> int:
    """Decimal places that show two digits of the width, but no more than `digits` significant digits."""
    size = max(abs(lower), abs(upper))
    if size == 0:
        return 0
    most = digits - 1 - floor_log10(size)
    return most if lower == upper else min(most, 1 - floor_log10(upper - lower))


def decimal(scaled: int, places: int) -> str:
    """The number scaled * 10^-places, exactly."""
    sign, text = ("-" if scaled < 0 else ""), str(abs(scaled))
    exponent = len(text) - 1 - places
    if scaled == 0:
        return "0"
    if exponent in _PLAIN:
        if places <= 0:
            return sign + text + "0" * -places
        text = text.rjust(places + 1, "0")
        return f"{sign}{text[:-places]}.{text[-places:]}"
    stem = text[0] + ("." + text[1:] if len(text) > 1 else "")
    return f"{sign}{stem}e{exponent}"
