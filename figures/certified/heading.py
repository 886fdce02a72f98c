"""What stands at the head of a picture of an atlas."""

from __future__ import annotations

from orbitproof.shared.formats import SURFACE, AnyAtlas
from orbitproof.shared.systems import HILL_VARIED, MASS_PARAMETERS, shown

_KINDS = {
    "arc": "curve",
    "loop": "closed curve",
    "symmetric-arc": "symmetric curve",
    "symmetric-loop": "symmetric closed curve",
    SURFACE: "surface",
    "periodic-arc": "curve",
    "periodic-loop": "closed curve",
}


def heading_of(atlas: AnyAtlas) -> str:
    """The id, kind, system and mass of an atlas, which its check is about; its title is free text."""
    mu = atlas.parameters.get("mu")
    masses = [name for name, value in MASS_PARAMETERS.items() if value == mu and name not in atlas.id.lower()]
    mass = "".join(f", {'-'.join(part.capitalize() for part in name.split('-'))}" for name in masses[:1])
    if atlas.system is HILL_VARIED:
        return f"{shown(atlas.id)}: {_KINDS[atlas.claim.kind]} of period doublings over the mass ({atlas.system.name})"
    return f"{shown(atlas.id)}: {_KINDS[atlas.claim.kind]} of {atlas.system.name}{mass}"
