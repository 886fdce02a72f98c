"""Fixed levels and exact numbers in descriptions."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.described_functions import DescriptionError
from orbitproof.shared.systems.formulas import FormulaError, evaluate_formula
from orbitproof.shared.systems.system import FixedLevel


def level_entry(level: FixedLevel) -> dict[str, Any]:
    """A fixed level as a description has it."""
    where = {"sign": level.sign} if level.between is None else {"between": [str(end) for end in level.between]}
    return {"value": str(level.value), **where}


def level_of(value: Any) -> FixedLevel | None:
    """The fixed level that a description names. Raises `DescriptionError`."""
    if value is None:
        return None
    keys = set(value) if isinstance(value, Mapping) else set()
    if keys == {"value", "sign"} and value["sign"] in (1, -1):
        return FixedLevel(exact_number("fixed_level.value", value["value"]), int(value["sign"]))
    if keys == {"value", "between"} and isinstance(value["between"], (list, tuple)) and len(value["between"]) == 2:
        low, high = (exact_number("fixed_level.between", end) for end in value["between"])
        return FixedLevel(exact_number("fixed_level.value", value["value"]), between=(low, high))
    where = "of the level coordinate sign, 1 or -1, or between, the ends of an interval"
    raise DescriptionError(f"fixed_level: {value!r} is no level; give value, a number, and {where}")


def exact_number(key: str, value: Any) -> Fraction:
    """A number of a description, exactly. Raises `DescriptionError`."""
    try:
        number = evaluate_formula(str(value), {}) if isinstance(value, (int, str)) else value
    except FormulaError as error:
        raise DescriptionError(f"{key}: {error}") from None
    if not isinstance(number, Fraction):
        raise DescriptionError(f'{key}: {value!r} is no exact number; write it as text, "1/10" or "0.1"')
    return number
