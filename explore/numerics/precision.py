"""Numbers of mpmath with so many bits, made from exact numbers and read back."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import Any

import mpmath


@lru_cache(maxsize=64)
def working_context(bits: int) -> mpmath.MPContext:
    """Arithmetic with so many bits, the same for all who ask: it takes milliseconds to make. Nobody changes `prec`."""
    context = mpmath.MPContext()
    context.prec = bits
    return context


def mpf(value: Any, context: mpmath.MPContext) -> Any:
    """An exact number, rounded to the precision of `context`."""
    exact = Fraction(value)
    return context.mpf(exact.numerator) / exact.denominator


def fraction(value: Any) -> Fraction:
    """A number of mpmath or an integer, exactly; raises `ValueError` unless it is finite."""
    if isinstance(value, int):
        return Fraction(value)
    sign, mantissa, exponent, _ = value._mpf_
    if not mantissa and exponent:
        raise ValueError("a number is not finite")
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent
