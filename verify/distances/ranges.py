"""Half periods and distances over parts of a curve, from stored functions (section 20)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

from flint import arb

from orbitproof.shared.systems import ReversibleSystem
from orbitproof.verify.claim import is_left_alone
from orbitproof.verify.distances.stored_distances import PARTS, SLACK, Bounds, DistanceFunctions, Where
from orbitproof.verify.evidence import enclose, hull, is_positive, up_to
from orbitproof.verify.functions import REACH, BoundedFunction

if TYPE_CHECKING:
    from orbitproof.verify.distances.distances import DistanceAlongCurve
    from orbitproof.verify.poincare import HalfOrbits

_PIECES = 4
"""Values over a part of an interval are enclosed on so many pieces of it."""


@dataclass(frozen=True)
class Extreme:
    """The least or the greatest squared distance of the orbits of a part of an interval.

    Attributes:
        square: encloses it.
        where: on the orbits it is taken.
    """

    square: arb
    where: Where

    @property
    def as_found(self) -> Extreme:
        """The extreme with the bounds that were found, if these are what `DistanceAlongCurve` has made of them."""
        low, high = self.square.lower() / enclose(1 - SLACK), self.square.upper() / enclose(1 + SLACK)
        return Extreme(hull(low, high), self.where)


@dataclass(frozen=True)
class PartOfInterval:
    """Both for tau from `lower` to `upper`."""

    lower: Fraction
    upper: Fraction
    least: Extreme
    greatest: Extreme


@dataclass(frozen=True)
class KnownDistances:
    """Distances from a body along the orbits of an interval.

    Attributes:
        here, there: squares at x(s) and y(s), functions of tau.
        parts: from left to right.
    """

    here: BoundedFunction
    there: BoundedFunction
    parts: tuple[PartOfInterval, ...]

    def mirrored(self) -> KnownDistances:
        """The distances of -s."""
        parts = [PartOfInterval(-p.upper, -p.lower, p.least, p.greatest) for p in reversed(self.parts)]
        return KnownDistances(self.here.mirrored(), self.there.mirrored(), tuple(parts))

    def over(self, lower: Fraction, upper: Fraction) -> tuple[Extreme, Extreme] | None:
        """The least and the greatest squared distances for tau in an interval; `None` if it is not one of them."""
        found = [
            (max(lower, part.lower), min(upper, part.upper), part)
            for part in self.parts
            if part.lower <= upper and lower <= part.upper
        ]
        if not found:
            return None
        least = [self._values(part.least, first, last) for first, last, part in found]
        greatest = [self._values(part.greatest, first, last) for first, last, part in found]
        return joined(least), joined(greatest)

    def _values(self, extreme: Extreme, lower: Fraction, upper: Fraction) -> Extreme:
        if extreme.where is Where.ALONG:
            return extreme
        function = self.here if extreme.where is Where.HERE else self.there
        return Extreme(_values(function, lower, upper), extreme.where)


def _values(function: BoundedFunction, lower: Fraction, upper: Fraction) -> arb:
    """Encloses the values of a function on an interval of tau."""
    if lower == upper:
        return function.value(enclose(lower))
    ends = [enclose(lower + (upper - lower) * number / _PIECES) for number in range(_PIECES + 1)]
    return _hull(function.value(hull(*pair)) for pair in pairwise(ends))


def _hull(balls: Iterable[arb]) -> arb:
    first, *others = balls
    return hull(first, *others)


def joined(extremes: Sequence[Extreme]) -> Extreme:
    """What holds of several parts together."""
    places = {extreme.where for extreme in extremes}
    return Extreme(_hull(extreme.square for extreme in extremes), places.pop() if len(places) == 1 else Where.ALONG)


def is_distance_of_orbits(system: ReversibleSystem, symmetry: str | None) -> bool:
    """Whether the system names a distance that R and S, if one is named, leave alone."""
    return is_left_alone(system.squared_distance_program, system, symmetry)


def distance_along(returns: HalfOrbits, symmetry: str | None, share: Fraction) -> DistanceAlongCurve | None:
    """For the distance that the system names, if R and S leave it alone; arguments as of `DistanceAlongCurve`."""
    if not is_distance_of_orbits(returns.system, symmetry):
        return None
    from orbitproof.verify.distances.distances import DistanceAlongCurve

    return DistanceAlongCurve(returns, share)


def known_distances(found: DistanceFunctions) -> KnownDistances:
    """What stored distances say. Raises `ValueError` if they are none."""
    if len(found.parts) != PARTS:
        raise ValueError("the distance is given on another number of parts")
    parts = []
    for number, part in enumerate(found.parts):
        lower, upper = (Fraction(2 * end - PARTS, PARTS) / REACH for end in (number, number + 1))
        least, greatest = _extreme(part.least, part.least_at), _extreme(part.greatest, part.greatest_at)
        parts.append(PartOfInterval(lower, upper, least, greatest))
    return KnownDistances(found.here.enclosed, found.there.enclosed, tuple(parts))


def _extreme(bounds: Bounds, where: Where) -> Extreme:
    low, high = bounds
    if not 0 <= low <= high:
        raise ValueError("bounds of a distance are none")
    return Extreme(hull(enclose(low), enclose(high)), where)


class Known(Protocol):
    """A part of the curve with the functions known on it; `places.Segment`."""

    @property
    def stretch(self) -> int:
        """Number of the stretch."""

    @property
    def start(self) -> Fraction:
        """s where it begins."""

    @property
    def end(self) -> Fraction:
        """s where it ends."""

    @property
    def half_period(self) -> BoundedFunction:
        """Function of tau."""

    @property
    def distances(self) -> KnownDistances | None:
        """If they are known."""

    def tau(self, s: Fraction) -> Fraction:
        """The variable of the functions."""


@dataclass(frozen=True)
class Ranges:
    """Half periods, least and greatest squared distances of the orbits of a part of the curve.

    Attributes:
        least, greatest: `None` if not known on all of it.
    """

    half_period: arb
    least: Extreme | None
    greatest: Extreme | None

    @property
    def distances(self) -> dict[str, tuple[arb, Where]]:
        """Enclosures of the distances, and where they are taken, by name."""
        found = {"least": self.least, "greatest": self.greatest}
        return {name: (_root(each.square), each.where) for name, each in found.items() if each is not None}


def together(parts: Sequence[Ranges]) -> Ranges | None:
    """The ranges of several parts of the curve together; `None` if there are no parts."""
    if not parts:
        return None
    least = [part.least for part in parts if part.least is not None]
    greatest = [part.greatest for part in parts if part.greatest is not None]
    return Ranges(
        _hull(part.half_period for part in parts),
        joined(least) if len(least) == len(parts) else None,
        joined(greatest) if len(greatest) == len(parts) else None,
    )


def ranges_between(segments: Sequence[Known], begin: tuple[int, Fraction], end: tuple[int, Fraction]) -> Ranges | None:
    """The ranges over the curve from one place to another, stretch and s; `None` if nothing is known of it."""
    found = []
    for segment in segments:
        low = max(segment.start, begin[1]) if segment.stretch == begin[0] else segment.start
        high = min(segment.end, end[1]) if segment.stretch == end[0] else segment.end
        if begin[0] <= segment.stretch <= end[0] and low <= high:
            first, last = segment.tau(low), segment.tau(high)
            known = None if segment.distances is None else segment.distances.over(first, last)
            found.append(Ranges(_values(segment.half_period, first, last), *(known or (None, None))))
    return together(found)


def _root(square: arb) -> arb:
    """The root of a number that is not negative."""
    return square.sqrt() if is_positive(square) else up_to(arb(square.upper()).sqrt())
