"""All resonances up to an order on a proved curve, and what could not be covered (section 18.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import Any

from flint import arb, fmpq

from orbitproof.shared.formats import Atlas, Piece
from orbitproof.shared.numbers import parse_exact
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Bifurcation, Chain, Stretch
from orbitproof.verify.evidence import dot, enclose, excludes_zero, sign, symmetric
from orbitproof.verify.stability.between_orbits import between_orbits
from orbitproof.verify.stability.extrema import extrema_on
from orbitproof.verify.stability.functions import REACH, BoundedFunction, function_from_json
from orbitproof.verify.stability.matching import about_the_list, with_certificates
from orbitproof.verify.stability.out_of_plane import variations_from_json
from orbitproof.verify.stability.places import (
    COLLISION,
    EXTREMUM,
    FOLD,
    HERE,
    LOSS,
    RESONANCE,
    SYMMETRIC,
    THERE,
    UNKNOWN,
    CompleteList,
    Extremum,
    Gap,
    Point,
    Segment,
)
from orbitproof.verify.stability.ranges import distances_from_json
from orbitproof.verify.stability.zeros import Zero, between, ends_of, zeros_beside_double_one, zeros_on

PRECISION = 192
"""Bits of the ball arithmetic."""


def orders(order: int) -> list[tuple[int, int]]:
    """All (k, j) with k <= order, gcd(j, k) = 1 and 0 <= 2 j <= k: the values cos(2 pi j/k), each once."""
    pairs = [(k, j) for k in range(1, order + 1) for j in range(k // 2 + 1)]
    return [(k, j) for k, j in pairs if gcd(j, k) == 1]


def resonant_value(k: int, j: int) -> arb:
    """cos(2 pi j/k), exactly where it is 0 or an integer."""
    return arb.cos_pi_fmpq(fmpq(2 * j, k))


def complete_list(
    atlas: Atlas,
    chain: Chain,
    results: Sequence[Mapping[str, Any]],
    order: int,
    bifurcations: Sequence[Bifurcation] = (),
) -> CompleteList:
    """All zeros of det(c - Sigma) on the curve for c = cos(2 pi j/k), k <= order, and of the discriminant.

    Args:
        results: of the pieces, as JSON, with what `matrix` knows of them.
        bifurcations: certified ones, and certified orbits, with their places on the curve.

    Raises `EmptyIntersectionError` if a certified bifurcation on the curve is not in the list, or an orbit on it
    contradicts it.
    """
    points: list[Point] = []
    extrema: list[Extremum] = []
    gaps: list[Gap] = []
    open_extrema: list[Gap] = []
    segments: list[Segment] = []
    for number, stretch in enumerate(chain.stretches):
        found, missing = segments_of(number, stretch, results)
        segments += found
        gaps += missing
        for segment in found:
            finder = Finder(atlas, stretch, segment)
            for k, j in orders(order):
                finder.resonances(k, j)
            finder.collisions()
            finder.turns()
            points += finder.points
            extrema += finder.extrema
            gaps += finder.gaps
            open_extrema += finder.open_extrema
    listed = tuple(sorted(points, key=lambda entry: (entry.stretch, ends_of(entry.s)[0])))
    gaps.sort(key=lambda gap: (gap.stretch, gap.start))
    pieces = [stretch.tube.piece.id for stretch in chain.stretches]
    turns = between_orbits(extrema, [*gaps, *open_extrema], segments, pieces, bifurcations)
    return CompleteList(
        order,
        with_certificates(listed, gaps, about_the_list(atlas, bifurcations, order)),
        tuple(gaps),
        tuple(segments),
        tuple(sorted(turns, key=lambda entry: (entry.stretch, ends_of(entry.s)[0]))),
        tuple(open_extrema),
    )


@dataclass(frozen=True)
class _Known:
    """What a result knows on an interval; of two of them that with the smaller rank, the narrower one, is taken."""

    low: Fraction
    high: Fraction
    entry: Mapping[str, Any]
    mirrored: bool
    rank: tuple[Fraction, int]


def segments_of(number: int, stretch: Stretch, results: Sequence[Mapping[str, Any]]) -> tuple[list[Segment], list[Gap]]:
    """The parts of a stretch on which functions are known, from its beginning to its end, and the rest."""
    piece = stretch.tube.piece
    known: list[_Known] = []
    reasons: list[tuple[Fraction, Fraction, str]] = []
    for result in results:
        if result.get("piece") != piece.id or result.get("verdict") != "proved":
            continue
        start, end = (parse_exact(text) for text in result["interval"])
        entry = result.get("stability", {"reason": {"message": "the stability of its orbits was not looked at"}})
        for low, high, mirrored in ((start, end, False), (-end, -start, True)):
            if mirrored and not stretch.tube.is_symmetric:
                continue
            if "reason" in entry:
                reasons.append((low, high, str(entry["reason"]["message"])))
            elif _is_proved(stretch, low, high):
                digits = int(result.get("computation", {}).get("precision", 0))
                known.append(_Known(low, high, entry, mirrored, (high - low, -digits)))
    segments: list[Segment] = []
    gaps: list[Gap] = []
    reached = stretch.enters
    while reached < stretch.leaves:
        here = [item for item in known if item.low <= reached < item.high]
        later = [item for item in known if item.low > reached]
        if not here:
            end = min([item.low for item in later] + [stretch.leaves])
            why = next((text for low, high, text in reasons if low <= reached <= high), "nothing is known there")
            gaps.append(Gap(number, piece.id, reached, end, "everything", why))
        else:
            best = min(here, key=lambda item: item.rank)
            end = min([best.high, stretch.leaves] + [item.low for item in later if item.rank < best.rank])
            entered = min(max(reached, stretch.entered), end)
            segments.append(
                segment_of(number, (reached, entered, end), (best.low, best.high), best.entry, best.mirrored)
            )
        reached = end
    return segments, gaps


def _is_proved(stretch: Stretch, low: Fraction, high: Fraction) -> bool:
    """Whether the interval is one of those that the curve's proof counts."""
    return any((part.start, part.end) == (low, high) for part in stretch.run.intervals)


