"""What the files of the search have in common: records of numbers, to JSON and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction
from math import isfinite
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from orbitproof.shared.formats import InputError
from orbitproof.shared.numbers import format_rational
from orbitproof.shared.systems import ReversibleSystem, describe

Array = NDArray[np.float64]


def to_json(value: Any) -> Any:
    """A record as an object: arrays as lists, complex numbers as pairs, exact numbers as text, systems described."""
    if isinstance(value, ReversibleSystem):
        return describe(value)
    if is_dataclass(value):
        return {field.name: to_json(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, Fraction):
        return format_rational(value)
    if isinstance(value, Mapping):
        return {name: to_json(part) for name, part in value.items()}
    if isinstance(value, (tuple, list)):
        return [to_json(part) for part in value]
    return value


@dataclass(frozen=True)
class ObjectReader:
    """Where an object of a file stands, for reading its numbers; what is wrong with one is an `InputError`."""

    source: str
    system: ReversibleSystem

    def refuse(self, name: str, why: str, remedy: str = "write the file again") -> NoReturn:
        """Raise the `InputError` about a field."""
        raise InputError(f"{self.source}.{name}: {why}; {remedy}")

    def finite(self, name: str, *numbers: float | None) -> None:
        """Refuse numbers that are too large for a double; `None` is none."""
        if not all(isfinite(number) for number in numbers if number is not None):
            self.refuse(name, "a number is too large for a double")

    def array(self, name: str, value: Any, *shape: int) -> Array:
        """Finite numbers of the shape that the system needs."""
        try:
            result = np.array(value, dtype=float)
        except (TypeError, ValueError):
            self.refuse(name, "rows of different lengths, or none")
        # A list of no rows has no second dimension.
        result = result.reshape(shape) if result.size == 0 and 0 in shape else result
        if result.shape != shape:
            self.refuse(name, f"shape {result.shape}", f"{self.system.name} needs {shape}")
        if not np.all(np.isfinite(result)):
            self.refuse(name, "a number is too large for a double")
        return result

    def increasing(self, name: str, places: Array) -> None:
        """Refuse places along a curve that are not in order; `name` has {} for the index."""
        wrong = np.flatnonzero(~(np.diff(places) > 0))
        if len(wrong):
            self.refuse(name.format(wrong[0] + 1), "does not increase", "list the orbits along the family")

    def stability(self, name: str, pairs: Any) -> tuple[complex, ...]:
        """The stability parameters of an orbit."""
        rows = self.array(name, pairs, len(self.system.kernel_coordinates), 2)
        return tuple(complex(*row) for row in rows.tolist())
