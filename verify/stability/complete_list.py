"""All resonances up to an order on a proved curve, and what could not be covered (section 18.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import gcd
from typing import TYPE_CHECKING, Any

from flint import arb, fmpq

from orbitproof.shared.formats import Atlas
from orbitproof.verify.curve import Chain, Stretch
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
from orbitproof.verify.evidence import enclose, excludes_zero, sign
from orbitproof.verify.functions import BoundedFunction
from orbitproof.verify.stability.combinations import combination_functions
from orbitproof.verify.stability.extrema import extrema_on, is_in_band
from orbitproof.verify.stability.kinds import Kind, Matter, Resonance, Subject
from orbitproof.verify.stability.known_functions import point_over, segments_of
from orbitproof.verify.stability.level import Level
from orbitproof.verify.stability.linear_stability import is_stable
from orbitproof.verify.stability.list_entries import Combinations, CompleteList, Extremum, Gap, Point, Segment
from orbitproof.verify.stability.stored_stability import StabilityResult
from orbitproof.verify.stability.units import is_of_vertical_orbits
from orbitproof.verify.stability.zeros import Zero, between, ends_of, zeros_beside_double_one, zeros_on

if TYPE_CHECKING:
    from orbitproof.verify.curve import Bifurcation

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
    results: Sequence[StabilityResult],
    order: int,
    bifurcations: Sequence[Bifurcation] = (),
    combinations: bool = False,
    begun: Callable[[int], None] = lambda number: None,
) -> CompleteList:
    """All zeros of det(c - Sigma) on the curve for c = cos(2 pi j/k), k <= order, and of the discriminant.

    Args:
        results: of the pieces, with what `matrix` knows of them.
        order: the largest k; if it is 1, those with k = 2 are listed too.
        bifurcations: certified ones, and certified orbits, with their places on the curve.
        combinations: whether combination resonances are listed too, for n = 2.
        begun: called with the number of each stretch before it is looked at.

    Raises `EmptyIntersectionError` if a certified bifurcation on the curve is not in the list, or an orbit on it
    contradicts it.
    """
    # Stability changes at k = 1 and 2, whatever is asked for.
    order = max(order, 2)
    level = Level(atlas)
    points: list[Point] = []
    extrema: list[Extremum] = []
    gaps: list[Gap] = []
    open_extrema: list[Gap] = []
    segments: list[Segment] = []
    combined: list[Point] = []
    open_combinations: list[Gap] = []
    for number, stretch in enumerate(chain.stretches):
        begun(number)
        found, missing = segments_of(number, stretch, results)
        found, singular = level.regular(stretch, found)
        segments += found
        gaps += singular
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
            combiner = Finder(atlas, stretch, segment)
            if combinations:
                combiner.combinations()
            combined += combiner.points
            open_combinations += combiner.gaps
    listed, combined_points = (
        tuple(sorted(found, key=lambda entry: (entry.stretch, ends_of(entry.s)[0]))) for found in (points, combined)
    )
    gaps.sort(key=lambda gap: (gap.stretch, gap.start))
    turns = tuple(extrema)
    if bifurcations:
        from orbitproof.verify.stability.between_orbits import between_orbits
        from orbitproof.verify.stability.matching import about_the_list, with_certificates

        pieces = [stretch.tube.piece.id for stretch in chain.stretches]
        turns = between_orbits(extrema, [*gaps, *open_extrema], segments, pieces, bifurcations)
        own = about_the_list(atlas, bifurcations, order)
        listed = with_certificates(listed, gaps, own, is_of_vertical_orbits(atlas.system))
    size = len(chain.stretches[0].tube.piece.tube)
    return CompleteList(
        order,
        size,
        listed,
        tuple(gaps),
        tuple(segments),
        tuple(sorted(turns, key=lambda entry: (entry.stretch, ends_of(entry.s)[0]))),
        tuple(open_extrema),
        level.hypotheses,
        Combinations(combined_points, tuple(open_combinations)) if combinations and size == 2 else None,
    )


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
        for zero in self._zeros(function, at_end, Resonance(k, j)):
            self.points.append(self._point(k, j, self._kind(k, zero), zero.place))
        if at_end:
            self.points.append(self._point(k, j, Kind.SYMMETRIC, arb(0)))

    def add(self, function: BoundedFunction, k: int, j: int, kind: Kind, subject: Subject | None = None) -> None:
        """The zeros of a function of tau, as points of this kind; `subject` is what is open elsewhere."""
        for zero in self._zeros(function, 0, subject or Resonance(k, j)):
            self.points.append(self._point(k, j, kind, zero.place))

    def collisions(self) -> None:
        """The zeros of the discriminant, for n = 2."""
        function = self.segment.discriminant
        if function is not None:
            for zero in self._zeros(function, 0, Matter.COLLISION):
                self.points.append(self._point(0, 0, Kind.COLLISION, zero.place))

    def combinations(self) -> None:
        """The combination resonances up to order 4 of linearly stable orbits, for n = 2."""
        for kind, function in combination_functions(self.segment):
            for zero in self._zeros(function, 0, Matter.COMBINATIONS):
                stable = is_stable(self.segment, zero.place)
                if stable is None:
                    why = "whether the orbit is linearly stable there is not decided"
                    self._gap(zero.lower, zero.upper, Matter.COMBINATIONS, why)
                elif stable:
                    self.points.append(self._point(0, 0, kind, zero.place))

    def turns(self) -> None:
        """The extrema of the stability parameters close to the resonant values, for n <= 2."""
        segment = self.segment
        if not segment.has_few_parameters:
            return
        at_end = segment.meets_symmetric_point if self.stretch.tube.is_symmetric else 0
        found, undecided = extrema_on(segment, at_end)
        for tau, value in found:
            s = segment.s_of(tau)
            self.extrema.append(
                Extremum(
                    segment.stretch, self.stretch.tube.piece.id, value, is_in_band(value), s,
                    segment.level.value(tau), segment.half_period.value(tau),
                )
            )  # fmt: skip
        why = "extrema are neither excluded nor separated: bounds too wide"
        self.open_extrema += [self._place(low, high, Matter.EXTREMA, why) for low, high in undecided]

    def _zeros(self, function: BoundedFunction, at_end: int, subject: Subject) -> Sequence[Zero]:
        segment = self.segment
        start, entered, end = (segment.tau(s) for s in (segment.start, segment.entered, segment.end))
        if start < entered and not excludes_zero(function.value(between(start, entered))):
            self._gap(start, entered, subject, "a zero may lie at the joint of two pieces, and which side of it")
        if at_end:
            far = end if at_end < 0 else entered
            _, found = zeros_beside_double_one(function, far)
        else:
            found = zeros_on(function, entered, end)
        for low, high in found.undecided:
            self._gap(low, high, subject, "zeros are neither excluded nor separated: a double zero, or bounds too wide")
        return found.zeros

    def _gap(self, low: Fraction, high: Fraction, subject: Subject, reason: str) -> None:
        self.gaps.append(self._place(low, high, subject, reason))

    def _place(self, low: Fraction, high: Fraction, subject: Subject, reason: str) -> Gap:
        segment = self.segment
        start, end = (segment.middle + segment.radius * tau for tau in (low, high))
        return Gap(segment.stretch, self.stretch.tube.piece.id, start, end, subject, reason)

    def _kind(self, k: int, zero: Zero) -> Kind:
        if k > 2:
            return Kind.RESONANCE
        if k == 2:
            return _factor(self.segment.first_factor.value, zero, Kind.HERE, Kind.THERE)
        if self.atlas.system.normalised:
            # The level along the curve is a size there, no invariant of the flow.
            return Kind.IN_PLANE if self._is_birth(zero) else Kind.UNDECIDED
        return _factor(self.segment.level.slope, zero, Kind.FOLD, Kind.LOSS)

    def _is_birth(self, zero: Zero) -> bool:
        """Whether the one zero for k = 1 there is that at size 0, where axial orbits are born (Lemma 18.14)."""
        if not is_of_axial_orbits(self.atlas.system):
            return False
        span = self.segment.s_of(between(zero.lower, zero.upper))
        if not excludes_zero(self._coordinates(span)["vy"]):
            return False
        return [sign(self.segment.level.value(enclose(end))) for end in (zero.lower, zero.upper)] == [-1, 1]

    def _point(self, k: int, j: int, kind: Kind, tau: arb) -> Point:
        segment = self.segment
        s = segment.s_of(tau)
        return Point(
            segment.stretch, self.stretch.tube.piece.id, k, j, kind, s, segment.level.value(tau),
            segment.half_period.value(tau), self._coordinates(s),
        )  # fmt: skip

    def _coordinates(self, s: arb) -> dict[str, arb]:
        return dict(zip(self.atlas.system.centre_coordinates, point_over(self.stretch, s), strict=True))


def _factor(function: Any, zero: Zero, changes: Kind, keeps: Kind) -> Kind:
    """Which factor of the function vanishes at a simple zero: the one given, if it changes sign there (Lemma 18.3)."""
    if excludes_zero(function(between(zero.lower, zero.upper))):
        return keeps
    signs = [sign(function(enclose(end))) for end in (zero.lower, zero.upper)]
    if signs[0] * signs[1] == -1:
        return changes
    return keeps if excludes_zero(function(zero.place)) else Kind.UNDECIDED
