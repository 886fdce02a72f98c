"""Exact numbers as they are given on the command line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from fractions import Fraction

from orbitproof.shared.formats import InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import FormulaError, evaluate_formula

NO_NUMBER = "no number; write a decimal, a fraction or a hexadecimal number"


def number_in(text: str, names: Mapping[str, Fraction] | None = None) -> Fraction | None:
    """The number that a text is, exactly, if `names` are the numbers that it may name; `None` if it is none."""
    with suppress(ValueError):
        return parse_exact(text)
    with suppress(FormulaError):
        return Fraction(evaluate_formula(text, names or {}))
    return None


def exact_number(
    option: str, text: str, wrong: str = NO_NUMBER, names: Mapping[str, Fraction] | None = None
) -> Fraction:
    """The number given with an option, exactly as written, `names` being known in it. Raises `InputError`."""
    value = number_in(text, names)
    if value is None:
        raise InputError(f"{option} {text}: {wrong}")
    return value


SECONDS: Mapping[str, int] = {"days": 86400, "day": 86400, "hours": 3600, "hour": 3600, "d": 86400, "h": 3600, "s": 1}
"""Units in which a time may be given: 6.5d, 6.5 days, 12h, 540000s; no unit ends with one that stands before it."""


def split_unit(text: str, units: Iterable[str]) -> tuple[str, str]:
    """A number and its unit, the first of these with which the text ends; without one the unit is empty."""
    unit = next((each for each in units if text.endswith(each)), "")
    return text.removesuffix(unit).rstrip(), unit


def time_given(
    option: str, text: str, unit: float | None, wrong: str = NO_NUMBER, names: Mapping[str, Fraction] | None = None
) -> Fraction:
    """A time as `exact_number` reads one, or with d, h or s; `unit` is that of the system in seconds, if it is known.

    Raises `InputError`.
    """
    digits, name = split_unit(text, SECONDS)
    number, size = number_in(digits), SECONDS.get(name)
    if number is None or size is None:
        return exact_number(option, text, wrong, names)
    if unit is None:
        known = "jpl-earth-moon, sun-earth, .."
        raise InputError(
            f"{option} {text}: the units of this system are not known; give a number in its own, or a mass of the "
            f"catalogue ({known})"
        )
    return number * size / Fraction(str(unit))
