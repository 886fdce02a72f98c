"""Units of length and time: nondimensional, or kilometres and seconds."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from orbitproof.explore.three_body.names import foreign_units, units_of_system
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import MASS_PARAMETERS, UNITS, SystemUnits


@dataclass(frozen=True)
class Units:
    """What the nondimensional units of a three-body system are.

    Attributes:
        length: the distance of the primaries, km.
        time: the inverse of their angular velocity, s.
        source: who says so.
    """

    length: float
    time: float
    source: str

    @property
    def velocity(self) -> float:
        """km/s."""
        return self.length / self.time


def units_of(mass: Fraction | None) -> Units | None:
    """Units of the catalogue's system with exactly this mass parameter; `None` if there is none."""
    known = None if mass is None else UNITS.get(mass)
    return None if known is None else Units(known.length, known.time, f"of the catalogue's system {known.name}")


def chosen_units(
    wanted: str, length: float | None, time: float | None, known: Units | None, system: SystemUnits | None = None
) -> Units | None:
    """The units that a file is written in; `None`: nondimensional.

    Arguments:
        wanted: "nondimensional" or "km".
        length, time: km and s as the user gives them, or `None`.
        known: units that the file of the orbit names.
        system: the one that the orbit is of, if it has a name.

    Raises `InputError` where kilometres are wanted and nobody says how long the units are, and for units that are
    not those of the system.
    """
    if (length is None) != (time is None):
        missing = "--lunit" if length is None else "--tunit"
        raise InputError(f"{missing}: missing; give the unit of length in km and the unit of time in s, or neither")
    if length is not None and time is not None and (why := foreign_units(length, time, system)) is not None:
        raise InputError(f"--lunit, --tunit: {why}")
    if wanted == "nondimensional":
        return None
    if length is not None and time is not None:
        return Units(length, time, "given by the user")
    if known is None:
        known_as = "" if system is None else f"; of {system.name}: {system.length:.15g} and {system.time:.15g}"
        raise InputError(
            "--lunit, --tunit: missing; the orbit's file names no units: give the unit of length in km, of time in s"
            + known_as
        )
    return known


def units_named(units: Units | str, mass: float | None) -> Units:
    """Units as they are, or those of a system by the name of its mass.

    Raises `ValueError` for an unknown name, and for units that are not those of the system with the mass parameter.
    """
    known = units_of(MASS_PARAMETERS.get(units)) if isinstance(units, str) else units
    if known is None:
        names = ", ".join(name for name, value in MASS_PARAMETERS.items() if value in UNITS)
        raise ValueError(f"units: {units!r} is unknown; there are {names}, or give explore.Units")
    why = foreign_units(known.length, known.time, units_of_system(mass))
    if why is not None:
        raise ValueError(f"units: {why}")
    return known
