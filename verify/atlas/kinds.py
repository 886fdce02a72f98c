"""What is asked of a kind of theorem about branches, curves and surfaces, besides what is asked of any."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any, cast

from orbitproof.shared.claims import AnyAtlas
from orbitproof.verify.atlas.results import Settings
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.curve import PieceLimits
from orbitproof.verify.evidence import Theorem
from orbitproof.verify.surface import SurfaceLimits


@dataclass(frozen=True, kw_only=True)
class BranchKind(Kind):
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


def kind_of(atlas: AnyAtlas) -> BranchKind:
    """The kind of an atlas."""
    return cast(BranchKind, kind_named(atlas.claim.kind))
