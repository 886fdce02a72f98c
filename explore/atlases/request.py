"""What a command asks to be covered by an atlas: the curve, its parameters, its coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from orbitproof.shared.formats import Covers, InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import MASS_PARAMETERS, ReversibleSystem


@dataclass(frozen=True)
class Source:
    """The curve that is asked for; `system` is `None` only together with `path`, a family file."""

    system: ReversibleSystem | None
    family: str | None
    mass: str | None
    path: Path | None
    covers: Covers | None
    increasing: tuple[str, ...]
    title: str | None


def parameters_of(system: ReversibleSystem, mass: str | None) -> dict[str, Fraction]:
    """The exact fixed parameters that belong to --mass. Raises `InputError`."""
    if not system.fixed_parameters:
        if mass is not None:
            raise InputError(f"--mass {mass}: {system.name} has no mass parameter; leave it out")
        return {}
    if mass is None:
        raise InputError(f"--mass: missing; give a name ({', '.join(MASS_PARAMETERS)}) or a number in (0, 1)")
    value = MASS_PARAMETERS.get(mass)
    if value is None:
        value = exact_number("--mass", mass)
    if not 0.0 < float(value) < 1.0 or not 0 < value < 1:
        raise InputError(f"--mass {mass}: outside (0, 1); give the smaller mass over the total mass")
    return {"mu": value}


def check_names(system: ReversibleSystem, covers: Covers | None, increasing: tuple[str, ...]) -> None:
    """Refuse names that are no coordinates of the system's points with an `InputError`."""
    wanted = ", ".join(system.centre_coordinates)
    for option, name in (*(("--increasing", name) for name in increasing), ("--covers", covers and covers.coordinate)):
        if name is not None and name not in system.centre_coordinates:
            raise InputError(f"{option} {name}: no coordinate of {system.name}; give one of {wanted}")


def exact_number(option: str, text: str) -> Fraction:
    """The number given with an option, exactly as written. Raises `InputError`."""
    try:
        return parse_exact(text)
    except ValueError:
        names = f"neither a name ({', '.join(MASS_PARAMETERS)}) nor a number" if option == "--mass" else "no number"
        raise InputError(f"{option} {text}: {names}; write a decimal or hexadecimal number") from None
