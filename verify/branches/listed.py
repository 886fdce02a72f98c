"""What the certificate of a branch lists of a curve, as values: resonances and stable intervals (section 18.5).

They are what its maker wrote; whether it follows is what `recheck` decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.stored import stored


@dataclass(frozen=True, repr=False)
class ListedPoint:
    """A point of a curve at which its stability changes, or an orbit is in resonance.

    All balls are in nondimensional units.

    Attributes:
        piece: id of the piece on which it lies.
        kind: what happens there, in words.
        k, j: a stability parameter is cos(2 pi j/k) there; 0 for a Krein collision.
        s: a ball that contains the point's.
        level: encloses the first integral of the orbit, or the parameter of its family.
        half_period: encloses half its period; of vertical orbits, whose list is one up to z -> -z, a quarter of it.
        point: balls that contain the coordinates on Fix(R), by name.
        certificates: ids of the certificates of bifurcations at this point.
    """

    piece: str
    kind: str
    k: int
    j: int
    s: arb
    level: arb
    half_period: arb
    point: Mapping[str, arb]
    certificates: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ListedPoint {self.kind}{f' {self.j}/{self.k}' if self.k > 1 else ''} on {self.piece}>"


@dataclass(frozen=True, repr=False)
class ListedEnd:
    """An end of an interval of linear stability.

    Attributes:
        piece: id of the piece on which it lies.
        what: what happens there, in words.
        interval: of s, that contains it.
        level, half_period: as of `ListedPoint`, for the orbit there; `None` where it is not known.
    """

    piece: str
    what: tuple[str, ...]
    interval: tuple[Fraction, Fraction]
    level: arb | None = None
    half_period: arb | None = None

    def __repr__(self) -> str:
        return f"<ListedEnd {', '.join(self.what)} on {self.piece}>"


@dataclass(frozen=True)
class ListedInterval:
    """Between two ends, themselves not included, all orbits of a curve are linearly stable."""

    start: ListedEnd = stored("from")
    end: ListedEnd = stored("to")
