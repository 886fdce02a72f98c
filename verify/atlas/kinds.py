"""The kinds of claims about branches, curves and surfaces: a table of what certificates need of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from orbitproof.shared.claims import CLAIMS, PERIODIC_CURVES, SURFACE, AnyAtlas
from orbitproof.verify.atlas.results import Settings
from orbitproof.verify.curve import CurveTheorem, PieceLimits
from orbitproof.verify.evidence import Theorem
from orbitproof.verify.periodic_curve import PeriodicCurveTheorem, PeriodicLimits, conclude_periodic
from orbitproof.verify.surface import SurfaceLimits, SurfaceTheorem, conclude_surface


@dataclass(frozen=True)
class BranchKind:
    """One kind of claim.

    Attributes:
        theorem: that an atlas claims.
        limits: the type of the settings of the integrator for its pieces.
        about: what it is about, in words.
        conclude: what results give together; `None` for symmetric curves, on which points are looked for as well.
    """

    theorem: Callable[[Any], Theorem]
    limits: type[PieceLimits] | type[SurfaceLimits]
    about: str
    conclude: Callable[[Any, Sequence[Any]], Any] | None = None

    @property
    def holds_points(self) -> bool:
        """Whether certified orbits are looked for on such a branch, and resonances listed."""
        return self.conclude is None

    def settings(self, **given: int) -> Settings:
        """Settings of the integrator, those that are not given as it suits. Raises `ValueError` out of range."""
        return asdict(self.limits(**given))


CURVES = BranchKind(CurveTheorem, PieceLimits, "a curve of symmetric orbits")
SURFACES = BranchKind(SurfaceTheorem, SurfaceLimits, "a surface", conclude_surface)
PERIODIC = BranchKind(PeriodicCurveTheorem, PeriodicLimits, "orbits without symmetry", conclude_periodic)

KINDS: Mapping[str, BranchKind] = {
    **dict.fromkeys(CLAIMS, CURVES), SURFACE: SURFACES, **dict.fromkeys(PERIODIC_CURVES, PERIODIC)
}  # fmt: skip
"""By the kinds of claims as atlases say them."""


def kind_of(atlas: AnyAtlas) -> BranchKind:
    """The kind of an atlas."""
    return KINDS[atlas.claim.kind]
