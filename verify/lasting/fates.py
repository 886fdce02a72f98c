"""Which orbits of a curve are stable for ever, which are unstable, and which exceptions there are (section 29.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum, unique
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve import Chain, Stretch
from orbitproof.verify.evidence import sign
from orbitproof.verify.functions import REACH, BoundedFunction
from orbitproof.verify.lasting.odd import odd_coordinate
from orbitproof.verify.lasting.stored import CurveIntervalResult, TwistFunctions
from orbitproof.verify.stability import (
    CompleteList,
    Finder,
    Gap,
    Kind,
    Matter,
    Point,
    Resonance,
    Rule,
    Segment,
    StableInterval,
    Subject,
    ends_of,
    intervals_where,
    is_stable,
    orbit_between,
    stable_intervals,
)

LEAST_ORDER = 4
"""Resonances up to this order of the list are exceptions."""
_NOT_KNOWN = "the twist of the orbits was not enclosed there"
_BESIDE = "the twist may vanish next to a resonance"


@unique
class Fate(Enum):
    """What is shown of an exception, on its own."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    OPEN = "open"


@dataclass(frozen=True)
class ExceptionalOrbit:
    """An orbit at which the twist decides nothing: a resonance of order 1 to 4, or one without twist."""

    point: Point
    fate: Fate


@dataclass(frozen=True)
class LastingInterval:
    """Between two places of the curve all orbits are stable for ever.

    Attributes:
        between: the two places.
        sign: of the twist.
    """

    between: StableInterval
    sign: int


@dataclass(frozen=True)
class LastingList:
    """What is shown of the stability for ever of the orbits of a curve.

    Attributes:
        exceptions: in order along the curve.
        stable: intervals of orbits that are stable for ever.
        undecided: intervals of which that is not known.
        gaps: where the twist is not decided; those of the list of resonances are not repeated.
    """

    exceptions: tuple[ExceptionalOrbit, ...]
    stable: tuple[LastingInterval, ...]
    undecided: tuple[StableInterval, ...]
    gaps: tuple[Gap, ...]


@dataclass(frozen=True)
class _Twist:
    """The functions of section 29.3 on a segment: Theta in both forms, or Theta_0 of odd maps, and Delta."""

    functions: tuple[BoundedFunction, BoundedFunction]
    fourth: BoundedFunction
    odd: bool

    def sign(self, tau: arb) -> int:
        """The sign of Theta at all points of a ball; 0 if it is not known."""
        return next((found for found in (sign(each.value(tau)) for each in self.functions) if found), 0)

    def factor(self, segment: Segment, tau: arb) -> int:
        """The sign of 1 + 2 c_1, if the functions differ from the twist by it; 0 if it is not known."""
        return 1 if self.odd else sign(1 + 2 * segment.characteristic[0].value(tau))


def lasting_list(
    atlas: Atlas,
    chain: Chain,
    found: CompleteList,
    results: Sequence[CurveIntervalResult],
    begun: Callable[[int], None] = lambda number: None,
) -> LastingList:
    """The list for a curve with n = 1.

    Args:
        found: its resonances, of order 4 at least.
        results: of the pieces, with what is known of the twist.
        begun: called with the number of a stretch before a part of it is looked at.
    """
    # Functions of odd maps count only where a symmetry is shown to fix the orbits (29.7).
    fixed = {piece.id for piece in atlas.curve_pieces() if odd_coordinate(atlas.system, piece) is not None}
    results = [each for each in results if not _is_odd(each) or each.piece in fixed]
    points: list[Point] = []
    gaps: list[Gap] = []
    for part in _elliptic(chain, found):
        begun(part.stretch)
        stretch = chain.stretches[part.stretch]
        twist = _twist_on(part, stretch, results)
        if twist is None:
            gaps.append(_gap(part, stretch, part.start, part.end, _NOT_KNOWN))
            continue
        first = Finder(atlas, stretch, part)
        first.add(twist.functions[0], 0, 0, Kind.TWISTLESS, Matter.TWIST)
        finders = [first]
        for gap in first.gaps:
            entered = min(max(gap.start, part.entered), gap.end)
            second = Finder(atlas, stretch, replace(part, start=gap.start, entered=entered, end=gap.end))
            second.add(twist.functions[1], 0, 0, Kind.TWISTLESS, Matter.TWIST)
            finders.append(second)
            gaps += second.gaps
        for point in (point for finder in finders for point in finder.points):
            tau = part.tau_of(point.s)
            # Where 1 + 2 c_1 may be 0 a zero of Theta may be that factor's.
            if is_stable(part, tau) and twist.factor(part, tau):
                points.append(point)
            else:
                gaps.append(_gap(part, stretch, *ends_of(point.s), _BESIDE))
    points.sort(key=_place)
    gaps.sort(key=lambda gap: (gap.stretch, gap.start))
    whole = replace(found, points=(*found.points, *points), gaps=(*found.gaps, *gaps))

    def sign_at(segment: Segment, tau: arb) -> int:
        twist = _twist_on(segment, chain.stretches[segment.stretch], results)
        return 0 if twist is None else twist.factor(segment, tau) * twist.sign(tau)

    def lasts(segment: Segment, tau: arb) -> bool | None:
        stable = is_stable(segment, tau)
        return None if stable and not sign_at(segment, tau) else stable

    rule = Rule(lambda point: point.k <= LEAST_ORDER, _may_end, lasts)
    signs = {}
    for entry in intervals_where(chain, whole, False, rule)[0]:
        orbit = orbit_between(chain, found.segments, entry.begin, entry.end)
        assert orbit is not None
        signs[entry.end.stretch, entry.end.lower] = sign_at(*orbit)
    stable, undecided = intervals_where(chain, whole, atlas.claim.goes_round, rule)
    listed = sorted((point for point in whole.points if rule.ends_at(point)), key=_place)
    return LastingList(
        tuple(ExceptionalOrbit(point, _fate(chain, found, results, point)) for point in listed),
        tuple(LastingInterval(entry, signs[entry.end.stretch, entry.end.lower]) for entry in stable),
        tuple(undecided),
        tuple(gaps),
    )


