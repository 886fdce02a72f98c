"""Atlases of curves of periodic orbits of which no symmetry is used, over a parameter or the levels of an integral."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from orbitproof.shared.claims.atlas import Atlas, Covers, Names, Pieces
from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Line, Numbers
from orbitproof.shared.claims.pieces import BirthPiece, LibrationPiece, Piece, SurfacePiece, pieces_of
from orbitproof.shared.stored import Rational, stored
from orbitproof.shared.systems import System
from orbitproof.shared.wording import counted

Refusal = tuple[str, str, str]
"""The field of a claim that is malformed, what is wrong, and what to do."""


@dataclass(frozen=True)
class PeriodicCurveClaim:
    """What the pieces are claimed to be together: one curve of periodic orbits, all from one section.

    The section is the set of the x with normal . x = offset. A crossing is a point of an orbit on it where normal . x
    grows (direction 1) or falls (direction -1) in time. Each orbit of the curve returns to its point of the curve at
    crossing number `crossings` after it, and not before.

    Attributes:
        kind: one of `PERIODIC_CURVES`; a loop is closed.
        normal: shape (N,), not zero; of the section.
        offset: of the section.
        direction: 1 or -1.
        crossings: m.
        parameter: of the vector field, the one that varies along the curve; `None`: the level of the first integral.
        level: of the first integral, on which all orbits are claimed to lie; only where a parameter varies.
        increasing: coordinates that increase along the curve.
        covers: the range that a coordinate takes, or `None`.
    """

    kind: Literal["periodic-arc", "periodic-loop"]
    normal: Numbers
    offset: Fraction
    direction: Literal[1, -1]
    crossings: Crossings
    parameter: Identifier | None = None
    level: Rational | None = None
    increasing: Names = ()
    covers: Covers | None = None

    symmetry = None
    is_of_symmetric_curve = False

    @property
    def is_closed(self) -> bool:
        """Whether the curve is claimed to be closed."""
        return self.kind == "periodic-loop"

    @property
    def goes_round(self) -> bool:
        """Whether its last piece leads into its first."""
        return self.is_closed

    @property
    def uses_integral(self) -> bool:
        """Whether an equation is replaced because a first integral is constant along orbits."""
        return self.parameter is None or self.level is not None

    @property
    def numbers(self) -> tuple[tuple[str, Fraction], ...]:
        """All exact numbers with the field that each stands in."""
        normal = tuple((f"normal[{i}]", value) for i, value in enumerate(self.normal))
        return (("offset", self.offset), *normal, *(() if self.level is None else (("level", self.level),)))

    def refusal(self, system: System) -> Refusal | None:
        """What the claim cannot say of a system."""
        size, names = len(system.given_state), ", ".join(system.given_state)
        if len(self.normal) != size:
            return "normal", f"{len(self.normal)} numbers", f"give {size}; the state is {names}"
        if not any(self.normal):
            return "normal", "is zero", "give a vector across the section"
        if self.uses_integral and system.first_integral_program is None:
            over_levels = self.parameter is None
            remedy = "name the parameter that varies" if over_levels else "leave it out"
            return "parameter" if over_levels else "level", f"{system.name} has no first integral", remedy
        if self.parameter is None and self.level is not None:
            return "level", "the level varies along the curve", "leave it out, or name a parameter that varies"
        if size < 2 + self.uses_integral:
            return "kind", f"a state of {size} coordinates has no such curves", "give another system"
        return None

    @property
    def pivot(self) -> int:
        """The state coordinate that follows from the others on the section: the normal has no larger entry."""
        return max(range(len(self.normal)), key=lambda index: abs(self.normal[index]))

    def coordinates(self, system: System) -> tuple[str, ...]:
        """Names of the coordinates of a point: the parameter that varies, then the state but for the pivot."""
        state = [name for index, name in enumerate(system.given_state) if index != self.pivot]
        return (*([] if self.parameter is None else [self.parameter]), *state)

    @property
    def setting(self) -> tuple[Any, ...]:
        """What a proof of a piece depends on beside the piece, the system and its parameters."""
        return self.normal, self.offset, self.direction, self.crossings, self.parameter, self.level


@dataclass(frozen=True, repr=False)
class PeriodicAtlas:
    """A claim about a curve of periodic orbits, and its pieces in order along it.

    Attributes:
        id: short name.
        title: what people read.
        system: the vector field; if the system has a symmetry, it is not used.
        parameters: exact values of all parameters of the vector field but the one that varies, by name.
        claim: what the pieces are together.
        pieces: all of them regular, in the coordinates `coordinates`.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    title: Line
    system: System
    parameters: Mapping[Identifier, Rational]
    claim: PeriodicCurveClaim
    pieces: Pieces
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    is_surface = is_of_symmetric_orbits = False

    def __repr__(self) -> str:
        pieces = counted(len(self.pieces), "piece")
        return f"<PeriodicAtlas {self.id!r}: {self.claim.kind} in {pieces}, of {self.system.name}>"

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of a point."""
        return self.claim.coordinates(self.system)

    def curve_pieces(self) -> tuple[Piece, ...]:
        """The pieces."""
        return pieces_of(Piece, self.pieces)

    def birth_pieces(self) -> tuple[BirthPiece, ...]:
        """None: no piece begins at a birth."""
        return ()

    def surface_pieces(self) -> tuple[SurfacePiece, ...]:
        """None: it is about a curve."""
        return ()

    def libration_pieces(self) -> tuple[LibrationPiece, ...]:
        """None: no piece begins at a libration point."""
        return ()


AnyAtlas = Atlas | PeriodicAtlas
"""What a file of an atlas claims."""
