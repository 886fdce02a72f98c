"""Where on a proved curve the orbits are linearly stable (section 18.6)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb

from orbitproof.shared.claims.fields import PieceId, Short
from orbitproof.verify.curve import Chain
from orbitproof.verify.distances import Ranges, ranges_between, together
from orbitproof.verify.evidence import enclose, is_positive
from orbitproof.verify.stability.kinds import CurveEnd, Kind, Subject, What, may_change_stability, short_name
from orbitproof.verify.stability.list_entries import CompleteList, Point, Segment
from orbitproof.verify.stability.zeros import ends_of


@dataclass(frozen=True)
class Bound:
    """Where an interval of the curve ends: a point at which stability changes, an end of the curve, or a gap.

    Attributes:
        stretch, lower, upper: where on the curve; s of the two sides of it.
        what: is there, in order along the curve; several where they are not separated.
        point: if it is one of the list, and nothing else.
        is_one_point: whether all orbits but one between `lower` and `upper` are as those on the same side of it.
        ranges: half period and distances there, if it is a point of the list.
    """

    stretch: int
    lower: Fraction
    upper: Fraction
    what: tuple[What, ...]
    point: Point | None = None
    is_one_point: bool = True
    ranges: Ranges | None = None


@dataclass(frozen=True)
class IntervalEnd:
    """An end of an interval of the curve: what is there, on which piece, between which s."""

    what: tuple[Short, ...]
    piece: PieceId
    interval: tuple[Fraction, Fraction]

    @staticmethod
    def of(bound: Bound, chain: Chain) -> IntervalEnd:
        """The stored form of an end of an interval, exactly."""
        piece = chain.stretches[bound.stretch].tube.piece.id
        return IntervalEnd(tuple(map(short_name, bound.what)), piece, (bound.lower, bound.upper))


@dataclass(frozen=True)
class StableInterval:
    """Between two places of the curve all orbits are linearly stable: multipliers on the unit circle, distinct.

    Attributes:
        begin, end: the two places, themselves not included.
        pieces: ids of the pieces at the two places.
        ranges: half periods and distances of the orbits in between, if they are known.
    """

    begin: Bound
    end: Bound
    pieces: tuple[str, str]
    ranges: Ranges | None = None


@dataclass(frozen=True)
class Rule:
    """What holds of all orbits between two neighbouring places of a curve if it holds of one of them.

    Attributes:
        ends_at: whether it may change at a point.
        ends_where: whether it may change where this is open.
        holds: of the orbit at a ball of tau of a segment; `None` if that is not known.
    """

    ends_at: Callable[[Point], bool]
    ends_where: Callable[[Subject], bool]
    holds: Callable[[Segment, arb], bool | None]


def stable_intervals(
    chain: Chain, found: CompleteList, closed: bool
) -> tuple[list[StableInterval], list[StableInterval]]:
    """The intervals between which the orbits are linearly stable, and those of which nothing is known.

    All in order along the curve; on the rest of it no orbit is stable. For n >= 3 there are none of either.

    Args:
        closed: whether the curve is a loop, which has no ends where it begins and ends.
    """
    if not found.has_few_parameters:
        return [], []
    return intervals_where(chain, found, closed, Rule(lambda point: not point.k > 2, may_change_stability, is_stable))


def intervals_where(
    chain: Chain, found: CompleteList, closed: bool, rule: Rule
) -> tuple[list[StableInterval], list[StableInterval]]:
    """The intervals between which something holds of the orbits, and those of which that is not known.

    All in order along the curve; on the rest of it that holds of no orbit.

    Args:
        closed: as in `stable_intervals`.
    """
    bounds = list(bounds_on(chain, found, rule.ends_at, rule.ends_where))
    result: list[StableInterval] = []
    unknown: list[StableInterval] = []
    for before, after in pairwise(bounds):
        if not before.is_one_point:
            name = chain.stretches[before.stretch].tube.piece.id
            unknown.append(StableInterval(before, before, (name, name)))
        orbit = orbit_between(chain, found.segments, before, after)
        holds = None if orbit is None else rule.holds(*orbit)
        if holds is not False:
            ids = [chain.stretches[bound.stretch].tube.piece.id for bound in (before, after)]
            ranges = ranges_between(found.segments, (before.stretch, before.lower), (after.stretch, after.upper))
            entry = StableInterval(before, after, (ids[0], ids[1]), ranges if holds else None)
            (result if holds else unknown).append(entry)
    if not bounds[-1].is_one_point:
        name = chain.stretches[bounds[-1].stretch].tube.piece.id
        unknown.append(StableInterval(bounds[-1], bounds[-1], (name, name)))
    if closed and len(result) > 1 and _is_cut(result[0].begin, result[-1].end):
        first, last = result[0], result.pop()
        known = [entry.ranges for entry in (last, first) if entry.ranges is not None]
        ranges = together(known) if len(known) == 2 else None
        result[0] = StableInterval(last.begin, first.end, (last.pieces[0], first.pieces[1]), ranges)
    return result, unknown


def _is_cut(begin: Bound, end: Bound) -> bool:
    """Whether these are the two sides of the place where a loop is cut, and nothing else is there."""
    return begin.what == (CurveEnd.BEGINNING,) and end.what == (CurveEnd.END,)


def bounds_on(
    chain: Chain,
    found: CompleteList,
    ends_at: Callable[[Point], bool],
    ends_where: Callable[[Subject], bool],
) -> Iterator[Bound]:
    """All places at which something may change, disjoint, in order: such points, such gaps, the ends of the curve."""
    places = []
    for point in found.points:
        if ends_at(point):
            low, high = ends_of(point.s)
            ranges = ranges_between(found.segments, (point.stretch, low), (point.stretch, high))
            places.append(Bound(point.stretch, low, high, (point.found,), point, True, ranges))
    for gap in found.gaps:
        if ends_where(gap.subject):
            places.append(Bound(gap.stretch, gap.start, gap.end, (gap.subject,), None, False))
    first, last = chain.stretches[0], chain.stretches[-1]
    places.append(Bound(0, first.enters, first.entered, (CurveEnd.BEGINNING,)))
    places.append(Bound(len(chain.stretches) - 1, last.leaves, last.leaves, (CurveEnd.END,)))
    places.sort(key=lambda bound: (bound.stretch, bound.lower, bound.upper))
    held = places[0]
    for bound in places[1:]:
        if bound.stretch == held.stretch and bound.lower <= held.upper:
            held = _together(held, bound)
        else:
            yield held
            held = bound
    yield held


def _together(first: Bound, second: Bound) -> Bound:
    """Two places that are not separated."""
    for bound, other in ((first, second), (second, first)):
        at_end = len(other.what) == 1 and isinstance(other.what[0], CurveEnd)
        is_symmetric = bound.point is not None and bound.point.kind is Kind.SYMMETRIC
        if is_symmetric and at_end and first.lower == second.upper:
            return bound
    what = tuple(dict.fromkeys((*first.what, *second.what)))
    upper = max(first.upper, second.upper)
    return Bound(first.stretch, first.lower, upper, what, None, False)


def orbit_between(chain: Chain, segments: Sequence[Segment], before: Bound, after: Bound) -> tuple[Segment, arb] | None:
    """An orbit between two neighbouring places, by tau on its segment: the others are as it is (Lemma 18.4)."""
    for number in range(before.stretch, after.stretch + 1):
        stretch = chain.stretches[number]
        low = before.upper if number == before.stretch else stretch.entered
        high = after.lower if number == after.stretch else stretch.leaves
        if low < high:
            s = (low + high) / 2
            here = [part for part in segments if part.stretch == number and part.entered <= s <= part.end]
            return (here[0], enclose(here[0].tau(s))) if here else None
    return None


def is_stable(segment: Segment, tau: arb) -> bool | None:
    """Whether all eigenvalues of Sigma lie in (-1, 1) and differ; `None` if that is not known. For n <= 2."""
    if not segment.has_few_parameters:
        return None
    above, below = (segment.at(arb(c)).value(tau) for c in (1, -1))
    discriminant = segment.discriminant
    if discriminant is None:
        inside = [above, -below]
    else:
        trace = segment.characteristic[0].value(tau)
        inside = [above, below, 2 - trace, 2 + trace, discriminant.value(tau)]
    if all(is_positive(value) for value in inside):
        return True
    return False if any(is_positive(-value) for value in inside) else None
