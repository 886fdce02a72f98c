"""What stands at the head of a picture of an atlas."""

from __future__ import annotations

from orbitproof.shared.formats import SURFACE, AnyAtlas
from orbitproof.shared.systems import HILL_VARIED, MASS_PARAMETERS, shown

_KINDS = {"symmetric-arc": "symmetric curve", "symmetric-loop": "symmetric closed curve", SURFACE: "surface"}


def heading_of(atlas: AnyAtlas) -> str:
    """The id, kind, system and mass of an atlas, which its check is about; its title is free text."""
    mu = atlas.parameters.get("mu")
    masses = [name for name, value in MASS_PARAMETERS.items() if value == mu and name not in atlas.id.lower()]
    mass = "".join(f", {'-'.join(part.capitalize() for part in name.split('-'))}" for name in masses[:1])
    kind = _KINDS.get(atlas.claim.kind) or ("closed curve" if atlas.claim.is_closed else "curve")
    if atlas.system is HILL_VARIED:
        return f"{shown(atlas.id)}: {kind} of period doublings over the mass ({atlas.system.name})"
    return f"{shown(atlas.id)}: {kind} of {atlas.system.name}{mass}"
