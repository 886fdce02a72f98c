"""What the options of ``orbitproof explore orbit`` say of an orbit: what singles it out, and what is claimed of it."""

from __future__ import annotations

import argparse
from typing import Literal

from orbitproof.explore.names import NO_NUMBER, exact_number, time_given
from orbitproof.explore.three_body.names import MONTHS
from orbitproof.shared.formats import (
    COORDINATE,
    HALF_PERIOD,
    INVARIANT_TORI,
    LEVEL,
    ORBIT,
    STABLE_ORBIT,
    Equation,
    InputError,
)
from orbitproof.shared.systems import MASS_PARAMETERS, UNITS, ReversibleSystem


def equation_of(options: argparse.Namespace, system: ReversibleSystem, wanted: bool = True) -> Equation | None:
    """What the options single out the orbit by. Raises `InputError`."""
    given = [option for option in ("period", "level", "at") if getattr(options, option) is not None]
    if len(given) > 1 or (wanted and not given):
        raise InputError("--period, --level or --at: give one of them, to single out an orbit")
    if not given:
        return None
    text: str = getattr(options, given[0])
    if given[0] == "at":
        name, _, text = text.partition("=")
        if name not in system.centre_coordinates:
            known = ", ".join(system.centre_coordinates)
            raise InputError(f"--at {name}: no coordinate of {system.name} on Fix(R); give {known}")
        return Equation(COORDINATE, exact_number(f"--at {name}", text), name)
    if given[0] == "period":
        months = MONTHS if system.fixed_parameters == ("mu",) else {}
        hint = f"{NO_NUMBER}, or arithmetic with {' and '.join(months)}" if months else NO_NUMBER
        masses = [MASS_PARAMETERS.get(name) for name in getattr(options, "mass", None) or []]
        units = UNITS.get(masses[0]) if len(masses) == 1 and masses[0] is not None else None
        value = time_given("--period", text, None if units is None else units.time, hint, months)
    else:
        value = exact_number("--level", text)
    if given[0] == "level":
        if system.first_integral is None:
            raise InputError(f"--level: {system.name} has no first integral; give --period or --at")
        return Equation(LEVEL, value)
    if not value > 0:
        raise InputError(f"--period {text}: not positive; give a positive number")
    return Equation(HALF_PERIOD, value / 2)


def kind_of(
    options: argparse.Namespace, system: ReversibleSystem
) -> Literal["orbit", "stable_orbit", "invariant_tori"]:
    """What is claimed of an orbit of a system. Raises `InputError` for what is not known of its orbits."""
    n = len(system.kernel_coordinates)
    if options.stable and options.tori:
        raise InputError("--tori: is about n = 2, and --stable about n = 1; give one of them")
    if options.stable and n != 1:
        raise InputError(
            f"--stable: orbits of {system.name} have n = {n}, of which this is not known; give a system with n = 1, "
            "such as a planar problem"
        )
    if options.tori and n != 2:
        raise InputError(f"--tori: orbits of {system.name} have n = {n}, and this is about n = 2; leave it out")
    return STABLE_ORBIT if options.stable else INVARIANT_TORI if options.tori else ORBIT
