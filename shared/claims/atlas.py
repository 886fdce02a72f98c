"""Atlases: a curve of symmetric periodic orbits in pieces, or a surface of them over the mass parameter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from orbitproof.shared.claims.pieces import AnyPiece, LibrationPiece, Piece, SurfacePiece
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import ReversibleSystem

SURFACE = "symmetry-breaking-surface"
CLAIMS = ("arc", "symmetric-arc", "symmetric-loop", "loop", SURFACE)


@dataclass(frozen=True)
class Covers:
    """The claim that a coordinate goes from a value <= `start` to one >= `end`."""

    coordinate: str
    start: Fraction
    end: Fraction

    def to_json(self) -> dict[str, str]:
        """The JSON object."""
        return {"coordinate": self.coordinate, "from": format_exact(self.start), "to": format_exact(self.end)}


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

    kind: str
    symmetry: str | None = None
    increasing: tuple[str, ...] = ()
    covers: Covers | None = None
    crossings: int = 1

    def to_json(self) -> dict[str, Any]:
        """The JSON object."""
        result: dict[str, Any] = {"kind": self.kind, "symmetry": self.symmetry}
        if self.increasing:
            result["increasing"] = list(self.increasing)
        if self.covers is not None:
            result["covers"] = self.covers.to_json()
        if self.crossings != 1:
            result["crossings"] = self.crossings
        return result


@dataclass(frozen=True)
class Atlas:
    """A claim about a curve or a surface, and its pieces in order along it.

    Attributes:
        id: short name.
        title: what people read.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name; empty for a surface.
        claim: what the pieces are together.
        pieces: all of them `Piece`, or for a surface `SurfacePiece`, and `LibrationPiece` in Hill's units.
        provenance: free-form, ignored by the verifier.
    """

    id: str
    title: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    claim: Claim
    pieces: tuple[AnyPiece, ...]
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_surface(self) -> bool:
        """Whether the claim is about a surface over the parameters."""
        return self.claim.kind == SURFACE

    def curve_pieces(self) -> tuple[Piece, ...]:
        """The pieces of a curve; none for a surface."""
        return tuple(piece for piece in self.pieces if isinstance(piece, Piece))

    def surface_pieces(self) -> tuple[SurfacePiece, ...]:
        """The pieces of a surface; none for a curve."""
        return tuple(piece for piece in self.pieces if isinstance(piece, SurfacePiece))

    def libration_pieces(self) -> tuple[LibrationPiece, ...]:
        """The pieces of the planar families over which a surface lives; none for a curve."""
        return tuple(piece for piece in self.pieces if isinstance(piece, LibrationPiece))
