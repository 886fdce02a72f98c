"""Neighbouring pieces of a symmetry-breaking surface describe the same points (section 17.3).

At one parameter value that both pieces cover, the bifurcation point of the first lies in the box of the second. There
the second has exactly one, so they agree, and with them the surfaces over all common parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat

from orbitproof.shared.formats import SurfacePiece, evaluate
from orbitproof.verify.algebra import ball_polynomial, values_around
from orbitproof.verify.evidence import (
    Evidence,
    all_finite,
    dot,
    enclose,
    exact_interval_text,
    hull,
    is_inside,
    is_positive,
)
from orbitproof.verify.surface.proved_parts import ProvedPart, SurfaceResult

_SLOPE_PARTS = 32
_BISECTIONS = 80


@dataclass(frozen=True)
class Sheet:
    """A piece and the parts of [-1, 1] on which it is proved, in order.

    Attributes:
        piece: exact numbers.
        parameter: the row of its parameter, coefficients of 1, s, s^2, ..
        parts: by their starts.
    """

    piece: SurfacePiece
    parameter: tuple[Fraction, ...]
    parts: tuple[ProvedPart, ...]

    def gap(self) -> Fraction | None:
        """The least s in [-1, 1] from which on nothing is proved, `None` if all is."""
        reached = Fraction(-1)
        for part in self.parts:
            if part.start > reached:
                break
            reached = max(reached, part.end)
        return None if reached >= 1 else reached

    def increases(self) -> bool:
        """Whether the parameter certainly increases with s on [-1, 1]."""
        slope, reach = ball_polynomial(self.parameter).derivative(), arb(1) / _SLOPE_PARTS
        middles = (Fraction(2 * k + 1, _SLOPE_PARTS) - 1 for k in range(_SLOPE_PARTS))
        return all(is_positive(values_around(slope, enclose(middle), reach)) for middle in middles)

    def place(self, value: Fraction) -> tuple[Fraction, Fraction]:
        """An interval that contains the s with this parameter; it increases, and takes the value."""
        low, high = Fraction(-1), Fraction(1)
        for _ in range(_BISECTIONS):
            middle = (low + high) / 2
            low, high = (middle, high) if evaluate(self.parameter, middle) <= value else (low, middle)
        return low, high

    def centre(self, s: arb) -> list[arb]:
        """The centre at s."""
        return [_value(row, s) for row in self.piece.centre]

    def local(self, low: Fraction, high: Fraction) -> list[arb]:
        """The coordinates p of the bifurcation points for s in [low, high]. Raises `ValueError` beyond the parts."""
        meeting = [part.point for part in self.parts if part.start <= high and part.end >= low]
        if not meeting:
            raise ValueError(f"nothing is proved for s in {exact_interval_text(low, high)}")
        return [hull(balls[0], *balls[1:]) for balls in zip(*meeting, strict=True)]

    def point(self, low: Fraction, high: Fraction) -> list[arb]:
        """The coordinates of the bifurcation points for s in [low, high]."""
        s = hull(enclose(low), enclose(high))
        u = self._sheared(s, self.local(low, high), 1)
        return [
            middle + dot([enclose(value) for value in row], u)
            for middle, row in zip(self.centre(s), self.piece.frame, strict=True)
        ]

    def offsets(self, low: Fraction, high: Fraction, point: Sequence[arb]) -> list[arb]:
        """The coordinates p of a point in the box of some s in [low, high]."""
        s = hull(enclose(low), enclose(high))
        away = [x - c for x, c in zip(point, self.centre(s), strict=True)]
        frame = arb_mat([[enclose(value) for value in row] for row in self.piece.frame])
        solution = frame.solve(arb_mat([[value] for value in away]))
        return self._sheared(s, [solution[i, 0] for i in range(len(away))], -1)

    def _sheared(self, s: arb, p: Sequence[arb], sign: int) -> list[arb]:
        """(p_0 + bend_0 p_1^2, p_1, p_2 + tilt_2 p_0 + bend_2 p_1^2) for sign 1, the inverse of this for sign -1."""
        result = list(p)
        across = range(2, len(p))
        square = p[1] * p[1]
        for j, row in zip((0, *across), self.piece.bend, strict=bool(self.piece.bend)):
            result[j] = result[j] + sign * _value(row, s) * square
        # What the tilt multiplies is p_0, not what the bend made of it.
        first = p[0] if sign > 0 else result[0]
        for j, row in zip(across, self.piece.tilt, strict=bool(self.piece.tilt)):
            result[j] = result[j] + sign * _value(row, s) * first
        return result


def _value(coefficients: Sequence[Fraction], s: arb) -> arb:
    return ball_polynomial(coefficients)(s)


@dataclass(frozen=True)
class SurfaceJoint:
    """Where a piece goes over into the next one.

    Attributes:
        before, after: ids of the pieces.
        parameter: a value that both cover.
        offsets: coordinates p in the latter of the former's bifurcation point, inside its box.
    """

    before: str
    after: str
    parameter: Fraction
    offsets: tuple[arb, ...]


def read_sheet(piece: SurfacePiece, parameter: str, results: Sequence[SurfaceResult]) -> Sheet:
    """The proved parts of a piece. Raises `ValueError` for a part that is none of the piece."""
    parts = []
    for part in (part for result in results if result.is_proved for part in result.parts):
        if not -1 <= part.start < part.end <= 1 or len(part.point) != len(piece.radii):
            raise ValueError(f"piece {piece.id}: a part of a result is not within [-1, 1], or has no point")
        if all_finite(part.point):
            parts.append(part)
    return Sheet(piece, piece.parameters[parameter], tuple(sorted(parts, key=lambda part: (part.start, part.end))))


def glue(evidence: Evidence, before: Sheet, after: Sheet) -> SurfaceJoint | None:
    """Require that two pieces overlap in the parameter and describe the same bifurcation point there."""
    names = f"{before.piece.id} and {after.piece.id}"
    first, last = evaluate(after.parameter, Fraction(-1)), evaluate(before.parameter, Fraction(1))
    evidence.require(first < last, f"{names} have no parameter values in common")
    evidence.require(
        evaluate(before.parameter, Fraction(-1)) < first and last < evaluate(after.parameter, Fraction(1)),
        f"{names} are not in order: each has to cover parameters that the other does not",
    )
    if not evidence.holds:
        return None
    common = (first + last) / 2
    try:
        point = before.point(*before.place(common))
        offsets = after.offsets(*after.place(common), point)
    except ValueError as error:
        evidence.require(False, f"{names}: {error}")
        return None
    for j, (ball, radius) in enumerate(zip(offsets, after.piece.radii, strict=True)):
        evidence.record(f"p_{j} of {before.piece.id} in {after.piece.id}", ball)
        evidence.require(
            is_inside(ball, radius), f"the point of {before.piece.id} is not in the box of {after.piece.id}"
        )
    return SurfaceJoint(before.piece.id, after.piece.id, common, tuple(offsets))
