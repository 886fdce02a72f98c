"""Between which orbits of a curve the index is constant, and the orbits at which it is counted (section 35.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import ceil, log2

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import AROUND, CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, LIFTED, VERTICAL, ReversibleSystem
from orbitproof.verify.curve import ProvedCurve, Stretch, derived_parameter, is_planar, point_name, vertical_point
from orbitproof.verify.evidence import is_positive
from orbitproof.verify.index.following import Start
from orbitproof.verify.stability import Bound, Matter, Point, ProvedList, Resonance, Subject, bounds_on

PRECISION = 192
"""Bits of the ball arithmetic."""

SYSTEMS: tuple[ReversibleSystem, ...] = (
    *(CR3BP, CR3BP_AXIAL, CR3BP_PLANAR),
    *AROUND.values(),
    *VERTICAL.values(),
    LIFTED,
)
"""Whose orbits are orbits of the CR3BP."""

ACROSS_PLANE = replace(CR3BP_AXIAL, section=LIFTED.section)
"""The CR3BP under the half turn about the x axis, with half orbits from the plane of the primaries to it."""

_SHARES = tuple(Fraction(part, 16) for part in (8, 4, 12, 6, 10, 2, 14, 1, 15))
"""Where in an interval orbits are looked for, one after the other."""


@dataclass(frozen=True)
class Interval:
    """Between two places of the curve the index is constant.

    Attributes:
        begin, end: the two places, themselves not included.
    """

    begin: Bound
    end: Bound

    def holds(self, stretch: int, s: Fraction) -> bool:
        """Whether it certainly contains a point of a stretch."""
        return (self.begin.stretch, self.begin.upper) < (stretch, s) < (self.end.stretch, self.end.lower)


def intervals_of(curve: ProvedCurve, found: ProvedList) -> tuple[Interval, ...]:
    """The intervals on which no stability parameter is 1, in the plane or across it (Lemma 35.4)."""
    whole = found.found
    if found.across is not None:
        across = found.across.found
        whole = replace(whole, points=(*whole.points, *across.points), gaps=(*whole.gaps, *across.gaps))
    with ctx.workprec(PRECISION):
        bounds = list(bounds_on(curve.chain, whole, _is_degenerate, _may_be_degenerate))
    return tuple(Interval(before, after) for before, after in pairwise(bounds))


def intervals_with_orbits(atlas: Atlas, curve: ProvedCurve, found: ProvedList) -> tuple[Interval, ...]:
    """The intervals whose points are orbits of the CR3BP: of axial ones where eps2 > 0 (section 35.4)."""
    intervals = intervals_of(curve, found)
    if atlas.system is not LIFTED:
        return intervals
    size = LIFTED.centre_coordinates.index("eps2")
    ends = [(curve.chain.stretches[each.end.stretch], each.end.lower) for each in intervals]
    positive = [is_positive(stretch.tube.point(stretch.run, s)[size]) for stretch, s in ends]
    return tuple(each for each, is_off_plane in zip(intervals, positive, strict=True) if is_off_plane)


def _is_degenerate(point: Point) -> bool:
    return point.k == 1


def _may_be_degenerate(subject: Subject) -> bool:
    return subject.k == 1 if isinstance(subject, Resonance) else subject is Matter.EVERYTHING


def places_in(curve: ProvedCurve, interval: Interval | None) -> list[tuple[int, Fraction]]:
    """Orbits inside an interval, or of the whole curve, by stretch and s; the first one is the first to be tried."""
    parts = []
    for number, stretch in enumerate(curve.chain.stretches):
        low, high = stretch.entered, stretch.leaves
        if interval is not None:
            if not interval.begin.stretch <= number <= interval.end.stretch:
                continue
            low = interval.begin.upper if number == interval.begin.stretch else low
            high = interval.end.lower if number == interval.end.stretch else high
        if low < high:
            parts.append((number, low, high))
    parts.sort(key=lambda part: part[1] - part[2])
    # Where all orbits of some pieces come too close to a primary, others are tried, in an interval far from each other.
    wide = parts if interval is None else parts[:: max(1, len(parts) // 3)][:3]
    return [(number, _few_bits(low, high, share)) for share in _SHARES for number, low, high in wide]


def _few_bits(low: Fraction, high: Fraction, share: Fraction) -> Fraction:
    """A number near a part of the way."""
    bits = 8 + max(0, ceil(-log2(high - low)))
    return round_dyadic(low + share * (high - low), bits)


def start_at(atlas: Atlas, stretch: Stretch, s: Fraction) -> Start | None:
    """The orbit at s as one of the CR3BP; `None` if none is shown to be there, as at a libration point."""
    with ctx.workprec(PRECISION):
        names = atlas.system.centre_coordinates
        point = dict(zip(names, stretch.tube.point(stretch.run, s), strict=True))
        return _start(atlas, point)


def _start(atlas: Atlas, point: Mapping[str, arb]) -> Start | None:
    system, mu, crossings = atlas.system, atlas.parameters["mu"], atlas.claim.crossings
    zero = arb(0)
    if system is LIFTED:
        # By Theorem 16.10 its half ends in Fix(R), where it meets the plane first.
        size = point["eps2"]
        if not is_positive(size):
            return None
        return Start(ACROSS_PLANE, (point["x"], zero, zero, zero, point["vy"], size.sqrt()), mu, crossings, False)
    if point_name(system) is None and vertical_point(system) is None:
        spatial = CR3BP if system is CR3BP_PLANAR else system
        state = tuple(point.get(name, zero) for name in spatial.state)
        return Start(spatial, state, mu, crossings, is_planar(system))
    x_l = derived_parameter(system, "x_l", atlas.parameters, ctx.prec).ball
    if point_name(system) is not None:
        eps = point["eps"]
        if not (is_positive(eps) or is_positive(-eps)):
            return None
        return Start(CR3BP, (x_l + eps, zero, zero, zero, eps * point["vy"], zero), mu, crossings, True)
    size = point["eps2"]
    if not is_positive(size):
        return None
    # By Theorem 16.6 its quarter ends in Fix(R): the half orbit meets the section twice as often.
    state = (x_l + size * point["x"], zero, zero, zero, size * point["vy"], size.sqrt())
    return Start(CR3BP_AXIAL, state, mu, 2 * crossings, False)


def stretch_of(curve: ProvedCurve, piece: str, s: Fraction) -> int | None:
    """The number of the stretch that a place is certainly on; `None` if there is none."""
    for number, stretch in enumerate(curve.chain.stretches):
        if stretch.tube.piece.id == piece and stretch.entered <= s <= stretch.leaves:
            return number
    return None
