"""Named searches: families and masses that one word stands for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

POINTS = ("one", "distinct", "all")
"""Where an orbit's new orbits appear near both of its points on Fix(R): which of these become candidates."""


@dataclass(frozen=True)
class PresetFamilies:
    """Families of one system that a preset searches.

    Attributes:
        system: name of the system.
        families, masses: each mass with each family; without masses, the families of a system without parameters.
        multiplicities: unless -k says otherwise.
        velocity_max: the largest |vy| of the first point, one for each mass, if any.
        z_max: the largest |z| of the first point, or `None`.
    """

    system: str
    families: tuple[str, ...]
    multiplicities: tuple[int, ...]
    masses: tuple[str | None, ...] = (None,)
    velocity_max: tuple[float | None, ...] = (None,)
    z_max: float | None = None


@dataclass(frozen=True)
class Preset:
    """A named search: what it stands for on the command line.

    Attributes:
        searched: the families, system by system.
        points: one of `POINTS`, unless --points says otherwise.
        meaning: for the help text.
    """

    searched: tuple[PresetFamilies, ...]
    points: str
    meaning: str


_MASSES = ("earth-moon", "sun-jupiter")

PRESETS: Mapping[str, Preset] = {
    "tables": Preset(
        (PresetFamilies("cr3bp", ("L1-halo", "L2-halo"), (1, 2, 3, 4), _MASSES, (20.5, 8.0)),),
        "distinct",
        "the L1 halo loops and the L2 halo families of the Earth-Moon and the Sun-Jupiter system, as far as the paper "
        "follows them",
    ),
    "axial-births": Preset(
        (PresetFamilies("cr3bp-axial", ("L1-axial", "L2-axial"), (1,), _MASSES, (0.1, 0.1)),),
        "one",
        "the births of the axial families on the planar families of L1 and L2, of the Earth-Moon and the Sun-Jupiter "
        "system; those of the halo families are among the tables",
    ),
    "demo": Preset(
        (
            PresetFamilies("cr3bp", ("L1-halo",), (1, 2, 3, 4), ("earth-moon",), z_max=0.3),
            PresetFamilies("falkner-skan", ("odd",), (2, 3, 4)),
        ),
        "one",
        "the L1 halo family of the Earth-Moon system up to z = 0.3, and the Falkner-Skan family",
    ),
}
