"""The Poincare map near a symmetric orbit: its linearisation, and that of all its iterates from one half return.

Coordinates of the section are (u, q): u those of a candidate's centre (the family parameter, if the
system has one, then Fix(R)), q those that R negates; R = diag(1, .., 1, -1, .., -1). With A = DP(x) at a
point x of a symmetric orbit of period 2, reversibility gives DP(P(x)) = R A^-1 R = B, hence
D P^k(x) = .. A B A. So one integration to the first return serves every k. Away from a symmetric orbit
the same word in A and B still is a smooth function of the point, which is all that Newton's method needs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from explore.crossing import Crossing, section_crossings
from explore.jets import Jet, JetBasis
from shared.systems import ReversibleSystem


@dataclass(frozen=True)
class HalfReturn:
    """The Poincare map P at a point u of Fix(R), n = dim q.

    Attributes:
        kernel_values: q-coordinates of P(u), length n; they vanish at a symmetric orbit.
        derivative: DP(u) in the coordinates (u, q), shape (1 + 2n, 1 + 2n), an mpmath matrix.
        slopes: for each u_j the derivative of DP(u), or `None` if it was not asked for.
        time: elapsed time.
    """

    kernel_values: list[Any]
    derivative: Any
    slopes: list[Any] | None
    time: float


def start_jets(
    system: ReversibleSystem, point: Sequence[Any], directions: Sequence[Sequence[Any]], basis: JetBasis
) -> tuple[list[Jet], Jet | None]:
    """Jets of the state, and of the family parameter, at `point` + sum of directions[v] * (variable v).

    `point` has 1 + n numbers; each direction has 1 + 2n, in the coordinates (u, q).
    """
    coordinates = []
    n = len(system.kernel_coordinates)
    for position in range(1 + 2 * n):
        jet = basis.constant(point[position] if position <= n else 0)
        if basis.degree:
            for v, direction in enumerate(directions):
                jet.coefficients[basis.variable(v)] = direction[position]
        coordinates.append(jet)
    state = [basis.constant(0) for _ in system.state]
    parameter = None
    moving = list(coordinates)
    if system.family_parameter is not None:
        parameter = moving.pop(0)
    for index, jet in zip([*system.fixed_coordinates, *system.kernel_coordinates], moving, strict=True):
        state[index] = jet
    return state, parameter


def section_jets(system: ReversibleSystem, crossing: Crossing, parameter: Jet | None) -> list[Jet]:
    """The jets of a crossing in the coordinates (u, q)."""
    lead = [] if parameter is None else [parameter]
    return lead + [crossing.jets[i] for i in (*system.fixed_coordinates, *system.kernel_coordinates)]


def half_return(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    context: mpmath.MPContext,
    second: bool,
) -> HalfReturn:
    """P and DP at `point`, with the derivatives of DP along Fix(R) if `second`.

    Raises `IntegrationFailure` if the orbit does not return to the section.
    """
    n = len(system.kernel_coordinates)
    size = 1 + 2 * n
    basis = JetBasis.graded((1,) * size, 1)
    if second:
        pairs = {tuple(sorted((i, j))) for i in range(1 + n) for j in range(size)}
        squares = [tuple((i == v) + (j == v) for v in range(size)) for i, j in pairs]
        basis = JetBasis.of([*basis.monomials, *squares])
    unit = [[int(i == j) for j in range(size)] for i in range(size)]
    values = [context.mpf(u.numerator) / u.denominator for u in point]
    start, parameter = start_jets(system, values, unit, basis)
    crossing = next(section_crossings(system, parameters, start, parameter, context))
    image = section_jets(system, crossing, parameter)
    derivative = context.matrix(size, size)
    for i in range(size):
        for j in range(size):
            derivative[i, j] = image[i].coefficients[basis.variable(j)]
    slopes = None
    if second:
        slopes = []
        for v in range(1 + n):
            slope = context.matrix(size, size)
            for j in range(size):
                monomial = tuple((w == v) + (w == j) for w in range(size))
                for i in range(size):
                    slope[i, j] = image[i].coefficients[basis.index[monomial]] * (2 if v == j else 1)
            slopes.append(slope)
    kernel_values = [jet.coefficients[0] for jet in image[1 + n :]]
    return HalfReturn(kernel_values, derivative, slopes, crossing.time)


@dataclass(frozen=True)
class IterateDerivatives:
    """D pi_q P^i at a point of Fix(R), along Fix(R).

    Attributes:
        matrices: matrices[i - 1] has shape (n, 1 + n).
        slopes: of the last matrix, for each u_j its derivative, or `None`.
    """

    matrices: list[Any]
    slopes: list[Any] | None


def iterate_derivatives(half: HalfReturn, k: int, context: mpmath.MPContext) -> IterateDerivatives:
    """D pi_q P^i for i = 1, .., k by reversibility; raises `ZeroDivisionError` if DP is singular."""
    size = half.derivative.rows
    n = (size - 1) // 2
    signs = [1] * (1 + n) + [-1] * n

    def reflected(matrix: Any) -> Any:
        result = matrix.copy()
        for i in range(size):
            for j in range(size):
                if signs[i] != signs[j]:
                    result[i, j] = -result[i, j]
        return result

    there, slopes = half.derivative, half.slopes
    factors = [(there, slopes)]
    if k > 1:
        inverse = context.inverse(there)
        back_slopes = None if slopes is None else [reflected(-(inverse * slope * inverse)) for slope in slopes]
        factors.append((reflected(inverse), back_slopes))
    # Only the columns along Fix(R) are wanted.
    word = there[:, : 1 + n]
    word_slopes = None if slopes is None else [slope[:, : 1 + n] for slope in slopes]
    matrices = [word[1 + n :, :]]
    for i in range(1, k):
        factor, factor_slopes = factors[i % 2]
        if word_slopes is not None and factor_slopes is not None:
            word_slopes = [f * word + factor * w for f, w in zip(factor_slopes, word_slopes, strict=True)]
        word = factor * word
        matrices.append(word[1 + n :, :])
    return IterateDerivatives(matrices, None if word_slopes is None else [w[1 + n :, :] for w in word_slopes])
