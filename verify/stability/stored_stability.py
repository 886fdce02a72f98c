"""Functions of the stability of orbits on an interval of a piece, and what is stored of them (section 18.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from orbitproof.shared.stored import rules
from orbitproof.verify.algebra import Series
from orbitproof.verify.curve import BEYOND, IntervalResult
from orbitproof.verify.distances import DistanceFunctions
from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.functions import REACH, StoredFunction
from orbitproof.verify.out_of_plane import VariationFunctions

SHARE = 1 / BEYOND * REACH
"""sigma = SHARE tau."""


@dataclass(frozen=True)
class StabilityFunctions:
    """Functions of tau on an interval of a piece.

    Attributes:
        characteristic, level, half_period, first_factor: as of `OrbitFunctions`.
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
class OrbitFunctions:
    """Functions of tau on an interval of a piece, as elements of the algebra (section 18.3).

    Attributes:
        characteristic: a_1, .., a_n with det(c - Sigma) = c^n - a_1 c^(n-1) + a_2 c^(n-2) - ..
        level: the family parameter, or the first integral.
        half_period: the time to the end of a half orbit.
        first_factor: the determinant of D(pi_p P) on Fix(R), up to a constant factor.
        distance: along the orbits, or why it is not known; `None` if the system names none.
        out_of_plane: V of variations out of the plane, or why not; `None` if the system is none in a plane.
    """

    characteristic: tuple[Series, ...]
    level: Series
    half_period: Series
    first_factor: Series
    distance: DistanceFunctions | NotKnown | None = None
    out_of_plane: VariationFunctions | NotKnown | None = None

    @property
    def stored(self) -> StabilityFunctions:
        """As they are stored."""
        level, half_period, first_factor = map(StoredFunction.of, (self.level, self.half_period, self.first_factor))
        characteristic = tuple(map(StoredFunction.of, self.characteristic))
        known = self.distance, self.out_of_plane
        return StabilityFunctions(characteristic, level, half_period, first_factor, *known)


@dataclass(frozen=True)
class StabilityResult(IntervalResult):
    """What was found for a piece of a curve.

    Attributes:
        stability: functions, or why there are none; `None` if they were not asked for.
    """

    stability: StabilityFunctions | NotKnown | None = None
