"""The parts of a curve, and the functions that are known on each of them (section 18.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Piece
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Stretch
from orbitproof.verify.distances import DistanceFunctions, known_distances
from orbitproof.verify.evidence import dot, enclose, symmetric
from orbitproof.verify.functions import REACH
from orbitproof.verify.out_of_plane import VariationFunctions
from orbitproof.verify.stability.kinds import Matter
from orbitproof.verify.stability.list_entries import Gap, Segment
from orbitproof.verify.stability.stored_stability import StabilityFunctions, StabilityResult
from orbitproof.verify.stability.zeros import ends_of

_NOT_LOOKED_AT = "the stability of its orbits was not looked at"
_NOT_ENCLOSED = "the stability of its orbits was not enclosed there, its result says why"


@dataclass(frozen=True)
class _Known:
    """What a result knows on an interval; of two of them that with the smaller rank, the narrower one, is taken."""

    low: Fraction
    high: Fraction
    entry: StabilityFunctions
    mirrored: bool
    rank: tuple[Fraction, int]


def segments_of(number: int, stretch: Stretch, results: Sequence[StabilityResult]) -> tuple[list[Segment], list[Gap]]:
    """The parts of a stretch on which functions are known, from its beginning to its end, and the rest."""
    piece = stretch.tube.piece
    size = len(piece.tube)
    known: list[_Known] = []
    # What a result says of why functions are missing is no word of ours: the theorem does not repeat it.
    reasons: list[tuple[Fraction, Fraction, str]] = []
    for result in results:
        if result.piece != piece.id or not result.is_proved:
            continue
        (start, end), entry = result.interval, result.stability
        for low, high, mirrored in ((start, end, False), (-end, -start, True)):
            if mirrored and not stretch.tube.is_symmetric:
                continue
            if not isinstance(entry, StabilityFunctions):
                reasons.append((low, high, _NOT_LOOKED_AT if entry is None else _NOT_ENCLOSED))
            elif len(entry.characteristic) != size:
                reasons.append((low, high, f"there are not {size} coefficients of the characteristic polynomial"))
            elif _is_proved(stretch, low, high):
                digits = result.computation.precision or 0
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
            gaps.append(Gap(number, piece.id, reached, end, Matter.EVERYTHING, why))
        else:
            # Bounds of derivatives are weak at the ends of an interval: of those alike each is used about its middle.
            best = min(here, key=lambda item: (item.rank, abs(item.low + item.high - 2 * reached), -item.high))
            alike = [item.low for item in known if item.rank == best.rank and best.low < item.low < best.high]
            middles = [(low + best.high) / 2 for low in alike]
            better = [item.low for item in later if item.rank < best.rank]
            end = min([best.high, stretch.leaves, *better, *middles])
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
    entry: StabilityFunctions,
    mirrored: bool,
) -> Segment:
    """A part of the curve with what a result on an interval of its piece knows.

    Args:
        places: where it begins, is surely entered, and ends.
        entry: the stored functions.
        mirrored: whether they are those of -s.
    """
    low, high = interval
    stored = (*entry.characteristic, entry.level, entry.half_period, entry.first_factor)
    functions = [function.enclosed for function in stored]
    if mirrored:
        functions = [function.mirrored() for function in functions]
    *characteristic, level, half_period, first_factor = functions
    distances = known_distances(entry.distance) if isinstance(entry.distance, DistanceFunctions) else None
    across = entry.out_of_plane.known if isinstance(entry.out_of_plane, VariationFunctions) else None
    if mirrored:
        distances = None if distances is None else distances.mirrored()
        across = None if across is None else across.mirrored()
    return Segment(
        number, *places, (low + high) / 2, (high - low) / 2 * REACH, tuple(characteristic), level, half_period,
        first_factor, distances, across,
    )  # fmt: skip


def point_over(stretch: Stretch, s: arb) -> list[arb]:
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
