"""Exact numbers as people give them: integers, fractions, and decimals as text."""

from __future__ import annotations

import re
from fractions import Fraction

from orbitproof.shared.numbers import parse_exact

Number = int | str | Fraction


def exact(key: str, value: Number) -> Fraction:
    """The exact value of a number. Raises `ValueError`, one line that begins with the key, for what is none."""
    if isinstance(value, (int, Fraction)) and not isinstance(value, bool):
        return Fraction(value)
    if isinstance(value, str):
        try:
            return parse_exact(re.sub(r"^\+(?=[0-9])", "", value.strip()))
        except ValueError:
            pass
    raise ValueError(f"{key}: {value!r} is no exact number; write it as text, '0.1' or '1/3', or as an int or Fraction")


def positive(key: str, value: object, least: int = 1) -> int:
    """A whole number of a least size. Raises `ValueError`."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise ValueError(f"{key}: {value!r} is no whole number from {least} on")
    return value
