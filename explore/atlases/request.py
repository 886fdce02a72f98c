"""What a command asks to be covered by an atlas: the curve, its parameters, its coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from orbitproof.shared.formats import Covers, InputError
from orbitproof.shared.systems import ReversibleSystem


@dataclass(frozen=True)
class Source:
    """The curve that is asked for; `system` is `None` only together with `path`, a family file.

    `birth`: whether it ends at the doubling from which its orbits are born, whatever it covers.
    """

    system: ReversibleSystem | None
    family: str | None
    mass: str | None
    path: Path | None
    covers: Covers | None
    increasing: tuple[str, ...]
    title: str | None
    birth: bool = False


def check_names(system: ReversibleSystem, covers: Covers | None, increasing: tuple[str, ...]) -> None:
    """Refuse names that are no coordinates of the system's points with an `InputError`."""
    wanted = ", ".join(system.centre_coordinates)
    for option, name in (*(("--increasing", name) for name in increasing), ("--covers", covers and covers.coordinate)):
        if name is not None and name not in system.centre_coordinates:
            raise InputError(f"{option} {name}: no coordinate of {system.name}; give one of {wanted}")
