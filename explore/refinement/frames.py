"""Frames of a candidate's box (sections 1.2 and 8 of the method).

Near a bifurcation point the symmetric orbits are the zeros of pi_q P^k on Fix(R). The frame turns its
coordinates into p_0 along the family of period-2 orbits, p_1 along the kernel of D pi_q P^k beside
the family, p_2 across; the kernel frame puts q_1 along the left null vector. In these coordinates the
first derivatives that the Lyapunov-Schmidt reduction divides out vanish at the centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

from orbitproof.shared.systems import ReversibleSystem


class RefinementFailure(Exception):
    """A bifurcation point was not found; the message is one line that says why."""


@dataclass(frozen=True)
class Parity:
    """How a symmetry S splits the coordinates u of the centre and the kernel coordinates q."""

    even: tuple[int, ...]
    odd: tuple[int, ...]
    kernel_even: tuple[int, ...]
    kernel_odd: tuple[int, ...]


@dataclass(frozen=True)
class Directions:
    """Directions at a point of Fix(R), as mpmath matrices.

    Attributes:
        columns: shape (1 + n, 1 + n), column j is the direction of p_j.
        rows: shape (n, n), q_i is row i times the kernel coordinates.
    """

    columns: Any
    rows: Any


def parity_of(system: ReversibleSystem, symmetry: str) -> Parity:
    """The S-even and S-odd coordinates; raises `RefinementFailure` unless one p and one q are odd."""
    signs = system.symmetries[symmetry]
    lead = [] if system.family_parameter is None else [1]
    centre = lead + [signs[i] for i in system.fixed_coordinates]
    kernel = [signs[i] for i in system.kernel_coordinates]
    parity = Parity(
        tuple(i for i, s in enumerate(centre) if s == 1),
        tuple(i for i, s in enumerate(centre) if s == -1),
        tuple(i for i, s in enumerate(kernel) if s == 1),
        tuple(i for i, s in enumerate(kernel) if s == -1),
    )
    if len(parity.odd) != 1 or len(parity.kernel_odd) != 1:
        raise RefinementFailure(
            f"symmetry {symmetry} does not negate exactly one coordinate of Fix(R), as one that fixes the orbits does; "
            "if it shifts them in time, orbits that lose it are born in the kind reversor_breaking"
        )
    return parity


def bifurcation_frame(
    system: ReversibleSystem,
    family_derivative: Any,
    derivative: Any,
    level_gradient: Sequence[Any],
    tangential: bool,
    parity: Parity | None,
    context: mpmath.MPContext,
) -> Directions:
    """The frame from D pi_q P and D pi_q P^k, both n x (1 + n), at or near a bifurcation point.

    `level_gradient` is the gradient of the bifurcation parameter: that of the first integral, or
    (1, 0, .., 0) for a family parameter. `tangential`: the new branch is tangent to a level set
    (all but touch and go) and p_1 is its direction; otherwise p_1 is orthogonal to the family. With `parity` the
    frame is adapted to S, with exact zeros.
    Raises `RefinementFailure` where these directions are not defined.
    """
    n = derivative.rows
    family = _rows(family_derivative)
    if parity is not None:
        even_family = [[family[i][j] for j in parity.even] for i in parity.kernel_even]
        even_tangent = _family_tangent(even_family, context)
        tangent = [context.mpf(0)] * (n + 1)
        for index, value in zip(parity.even, even_tangent, strict=True):
            tangent[index] = value
        kernel = _unit(context, parity.odd[0], n + 1)
        odd = parity.kernel_odd[0]
        rows = [_unit(context, odd, n)] + [_unit(context, i, n) for i in parity.kernel_even]
        return _assemble(system, tangent, kernel, rows, parity.even, context)
    tangent = _family_tangent(family, context)
    matrix = _rows(derivative)
    left, _, right = np.linalg.svd(_floats(matrix))
    reduced = [[dot(row, v) for row in matrix] for v in _exact(context, right[: n - 1])]
    left_null = _normalised(context, _solve(context, reduced, left[:, -1]))
    rows = [left_null, *_complement(context, [left_null], n)]
    equations = [[dot(row, column) for column in zip(*matrix, strict=True)] for row in rows[1:]]
    at_level = tangential or system.family_parameter is not None
    condition = list(level_gradient) if at_level else tangent
    first, second = right[n - 1], right[n]
    slopes = np.array([float(c) for c in condition])
    guess = (slopes @ second) * first - (slopes @ first) * second
    size = float(np.linalg.norm(guess))
    if size < 1e-13 * float(np.linalg.norm(slopes)):
        raise RefinementFailure("the kernel of D pi_q P^k lies in a level set of the bifurcation parameter")
    kernel = _normalised(context, _solve(context, [*equations, condition], guess / size))
    return _assemble(system, tangent, kernel, rows, range(n + 1), context)


@dataclass(frozen=True)
class Turning:
    """How the bifurcation parameter changes along the curve of symmetric orbits, at a point.

    Attributes:
        tangent: unit tangent of the curve, 1 + n numbers.
        multipliers: n numbers; the gradient of the parameter is their combination of the rows of D pi_q P, plus
            `slope` times the tangent.
        slope: derivative of the parameter along the tangent; it vanishes at a fold.
    """

    tangent: list[Any]
    multipliers: list[Any]
    slope: Any


def turning(derivative: Any, level_gradient: Sequence[Any], context: mpmath.MPContext) -> Turning:
    """From D pi_q P, n x (1 + n), and the gradient of the parameter. Raises `RefinementFailure` without a tangent."""
    rows = _rows(derivative)
    tangent = _family_tangent(rows, context)
    try:
        solution = context.lu_solve(context.matrix([*rows, tangent]).T, context.matrix(list(level_gradient)))
    except ZeroDivisionError:
        raise RefinementFailure("the curve of symmetric orbits has no unique tangent") from None
    *multipliers, slope = list(solution)
    return Turning(tangent, multipliers, slope)


def fold_frame(
    system: ReversibleSystem, derivative: Any, level_gradient: Sequence[Any], context: mpmath.MPContext
) -> Directions:
    """The frame at or near a fold: p_1 along the curve, p_0 across the levels of the parameter, p_2 across both.

    Arguments as for `turning`. q_1 does not change to first order along the level. Raises `RefinementFailure`.
    """
    found = turning(derivative, level_gradient, context)
    first = _normalised(context, found.multipliers)
    rows = [first, *_complement(context, [first], len(first))]
    across = _normalised(context, level_gradient)
    return _assemble(system, across, found.tangent, rows, range(len(across)), context)


def _family_tangent(derivative: list[list[Any]], context: mpmath.MPContext) -> list[Any]:
    _, _, right = np.linalg.svd(_floats(derivative)) if derivative else (0, 0, np.eye(1))
    return _normalised(context, _solve(context, derivative, right[-1]))


def _assemble(
    system: ReversibleSystem,
    tangent: list[Any],
    kernel: list[Any],
    rows: list[list[Any]],
    support: Sequence[int],
    context: mpmath.MPContext,
) -> Directions:
    """Complete p_0, p_1 by directions across, with coordinates in `support` only."""
    size = len(tangent)
    fixed = [tangent, kernel]
    if system.family_parameter is not None:
        # p_0 is the parameter itself, and the other directions leave it alone.
        if abs(tangent[0]) < 1e-12:
            raise RefinementFailure(f"the family turns back in {system.family_parameter}")
        tangent = [t / tangent[0] for t in tangent]
        kernel = _normalised(context, [context.mpf(0), *kernel[1:]])
        fixed = [_unit(context, 0, size), kernel]
    outside = [_unit(context, i, size) for i in range(size) if i not in support and kernel[i] == 0]
    across = _complement(context, fixed + outside, size)
    columns = context.matrix([tangent, kernel, *across]).T
    return Directions(columns, context.matrix(rows))


def _rows(matrix: Any) -> list[list[Any]]:
    return [[matrix[i, j] for j in range(matrix.cols)] for i in range(matrix.rows)]


def _floats(rows: Sequence[Sequence[Any]]) -> np.ndarray[Any, Any]:
    return np.array([[float(x) for x in row] for row in rows])


def _exact(context: mpmath.MPContext, rows: Any) -> list[list[Any]]:
    return [[context.mpf(float(x)) for x in row] for row in rows]


def dot(left: Sequence[Any], right: Sequence[Any]) -> Any:
    """The scalar product."""
    return sum(a * b for a, b in zip(left, right, strict=True))


def _unit(context: mpmath.MPContext, index: int, size: int) -> list[Any]:
    return [context.mpf(int(i == index)) for i in range(size)]


def _normalised(context: mpmath.MPContext, vector: Sequence[Any]) -> list[Any]:
    length = context.sqrt(dot(vector, vector))
    return [x / length for x in vector]


def _solve(context: mpmath.MPContext, equations: Sequence[Sequence[Any]], guess: Any) -> list[Any]:
    """The vector that `equations` annihilate, with component 1 along its float64 approximation `guess`.

    The sign of `guess` is arbitrary; the largest component is made positive, the same at nearby points.
    """
    sign = 1 if max(guess, key=abs) > 0 else -1
    last = [context.mpf(sign * float(x)) for x in guess]
    matrix = context.matrix([*(list(row) for row in equations), last])
    try:
        solution = context.lu_solve(matrix, context.matrix(_unit(context, len(last) - 1, len(last))))
    except ZeroDivisionError:
        raise RefinementFailure("the kernel of D pi_q P^k or the family's tangent is not simple") from None
    return [solution[i] for i in range(len(last))]


def _complement(context: mpmath.MPContext, vectors: Sequence[Sequence[Any]], size: int) -> list[list[Any]]:
    """An orthonormal basis of the orthogonal complement of independent `vectors`; exact zeros are kept."""
    basis: list[list[Any]] = []

    def reduced(vector: Sequence[Any]) -> list[Any]:
        result = list(vector)
        for b in [*basis, *basis]:
            c = dot(result, b)
            result = [x - c * y for x, y in zip(result, b, strict=True)]
        return result

    for vector in vectors:
        basis.append(_normalised(context, reduced(vector)))
    found = len(basis)
    while len(basis) < size:
        rest = [reduced(_unit(context, i, size)) for i in range(size)]
        basis.append(_normalised(context, max(rest, key=lambda v: dot(v, v))))
    return basis[found:]
