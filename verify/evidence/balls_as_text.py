"""Balls as text: exact for certificates, decimals rounded outward for people (section 10)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor

from flint import arb

from orbitproof.shared.numbers import format_dyadic, format_rational, parse_exact

_PLAIN = range(-7, 22)
"""Decimal exponents that are written without an exponent."""


def exact_value(point: arb) -> Fraction:
    """The exact value of a ball of radius zero, for example a midpoint or a radius."""
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def bounds(ball: arb) -> tuple[Fraction, Fraction]:
    """Exact lower and upper end of a finite ball. Raises `ValueError` for others."""
    if not ball.is_finite():
        raise ValueError("the ball is not finite")
    middle, radius = exact_value(ball.mid()), exact_value(ball.rad())
    return middle - radius, middle + radius


def ball_to_json(ball: arb) -> dict[str, str]:
    """A finite ball as exact dyadic midpoint and radius, with an outward-rounded decimal beside them."""
    bounds(ball)
    return {
        "mid": format_dyadic(exact_value(ball.mid())),
        "rad": format_dyadic(exact_value(ball.rad())),
        "decimal": decimal_interval(ball),
    }


def ball_from_json(entry: Mapping[str, str]) -> arb:
    """The same ball. Raises `ValueError` if the entry is not a ball that `ball_to_json` writes."""
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


def decimal_interval(ball: arb, digits: int = 40) -> str:
    """``[lower, upper]`` in decimals, rounded outward, about two digits of the width visible.

    At most `digits` significant digits are written; balls that are not finite are named.
    """
    if not ball.is_finite():
        return "not finite"
    lower, upper = bounds(ball)
    places = _places(lower, upper, digits)
    return f"[{_decimal(floor(lower * _ten(places)), places)}, {_decimal(ceil(upper * _ten(places)), places)}]"


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
    low, high = _places(lower, lower, digits), _places(upper, upper, digits)
    return f"[{_decimal(floor(lower * _ten(low)), low)}, {_decimal(ceil(upper * _ten(high)), high)}]"


def exact_interval_text(lower: Fraction, upper: Fraction, digits: int = 9, inward: bool = False) -> str:
    """``[lower, upper]`` in decimals that contain all of an exact interval, or with `inward` nothing beyond it.

    A single point has nothing inside: it is contained, with `inward` too.
    `digits` significant digits are written, and more where it takes them to show two digits of the width.
    """
    size = max(abs(lower), abs(upper))
    places = digits - 1 - _floor_log10(size) if size else 0
    if lower < upper:
        places = max(places, 1 - _floor_log10(upper - lower))
    down, up = (ceil, floor) if inward and lower < upper else (floor, ceil)
    return f"[{_short(down(lower * _ten(places)), places)}, {_short(up(upper * _ten(places)), places)}]"


def _short(scaled: int, places: int) -> str:
    """As `_decimal`, without zeros at the end."""
    while scaled and scaled % 10 == 0 and places > 0:
        scaled, places = scaled // 10, places - 1
    return _decimal(scaled, places)


def exact_text(value: Fraction) -> str:
    """A number exactly: in decimals where these are short, else dyadic with an approximate decimal before it."""
    if value.denominator == 1:
        return str(value.numerator)
    exact = format_rational(value)
    return str(float(value)) if Fraction(str(float(value))) == value else f"{float(value):.17g} (exactly {exact})"


def certain_digits(ball: arb, digits: int = 60) -> str:
    """The common digits of all points, then the range of the next ones: ``3.0216192[40,58]``.

    Falls back to `decimal_interval` where the ends have no leading digits in common.
    """
    if not ball.is_finite():
        return "not finite"
    lower, upper = bounds(ball)
    places = _places(lower, upper, digits)
    left, right = _decimal(floor(lower * _ten(places)), places), _decimal(ceil(upper * _ten(places)), places)
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
    return max(0, _floor_log10(size / radius)) if size else 0


def _ten(places: int) -> Fraction:
    return Fraction(10) ** places


def _floor_log10(value: Fraction) -> int:
    """floor(log10(value)) for a positive value."""
    guess = int((value.numerator.bit_length() - value.denominator.bit_length()) * 0.30103)
    while _ten(guess) > value:
        guess -= 1
    while _ten(guess + 1) <= value:
        guess += 1
    return guess


def _places(lower: Fraction, upper: Fraction, digits: int) -> int:
    """Decimal places that show two digits of the width, but no more than `digits` significant digits."""
    size = max(abs(lower), abs(upper))
    if size == 0:
        return 0
    most = digits - 1 - _floor_log10(size)
    return most if lower == upper else min(most, 1 - _floor_log10(upper - lower))


def _decimal(scaled: int, places: int) -> str:
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


def balls_to_json(balls: Mapping[str, arb]) -> dict[str, dict[str, str]]:
    """The JSON objects of those balls that are finite, by name."""
    return {name: ball_to_json(ball) for name, ball in balls.items() if ball.is_finite()}
