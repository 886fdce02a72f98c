"""Exact numbers as JSON strings.

A number that carries proof is never a JSON float. It is a string of one of these forms:

- hexadecimal dyadic ``[-]0xM`` or ``[-]0xMp[+-]E``: the integer M (hexadecimal digits, no point)
  times 2 to the decimal integer E;
- decimal ``[-]D[.D][e[+-]E]``: the rational number that it denotes, exactly;
- a fraction ``[-]D/D``, for the parameters of a system only.

A ball is an object ``{"mid": number, "rad": number}`` of dyadic strings.
"""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from math import ceil, log2

NUMBER = r"-?0x[0-9a-f]{1,4000}(p[+-]?[0-9]{1,6})?|-?[0-9]{1,4000}(\.[0-9]{1,4000})?(e[+-]?[0-9]{1,5})?"
RATIONAL = NUMBER + r"|-?[0-9]{1,4000}/0*[1-9][0-9]{0,3999}"
"""How long numbers of claims may be, as the schemas say too: exact numbers, and for parameters any fractions."""

_HEX = re.compile(r"(-?)0x([0-9a-f]+)(?:p([+-]?[0-9]{1,6}))?\Z")
_FRACTION = re.compile(r"-?[0-9]{1,4000}/0*[1-9][0-9]{0,3999}\Z")
_DECIMAL = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]{1,5})?\Z")


def dyadic(mantissa: int, exponent: int) -> Fraction:
    """The mantissa times a power of 2."""
    return Fraction(mantissa << exponent) if exponent >= 0 else Fraction(mantissa, 1 << -exponent)


def parse_exact(text: str) -> Fraction:
    """The exact rational value of a number string. Raises `ValueError` for anything else."""
    match = _HEX.match(text)
    if match:
        sign, mantissa, exponent = match.groups()
        value = dyadic(int(mantissa, 16), int(exponent or 0))
        return -value if sign else value
    if _DECIMAL.match(text) or _FRACTION.match(text):
        return Fraction(text)
    raise ValueError(f"{text!r} is not an exact number (hexadecimal dyadic or decimal)")


def format_dyadic(value: Fraction) -> str:
    """`value` as a hexadecimal dyadic string. Raises `ValueError` if it is not dyadic."""
    denominator = value.denominator
    if denominator & (denominator - 1):
        raise ValueError(f"{value} is not dyadic")
    mantissa, exponent = abs(value.numerator), 1 - denominator.bit_length()
    if exponent == 0 and mantissa:
        shift = (mantissa & -mantissa).bit_length() - 1
        mantissa, exponent = mantissa >> shift, shift
    sign = "-" if value < 0 else ""
    return f"{sign}0x{mantissa:x}" + (f"p{exponent:+d}" if exponent else "")


def format_exact(value: Fraction) -> str:
    """`value` as `parse_exact` reads it: dyadic in hexadecimal, else decimal. Raises `ValueError` if it is neither."""
    denominator = value.denominator
    if denominator & (denominator - 1) == 0:
        return format_dyadic(value)
    twos = (denominator & -denominator).bit_length() - 1
    rest = denominator >> twos
    fives = ceil((rest.bit_length() - 1) / log2(5))
    if rest != 5**fives:
        raise ValueError(f"{value} is neither dyadic nor decimal")
    digits = max(twos, fives)
    # Decimal writes integers of any length; int refuses beyond some thousand digits.
    return f"{Decimal((value * 10**digits).numerator)}e-{digits}"


def format_rational(value: Fraction) -> str:
    """`value` as `parse_exact` reads it, in any case: as `format_exact` writes it, or else as a fraction."""
    try:
        return format_exact(value)
    except ValueError:
        return f"{value.numerator}/{value.denominator}"


def round_dyadic(value: Fraction, bits: int) -> Fraction:
    """The multiple nearest to `value` (ties to even) of a power of 2, with at most `bits` + 1 significant bits."""
    if value == 0:
        return value
    magnitude = abs(value)
    exponent = magnitude.numerator.bit_length() - magnitude.denominator.bit_length() - bits
    scale = Fraction(2) ** exponent
    return round(value / scale) * scale
