"""Errors in a frame that is carried from step to step (section 4.4).

Errors e = Q eta of a state, Q a real matrix, are known by bounds of eta. On a step e = Y eta + r:
the columns of Y solve the equation of the first variation approximately, and the comparison system bounds r. So what
the flow contracts becomes small, in whichever direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from operator import add
from typing import Protocol

import numpy as np
from flint import fmpz, fmpz_mat, fmpz_poly

from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, float_above, fraction_above
from orbitproof.verify.flow.expansion import Expansion
from orbitproof.verify.flow.field_along import FieldAlong
from orbitproof.verify.flow.gronwall import Floats, bounds_on_parts, grown, norm_arithmetic
from orbitproof.verify.flow.step import FlowStep, enclose_step

_SLACK, _FLOOR = 1.0 + 2.0**-30, 2.0**-1000
_MOST_DEGREE = 400
_WORST = 0.25
"""A frame is taken if its inverse is known up to this part."""

Slopes = Sequence[dict[int, Series]]
Columns = Sequence[Sequence[fmpz_poly]]


class FrameOracle(Protocol):
    """Finds frames, and what becomes of them: nothing is believed of it. Numbers are integers times 2^-bits."""

    def columns(
        self, slopes: Sequence[dict[int, fmpz_poly]], frame: fmpz_mat, step: Fraction, coarse: Arithmetic
    ) -> Columns | None:
        """Y with Y' = step slopes Y and Y(0) = frame, polynomials in theta; `None` where a frame is of no use.

        Args:
            slopes: row i maps j to d f_i / d x_j along the centre; entries that vanish may be absent.
            coarse: the format of slopes and columns.
        """

    def next_frame(self, end: fmpz_mat, bounds: Floats, bits: int) -> tuple[fmpz_mat, fmpz_mat]:
        """A matrix in which errors `end` eta are to be followed, and about the inverse of it.

        Args:
            bounds: of eta, shape (number of components, number of slots).
        """


@dataclass(frozen=True)
class Frame:
    """Errors Q eta of a state.

    Attributes:
        matrix: Q, integers times 2^-bits.
        bits: those of the norm arithmetic.
        bounds: of eta by grade, shape (number of components, number of slots).
    """

    matrix: fmpz_mat
    bits: int
    bounds: Floats


class InFrame:
    """Steps of the flow, one after another, with errors in a frame that the steps hand on.

    Args:
        oracle: finds the frames.
    """

    def __init__(self, oracle: FrameOracle) -> None:
        self._oracle = oracle
        self._reached: tuple[Series, ...] = ()
        self._frame: Frame | None = None

    def advance(
        self,
        program: PreparedProgram,
        state: Sequence[Series],
        parameters: Sequence[Series],
        expansion: Expansion,
        step: Fraction,
    ) -> FlowStep:
        """As `flow.advance`. The frame of the step before is used if `state` is where that step has ended."""
        along = FieldAlong(program, state[0].arithmetic, state, parameters)
        expansion.solve(along, step)
        goes_on = len(state) == len(self._reached) and all(a is b for a, b in zip(state, self._reached, strict=True))
        over = _Over(self._frame if goes_on and self._frame else _axes(state), self._oracle)
        flow = enclose_step(along, step, over.errors)
        if over.last is not None:
            end = (x.with_errors(row) for x, row in zip(flow.end, over.last.tolist(), strict=True))
            flow = replace(flow, end=tuple(end))
        self._reached, self._frame = flow.end, over.following
        return flow


def _axes(state: Sequence[Series]) -> Frame:
    """The errors of a state in the frame of its coordinates."""
    size, bits = len(state), norm_arithmetic(state[0].arithmetic).bits
    return Frame(_unit(size, bits), bits, np.array([x.errors for x in state]))


class _Over:
    """The errors of a step that begins in a frame.

    Attributes:
        last: errors at the end of the step; `None` where they are those on the whole step.
        following: the frame there.
    """

    def __init__(self, frame: Frame, oracle: FrameOracle) -> None:
        self.frame, self.oracle = frame, oracle
        self.last: Floats | None = None
        self.following: Frame | None = None

    def errors(self, slopes: Slopes, start: Floats, defects: Floats, step: Fraction) -> Floats:
        """Bounds of the errors on a step, shape (m, slots), as `gronwall.grown` (Lemma 4.2)."""
        self.last = self.following = None
        columns = self._columns(slopes, step)
        if columns is None:
            return grown(slopes, start, step)
        coarse, bounds = norm_arithmetic_of(slopes), self.frame.bounds
        reach = np.array([[bounds_on_parts(Series(coarse, [p], [])).max() for p in row] for row in columns])
        known = _up(reach @ bounds)
        sources = _defect(slopes, columns, step, coarse) @ bounds + defects
        length = fraction_above(step)
        for i, row in enumerate(slopes):
            for j, slope in row.items():
                sources[i] += _convolved(_up(length * np.array(slope.errors)), known[j])
        rest = grown(slopes, _up(sources), step)
        end = [[coarse.at_end(p) for p in row] for row in columns]
        self.last = _up(_sizes(end, coarse.bits) @ bounds + rest)
        self.following = self._next(end, rest)
        return _up(known + rest)

    def _columns(self, slopes: Slopes, step: Fraction) -> Columns | None:
        """Polynomials that begin at the frame; `None` if there are none."""
        size, matrix = len(self.frame.bounds), self.frame.matrix
        if not any(slopes):
            return None
        coarse = norm_arithmetic_of(slopes)
        known = [{j: fmpz_poly(slope.coefs[0]) for j, slope in row.items()} for row in slopes]
        found = self.oracle.columns(known, fmpz_mat(matrix), step, coarse)
        if found is None:
            return None
        columns = [[fmpz_poly(p) for p in row] for row in found]
        if len(columns) != size or any(len(row) != size for row in columns):
            return None
        long = replace(coarse, degree=_MOST_DEGREE)
        fits = not any(long.cut(p)[1] for row in columns for p in row)
        begins = [[p.truncate(coarse.stride) for p in row] for row in columns]
        return columns if fits and begins == [[fmpz_poly([x]) for x in row] for row in matrix.tolist()] else None

    def _next(self, end: Columns, rest: Floats) -> Frame | None:
        """Errors end eta + r in another frame, whose matrix is shown to be regular (Lemma 4.3)."""
        bounds, bits = self.frame.bounds, self.frame.bits
        size = len(bounds)
        middle = fmpz_mat([[p[0] for p in row] for row in end])
        matrix, inverse = map(fmpz_mat, self.oracle.next_frame(middle, bounds.copy(), bits))
        if {(x.nrows(), x.ncols()) for x in (matrix, inverse)} != {(size, size)}:
            return None
        lacking = _up(_sizes((_unit(size, 2 * bits) - inverse * matrix).tolist(), 2 * bits).sum(axis=1))
        worst = float(lacking.max())
        if not worst <= _WORST:
            return None
        moved = [
            [reduce(add, (a * p for a, p in zip(row, column, strict=True))) for column in zip(*end, strict=True)]
            for row in inverse.tolist()
        ]
        seen = _up(_sizes(moved, 2 * bits) @ bounds + _sizes(inverse.tolist(), bits) @ rest)
        further = _up(seen + np.outer(lacking, seen.max(axis=0)) / (1.0 - worst))
        return Frame(matrix, bits, further) if bool(np.all(np.isfinite(further))) else None


def norm_arithmetic_of(slopes: Slopes) -> Arithmetic:
    """The format of derivatives, of which there is one at least."""
    return next(slope.arithmetic for row in slopes for slope in row.values())


def _unit(size: int, bits: int) -> fmpz_mat:
    return fmpz_mat([[fmpz(int(i == j) << bits) for j in range(size)] for i in range(size)])


def _up(values: Floats) -> Floats:
    """Upper bounds of sums of products of non-negative floats (section 2.3)."""
    return np.asarray(values * _SLACK + _FLOOR)


def _sizes(entries: Sequence[Sequence[fmpz | fmpz_poly]], bits: int) -> Floats:
    """Bounds of numbers, or of the sums of the absolute values of coefficients, all times 2^-bits."""
    return np.array([[float_above(_sum(entry), -bits) for entry in row] for row in entries])


def _sum(entry: fmpz | fmpz_poly) -> int:
    return int(sum(map(abs, entry.coeffs()), fmpz(0)) if isinstance(entry, fmpz_poly) else abs(entry))


def _convolved(left: Floats, right: Floats) -> Floats:
    """The graded norm of a product, everything above the top grade in the last slot."""
    last = len(left) - 1
    result = np.zeros(len(left))
    for i, a in enumerate(left):
        for j, b in enumerate(right):
            result[min(i + j, last)] += a * b
    return result


def _defect(slopes: Slopes, columns: Columns, step: Fraction, coarse: Arithmetic) -> Floats:
    """Bounds of step P Y - dY/dtheta on the step, P the known part of the slopes."""
    numerator, denominator = fmpz(step.numerator), fmpz(step.denominator << coarse.bits)
    exact = [
        [reduce(add, (p.coefs[0] * columns[j][k] for j, p in row.items()), fmpz_poly([])) for k in range(len(columns))]
        for row in slopes
    ]
    differences = [
        [p * numerator - coarse.derivative(y) * denominator for p, y in zip(left, right, strict=True)]
        for left, right in zip(exact, columns, strict=True)
    ]
    return _sizes(differences, step.denominator.bit_length() - 1 + 2 * coarse.bits)
