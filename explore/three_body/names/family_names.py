"""The names of the families that can be asked for."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from math import gcd
from typing import Literal

Branch = Literal["north", "south"]
"""The sign of z where an orbit is farthest from the smaller primary: northern orbits have z > 0 there."""

NORTH: Branch = "north"
SOUTH: Branch = "south"
BRANCHES: tuple[Branch, ...] = (NORTH, SOUTH)
DEFAULT_BRANCH: Branch = SOUTH
"""The branch of every family that has both, as the orbits of the Gateway are."""

RESONANCES = ("1:1", "1:2", "1:3", "1:4", "2:1", "2:3", "3:1", "3:2", "3:4", "4:1", "4:3")
"""Resonant families that are listed: an orbit of p:q goes round p times while the primaries do so q times."""

FAMILY_NAMES: Mapping[str, tuple[str, ...]] = {
    "cr3bp": (
        *(f"{point}-{kind}" for kind in ("halo", "lyapunov", "vertical") for point in ("L1", "L2", "L3")),
        *(f"{point}-{kind}" for kind in ("butterfly", "dragonfly") for point in ("L1", "L2")),
        "dro",
        "dpo",
        "lpo-east",
        "lpo-west",
        *(f"resonant-{ratio.replace(':', '-')}" for ratio in RESONANCES),
    ),
    "cr3bp-axial": ("L1-axial", "L2-axial", "L3-axial"),
    "cr3bp-planar": ("dro",),
    "falkner-skan": ("odd",),
}
"""The families that can be asked for, by system; `families.named` traces them."""

WITHOUT_SYMMETRY = ("L4-short", "L4-long", "L5-short", "L5-long")
"""Families of the CR3BP whose orbits no reversor maps to themselves."""

_ALIASES: Mapping[str, str] = {
    "distant-retrograde": "dro",
    "distant-prograde": "dpo",
    **{f"{word}-{side}": f"lpo-{side}" for word in ("lpo", "low-prograde") for side in ("east", "west")},
    **{f"{word}-{side}ern": f"lpo-{side}" for word in ("lpo", "low-prograde") for side in ("east", "west")},
    "lpo-e": "lpo-east",
    "lpo-w": "lpo-west",
    "butterfly": "L2-butterfly",
    "dragonfly": "L2-dragonfly",
    # Near-rectilinear halo orbits are the far parts of the halo families.
    "nrho": "L2-halo",
    "l1-nrho": "L1-halo",
    "l2-nrho": "L2-halo",
    **{f"{point}-{kind}": f"{point}-{kind[:-1]}" for point in ("l4", "l5") for kind in ("shortp", "longp")},
    **{f"{point}-{kind}-period": f"{point}-{kind}" for point in ("l4", "l5") for kind in ("short", "long")},
}

_BRANCH = re.compile(r"L[123]-halo(?:-([2-9]|[1-9][0-9]))?")
_RESONANT = re.compile(r"resonant-([1-9])-([1-9])(-near)?")
_RATIO = re.compile(r"(?:resonant[- ])?([1-9])[:-]?([1-9])(-near|-far)?")
_NEAR = ("12", "23", "31")
"""The resonances of which the JPL catalogue lists the phase that comes closer to the smaller primary."""


def family_name(text: str) -> str:
    """The name of a family that is asked for, in any case or by its long name; other texts as they are."""
    wanted = text.casefold()
    wanted = _ALIASES.get(wanted, wanted)
    listed = [name for names in FAMILY_NAMES.values() for name in names]
    known = {name.casefold(): name for name in (*listed, *WITHOUT_SYMMETRY)}
    if _BRANCH.fullmatch(f"{wanted[:1].upper()}{wanted[1:]}") is not None:
        return f"{wanted[:1].upper()}{wanted[1:]}"
    if wanted in known:
        return known[wanted]
    if (ratio := _RATIO.fullmatch(wanted)) is not None:
        is_near = ratio[3] == "-near" if ratio[3] else f"{ratio[1]}{ratio[2]}" in _NEAR
        return f"resonant-{ratio[1]}-{ratio[2]}{'-near' if is_near else ''}"
    return known.get(wanted.casefold(), text)


def resonance_of(name: str) -> tuple[int, int, bool] | None:
    """p, q and whether "-near" follows in the name of a resonant family, p and q without a common divisor."""
    match = _RESONANT.fullmatch(name)
    if match is None or gcd(int(match[1]), int(match[2])) != 1:
        return None
    return int(match[1]), int(match[2]), match[3] is not None


def is_family_name(system: str, name: str) -> bool:
    """Whether a family of that name can be traced: one of `FAMILY_NAMES`, L1-halo-2, L1-halo-3, .., or a resonance."""
    numbered = _BRANCH.fullmatch(name) is not None or resonance_of(name) is not None
    return name in FAMILY_NAMES.get(system, ()) or (system == "cr3bp" and numbered)


def families_to_give(system: str, name: str) -> str:
    """Which families there are of a system, for one who has asked for another: first those with nearly that name."""
    names = (*FAMILY_NAMES.get(system, ()), *(WITHOUT_SYMMETRY if system == "cr3bp" else ()))
    close = get_close_matches(name.casefold(), [*(known.casefold() for known in names), *_ALIASES], 3, 0.5)
    close = [_ALIASES.get(each, each).casefold() for each in close]
    given = ", ".join(sorted(names, key=lambda known: known.casefold() not in close))
    sides = (f"; and branch {side} for {side}ern orbits" for side in BRANCHES if name.casefold().startswith(side))
    return given + "".join(sides)


def system_with(names: Sequence[str]) -> str | None:
    """The first system that has families of all these names; `None` if there is no name or no such system."""
    fits = [system for system in FAMILY_NAMES if names and all(is_family_name(system, name) for name in names)]
    return fits[0] if fits else None


def branch_name(planar: str, number: int) -> str:
    """The name of the branch at the symmetry breaking `number` = 1, 2, .. of a planar family: L1-halo, L1-halo-2, .."""
    point = planar.partition("-")[0]
    return f"{point}-halo" if number == 1 else f"{point}-halo-{number}"


def branch_number(name: str) -> int | None:
    """The inverse of `branch_name`, whatever the side of the orbits; `None` for a family of another kind."""
    match = _BRANCH.fullmatch(name.removesuffix(f"-{NORTH}"))
    return None if match is None else int(match[1] or 1)


def has_branches(name: str) -> bool:
    """Whether a family by name is one of two, mirror images under S: northern and southern orbits."""
    return branch_number(name) is not None or name.endswith(("-butterfly", "-dragonfly"))


def name_on(name: str, branch: Branch) -> str:
    """What a family is called in files and ids: L1-halo for the default branch, L1-halo-north for the other one."""
    return f"{name}-{branch}" if has_branches(name) and branch != DEFAULT_BRANCH else name


def on_branch(name: str, branch: Branch | None) -> str:
    """A name with the side of its orbits in words, if they have one: southern L1-halo."""
    side = "" if branch is None else f"{branch}ern "
    return f"{side}{name.removesuffix(f'-{branch}')}"
