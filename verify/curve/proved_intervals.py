"""What is proved of a piece on intervals of s, and which stored results count (section 15.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.shared.formats import Piece
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.verify.curve.equation import HalfReturn
from orbitproof.verify.curve.piece_result import Interval, interval_to_json
from orbitproof.verify.evidence import Reason, ball_from_json, ball_to_json


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

    def to_json(self) -> dict[str, Any]:
        """Its part of the JSON object of a result; all numbers that carry proof are exact."""
        return {
            "interval": interval_to_json((self.start, self.end)),
            "deviation": [format_exact(value) for value in self.deviation],
            "slope_deviation": [format_exact(value) for value in self.slope_deviation],
            "time": ball_to_json(self.time),
        }

    def mirrored(self) -> ProvedInterval:
        """The same for -s, which S gives on a symmetric piece."""
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
    piece: Piece, results: Sequence[Mapping[str, Any]]
) -> tuple[tuple[Run, ...], tuple[tuple[Interval, Reason], ...]]:
    """The proved runs of a piece from left to right, and what does not count and why, from results in JSON form.

    A result counts if its verdict is "proved", its numbers are exact and complete, and its deviations are smaller
    than the tube. On a symmetric piece it counts for -s too.
    """
    intervals: list[ProvedInterval] = []
    refusals: list[tuple[Interval, Reason]] = []
    for result in results:
        found = _read_interval(piece, result)
        if not isinstance(found, ProvedInterval):
            refusals.append(found)
            continue
        intervals.append(found)
        if piece.kind == "symmetric":
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


def _read_interval(piece: Piece, result: Mapping[str, Any]) -> ProvedInterval | tuple[Interval, Reason]:
    ends = _numbers(result.get("interval"))
    if ends is None or len(ends) != 2 or not -1 <= ends[0] < ends[1] <= 1:
        return _refused((Fraction(-1), Fraction(1)), "the interval of a result does not lie within [-1, 1]")
    start, end = ends
    if result.get("verdict") != "proved":
        reason = result.get("reason")
        return _refused((start, end), str(reason.get("message") if isinstance(reason, Mapping) else "not proved"))
    deviation, slopes = (_numbers(result.get(key)) for key in ("deviation", "slope_deviation"))
    size = len(piece.tube)
    if not (_are_bounds(deviation, size) and _are_bounds(slopes, size)) or deviation is None or slopes is None:
        return _refused((start, end), f"deviation and slope_deviation are not {size} finite exact bounds each")
    if not all(value < width for value, width in zip(deviation, piece.tube, strict=True)):
        return _refused((start, end), "the deviation is not smaller than the tube")
    return ProvedInterval(start, end, deviation, slopes, _time(result.get("time")))


def _refused(interval: Interval, message: str) -> tuple[Interval, Reason]:
    return interval, Reason("piece", message, "prove the piece again")


def _are_bounds(values: tuple[Fraction, ...] | None, size: int) -> bool:
    return values is not None and len(values) == size and min(values) >= 0


def _numbers(values: object) -> tuple[Fraction, ...] | None:
    """Exact numbers; `None` if any entry is something else, a float included."""
    if not isinstance(values, (list, tuple)):
        return None
    try:
        return tuple(value if isinstance(value, Fraction) else parse_exact(value) for value in values)
    except (TypeError, ValueError):
        return None


def _time(value: object) -> arb:
    if isinstance(value, arb):
        return value
    try:
        return ball_from_json(value)  # type: ignore[arg-type]
    except (TypeError, KeyError, ValueError):
        return arb(float("nan"))
