"""Enclosures of a curve on the proved parts of a piece (section 15.4).

On every proved interval of s the tube of the piece contains exactly one symmetric orbit, which is known up to a
bound of its distance from the piece's polynomial. Everything is exact until it becomes a ball.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from flint import arb, arb_poly

from orbitproof.shared.formats import Piece
from orbitproof.verify.algebra import ball_polynomial, values_around
from orbitproof.verify.claim import inverse
from orbitproof.verify.curve.piece_result import Interval, IntervalResult
from orbitproof.verify.curve.proved_intervals import Run, read_results
from orbitproof.verify.evidence import (
    Reason,
    dot,
    enclose,
    exact_interval_text,
    exact_value,
    is_inside,
    is_positive,
    symmetric,
)

_BISECTIONS = 12
"""How often an interval is halved at most to find the sign of a function on it."""


@dataclass(frozen=True)
class Tube:
    """A piece and the runs of s on which it is proved.

    Attributes:
        piece: centre, frame, polynomial and tube, exact.
        runs: from left to right, with gaps between them.
        refusals: why further results of the piece do not count, with their intervals.
    """

    piece: Piece
    runs: tuple[Run, ...]
    refusals: tuple[tuple[Interval, Reason], ...] = ()

    def refusal(self, s: Fraction) -> str:
        """Why nothing is proved at s, from the shortest interval that was tried; empty if nothing is known."""
        tried = [(end - start, start, end, reason) for (start, end), reason in self.refusals if start <= s <= end]
        if not tried:
            return ""
        _, start, end, reason = min(tried, key=lambda entry: entry[0])
        return f"s in {exact_interval_text(start, end)}: {reason.message}"

    @property
    def is_symmetric(self) -> bool:
        """Whether the piece goes through the points that the symmetry fixes, at s = 0."""
        return self.piece.is_symmetric

    @cached_property
    def _polynomials(self) -> tuple[arb_poly, ...]:
        return tuple(ball_polynomial(row) for row in self.piece.polynomial)

    @cached_property
    def _inverse_frame(self) -> list[list[Fraction]]:
        rows = inverse(self.piece.frame)
        if rows is None:
            raise ZeroDivisionError(f"the frame of {self.piece.id} is singular")
        return rows

    def local(self, run: Run, s: Fraction) -> list[arb]:
        """Enclosures of p_0, .., p_n of the curve at s, which lies in the run."""
        errors = (Fraction(0), *run.at(s).deviation)
        return [enclose(p) + symmetric(e) for p, e in zip(self.piece.local(s), errors, strict=True)]

    def local_slope(self, run: Run, s: Fraction) -> list[arb]:
        """Enclosures of the derivatives in s of p_0, .., p_n of the curve at s, which lies in the run."""
        scale = abs(s) if self.is_symmetric else Fraction(1)
        errors = [scale * bound for bound in run.at(s).slope_deviation]
        slopes = [polynomial.derivative()(enclose(s)) for polynomial in self._polynomials]
        across = [slope + symmetric(e) for slope, e in zip(slopes, errors, strict=True)]
        return [enclose(self.piece.half_width), *across]

    def point(self, run: Run, s: Fraction) -> list[arb]:
        """Enclosures of the coordinates of the curve at s, shape (1 + n,)."""
        p = self.local(run, s)
        return [
            enclose(middle) + dot([enclose(value) for value in row], p)
            for middle, row in zip(self.piece.centre, self.piece.frame, strict=True)
        ]

    def points(self, deviation: Sequence[Fraction], lower: Fraction, upper: Fraction) -> list[arb]:
        """Enclosures of the coordinates of the curve for all s of a proved interval with this deviation."""
        middle, reach = enclose((lower + upper) / 2), enclose((upper - lower) / 2)
        return [
            values_around(ball_polynomial(self._coordinate(index)), middle, reach)
            + symmetric(self._spread(index, deviation))
            for index in range(len(self.piece.centre))
        ]

    def to_local(self, point: Sequence[arb]) -> list[arb]:
        """Enclosures of the p_0, .., p_n of a point that is given by enclosures of its coordinates."""
        distance = [ball - enclose(c) for ball, c in zip(point, self.piece.centre, strict=True)]
        return [dot([enclose(value) for value in row], distance) for row in self._inverse_frame]

    def from_piece(self, other: Piece, p: Sequence[arb], slope: Sequence[arb]) -> tuple[list[arb], list[arb]]:
        """What p_0, .., p_n of a point and the slope of a curve at it, in coordinates of `other`, are in those of this.

        The two affine maps are composed exactly, so that small numbers stay small.
        """
        shift = [a - b for a, b in zip(other.centre, self.piece.centre, strict=True)]
        origin = [sum((a * b for a, b in zip(row, shift, strict=True)), Fraction(0)) for row in self._inverse_frame]
        columns = list(zip(*other.frame, strict=True))
        change = [
            [enclose(sum((a * b for a, b in zip(row, column, strict=True)), Fraction(0))) for column in columns]
            for row in self._inverse_frame
        ]
        point = [enclose(value) + dot(row, p) for value, row in zip(origin, change, strict=True)]
        return point, [dot(row, slope) for row in change]

    def parameter(self, p: Sequence[arb]) -> arb:
        """s of a point with coordinates p."""
        return p[0] / enclose(self.piece.half_width)

    def offsets(self, s: arb, p: Sequence[arb]) -> list[arb]:
        """p_j - polynomial_j(s), j = 1, .., n."""
        return [ball - polynomial(s) for ball, polynomial in zip(p[1:], self._polynomials, strict=True)]

    def contains(self, s: arb, p: Sequence[arb]) -> bool:
        """Whether certainly |p_j - polynomial_j(s)| < tube_j for all j."""
        return all(is_inside(ball, width) for ball, width in zip(self.offsets(s, p), self.piece.tube, strict=True))

    def coordinate_is_beyond_zero(self, index: int, sign: int, run: Run, lower: Fraction, upper: Fraction) -> bool:
        """Whether sign times a coordinate of the curve is certainly positive for all s in [lower, upper]."""
        coefficients = [sign * c for c in self._coordinate(index)]
        parts = run.between(lower, upper)
        return bool(parts) and all(
            _is_positive_on(coefficients, self._spread(index, part.deviation), first, last)
            for part, first, last in parts
        )

    def coordinate_increases(self, index: int, run: Run, lower: Fraction, upper: Fraction) -> bool:
        """Whether a coordinate of the curve certainly increases with s on [lower, upper].

        On a symmetric piece the interval has to lie on one side of 0, and a coordinate that the symmetry fixes is
        even in s: its derivative divided by s is considered.
        """
        slopes = [n * c for n, c in enumerate(self._coordinate(index))][1:] or [Fraction(0)]
        if not self.is_symmetric:
            scaled, sign = slopes, 1
        elif self.piece.frame[index][0]:
            # Negated by the symmetry: frame[index][0] * half_width * s exactly, whatever the others do.
            return self.piece.frame[index][0] > 0
        else:
            if slopes[0] or lower < 0 < upper:
                return False
            scaled, sign = slopes[1:] or [Fraction(0)], 1 if lower >= 0 else -1
        parts = run.between(lower, upper)
        return bool(parts) and all(
            _is_positive_on([sign * c for c in scaled], self._spread(index, part.slope_deviation), first, last)
            for part, first, last in parts
        )

    def _coordinate(self, index: int) -> list[Fraction]:
        """Coefficients in s of a coordinate of the polynomial's point."""
        row = self.piece.frame[index]
        length = max(2, *(len(coefficients) for coefficients in self.piece.polynomial))
        result = [Fraction(0)] * length
        result[0] += self.piece.centre[index]
        result[1] += row[0] * self.piece.half_width
        for weight, coefficients in zip(row[1:], self.piece.polynomial, strict=True):
            for n, value in enumerate(coefficients):
                result[n] += weight * value
        return result

    def _spread(self, index: int, errors: Sequence[Fraction]) -> Fraction:
        return sum((abs(a) * e for a, e in zip(self.piece.frame[index][1:], errors, strict=True)), Fraction(0))


def read_tube(piece: Piece, results: Sequence[IntervalResult]) -> Tube:
    """A piece with what its results prove of it."""
    return Tube(piece, *read_results(piece, results))


def _is_positive_on(coefficients: Sequence[Fraction], error: Fraction, lower: Fraction, upper: Fraction) -> bool:
    """Whether a polynomial exceeds `error` on all of [lower, upper]; the interval is halved as often as it takes."""
    polynomial, allowance = ball_polynomial(coefficients), enclose(error)
    pending = [(lower, upper, 0)]
    while pending:
        first, last, depth = pending.pop()
        middle, radius = (first + last) / 2, (last - first) / 2
        if is_positive(values_around(polynomial, enclose(middle), enclose(radius)) - allowance):
            continue
        if depth == _BISECTIONS or not is_positive(polynomial(enclose(middle)) - allowance):
            return False
        pending += [(first, middle, depth + 1), (middle, last, depth + 1)]
    return True


def lower_end(ball: arb) -> Fraction:
    """A number that is at most every point of a finite ball."""
    return exact_value(ball.lower())


def upper_end(ball: arb) -> Fraction:
    """A number that is at least every point of a finite ball."""
    return exact_value(ball.upper())
