"""The theorem about the index along a curve (section 35.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb, ctx

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import shown
from orbitproof.shared.wording import counted
from orbitproof.verify.curve import ProvedCurve, is_planar
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    enclose,
    is_positive,
    sign,
)
from orbitproof.verify.index.along_curve import (
    PRECISION,
    Interval,
    intervals_with_orbits,
    start_at,
    stretch_of,
)
from orbitproof.verify.index.half_turns import HalfTurns, follow_from
from orbitproof.verify.index.libration_value import index_of_small_orbits, reaches_rest
from orbitproof.verify.stability import Bound, Kind, ProvedList, Segment


@dataclass(frozen=True)
class CountedOrbit:
    """An orbit of the curve, and the half turns that were counted along it (sections 35.2 and 35.3).

    Attributes:
        piece, s: its place.
        turns: of a planar orbit in the plane and across it.
    """

    piece: str
    s: Fraction
    turns: tuple[HalfTurns, ...]

    @property
    def index(self) -> int:
        """The Conley-Zehnder index, of a planar orbit the sum of both."""
        return sum(turns.index for turns in self.turns)


@dataclass(frozen=True)
class IndexTheorem:
    """The index of the orbits of a proved curve (Theorem 35.7).

    Attributes:
        atlas: the claim about the curve.
        with_list: whether it is proved with its list, so that the index is known between its points.
    """

    atlas: Atlas
    with_list: bool

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        listed = ("parity", "neighbours") if self.with_list else ()
        return ("curve", "counts", *listed, *(("libration-point",) if reaches_rest(self.atlas) else ()))


@dataclass(frozen=True)
class ProvedIndex:
    """What is proved of the index along a curve.

    Attributes:
        orbits: at which it was counted, in order along the curve.
        intervals: with the orbits in their places, the intervals that these are in; none without a list.
        small: the index of small orbits of a curve that reaches a libration point; nothing for others.
    """

    orbits: tuple[CountedOrbit, ...]
    intervals: tuple[Interval, ...]
    small: tuple[int, ...]


def conclude_index(
    atlas: Atlas, curve: ProvedCurve | None, found: ProvedList | None, orbits: Sequence[CountedOrbit], problem: str = ""
) -> Outcome[ProvedIndex]:
    """The theorem about the index along a curve, or the first hypothesis that is not shown.

    Args:
        curve: what is proved of it; `None` if that is nothing.
        found: its list, if it has one.
        orbits: at which the index was counted: one in each interval, in their order; without a list, any of the curve.
        problem: why there is no proved curve, or no such orbit.
    """
    checklist, theorem = Checklist(), IndexTheorem(atlas, found is not None)
    with ctx.workprec(PRECISION):
        try:
            curve = _check_curve(checklist, curve, problem)
            intervals = () if found is None else intervals_with_orbits(atlas, curve, found)
            _check_counts(checklist, atlas, curve, found, intervals, orbits, problem)
            if found is not None:
                _check_parity(checklist, curve, found, orbits)
                _check_neighbours(checklist, found, intervals, orbits)
            small: tuple[int, ...] = ()
            if "libration-point" in theorem.hypotheses:
                small = _check_libration_point(checklist, atlas, curve, intervals, orbits)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
    return Proved(theorem, ProvedIndex(tuple(orbits), intervals, small), tuple(checklist.hypotheses))


def _check_curve(checklist: Checklist, curve: ProvedCurve | None, problem: str) -> ProvedCurve:
    statement = "the curve is a proved one of symmetric periodic orbits of the CR3BP"
    with checklist.hypothesis("curve", "35.4", statement, "prove the curve first") as evidence:
        evidence.require(curve is not None, problem or "it is not proved")
    assert curve is not None
    return curve


def _check_counts(
    checklist: Checklist,
    atlas: Atlas,
    curve: ProvedCurve,
    found: ProvedList | None,
    intervals: Sequence[Interval],
    orbits: Sequence[CountedOrbit],
    problem: str,
) -> None:
    statement = "the half turns are counted along an orbit of the curve" + (
        "" if found is None else " in each of the intervals on which no stability parameter is 1"
    )
    with checklist.hypothesis("counts", "35.3", statement, "give more precision, or another orbit") as evidence:
        evidence.require(bool(orbits) and not problem, problem or "there are none")
        if found is not None:
            evidence.require(len(orbits) == len(intervals), f"of {len(intervals)} intervals {len(orbits)} have one")
            known = not is_planar(atlas.system) or found.across is not None
            evidence.require(known, "variations out of the plane have no list")
        kinds = (1, 1) if is_planar(atlas.system) else (2,)
        for number, orbit in enumerate(orbits):
            where = f"{shown(orbit.piece)}, s = {float(orbit.s):.6g}"
            stretch = stretch_of(curve, orbit.piece, orbit.s)
            if stretch is None or start_at(atlas, curve.chain.stretches[stretch], orbit.s) is None:
                evidence.require(False, f"{where}: is no orbit of the curve that can be followed")
                continue
            if found is not None and number < len(intervals):
                evidence.require(intervals[number].holds(stretch, orbit.s), f"{where}: is not in its interval")
            planes = tuple(turns.planes for turns in orbit.turns)
            evidence.require(planes == kinds, f"{where}: {planes} dimensions are not {kinds}")
            for block, turns in zip(_blocks(orbit), orbit.turns, strict=True):
                for name, number_of, angle in zip(
                    ("fixes", "negates"), (turns.fixed, turns.negated), turns.angles, strict=True
                ):
                    between = evidence.record(f"{where}{block}: angle of what R {name}", angle)
                    inside = follow_from(number_of, turns.planes, between)
                    evidence.require(inside, f"{where}: {counted(number_of, 'half turn')} are not those of the angle")


def _blocks(orbit: CountedOrbit) -> tuple[str, ...]:
    """What the half turns of an orbit are about, in words."""
    return (", in the plane", ", across it") if len(orbit.turns) > 1 else ("",)


def _segment(found: Sequence[Segment], stretch: int, s: Fraction) -> Segment | None:
    return next((each for each in found if each.stretch == stretch and each.entered <= s <= each.end), None)


def _check_parity(checklist: Checklist, curve: ProvedCurve, found: ProvedList, orbits: Sequence[CountedOrbit]) -> None:
    statement = "index and dimension differ by an even number where det(1 - Sigma) > 0, else by an odd one"
    lists = [found.found.segments, *([] if found.across is None else [found.across.found.segments])]
    with checklist.hypothesis("parity", "35.4", statement, "report this") as evidence:
        for orbit in orbits:
            where = f"{shown(orbit.piece)}, s = {float(orbit.s):.6g}"
            number = stretch_of(curve, orbit.piece, orbit.s)
            for segments, block, turns in zip(lists, _blocks(orbit), orbit.turns, strict=True):
                segment = None if number is None else _segment(segments, number, orbit.s)
                evidence.require(segment is not None, f"{where}: nothing is known of its stability")
                if segment is not None:
                    value = segment.at(arb(1)).value(enclose(segment.tau(orbit.s)))
                    evidence.record(f"{where}{block}: det(1 - Sigma)", value)
                    wanted = -1 if (turns.index - turns.planes) % 2 else 1
                    evidence.require(sign(value) != 0, f"{where}: the sign of det(1 - Sigma) is not known")
                    evidence.require(sign(value) == wanted, f"{where}: the index {turns.index} has not its parity")


def _check_neighbours(
    checklist: Checklist, found: ProvedList, intervals: Sequence[Interval], orbits: Sequence[CountedOrbit]
) -> None:
    statement = "the index changes by one where one stability parameter passes 1, in the plane or across it"
    with checklist.hypothesis("neighbours", "35.4", statement, "report this") as evidence:
        evidence.require(True, "")
        for (before, first), (after, second) in pairwise(zip(intervals, orbits, strict=True)):
            assert before.end is after.begin
            wanted = _changes(before.end, found, len(first.turns))
            if wanted is not None:
                by = tuple(abs(b.index - a.index) for a, b in zip(first.turns, second.turns, strict=True))
                where = f"{shown(first.piece)} to {shown(second.piece)}"
                evidence.require(by == wanted, f"{where}: it changes by {by} in place of {wanted}")


def _changes(bound: Bound, found: ProvedList, blocks: int) -> tuple[int, ...] | None:
    """By how much each index changes at a point of the list, up to the sign; `None` if that is not known."""
    if bound.point is None or not bound.is_one_point or bound.point.kind is Kind.SYMMETRIC:
        return None
    across = () if found.across is None else found.across.found.points
    is_across = any(point is bound.point for point in across)
    return (1,) if blocks == 1 else (0, 1) if is_across else (1, 0)


def _check_libration_point(
    checklist: Checklist,
    atlas: Atlas,
    curve: ProvedCurve,
    intervals: Sequence[Interval],
    orbits: Sequence[CountedOrbit],
) -> tuple[int, ...]:
    statement = (
        "the index of small orbits follows from the frequencies at the libration point, and is that counted there"
    )
    with checklist.hypothesis("libration-point", "35.5", statement, "report this") as evidence:
        small = index_of_small_orbits(evidence, atlas.system, atlas.parameters)
        for interval, orbit in zip(intervals, orbits, strict=False):
            if _holds_rest(atlas, curve, interval):
                found = tuple(turns.index for turns in orbit.turns)
                evidence.require(found == small, f"{found} was counted in place of {small}")
    return small


def _holds_rest(atlas: Atlas, curve: ProvedCurve, interval: Interval) -> bool:
    """Whether the interval certainly contains the point of the curve at which the size of the orbits is 0."""
    place = list(atlas.system.centre_coordinates).index("eps")
    stretches = curve.chain.stretches
    low, high = (
        stretches[number].tube.point(stretches[number].run, s)[place]
        for number, s in (
            (interval.begin.stretch, interval.begin.upper),
            (interval.end.stretch, interval.end.lower),
        )
    )
    return "eps" in atlas.claim.increasing and is_positive(-low) and is_positive(high)
