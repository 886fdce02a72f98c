"""What is proved of a piece of a surface on parts of an interval of s (section 17.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from flint import arb

from orbitproof.shared.errors import InputError
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.curve import PROVED, Computation, Interval, IntervalResult


@dataclass(frozen=True)
class ProvedPart:
    """For each s in the interval the piece's box has one symmetry breaking, at p in `point`, halo orbits on `side`.

    Attributes:
        interval: within [-1, 1].
        point: enclosures of the coordinates p of the bifurcation point.
        side: levels of the first integral at which the halo orbits live.
        enclosures: of what the hypotheses are about, by hypothesis and name.
    """

    interval: Interval
    point: Annotated[tuple[arb, ...], rules(minItems=1, maxItems=32)]
    side: Annotated[str, rules(enum=("above", "below"))]
    enclosures: Mapping[str, Mapping[str, arb]] = stored("hypotheses")

    @property
    def start(self) -> Fraction:
        """The least s."""
        return self.interval[0]

    @property
    def end(self) -> Fraction:
        """The greatest s."""
        return self.interval[1]


@dataclass(frozen=True)
class SurfaceResult(IntervalResult):
    """What was found for a piece of a surface.

    Attributes:
        parts: of the interval, in order, if it is proved.
    """

    parts: tuple[ProvedPart, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        reached = [self.interval[0], *(part.end for part in self.parts)]
        begun = [*(part.start for part in self.parts), self.interval[1]]
        if self.is_proved and any(end < start for end, start in zip(reached, begun, strict=True)):
            raise InputError("parts: are not all of the interval, in order; write the file again")


@dataclass(frozen=True)
class ProvedParts:
    """Parts that cover an interval of s, in order, and the half periods of the orbits over it."""

    parts: tuple[ProvedPart, ...]
    time: arb

    def stored(self, piece: str, computation: Computation) -> SurfaceResult:
        """As in `curve.piece_result.Results`."""
        interval = self.parts[0].start, self.parts[-1].end
        return SurfaceResult(piece, interval, PROVED, computation, time=self.time, parts=self.parts)
