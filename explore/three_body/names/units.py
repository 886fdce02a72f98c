"""Units of length and time against the system that they are said to be of."""

from __future__ import annotations

from fractions import Fraction

from orbitproof.shared.systems import MASS_PARAMETERS, UNITS, SystemUnits

_AGREE = 0.01
"""Relative difference of two sums of GM that are of one system: mean distances and mean motions differ by less."""


def units_of_system(mass: Fraction | float | None, name: str = "") -> SystemUnits | None:
    """Units of the system with this mass parameter, or of this name, such as Earth-Moon; `None` if none are known."""
    masses = (
        {} if mass is None else {key: known for key, known in MASS_PARAMETERS.items() if float(known) == float(mass)}
    )
    names = {name, *masses, *(UNITS[known].name for known in masses.values() if known in UNITS)}
    wanted = {each.casefold() for each in names}
    return next((units for units in UNITS.values() if units.name.casefold() in wanted), None)


def foreign_units(length: float, time: float, system: SystemUnits | None) -> str | None:
    """Why units, km and s, are none of a system, with both numbers: L^3/T^2 is the GM of both bodies.

    `None` if they fit, and where nothing is known of the system.
    """
    if system is None:
        return None
    given, right = length**3 / time**2, system.length**3 / system.time**2
    if abs(given - right) <= _AGREE * right:
        return None
    return (
        f"L^3/T^2 = {given:.6g} km^3/s^2 with {length:.10g} km and {time:.10g} s, but {right:.6g} km^3/s^2 for "
        f"{system.name}, the GM of both bodies; give the units of one system"
    )
