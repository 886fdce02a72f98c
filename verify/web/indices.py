"""What a web knows of the index of the orbits of an arc (section 33.6)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from orbitproof.shared.claims.fields import PieceId
from orbitproof.shared.stored import rules
from orbitproof.verify.stability import IntervalEnd


@dataclass(frozen=True)
class IndexOnArc:
    """The Conley-Zehnder index of orbits of an arc.

    Attributes:
        index: of planar orbits that in the plane, then that across it.
        piece, s: the place of an orbit that has it.
        begin, end: between these places of the curve all orbits have it; absent if it is known of that one alone.
    """

    index: Annotated[tuple[int, ...], rules(minItems=1, maxItems=2)]
    piece: PieceId
    s: Fraction
    begin: IntervalEnd | None = None
    end: IntervalEnd | None = None


@dataclass(frozen=True)
class Indices:
    """What the certificate of the index along the curve of an arc proves (Theorem 35.7).

    Attributes:
        digest: of that certificate.
        orbits: in order along the curve.
        small: the index of small orbits of a curve that reaches a libration point; of planar ones in the plane, across.
        problem: why it counts for nothing, if it does.
    """

    digest: str
    orbits: tuple[IndexOnArc, ...] = ()
    small: tuple[int, ...] = ()
    problem: str = ""
