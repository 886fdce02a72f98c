"""Krein collisions, n = 2, refined to claims.

Beside pi_q P(u) = 0 the equation is that the discriminant of the stability parameters is 0. Sigma = 2 A' A - 1 in all
1 + n coordinates of Fix(R), A and A' being the blocks of DP and of its inverse, has the eigenvalue 1 at symmetric
points; the sum and the product of the other two are taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath

from orbitproof.explore.refinement.frames import RefinementFailure
from orbitproof.explore.refinement.half_return import half_return, second_derivatives
from orbitproof.explore.refinement.one_point import Defect, Setting, refine_defect
from orbitproof.shared.formats import KREIN_COLLISION

_N = 2
_REAL = 1.01
"""Stability parameters beyond it belong to real multipliers, also at a point that is not refined yet."""


def _collision_at(setting: Setting, point: Sequence[Fraction], context: mpmath.MPContext) -> Defect:
    if len(setting.system.kernel_coordinates) != _N:
        raise RefinementFailure(f"{setting.system.name} has not two pairs of multipliers")
    where = setting.system, setting.parameters, point
    half = half_return(*where, context, setting.regularisation, setting.crossings)
    size, along = 1 + 2 * _N, 1 + _N
    units = [[int(i == j) for i in range(size)] for j in range(size)]
    bent = second_derivatives(*where, units[:along], units, context, setting.regularisation, setting.crossings)
    inverse = context.inverse(half.derivative)
    there, back = half.derivative[:along, :along], inverse[:along, :along]
    sigma = 2 * back * there - context.eye(along)
    trace, minors = _trace(sigma), (_trace(sigma) ** 2 - _trace(sigma * sigma)) / 2
    first, second = trace - 1, minors - (trace - 1)
    refuse_off_circle(float(first) / 2)
    slope = []
    for columns in bent:
        moved = context.matrix([[columns[j][i] for j in range(size)] for i in range(size)])
        turned = -(inverse * moved * inverse)[:along, :along]
        change = 2 * (turned * there + back * moved[:along, :along])
        d_first = _trace(change)
        d_second = trace * d_first - _trace(sigma * change) - d_first
        slope.append(2 * first * d_first - 4 * d_second)
    frame = tuple(tuple(Fraction(int(i == j)) for j in range(_N)) for i in range(_N))
    return Defect(first**2 - 4 * second, slope, half, frame)


def refuse_off_circle(parameter: float) -> None:
    """Raise `RefinementFailure` if a double stability parameter clearly is that of real multipliers."""
    if abs(parameter) > _REAL:
        raise RefinementFailure(
            f"two stability parameters meet at {parameter:.4g}, where multipliers are real: they do not meet on the "
            "unit circle there, and no claim is about that"
        )


def _trace(matrix: Any) -> Any:
    return sum(matrix[i, i] for i in range(matrix.rows))


refine_collision = partial(refine_defect, KREIN_COLLISION, _collision_at)
"""The claim that there is a Krein collision near a point; as `refine_defect`."""
