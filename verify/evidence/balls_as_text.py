"""Balls as text: exact for certificates, in decimals for people (section 10.2)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor

from flint import arb

from orbitproof.shared.numbers import format_dyadic, parse_exact
from orbitproof.verify.evidence.comparisons import bounds, exact_value
from orbitproof.verify.evidence.decimals import (
    decimal,
    decimal_interval,
    floor_log10,
    places_of,
    ten,
)


def ball_to_json(ball: arb) -> dict[str, str]:
    """A finite ball as exact dyadic midpoint and radius, with an outward-rounded decimal beside them."""
    bounds(ball)
    return {
        "mid": format_dyadic(exact_value(ball.mid())),
        "rad": format_dyadic(exact_value(ball.rad())),
        "decimal": decimal_interval(ball),
    }


def ball_from_json(entry: Mapping[str, str]) -> arb:
    """The ball that an entry stands for. Raises `ValueError` if the entry is not a ball that `ball_to_json` writes."""
    middle, radius = parse_exact(entry["mid"]), parse_exact(entry["rad"])
    if radius < 0:
        raise ValueError("the radius of a ball is not negative")
    if any(part and abs(_mantissa_exponent(part)[1]) > _LARGEST_EXPONENT for part in (middle, radius)):
        raise ValueError("a ball of a size that no computation gives")
    centre = arb(_mantissa_exponent(middle))
    if radius == 0:
        return centre
    mantissa, exponent = _mantissa_exponent(radius)
    if mantissa.bit_length() > _RADIUS_BITS:
        raise ValueError("the radius of a ball has at most 30 significant bits")
    # python-flint rounds every radius that it is given up by one unit, exact or not.
    shift = _RADIUS_BITS - mantissa.bit_length()
    mantissa, exponent = mantissa << shift, exponent - shift
    smaller = (2 * mantissa - 1, exponent - 1) if mantissa == 1 << (_RADIUS_BITS - 1) else (mantissa - 1, exponent)
    ball = arb(centre, arb(smaller))
    if exact_value(ball.rad()) != radius:
        raise ValueError("the radius of the ball cannot be represented")
    return ball


def balls_to_json(balls: Mapping[str, arb]) -> dict[str, dict[str, str]]:
    """The JSON objects of those balls that are finite, by name."""
    return {name: ball_to_json(ball) for name, ball in balls.items() if ball.is_finite()}


_RADIUS_BITS = 30
_LARGEST_EXPONENT = 1 << 16
"""Decimals of much larger or smaller numbers take seconds each."""


def _mantissa_exponent(value: Fraction) -> tuple[int, int]:
    if value.denominator & (value.denominator - 1):
        raise ValueError("a ball has dyadic midpoint and radius")
    mantissa, exponent = value.numerator, 1 - value.denominator.bit_length()
    if mantissa:
        shift = (abs(mantissa) & -abs(mantissa)).bit_length() - 1
        mantissa, exponent = mantissa >> shift, exponent + shift
    return mantissa, exponent


def interval_text(ball: arb, digits: int) -> str:
    """As `decimal_interval`, and 0 for the number 0."""
    return "0" if ball.is_zero() else decimal_interval(ball, digits)


def located(name: str, ball: arb, digits: int) -> str:
    """Where a quantity lies, in words: ``x in [0.82, 0.83]``, and ``z = 0`` for the number 0."""
    return f"{name} = 0" if ball.is_zero() else f"{name} in {decimal_interval(ball, digits)}"


def range_text(ball: arb, digits: int) -> str:
    """``[lower, upper]`` in decimals, each end rounded outward to its own `digits` significant digits.

    For the range of something that varies: where one end is a hundredth of the other it keeps its digits, which
    `decimal_interval` drops.
    """
    if not ball.is_finite():
        return "not finite"
    lower, upper = bounds(ball)
    low, high = places_of(lower, lower, digits), places_of(upper, upper, digits)
    return f"[{decimal(floor(lower * ten(low)), low)}, {decimal(ceil(upper * ten(high)), high)}]"


def certain_digits(ball: arb, digits: int = 60) -> str:
    """The common digits of all points, then the range of the next ones: ``3.0216192[40,58]``.

    Falls back to `decimal_interval` where the ends have no leading digits in common.
    """
    if not ball.is_finite():
        return "not finite"
    lower, upper = bounds(ball)
    places = places_of(lower, upper, digits)
    left, right = decimal(floor(lower * ten(places)), places), decimal(ceil(upper * ten(places)), places)
    common = 0
    while common < min(len(left), len(right)) and left[common] == right[common]:
        common += 1
    stem = left[:common]
    plain = len(left) == len(right) and "e" not in left + right and "." in stem
    if not plain or not any(character in "123456789" for character in stem):
        return f"[{left}, {right}]"
    if left == right:
        return left
    low, high = left[common:], right[common:]
    return f"{stem}[{low},{high}]" if left[0] != "-" else f"{stem}[{high},{low}]"


def count_certain_digits(ball: arb) -> int:
    """Number of significant decimal digits that the ball determines: floor(log10(|mid| / rad))."""
    lower, upper = bounds(ball)
    radius, size = (upper - lower) / 2, abs(lower + upper) / 2
    if radius == 0:
        return 10**6
    return max(0, floor_log10(size / radius)) if size else 0
