"""Atlases: a curve of symmetric periodic orbits in pieces, or a surface of them over the mass parameter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal

from orbitproof.shared.claims.fields import SURFACE, Crossings, Id, Identifier, Line
from orbitproof.shared.claims.pieces import AnyPiece, BirthPiece, LibrationPiece, Piece, SurfacePiece, pieces_of
from orbitproof.shared.stored import Rational, rules, stored
from orbitproof.shared.systems import ReversibleSystem
from orbitproof.shared.wording import counted

Names = Annotated[tuple[Identifier, ...], rules(maxItems=32)]
Pieces = Annotated[tuple[AnyPiece, ...], rules(minItems=1, maxItems=100000)]


@dataclass(frozen=True)
class Covers:
    """The claim that a coordinate goes from a value <= `start` to one >= `end`."""

    coordinate: Identifier
    start: Fraction = stored("from")
    end: Fraction = stored("to")


@dataclass(frozen=True)
class Claim:
    """What the pieces are claimed to be together.

    Attributes:
        kind: one of `CLAIMS`.
        symmetry: name of the symmetry of the curve (for a surface, of the one that breaks), or `None`.
        increasing: coordinates that increase along the curve, on a symmetric arc away from its symmetric point.
        covers: the range that a coordinate takes, or `None`.
        crossings: m, how often half orbits meet the section after their start; P^m then stands for P.
    """

    kind: Literal["arc", "symmetric-arc", "symmetric-loop", "loop", "symmetry-breaking-surface"]
    symmetry: Identifier | None = stored(always=True, default=None)
    increasing: Names = ()
    covers: Covers | None = None
    crossings: Crossings = 1

    @property
    def is_of_symmetric_curve(self) -> bool:
        """Whether the curve is claimed to be mapped to itself by the symmetry."""
        return self.kind in ("symmetric-arc", "symmetric-loop")

    @property
    def is_closed(self) -> bool:
        """Whether the curve is claimed to be closed."""
        return self.kind in ("loop", "symmetric-loop")

    @property
    def is_arc(self) -> bool:
        """Whether it is one curve with two ends, and no symmetry maps it to itself."""
        return self.kind == "arc"

    @property
    def goes_round(self) -> bool:
        """Whether its last piece leads into its first: it is closed, and all of it is in pieces."""
        return self.is_closed and not self.is_of_symmetric_curve

    @property
    def is_of_surface(self) -> bool:
        """Whether it is about a surface over the parameters."""
        return self.kind == SURFACE


@dataclass(frozen=True, repr=False)
class Atlas:
    """A claim about a curve or a surface, and its pieces in order along it.

    Attributes:
        id: short name.
        title: what people read.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name; empty for a surface.
        claim: what the pieces are together.
        pieces: all of them `Piece`, and last a `BirthPiece` if orbits in units of the speed across the plane, or those
            of two crossings in a half orbit, go on to where they are born; or for a surface `SurfacePiece`, and
            `LibrationPiece` in Hill's units.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    title: Line
    system: ReversibleSystem
    parameters: Mapping[Identifier, Rational]
    claim: Claim
    pieces: Pieces
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)
    is_of_symmetric_orbits = True

    def __repr__(self) -> str:
        pieces = counted(len(self.pieces), "piece")
        return f"<Atlas {self.id!r}: {self.claim.kind} in {pieces}, of {self.system.name}>"

    @property
    def is_surface(self) -> bool:
        """Whether the claim is about a surface over the parameters."""
        return self.claim.is_of_surface

    def curve_pieces(self) -> tuple[Piece, ...]:
        """The pieces of a curve; none for a surface."""
        return pieces_of(Piece, self.pieces)

    def birth_pieces(self) -> tuple[BirthPiece, ...]:
        """The pieces at whose middle the orbits of a curve are born from others; at most one is allowed."""
        return pieces_of(BirthPiece, self.pieces)

    def surface_pieces(self) -> tuple[SurfacePiece, ...]:
        """The pieces of a surface; none for a curve."""
        return pieces_of(SurfacePiece, self.pieces)

    def libration_pieces(self) -> tuple[LibrationPiece, ...]:
        """The pieces of the planar families over which a surface lives; none for a curve."""
        return pieces_of(LibrationPiece, self.pieces)
