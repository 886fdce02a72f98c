"""What is proved of a piece on intervals of s, and which stored results count (section 15.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import BirthPiece, Piece
from orbitproof.verify.curve.equation import HalfReturn
from orbitproof.verify.curve.piece_result import PROVED, Computation, Interval, IntervalResult
from orbitproof.verify.evidence import Reason


@dataclass(frozen=True)
class ProvedInterval:
    """What is proved of a piece for s in [start, end].

    For each s there is exactly one zero with |p_j - polynomial_j(s)| <= tube_j, it is regular and smooth in s, and
    its p_j differs from polynomial_j(s) by d_j(s).

    Attributes:
        start, end: the interval, within [-1, 1].
        deviation: shape (n,), bounds of |d_j|, smaller than the tube.
        slope_deviation: shape (n,), bounds of |d_j'|, of |d_j'(s)/s| for a symmetric piece.
        time: half periods of the orbits, not finite if they were not given.
        half_return: how the tube returns, if this comes from an integration.
    """

    start: Fraction
    end: Fraction
    deviation: tuple[Fraction, ...]
    slope_deviation: tuple[Fraction, ...]
    time: arb = field(default_factory=lambda: arb(float("nan")))
    half_return: HalfReturn | None = field(default=None, compare=False, repr=False)

    def stored(self, piece: str, computation: Computation) -> IntervalResult:
        """As in `Results`."""
        numbers = (self.deviation, self.slope_deviation, self.time)
        return IntervalResult(piece, (self.start, self.end), PROVED, computation, None, *numbers)

    def mirrored(self) -> ProvedInterval:
        """What S gives for -s on a symmetric piece."""
        return ProvedInterval(-self.end, -self.start, self.deviation, self.slope_deviation, self.time)


@dataclass(frozen=True)
class Run:
    """Proved intervals of one piece in order, without a gap between them."""

    intervals: tuple[ProvedInterval, ...]

    @property
    def start(self) -> Fraction:
        """The least s."""
        return self.intervals[0].start

    @property
    def end(self) -> Fraction:
        """The greatest s."""
        return max(interval.end for interval in self.intervals)

    def at(self, s: Fraction) -> ProvedInterval:
        """An interval that contains s. Raises `ValueError` if there is none."""
        for interval in self.intervals:
            if interval.start <= s <= interval.end:
                return interval
        raise ValueError(f"nothing is proved at s = {s}")

    def between(self, lower: Fraction, upper: Fraction) -> list[tuple[ProvedInterval, Fraction, Fraction]]:
        """Intervals that cover [lower, upper], each with the part of it that lies inside."""
        parts = [(part, max(part.start, lower), min(part.end, upper)) for part in self.intervals]
        return [(part, first, last) for part, first, last in parts if first <= last]


def read_results(
    piece: Piece | BirthPiece, results: Sequence[IntervalResult]
) -> tuple[tuple[Run, ...], tuple[tuple[Interval, Reason], ...]]:
    """The proved runs of a piece from left to right, and what does not count and why.

    A result counts if it is proved, its numbers are complete, and its deviations are smaller than the tube. On a
    symmetric piece it counts for -s too.
    """
    intervals: list[ProvedInterval] = []
    refusals: list[tuple[Interval, Reason]] = []
    for result in results:
        found = _read_interval(piece, result)
        if not isinstance(found, ProvedInterval):
            refusals.append(found)
            continue
        intervals.append(found)
        if piece.is_symmetric:
            intervals.append(found.mirrored())
    runs: list[list[ProvedInterval]] = []
    reached = Fraction(-2)
    for interval in sorted(intervals, key=lambda part: (part.start, part.end)):
        if runs and interval.start <= reached:
            runs[-1].append(interval)
        else:
            runs.append([interval])
        reached = max(reached, interval.end)
    return tuple(Run(tuple(run)) for run in runs), tuple(refusals)


def _read_interval(piece: Piece | BirthPiece, result: IntervalResult) -> ProvedInterval | tuple[Interval, Reason]:
    start, end = result.interval
    if not -1 <= start < end <= 1:
        return _refused((Fraction(-1), Fraction(1)), "the interval of a result does not lie within [-1, 1]")
    if result.reason is not None:
        return _refused((start, end), result.reason.message)
    size = len(piece.tube)
    if not (_are_bounds(result.deviation, size) and _are_bounds(result.slope_deviation, size)):
        return _refused((start, end), f"deviation and slope_deviation are not {size} finite exact bounds each")
    if not all(value < width for value, width in zip(result.deviation, piece.tube, strict=True)):
        return _refused((start, end), "the deviation is not smaller than the tube")
    time = arb(float("nan")) if result.time is None else result.time
    return ProvedInterval(start, end, result.deviation, result.slope_deviation, time)


def _refused(interval: Interval, message: str) -> tuple[Interval, Reason]:
    return interval, Reason("piece", message, "prove the piece again")


def _are_bounds(values: tuple[Fraction, ...], size: int) -> bool:
    return len(values) == size and min(values) >= 0
