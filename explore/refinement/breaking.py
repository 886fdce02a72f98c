"""Points at which the reversor R is lost, refined to claims.

Beside pi_q P(u) = 0 the equation is g(u) = 0, g from the bordered system [[B, e], [r, 0]] (w, g) = (0, 1). B is D_q P
in the coordinates of Fix(R) without the parameter, or without the coordinate that follows from the level, and dg = -
l dB w with the left solution l.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.refinement.half_return import HalfReturn, half_return, second_derivatives
from orbitproof.explore.refinement.one_point import FRAME_BITS, Defect, Setting, refine_defect
from orbitproof.shared.formats import REVERSOR_BREAKING
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem


def crossing_matrix(system: ReversibleSystem, half: HalfReturn) -> tuple[list[int], np.ndarray[Any, Any]]:
    """Rows of DP for the coordinates of Fix(R) without the parameter or the level coordinate, and B in floats."""
    names = system.centre_coordinates
    dropped = system.family_parameter or system.level_coordinate
    rows = [place for place, name in enumerate(names) if name != dropped]
    n = len(rows)
    return rows, np.array([[float(half.derivative[row, n + 1 + j]) for j in range(n)] for row in rows])


def _loss_at(setting: Setting, point: Sequence[Fraction], context: mpmath.MPContext) -> Defect:
    where = setting.system, setting.parameters, point
    half = half_return(*where, context, setting.regularisation, setting.crossings)
    rows, floats = crossing_matrix(setting.system, half)
    n = len(rows)
    left, _, right = np.linalg.svd(floats)
    e, r = ([context.mpf(float(value)) for value in vector] for vector in (left[:, -1], right[-1]))
    whole = context.matrix(n + 1, n + 1)
    for i in range(n):
        for j in range(n):
            whole[i, j] = half.derivative[rows[i], n + 1 + j]
        whole[i, n], whole[n, i] = e[i], r[i]
    last = context.matrix([0] * n + [1])
    solution, other = context.lu_solve(whole, last), context.lu_solve(whole.T, last)
    w, covector = list(solution[:n]), list(other[:n])
    units = [[int(i == j) for i in range(2 * n + 1)] for j in range(n + 1)]
    across = [0] * (n + 1) + w
    (bent,) = second_derivatives(*where, [across], units, context, setting.regularisation, setting.crossings)
    slope = [-sum(covector[i] * column[row] for i, row in enumerate(rows)) for column in bent]
    return Defect(solution[n], slope, half, _kernel_frame([float(value) for value in w]))


refine_breaking = partial(refine_defect, REVERSOR_BREAKING, _loss_at)
"""The claim that R is lost near a point; as `refine_defect`."""


def _kernel_frame(right: Sequence[float]) -> tuple[tuple[Fraction, ...], ...]:
    """A row along w, and unit rows but that of its largest component."""
    largest = max(range(len(right)), key=lambda i: abs(right[i]))
    rest = [i for i in range(len(right)) if i != largest]
    first = tuple(round_dyadic(Fraction(value), FRAME_BITS) for value in right)
    return (first, *(tuple(Fraction(int(i == j)) for j in range(len(right))) for i in rest))
