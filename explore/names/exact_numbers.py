"""Exact numbers as they are given on the command line."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction

from orbitproof.shared.formats import InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import MASS_PARAMETERS, FormulaError, evaluate_formula

NO_NUMBER = "no number; write a decimal, a fraction or a hexadecimal number"


def number_in(text: str) -> Fraction | None:
    """The number that a text is, exactly; `None` if it is none."""
    with suppress(ValueError):
        return parse_exact(text)
    with suppress(FormulaError):
        return Fraction(evaluate_formula(text, {}))
    return None


def exact_number(option: str, text: str, wrong: str = NO_NUMBER) -> Fraction:
    """The number given with an option, exactly as written. Raises `InputError`."""
    value = number_in(text)
    if value is None:
        raise InputError(f"{option} {text}: {wrong}")
    return value


def mass_parameter(option: str, text: str, *, or_zero: bool = False) -> Fraction:
    """A mass parameter, by name or as a number in (0, 1), in [0, 1) with `or_zero`. Raises `InputError`."""
    value = MASS_PARAMETERS.get(text)
    if value is None:
        names = ", ".join(MASS_PARAMETERS)
        value = exact_number(option, text, f"neither a name ({names}) nor a number; give a number in (0, 1)")
    # Neither the number nor the double next to it may be an end.
    inside = 0 < value < 1 and 0.0 < float(value) < 1.0
    if not inside and not (or_zero and value == 0):
        interval = "[0, 1)" if or_zero else "(0, 1)"
        raise InputError(f"{option} {text}: outside {interval}; give the smaller mass over the total mass")
    return value