def _is_odd(result: CurveIntervalResult) -> bool:
    return isinstance(result.twist, TwistFunctions) and result.twist.odd


def _place(point: Point) -> tuple[int, Fraction]:
    return point.stretch, ends_of(point.s)[0]


def _gap(part: Segment, stretch: Stretch, start: Fraction, end: Fraction, reason: str) -> Gap:
    return Gap(part.stretch, stretch.tube.piece.id, start, end, Matter.TWIST, reason)


def _may_end(subject: Subject) -> bool:
    """Whether stability for ever may change where this is open."""
    if isinstance(subject, Resonance):
        return subject.k <= LEAST_ORDER
    return subject not in (Matter.EXTREMA, Matter.COMBINATIONS)


def _elliptic(chain: Chain, found: CompleteList) -> list[Segment]:
    """The parts of segments that contain all orbits between two bounds that may be linearly stable, each once."""
    ranges: list[tuple[tuple[int, Fraction], tuple[int, Fraction]]] = []
    stable, unknown = stable_intervals(chain, found, False)
    entries = [*stable, *(entry for entry in unknown if entry.begin != entry.end)]
    for entry in sorted(entries, key=lambda entry: (entry.begin.stretch, entry.begin.lower)):
        first, last = (entry.begin.stretch, entry.begin.lower), (entry.end.stretch, entry.end.upper)
        if ranges and first <= ranges[-1][1]:
            first = ranges.pop()[0]
        ranges.append((first, last))
    parts = []
    for first, last in ranges:
        for segment in found.segments:
            start = max(first, (segment.stretch, segment.start))
            end = min(last, (segment.stretch, segment.end))
            if start < end:
                low, high = start[1], end[1]
                parts.append(replace(segment, start=low, entered=min(max(low, segment.entered), high), end=high))
    return parts


def _twist_on(segment: Segment, stretch: Stretch, results: Sequence[CurveIntervalResult]) -> _Twist | None:
    """The functions on the interval of a segment, if they are known; of several results those with the most bits."""
    for result in sorted(results, key=lambda result: -(result.computation.precision or 0)):
        low, high = result.interval
        if (
            result.piece != stretch.tube.piece.id
            or not result.is_proved
            or not isinstance(result.twist, TwistFunctions)
        ):
            continue
        if segment.radius != (high - low) / 2 * REACH:
            continue
        twist = result.twist
        functions = [each.enclosed for each in (twist.twist, twist.exchanged, twist.fourth)]
        if segment.middle == (low + high) / 2:
            return _Twist((functions[0], functions[1]), functions[2], twist.odd)
        if stretch.tube.is_symmetric and segment.middle == -(low + high) / 2:
            mirrored = [each.mirrored() for each in functions]
            return _Twist((mirrored[0], mirrored[1]), mirrored[2], twist.odd)
    return None


def _fate(chain: Chain, found: CompleteList, results: Sequence[CurveIntervalResult], point: Point) -> Fate:
    """What is shown of a resonance of order 3 or 4 (Lemmas 29.6 to 29.8 and 29.11)."""
    if point.k not in (3, 4):
        return Fate.OPEN
    low, high = ends_of(point.s)
    for segment in found.segments:
        if segment.stretch == point.stretch and segment.start <= low and high <= segment.end:
            twist = _twist_on(segment, chain.stretches[segment.stretch], results)
            tau = segment.tau_of(point.s)
            if twist is None:
                return Fate.OPEN
            if point.k == 3:
                if not twist.sign(tau):
                    return Fate.OPEN
                return Fate.STABLE if twist.odd else Fate.UNSTABLE
            return {1: Fate.UNSTABLE, -1: Fate.STABLE, 0: Fate.OPEN}[sign(twist.fourth.value(tau))]
    return Fate.OPEN
