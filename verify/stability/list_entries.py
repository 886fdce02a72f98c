"""Parts of a curve, places and points on it, and what a complete list is made of (section 18.5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.distances import KnownDistances
from orbitproof.verify.evidence import Hypothesis, enclose
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.out_of_plane import KnownVariations
from orbitproof.verify.stability.kinds import Found, Kind, Subject

_FEW = 2
"""For more stability parameters only resonances are listed."""


@dataclass(frozen=True)
class Segment:
    """A part of the curve on one piece, with the functions that are known on it.

    Attributes:
        stretch: number of the stretch.
        start, end: of s; the curve runs through it from `start` to `end`.
        entered: the curve runs through all of it from here on; it begins between `start` and this.
        middle, radius: s = middle + radius tau.
        characteristic, level, half_period, first_factor: functions of tau, as in `matrix.OrbitFunctions`.
        distances: from the body that the system names, if they are known.
        out_of_plane: variations out of the plane of motion, if they are known.
    """

    stretch: int
    start: Fraction
    entered: Fraction
    end: Fraction
    middle: Fraction
    radius: Fraction
    characteristic: tuple[BoundedFunction, ...]
    level: BoundedFunction
    half_period: BoundedFunction
    first_factor: BoundedFunction
    distances: KnownDistances | None = None
    out_of_plane: KnownVariations | None = None

    def tau(self, s: Fraction) -> Fraction:
        """The variable of the functions."""
        return (s - self.middle) / self.radius

    def tau_of(self, s: arb) -> arb:
        """The values of tau for the numbers in a ball."""
        return (s - enclose(self.middle)) / enclose(self.radius)

    def s_of(self, tau: arb) -> arb:
        """s of a ball of tau."""
        return enclose(self.middle) + enclose(self.radius) * tau

    def at(self, c: arb) -> BoundedFunction:
        """det(c - Sigma)."""
        result = BoundedFunction(ball_polynomial([Fraction(1)]), arb(0))
        for number, coefficient in enumerate(self.characteristic, start=1):
            result = result.scaled(c) + coefficient.scaled(arb(-1 if number % 2 else 1))
        return result

    @property
    def has_few_parameters(self) -> bool:
        """As `CompleteList.has_few_parameters`."""
        return len(self.characteristic) <= _FEW

    @cached_property
    def discriminant(self) -> BoundedFunction | None:
        """The discriminant of the characteristic polynomial for n = 2; `None` for n = 1, where it is 1, and n >= 3."""
        if len(self.characteristic) != 2:
            return None
        trace, determinant = self.characteristic
        return trace * trace - determinant.scaled(arb(4))

    @property
    def meets_symmetric_point(self) -> int:
        """-1 or 1 if the segment of a symmetric piece begins or ends at s = 0 = tau; else 0."""
        if self.middle:
            return 0
        return -1 if self.start == 0 else 1 if self.end == 0 else 0


@dataclass(frozen=True)
class Gap:
    """A part of the curve, or a place on it, of which something is not shown.

    Attributes:
        stretch: number of the stretch.
        start, end: of s.
        subject: what is not known there.
        reason: why, in words.
    """

    stretch: int
    piece: str
    start: Fraction
    end: Fraction
    subject: Subject
    reason: str


@dataclass(frozen=True)
class Point:
    """A point of the curve at which an eigenvalue of Sigma, or the discriminant, has a certain value.

    Attributes:
        stretch, piece: where on the curve.
        k, j: the eigenvalue is cos(2 pi j/k); 0 for a Krein collision or a combination resonance.
        kind: what happens there.
        s: a ball that contains it.
        level, half_period: enclosures.
        point: enclosures of the coordinates.
        certificates: ids of the certificates of bifurcations at this point.
    """

    stretch: int
    piece: str
    k: int
    j: int
    kind: Kind
    s: arb
    level: arb
    half_period: arb
    point: Mapping[str, arb]
    certificates: tuple[str, ...] = ()

    @property
    def found(self) -> Found:
        """What is there."""
        return Found(self.kind, self.k, self.j)


@dataclass(frozen=True)
class Extremum:
    """A point of the curve at which a stability parameter is stationary.

    Attributes:
        stretch, piece: where on the curve.
        value: encloses the stability parameter.
        in_band: whether it is certainly in the band (`extrema.BAND`); else it may be in it or beyond.
        s: a ball that contains the point's.
        level, half_period: enclosures.
        certificates: ids of the certificates of the orbits beside it that show its value.
    """

    stretch: int
    piece: str
    value: arb
    in_band: bool
    s: arb
    level: arb
    half_period: arb
    certificates: tuple[str, ...] = ()


@dataclass(frozen=True)
class Combinations:
    """Combination resonances up to order 4 of the linearly stable orbits of a curve, n = 2.

    Attributes:
        points: in order along the curve.
        open: where it is not decided whether there are more of them, beside the gaps of the list.
    """

    points: tuple[Point, ...]
    open: tuple[Gap, ...]


@dataclass(frozen=True)
class CompleteList:
    """What is proved of the resonances on a curve.

    Attributes:
        order: the largest k.
        parameters: n, the number of stability parameters.
        points: in order along the curve, those of Krein collisions included.
        gaps: what is not covered; the list is complete on the rest.
        segments: the parts of the curve with the functions known on them.
        extrema: of the stability parameters, close to the resonant values, in order along the curve.
        open_extrema: where it is not decided whether there are more of them.
        hypotheses: those of the list beside those of the curve.
        combinations: those of two pairs of multipliers, if they were asked for and n = 2.
    """

    order: int
    parameters: int
    points: tuple[Point, ...]
    gaps: tuple[Gap, ...]
    segments: tuple[Segment, ...]
    extrema: tuple[Extremum, ...] = ()
    open_extrema: tuple[Gap, ...] = ()
    hypotheses: tuple[Hypothesis, ...] = ()
    combinations: Combinations | None = None

    @property
    def has_few_parameters(self) -> bool:
        """Whether n <= 2: then collisions, extrema and linear stability are looked at (18.6, 18.10)."""
        return self.parameters <= _FEW


def level_name(atlas: Atlas) -> str:
    """What the level along the curve is called."""
    return str(atlas.system.family_parameter or atlas.system.first_integral_name or "first integral")
