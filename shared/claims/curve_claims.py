"""What an atlas may claim of a curve of which no symmetry is used."""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args, get_type_hints

from orbitproof.shared.claims.atlas import Atlas, Claim
from orbitproof.shared.claims.birth_curve import BirthAtlas, BirthCurveClaim
from orbitproof.shared.claims.equilibrium_curve import EquilibriumAtlas, EquilibriumCurveClaim
from orbitproof.shared.claims.periodic_curve import PeriodicAtlas, PeriodicCurveClaim
from orbitproof.shared.codec import kinds_said

CurveClaim = PeriodicCurveClaim | EquilibriumCurveClaim | BirthCurveClaim
"""What may be claimed of such a curve."""


@dataclass(frozen=True, repr=False)
class StoredAtlas(Atlas):
    """An atlas of any kind, for the schema."""

    claim: Claim | CurveClaim  # type: ignore[assignment]


CLAIMS_WITHOUT_REVERSOR: dict[str, type[CurveClaim]] = {
    name: claim for claim in get_args(CurveClaim) for name in kinds_said(claim)
}
"""The types of these claims, by kind."""
ATLASES_WITHOUT_REVERSOR: dict[str, type[PeriodicAtlas]] = {
    name: atlas
    for atlas in (PeriodicAtlas, EquilibriumAtlas, BirthAtlas)
    for name in kinds_said(get_type_hints(atlas)["claim"])
}
"""The types of the atlases that claim them, by kind."""
