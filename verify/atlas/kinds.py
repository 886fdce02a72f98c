"""The kinds of claims about branches, curves and surfaces: a table of what certificates need of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial

from orbitproof.shared.claims import CLAIMS, SURFACE, Atlas
from orbitproof.verify.atlas.results import Result, Settings
from orbitproof.verify.curve import CertifiedPoint, CurveTheorem, PieceLimits, conclude, enclose_other_point
from orbitproof.verify.evidence import Theorem
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.surface import SurfaceLimits, SurfaceTheorem, conclude_surface
from orbitproof.verify.words import BranchConclusion

partner = partial(enclose_other_point, ORACLE)
"""Encloses the other point of a symmetric orbit on Fix(R), by integration."""


@dataclass(frozen=True)
class BranchKind:
    """One kind of claim.

    Attributes:
        theorem: that an atlas claims.
        limits: the type of the settings of the integrator for its pieces.
        conclude: what results of the pieces of an atlas give together, with certified points that may lie there.
        holds_points: whether certified orbits are looked for on such a branch, and resonances listed: it has one
            parameter.
    """

    theorem: Callable[[Atlas], Theorem]
    limits: type[PieceLimits] | type[SurfaceLimits]
    conclude: Callable[[Atlas, Sequence[Result], Sequence[CertifiedPoint]], BranchConclusion]
    holds_points: bool

    def settings(self, **given: int) -> Settings:
        """Settings of the integrator, those that are not given as it suits. Raises `ValueError` out of range."""
        return asdict(self.limits(**given))


def _conclude_curve(atlas: Atlas, results: Sequence[Result], points: Sequence[CertifiedPoint]) -> BranchConclusion:
    return conclude(atlas, results, points, partner)


def _conclude_surface(atlas: Atlas, results: Sequence[Result], points: Sequence[CertifiedPoint]) -> BranchConclusion:
    return conclude_surface(atlas, results)


CURVES = BranchKind(CurveTheorem, PieceLimits, _conclude_curve, holds_points=True)
SURFACES = BranchKind(SurfaceTheorem, SurfaceLimits, _conclude_surface, holds_points=False)

KINDS: Mapping[str, BranchKind] = {**dict.fromkeys(CLAIMS, CURVES), SURFACE: SURFACES}
"""By the kinds of claims as atlases say them."""


def kind_of(atlas: Atlas) -> BranchKind:
    """The kind of an atlas."""
    return KINDS[atlas.claim.kind]
