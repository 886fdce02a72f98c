"""The entries of V on an interval of a piece, as they are known and as they are stored (section 21.1)."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.shared.stored import stored
from orbitproof.verify.functions import BoundedFunction, StoredFunction


@dataclass(frozen=True)
class KnownVariations:
    """The entries of V on an interval, functions of tau."""

    entries: tuple[BoundedFunction, ...]

    @property
    def parameter(self) -> BoundedFunction:
        """The stability parameter across the plane, V_11 V_22 + V_12 V_21."""
        one, two, three, four = self.entries
        return one * four + two * three

    def mirrored(self) -> KnownVariations:
        """The variations of -s."""
        return KnownVariations(tuple(entry.mirrored() for entry in self.entries))


@dataclass(frozen=True)
class VariationFunctions:
    """The entries of V on an interval, functions of tau, as they are stored."""

    first: StoredFunction = stored("11")
    second: StoredFunction = stored("12")
    first_rate: StoredFunction = stored("21")
    second_rate: StoredFunction = stored("22")

    @property
    def entries(self) -> tuple[StoredFunction, ...]:
        """By rows."""
        return self.first, self.second, self.first_rate, self.second_rate

    @property
    def known(self) -> KnownVariations:
        """What they enclose. Raises `ValueError` if they are none that is stored."""
        return KnownVariations(tuple(entry.enclosed for entry in self.entries))
