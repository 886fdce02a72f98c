"""Frames for errors, and what becomes of them over a step (section 4.4)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from flint import fmpz_mat, fmpz_poly

from orbitproof.verify.algebra import Arithmetic, Floats

_MOST_DEGREE = 64
_SMALL = 2.0**-56
_CONTRACTING = 2.0**-30
"""A step that contracts volumes by less, or expands them by less, is one of a flow that preserves them."""


class Frames:
    """See `flow.FrameOracle`: Lohner's method, a QR factorisation with the longest edge first.

    Attributes:
        everywhere: whether flows that preserve volume have frames too, which pays on long ways along unstable orbits.
    """

    everywhere = False

    def columns(
        self, slopes: Sequence[dict[int, fmpz_poly]], frame: fmpz_mat, step: Fraction, coarse: Arithmetic
    ) -> list[list[fmpz_poly]] | None:
        """See `flow.FrameOracle`."""
        try:
            return self._columns(slopes, frame, step, coarse)
        except (ArithmeticError, ValueError):
            return None

    @np.errstate(over="ignore", invalid="ignore")
    def _columns(
        self, slopes: Sequence[dict[int, fmpz_poly]], frame: fmpz_mat, step: Fraction, coarse: Arithmetic
    ) -> list[list[fmpz_poly]] | None:
        size, unit, stride, width = len(slopes), 2.0**-coarse.bits, coarse.stride, coarse.width + 1
        length = -(-max(p.length() for row in slopes for p in row.values()) // stride)
        flat = np.zeros((max(length, 1) * stride, size, size))
        for i, row in enumerate(slopes):
            for j, p in row.items():
                flat[: p.length(), i, j] = [float(int(c)) for c in p.coeffs()]
        matrices = (flat * unit * float(step)).reshape(-1, stride, size, size)
        if not self.everywhere and np.abs(np.trace(matrices, axis1=2, axis2=3)).sum() < _CONTRACTING:
            return None
        solution = [np.zeros((width, size, size))]
        solution[0][0] = _floats(frame, unit)
        while len(solution) <= _MOST_DEGREE:
            last = np.array(solution[-len(matrices) :][::-1])
            following = np.zeros((width, size, size))
            for power in range(width):
                known = matrices[: len(last), power]
                following[power:] += np.einsum("kij,kpjl->pil", known, last[:, : width - power]) / len(solution)
            solution.append(following)
            if max(np.abs(each).max() for each in solution[-3:]) < _SMALL:
                break
        packed = np.zeros((len(solution), stride, size, size))
        packed[:, :width] = solution
        if not np.isfinite(packed).all():
            return None
        exact, powers = frame.tolist(), packed.reshape(-1, size, size)[1:]
        return [
            [fmpz_poly([exact[i][j], *_integers(powers[:, i, j], coarse.bits)]) for j in range(size)]
            for i in range(size)
        ]

    def next_frame(self, end: fmpz_mat, bounds: Floats, bits: int) -> tuple[fmpz_mat, fmpz_mat]:
        """See `flow.FrameOracle`."""
        try:
            orthogonal = _orthogonal(end, bounds, bits)
            return _matrix(orthogonal, bits), _matrix(orthogonal.T, bits)
        except (ArithmeticError, ValueError):
            axes = _matrix(np.eye(len(bounds)), bits)
            return axes, axes


@np.errstate(over="ignore", invalid="ignore")
def _orthogonal(end: fmpz_mat, bounds: Floats, bits: int) -> Floats:
    """The orthogonal factor of a matrix with its columns in the order of the edges of what it makes of the bounds."""
    floats = _floats(end, 2.0**-bits)
    longest = bounds.max(axis=0)
    edges = (bounds / np.where(longest > 0, longest, 1.0)).mean(axis=1)
    return np.asarray(np.linalg.qr(floats[:, np.argsort(-np.linalg.norm(floats, axis=0) * edges)])[0])


def _floats(matrix: fmpz_mat, unit: float) -> Floats:
    return np.array([[float(int(x)) * unit for x in row] for row in matrix.tolist()])


def _matrix(values: Floats, bits: int) -> fmpz_mat:
    return fmpz_mat([_integers(row, bits) for row in values])


def _integers(values: Floats, bits: int) -> list[int]:
    return [int(value) for value in np.rint(values * 2.0**bits)]
