"""Units of length and time of systems whose mass parameter a catalogue fixes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from orbitproof.shared.systems.known import MASS_PARAMETERS


@dataclass(frozen=True)
class SystemUnits:
    """What the nondimensional units of a three-body system are, as a catalogue has them.

    Attributes:
        name: of the system, larger primary first.
        length: the distance of the primaries, km.
        time: the inverse of their angular velocity, s.
        radius: of the smaller primary, km.
    """

    name: str
    length: float
    time: float
    radius: float

    @property
    def details(self) -> Mapping[str, float]:
        """As the files of the catalogue have them."""
        return {"lunit": self.length, "tunit": self.time, "radius_secondary": self.radius}


UNITS: Mapping[Fraction, SystemUnits] = {
    MASS_PARAMETERS["jpl-earth-moon"]: SystemUnits("Earth-Moon", 389703.264829278, 382981.289129055, 1737.1),
}
"""By mass parameter, from a stored response of the JPL three-body periodic orbit catalogue."""
