"""Exact numbers as they are given on the command line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from difflib import get_close_matches
from fractions import Fraction

from orbitproof.shared.formats import InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import MASS_PARAMETERS, FormulaError, evaluate_formula

NO_NUMBER = "no number; write a decimal, a fraction or a hexadecimal number"

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")
"""pi, to 63 digits: an exact number that may stand in what an orbit is singled out by."""

MONTHS: Mapping[str, Fraction] = {
    "sidereal_month": 2 * PI,
    "synodic_month": 2 * PI * Fraction("29.530588853") / Fraction("27.321661547"),
}
"""The Moon's mean months at J2000 in time units of the Earth-Moon system, of which 2 pi are one sidereal month.

Of a sidereal month of 27.321661547 days and a synodic month of 29.530588853 days only the ratio counts.
"""


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


def mass_name(text: str) -> str:
    """The name of a mass parameter that is asked for, in any case; other texts as they are."""
    return text.casefold() if text.casefold() in MASS_PARAMETERS else text


def mass_parameter(option: str, text: str, *, or_zero: bool = False) -> Fraction:
    """A mass parameter, by name or as a number in (0, 1/2], in [0, 1/2] with `or_zero`. Raises `InputError`."""
    value = MASS_PARAMETERS.get(mass_name(text))
    if value is None:
        close = get_close_matches(text.casefold(), MASS_PARAMETERS, 1)
        remedy = f"did you mean {close[0]}?" if close else "give a number in (0, 1/2]"
        names = ", ".join(MASS_PARAMETERS)
        value = exact_number(option, text, f"neither a name ({names}) nor a number; {remedy}")
    # Neither the number nor the double next to it may be an end.
    inside = 0 < value < 1 and 0.0 < float(value) < 1.0
    if not inside and not (or_zero and value == 0):
        interval = "[0, 1/2]" if or_zero else "(0, 1/2]"
        raise InputError(f"{option} {text}: outside {interval}; give the smaller mass over the total mass")
    if (why := exchanged(value)) is not None:
        raise InputError(f"{option} {text}: {why}")
    return value


def exchanged(mass: Fraction) -> str | None:
    """Why a mass parameter is refused that is that of the larger primary, with the remedy; `None` up to 1/2."""
    if mass <= Fraction(1, 2):
        return None
    smaller = str(1 - mass) if (1 - mass).denominator < 1000 else f"{float(1 - mass):.17g}"
    return (
        f"above 1/2, so the primaries are exchanged; give the smaller mass over the total, 1 - mu = {smaller}, and "
        "states with the other sign of x, y, vx, vy"
    )
