"""What is stored of the stability of orbits on an interval of a piece (section 18.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from orbitproof.shared.stored import rules
from orbitproof.verify.curve import IntervalResult
from orbitproof.verify.distances import DistanceFunctions
from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.out_of_plane import VariationFunctions


@dataclass(frozen=True)
class StabilityFunctions:
    """Functions of tau on an interval of a piece.

    Attributes:
        characteristic, level, half_period, first_factor: as of `matrix.OrbitFunctions`.
        distance: along the orbits, or why it is not known; `None` if the system names none.
        out_of_plane: V of variations out of the plane, or why not; `None` if the system is none in a plane.
    """

    characteristic: Annotated[tuple[StoredFunction, ...], rules(minItems=1, maxItems=8)]
    level: StoredFunction
    half_period: StoredFunction
    first_factor: StoredFunction
    distance: DistanceFunctions | NotKnown | None = None
    out_of_plane: VariationFunctions | NotKnown | None = None


@dataclass(frozen=True)
class StabilityResult(IntervalResult):
    """What was found for a piece of a curve.

    Attributes:
        stability: functions, or why there are none; `None` if they were not asked for.
    """

    stability: StabilityFunctions | NotKnown | None = None
