"""The equations of a 1:k resonance on Fix(R), and their derivatives (Appendix B of the paper).

The unknowns are the coordinates u of a point of Fix(R) (the family parameter first, if the system has
one), the equations are

    pi_q P(u) = 0          (a symmetric orbit of period 2)   and   g(u) = 0,

with g the Schur complement of D_(p1,p2) pi_q P^k, that is dG_k/dp_1 after the Lyapunov-Schmidt
reduction; on the family it equals the reduced bifurcation function g_k. For k = 1 the symmetry S splits
the equations: u is S-even, the S-even part of pi_q P and d(q odd)/d(p odd) vanish. At a fold, k = 1 without a
symmetry, g is the derivative of the bifurcation parameter along the unit tangent t of the curve; with the
multipliers l of its gradient in the rows of D pi_q P, dg = D^2 parameter (t, .) - l D^2 pi_q P(t, .).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement.crossing import level_jet
from orbitproof.explore.refinement.frames import (
    Directions,
    Parity,
    RefinementFailure,
    bifurcation_frame,
    dot,
    fold_frame,
    turning,
)
from orbitproof.explore.refinement.half_return import (
    HalfReturn,
    LinearIterates,
    half_return,
    linear_iterates,
    product_rule,
    second_derivatives,
    start_jets,
)
from orbitproof.explore.refinement.jets import Jet, JetBasis
from orbitproof.shared.systems import Regularisation, ReversibleSystem


@dataclass(frozen=True)
class Resonance:
    """What is to be solved: a 1:k resonance of the symmetric orbits of a system, or a fold.

    `tangential`: the new branch is tangent to a level set of the bifurcation parameter; see
    `explore.refinement.frames.bifurcation_frame`. `parity` is set where the claim uses a symmetry S.
    `regularisation`: the coordinates in which the orbits are followed, if not the system's own.
    `crossings`: of the section in a half orbit, m; P^m stands for P.
    """

    system: ReversibleSystem
    parameters: dict[str, Fraction]
    k: int
    tangential: bool
    parity: Parity | None
    regularisation: Regularisation | None = None
    crossings: int = 1

    @property
    def is_fold(self) -> bool:
        """Whether the parameter is to have an extremum along the curve of symmetric orbits."""
        return self.k == 1 and self.parity is None

    @property
    def unknowns(self) -> tuple[int, ...]:
        """Numbers of the coordinates u that Newton's method moves."""
        return self.parity.even if self.parity is not None else tuple(range(len(self.system.centre_coordinates)))

    @property
    def equations(self) -> tuple[int, ...]:
        """Numbers of the kernel coordinates of P(u) that it makes vanish."""
        kernel = tuple(range(len(self.system.kernel_coordinates)))
        return self.parity.kernel_even if self.parity is not None else kernel

    def frame(
        self, point: Sequence[Fraction], iterates: LinearIterates, context: mpmath.MPContext, tangential: bool
    ) -> Directions:
        """The frame at a point, from the derivatives there."""
        gradient = self.level(point, context, 1).coefficients[1:]
        first, last = iterates.matrices[0], iterates.matrices[-1]
        if self.is_fold:
            return fold_frame(self.system, first, gradient, context)
        return bifurcation_frame(self.system, first, last, gradient, tangential, self.parity, context)

    def level(self, point: Sequence[Fraction], context: mpmath.MPContext, degree: int) -> Jet:
        """The bifurcation parameter at a point of Fix(R), as a jet in u of this degree."""
        size = len(point)
        basis = JetBasis.graded([1] * size, degree)
        n = size - 1
        unit = [[context.mpf(int(i == j)) for i in range(size + n)] for j in range(size)]
        values = [mpf(u, context) for u in point]
        start, parameter = start_jets(self.system, values, unit, basis)
        # Monomials of degree 1 come in the order of the variables, so these are the value and the gradient.
        return level_jet(self.system, self.parameters, start, parameter, context)

    def level_bend(self, point: Sequence[Fraction], direction: Sequence[Any], context: mpmath.MPContext) -> list[Any]:
        """The second derivatives of the bifurcation parameter in a direction and each coordinate u."""
        size = len(point)
        jet = self.level(point, context, 2)

        def second(i: int, j: int) -> Any:
            monomial = tuple((v == i) + (v == j) for v in range(size))
            return jet.coefficients[jet.basis.index[monomial]] * (1 + (i == j))

        return [sum(direction[i] * second(i, j) for i in range(size)) for j in range(size)]


@dataclass(frozen=True)
class LinearisedResonance:
    """The equations at a point: first-order data, frame, and the Schur complement g of D_(p1,p2) pi_q P^k.

    The derivative of g is that of left * D pi_q P^k * right for constant vectors; for a fold see above.
    """

    half: HalfReturn
    iterates: LinearIterates
    frame: Directions
    left: list[Any]
    right: list[Any]
    g: Any
    context: mpmath.MPContext


