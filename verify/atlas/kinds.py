"""The kinds of claims about branches, curves and surfaces: a table of what certificates need of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass

from orbitproof.shared.claims import CLAIMS, SURFACE, Atlas
from orbitproof.verify.atlas.results import Settings
from orbitproof.verify.curve import CurveTheorem, PieceLimits
from orbitproof.verify.evidence import Theorem
from orbitproof.verify.surface import SurfaceLimits, SurfaceTheorem


@dataclass(frozen=True)
class BranchKind:
    """One kind of claim.

    Attributes:
        theorem: that an atlas claims.
        limits: the type of the settings of the integrator for its pieces.
        holds_points: whether certified orbits are looked for on such a branch, and resonances listed: it has one
            parameter.
    """

    theorem: Callable[[Atlas], Theorem]
    limits: type[PieceLimits] | type[SurfaceLimits]
    holds_points: bool

    def settings(self, **given: int) -> Settings:
        """Settings of the integrator, those that are not given as it suits. Raises `ValueError` out of range."""
        return asdict(self.limits(**given))


CURVES = BranchKind(CurveTheorem, PieceLimits, holds_points=True)
SURFACES = BranchKind(SurfaceTheorem, SurfaceLimits, holds_points=False)

KINDS: Mapping[str, BranchKind] = {**dict.fromkeys(CLAIMS, CURVES), SURFACE: SURFACES}
"""By the kinds of claims as atlases say them."""


def kind_of(atlas: Atlas) -> BranchKind:
    """The kind of an atlas."""
    return KINDS[atlas.claim.kind]
