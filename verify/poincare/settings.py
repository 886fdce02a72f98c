"""How the orbits of a box are to be followed: precision, order, coordinates (sections 3 and 14)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

PHYSICAL: Final = "physical"
REGULARISED: Final = "regularised"
AUTO: Final = "auto"


@dataclass(frozen=True)
class IntegratorSettings:
    """How to integrate.

    Attributes:
        precision: fractional bits of the fixed-point format.
        order: degree of the time expansions; `None` chooses it from the precision.
        coordinates: "physical", "regularised" (where the system has such coordinates), or "auto" for
            those in which the orbit takes less time.
        accuracy: bits that the errors of the last crossing and of its derivative should have, for `EarlyEnd`.
    """

    precision: int
    order: int | None = None
    accuracy: tuple[int, int] | None = None
    coordinates: str = AUTO

    def __post_init__(self) -> None:
        if self.precision < 1 or (self.order is not None and self.order < 1):
            raise ValueError(f"precision {self.precision} and order {self.order} have to be positive")
        if self.accuracy is not None and min(self.accuracy) < 0:
            raise ValueError(f"accuracy {self.accuracy} is negative")
        if self.coordinates not in (AUTO, PHYSICAL, REGULARISED):
            raise ValueError(f"coordinates {self.coordinates!r} are none of {AUTO}, {PHYSICAL}, {REGULARISED}")
