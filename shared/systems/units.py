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
    MASS_PARAMETERS[name]: units
    for name, units in {
        "jpl-earth-moon": SystemUnits("Earth-Moon", 389703.264829278, 382981.289129055, 1737.1),
        "jupiter-europa": SystemUnits("Jupiter-Europa", 668518.69872684, 48562.3417930319, 1560.8),
        "mars-phobos": SystemUnits("Mars-Phobos", 9468.25503898377, 4451.83899462989, 11.267),
        "saturn-enceladus": SystemUnits("Saturn-Enceladus", 238529.333386019, 18913.2798604104, 252.1),
        "saturn-titan": SystemUnits("Saturn-Titan", 1195677.15191758, 212238.272684231, 2574.7),
        "sun-earth": SystemUnits("Sun-Earth", 149597870.7, 5022635.34820215, 6378.0),
        "sun-mars": SystemUnits("Sun-Mars", 208321281.703548, 8253621.92588451, 3389.5),
    }.items()
}
"""By mass parameter, as the JPL three-body periodic orbit catalogue has them: Earth-Moon from a stored response, the
others as programs quote its responses (shared/systems/README.md)."""
