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

from orbitproof.explore.numerics import mpf
from orbitproof.explore.refinement.crossing import Crossing, section_crossings
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.shared.systems import Regularisation, ReversibleSystem


@dataclass(frozen=True)
class HalfReturn:
    """The Poincare map P at a point u of Fix(R), n = dim q.

    Attributes:
        kernel_values: q-coordinates of P(u), length n; they vanish at a symmetric orbit.
        derivative: DP(u) in the coordinates (u, q), shape (1 + 2n, 1 + 2n), an mpmath matrix.
        time: elapsed time.
    """

    kernel_values: list[Any]
    derivative: Any
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
    regularisation: Regularisation | None = None,
    every: int = 1,
) -> HalfReturn:
    """P and DP at `point`, the orbit followed in regularised coordinates if there are any.

    With `every` = m it is P^m that is meant here, in `HalfReturn` and in what is made of it.

    Raises `IntegrationFailure` if the orbit does not return to the section.
    """
    n = len(system.kernel_coordinates)
    size = 1 + 2 * n
    basis = JetBasis.graded((1,) * size, 1)
    unit = [[int(i == j) for j in range(size)] for i in range(size)]
    image, time = _image(system, parameters, point, unit, basis, context, regularisation, every)
    derivative = context.matrix([[jet.coefficients[basis.variable(j)] for j in range(size)] for jet in image])
    return HalfReturn([jet.coefficients[0] for jet in image[1 + n :]], derivative, time)


def second_derivatives(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    directions: Sequence[Sequence[Any]],
    others: Sequence[Sequence[Any]],
    context: mpmath.MPContext,
    regularisation: Regularisation | None = None,
    every: int = 1,
) -> list[list[list[Any]]]:
    """D^2 P(v, w), 1 + 2n numbers, for each v of `directions` (outer list) and w of `others` (inner list).

    Vectors have 1 + 2n components in the coordinates (u, q); a w may also be one of the v.
    """
    vectors = list(directions) + [w for w in others if w not in directions]
    numbers = [vectors.index(w) for w in others]
    size = len(vectors)

    def square(i: int, j: int) -> tuple[int, ...]:
        return tuple((v == i) + (v == j) for v in range(size))

    linear = JetBasis.graded((1,) * size, 1).monomials
    basis = JetBasis.of([*linear, *(square(i, j) for i in range(len(directions)) for j in numbers)])
    image, _ = _image(system, parameters, point, vectors, basis, context, regularisation, every)
    return [
        [[jet.coefficients[basis.index[square(i, j)]] * (1 + (i == j)) for jet in image] for j in numbers]
        for i in range(len(directions))
    ]


def _image(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    point: Sequence[Fraction],
    directions: Sequence[Sequence[Any]],
    basis: JetBasis,
    context: mpmath.MPContext,
    regularisation: Regularisation | None,
    every: int,
) -> tuple[list[Jet], float]:
    values = [mpf(u, context) for u in point]
    start, parameter = start_jets(system, values, directions, basis)
    crossing = next(
        section_crossings(system, parameters, start, parameter, context, regularisation=regularisation, every=every)
    )
    return section_jets(system, crossing, parameter), crossing.time


@dataclass(frozen=True)
class LinearIterates:
    """The word .. A B A at a point of Fix(R): D P^i by reversibility, i = 1, .., k.

    Attributes:
        there: A, the derivative of the Poincare map at the point.
        inverse: its inverse, or `None` for k = 1.
        back: B = R A^-1 R, its derivative at the image of a symmetric point, or `None` for k = 1.
        matrices: D pi_q P^i along Fix(R), shape (n, 1 + n) each.
        signs: R as a list of signs.
    """

    there: Any
    inverse: Any
    back: Any
    matrices: list[Any]
    signs: list[int]

    def factor(self, i: int) -> Any:
        """The factor that turns D P^(i-1) into D P^i."""
        return self.there if i % 2 else self.back


def linear_iterates(half: HalfReturn, k: int, context: mpmath.MPContext) -> LinearIterates:
    """D P^i for i = 1, .., k; raises `ZeroDivisionError` if DP is singular."""
    there = half.derivative
    size = there.rows
    n = (size - 1) // 2
    signs = [1] * (1 + n) + [-1] * n
    inverse = back = None
    if k > 1:
        inverse = context.inverse(there)
        rows = range(size)
        back = context.matrix([[inverse[i, j] * (signs[i] * signs[j]) for j in rows] for i in rows])
    word = there[:, : 1 + n]  # only the columns along Fix(R) are wanted
    matrices = [word[1 + n :, :]]
    for i in range(1, k):
        word = (back if i % 2 else there) * word
        matrices.append(word[1 + n :, :])
    return LinearIterates(there, inverse, back, matrices, signs)


@dataclass(frozen=True)
class SecondOrderTerm:
    """A term covector * D^2 P(., vector) of the derivative of left * D P^k * right."""

    covector: list[Any]
    vector: list[Any]


def product_rule(iterates: LinearIterates, k: int, left: Sequence[Any], right: Sequence[Any]) -> list[SecondOrderTerm]:
    """The derivative of left * D pi_q P^k * right with respect to the point, by the product rule.

    `left` has n components, `right` 1 + n. With d(R A^-1 R) = -R A^-1 dA A^-1 R each factor gives one
    term in D^2 P.
    """
    n = len(left)
    signs = iterates.signs
    size = len(signs)

    def apply(matrix: Any, vector: Sequence[Any]) -> list[Any]:
        return [sum(matrix[i, j] * vector[j] for j in range(size)) for i in range(size)]

    def apply_left(covector: Sequence[Any], matrix: Any) -> list[Any]:
        return [sum(covector[i] * matrix[i, j] for i in range(size)) for j in range(size)]

    def reflect(vector: Sequence[Any]) -> list[Any]:
        return [sign * x for sign, x in zip(signs, vector, strict=True)]

    vectors = [[*right, *[0] * n]]
    for i in range(1, k):
        vectors.append(apply(iterates.factor(i), vectors[-1]))
    covector: list[Any] = [*[0] * (1 + n), *left]
    terms = []
    for i in range(k, 0, -1):
        if i % 2:
            terms.append(SecondOrderTerm(covector, vectors[i - 1]))
        else:
            minus = [-x for x in apply_left(reflect(covector), iterates.inverse)]
            terms.append(SecondOrderTerm(minus, apply(iterates.inverse, reflect(vectors[i - 1]))))
        covector = apply_left(covector, iterates.factor(i))
    return terms