def segment_of(
    number: int,
    places: tuple[Fraction, Fraction, Fraction],
    interval: tuple[Fraction, Fraction],
    entry: Mapping[str, Any],
    mirrored: bool,
) -> Segment:
    """A part of the curve with what a result on an interval of its piece knows.

    Args:
        places: where it begins, is surely entered, and ends.
        entry: the stored functions.
        mirrored: whether they are those of -s.
    """
    low, high = interval
    names = ("level", "half_period", "first_factor")
    functions = [function_from_json(part) for part in (*entry["characteristic"], *(entry[name] for name in names))]
    if mirrored:
        functions = [function.mirrored() for function in functions]
    *characteristic, level, half_period, first_factor = functions
    distances = distances_from_json(entry.get("distance"))
    across = variations_from_json(entry.get("out_of_plane"))
    if mirrored:
        distances = None if distances is None else distances.mirrored()
        across = None if across is None else across.mirrored()
    return Segment(
        number, *places, (low + high) / 2, (high - low) / 2 * REACH, tuple(characteristic), level, half_period,
        first_factor, distances, across,
    )  # fmt: skip


class Finder:
    """The zeros of the functions of one segment."""

    def __init__(self, atlas: Atlas, stretch: Stretch, segment: Segment) -> None:
        self.atlas = atlas
        self.stretch = stretch
        self.segment = segment
        self.points: list[Point] = []
        self.gaps: list[Gap] = []
        self.extrema: list[Extremum] = []
        self.open_extrema: list[Gap] = []

    def resonances(self, k: int, j: int) -> None:
        """The zeros of det(cos(2 pi j/k) - Sigma)."""
        function = self.segment.at(resonant_value(k, j))
        at_end = self.segment.meets_symmetric_point if self.stretch.tube.is_symmetric and k == 1 else 0
        for zero in self._zeros(function, at_end, f"k = {k}, j = {j}"):
            self.points.append(self._point(k, j, self._kind(k, zero), zero.place))
        if at_end:
            self.points.append(self._point(k, j, SYMMETRIC, arb(0)))

    def add(self, function: BoundedFunction, k: int, j: int, kind: str) -> None:
        """The zeros of a function of tau, as points of this kind."""
        for zero in self._zeros(function, 0, f"k = {k}, j = {j}"):
            self.points.append(self._point(k, j, kind, zero.place))

    def collisions(self) -> None:
        """The zeros of the discriminant."""
        function = self.segment.discriminant
        if function is not None:
            for zero in self._zeros(function, 0, COLLISION):
                self.points.append(self._point(0, 0, COLLISION, zero.place))

    def turns(self) -> None:
        """The extrema of the stability parameters close to the resonant values."""
        segment = self.segment
        at_end = segment.meets_symmetric_point if self.stretch.tube.is_symmetric else 0
        found, undecided = extrema_on(segment, at_end)
        for tau, value in found:
            s = segment.s_of(tau)
            self.extrema.append(
                Extremum(
                    segment.stretch, self.stretch.tube.piece.id, value, s, segment.level.value(tau),
                    segment.half_period.value(tau),
                )
            )  # fmt: skip
        why = "extrema are neither excluded nor separated: bounds too wide"
        self.open_extrema += [self._place(low, high, EXTREMUM, why) for low, high in undecided]

    def _zeros(self, function: BoundedFunction, at_end: int, about: str) -> Sequence[Zero]:
        segment = self.segment
        start, entered, end = (segment.tau(s) for s in (segment.start, segment.entered, segment.end))
        if start < entered and not excludes_zero(function.value(between(start, entered))):
            self._gap(start, entered, about, "a zero may lie at the joint of two pieces, and which side of it")
        if at_end:
            far = end if at_end < 0 else entered
            _, found = zeros_beside_double_one(function, far)
        else:
            found = zeros_on(function, entered, end)
        for low, high in found.undecided:
            self._gap(low, high, about, "zeros are neither excluded nor separated: a double zero, or bounds too wide")
        return found.zeros

    def _gap(self, low: Fraction, high: Fraction, about: str, reason: str) -> None:
        self.gaps.append(self._place(low, high, about, reason))

    def _place(self, low: Fraction, high: Fraction, about: str, reason: str) -> Gap:
        segment = self.segment
        start, end = (segment.middle + segment.radius * tau for tau in (low, high))
        return Gap(segment.stretch, self.stretch.tube.piece.id, start, end, about, reason)

    def _kind(self, k: int, zero: Zero) -> str:
        if k > 2:
            return RESONANCE
        if k == 2:
            return _factor(self.segment.first_factor.value, zero, HERE, THERE)
        if self.atlas.system.normalised:
            # The level along the curve is a size there, no invariant of the flow.
            return UNKNOWN
        return _factor(self.segment.level.slope, zero, FOLD, LOSS)

    def _point(self, k: int, j: int, kind: str, tau: arb) -> Point:
        segment = self.segment
        s = segment.s_of(tau)
        return Point(
            segment.stretch, self.stretch.tube.piece.id, k, j, kind, s, segment.level.value(tau),
            segment.half_period.value(tau), self._coordinates(s),
        )  # fmt: skip

    def _coordinates(self, s: arb) -> dict[str, arb]:
        return dict(zip(self.atlas.system.centre_coordinates, _point_over(self.stretch, s), strict=True))


def _factor(function: Any, zero: Zero, changes: str, keeps: str) -> str:
    """Which factor of the function vanishes at a simple zero: the one given, if it changes sign there (Lemma 18.3)."""
    if excludes_zero(function(between(zero.lower, zero.upper))):
        return keeps
    signs = [sign(function(enclose(end))) for end in (zero.lower, zero.upper)]
    if signs[0] * signs[1] == -1:
        return changes
    return keeps if excludes_zero(function(zero.place)) else UNKNOWN


def _point_over(stretch: Stretch, s: arb) -> list[arb]:
    """Enclosures of the coordinates of the curve over a ball of s in a stretch."""
    piece: Piece = stretch.tube.piece
    low, high = ends_of(s)
    parts = stretch.run.between(max(low, stretch.enters), min(high, stretch.leaves))
    spreads = [max(part.deviation[j] for part, _, _ in parts) for j in range(len(piece.tube))]
    p = [enclose(piece.half_width) * s]
    for row, spread in zip(piece.polynomial, spreads, strict=True):
        p.append(ball_polynomial(row)(s) + symmetric(spread))
    return [
        enclose(origin) + dot([enclose(value) for value in row], p)
        for origin, row in zip(piece.centre, piece.frame, strict=True)
    ]