def linearise(problem: Resonance, point: Sequence[Fraction], bits: int) -> LinearisedResonance:
    """Evaluate the equations at a point, from one half return with `bits` of working precision.

    Raises `IntegrationFailure`, or `RefinementFailure` if the kernel is not simple.
    """
    context = working_context(bits)
    half = half_return(problem.system, problem.parameters, point, context, problem.regularisation, problem.crossings)
    try:
        iterates = linear_iterates(half, problem.k, context)
        # p_1 tangent to the level set lies in the resonant plane of DP^2, which keeps few second derivatives.
        frame = problem.frame(point, iterates, context, True)
        if problem.is_fold:
            found = turning(iterates.matrices[0], problem.level(point, context, 1).coefficients[1:], context)
            minus = [-value for value in found.multipliers]
            return LinearisedResonance(half, iterates, frame, minus, found.tangent, found.slope, context)
        left, right = _schur_vectors(frame, iterates.matrices[-1], context)
    except ZeroDivisionError:
        raise RefinementFailure("the kernel of D pi_q P^k is not simple") from None
    matrix = iterates.matrices[-1]
    g = sum(left[i] * matrix[i, j] * right[j] for i in range(len(left)) for j in range(len(right)))
    return LinearisedResonance(half, iterates, frame, left, right, g, context)


def _schur_vectors(frame: Directions, matrix: Any, context: mpmath.MPContext) -> tuple[list[Any], list[Any]]:
    """Vectors with left * matrix * right = M_11 - M_12 M_22^-1 M_21, M the matrix in the frame's coordinates.

    Its derivative is left * d(matrix) * right.
    """
    n = matrix.rows
    columns = frame.columns[:, 1:]
    right, left = context.matrix(n, 1), context.matrix(1, n)
    right[0] = left[0] = context.mpf(1)
    if n > 1:
        local = frame.rows * matrix * columns
        inverse = context.inverse(local[1:, 1:])
        right[1:, 0] = -(inverse * local[1:, 0])
        left[0, 1:] = -(local[0, 1:] * inverse)
    return list(left * frame.rows), list(columns * right)


def resonance_slope(
    problem: Resonance,
    point: Sequence[Fraction],
    at: LinearisedResonance,
    bits: int,
    along: Sequence[Sequence[Any]] | None = None,
) -> list[Any]:
    """The derivative of g in the coordinates u that Newton's method moves, with `bits` of working precision.

    `along`: directions, of 1 + n numbers each, in which it is wanted instead.
    """
    n = len(problem.system.kernel_coordinates)
    context = working_context(bits)
    terms = product_rule(at.iterates, problem.k, at.left, at.right)
    coarse = [[context.mpf(x) for x in term.vector] for term in terms]
    chosen, combinations = _spanning(coarse, context)
    wanted = [[int(i == j) for i in range(1 + n)] for j in problem.unknowns] if along is None else along
    directions = [[context.mpf(x) for x in [*direction, *[0] * n]] for direction in wanted]
    # Each chosen vector lies in Fix(R), where it is a combination of the unknowns' directions, or not.
    second = second_derivatives(
        problem.system,
        problem.parameters,
        point,
        directions,
        chosen,
        context,
        problem.regularisation,
        problem.crossings,
    )
    slope = []
    for values in second:
        total = context.mpf(0)
        for term, combination in zip(terms, combinations, strict=True):
            for factor, value in zip(combination, values, strict=True):
                total += factor * sum(c * x for c, x in zip(term.covector, value, strict=True))
        slope.append(total)
    if problem.is_fold:
        bend = problem.level_bend(point, [context.mpf(x) for x in at.right], context)
        slope = [a + dot(bend, v[: n + 1]) for a, v in zip(slope, directions, strict=True)]
    return slope


def _spanning(vectors: list[list[Any]], context: mpmath.MPContext) -> tuple[list[list[Any]], list[list[Any]]]:
    """Few of the vectors that span all (within 1e-6), and each vector's coefficients in them.

    At a bifurcation point they lie in the plane of the resonant eigenvalues.
    """
    normal = np.array([[float(x) for x in v] for v in vectors])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rest, chosen = normal.copy(), [0]
    while True:
        direction = rest[chosen[-1]] / np.linalg.norm(rest[chosen[-1]])
        rest = rest - np.outer(rest @ direction, direction)
        sizes = np.linalg.norm(rest, axis=1)
        if sizes.max() < 1e-6:
            break
        chosen.append(int(sizes.argmax()))
    basis = [vectors[i] for i in chosen]
    gram = context.matrix([[dot(a, b) for b in basis] for a in basis])
    combinations = [list(context.lu_solve(gram, context.matrix([dot(a, v) for a in basis]))) for v in vectors]
    return basis, combinations


def newton_equations(problem: Resonance, at: LinearisedResonance, slope: Sequence[Any]) -> tuple[Any, Any]:
    """Residual and matrix for the unknowns, from the equations at the point and the derivative of g."""
    first = at.iterates.matrices[0]
    rows = [[first[i, j] for j in problem.unknowns] for i in problem.equations] + [list(slope)]
    residual = [at.half.kernel_values[i] for i in problem.equations] + [at.g]
    return at.context.matrix(residual), at.context.matrix(rows)


def newton_correction(problem: Resonance, at: LinearisedResonance, slope: Sequence[Any]) -> list[Any]:
    """Newton's correction of u, from the equations at the point and the derivative of g."""
    residual, matrix = newton_equations(problem, at, slope)
    return solved_step(problem, at, matrix, residual)


def solved_step(problem: Resonance, at: LinearisedResonance, matrix: Any, residual: Sequence[Any]) -> list[Any]:
    """The change of u that makes a residual vanish to first order."""
    try:
        step = at.context.lu_solve(matrix, at.context.matrix(residual))
    except ZeroDivisionError:
        raise RefinementFailure("Newton's matrix is singular: the resonance is degenerate") from None
    correction = [at.context.mpf(0)] * len(problem.system.centre_coordinates)
    for index, j in enumerate(problem.unknowns):
        correction[j] = -step[index]
    return correction
