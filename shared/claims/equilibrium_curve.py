"""Atlases of curves of equilibria over a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from orbitproof.shared.claims.atlas import Covers, Names
from orbitproof.shared.claims.fields import Identifier
from orbitproof.shared.claims.periodic_curve import PeriodicAtlas, Refusal
from orbitproof.shared.systems import System


@dataclass(frozen=True)
class EquilibriumCurveClaim:
    """What the pieces are claimed to be together: one curve of equilibria f(x, a) = 0 while a parameter a varies.

    Attributes:
        kind: one of `EQUILIBRIUM_CURVES`; a loop is closed.
        parameter: the one that varies along the curve.
        increasing: coordinates that increase along the curve.
        covers: the range that a coordinate takes, or `None`.
    """

    kind: Literal["equilibrium-arc", "equilibrium-loop"]
    parameter: Identifier
    increasing: Names = ()
    covers: Covers | None = None

    symmetry = level = None
    numbers = ()
    uses_integral = is_of_symmetric_curve = False
    crossings = 1

    def refusal(self, system: System) -> Refusal | None:
        """What the claim cannot say of a system: nothing but what is asked of every curve."""
        return None

    @property
    def is_closed(self) -> bool:
        """Whether the curve is claimed to be closed."""
        return self.kind == "equilibrium-loop"

    @property
    def goes_round(self) -> bool:
        """Whether its last piece leads into its first."""
        return self.is_closed

    def coordinates(self, system: System) -> tuple[str, ...]:
        """Names of the coordinates of a point: the parameter that varies, then the state."""
        return (self.parameter, *system.given_state)

    @property
    def setting(self) -> tuple[Any, ...]:
        """What a proof of a piece depends on beside the piece, the system and its parameters."""
        return self.kind, self.parameter


@dataclass(frozen=True, repr=False)
class EquilibriumAtlas(PeriodicAtlas):
    """A claim about a curve of equilibria: fields as of a curve of periodic orbits without symmetry, all at rest."""

    claim: EquilibriumCurveClaim  # type: ignore[assignment]
