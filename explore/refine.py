"""Newton refinement of bifurcation points to high precision (Appendix B of the paper).

The unknowns are the coordinates u of a point of Fix(R) (the family parameter first, if the system has
one), the equations are

    pi_q P(u) = 0          (a symmetric orbit of period 2)   and   g(u) = 0,

with g the Schur complement of D_(p1,p2) pi_q P^k, that is dG_k/dp_1 after the Lyapunov-Schmidt
reduction; on the family it equals the reduced bifurcation function g_k. For k = 1 the symmetry S splits
the equations: u is S-even, the S-even part of pi_q P and d(q odd)/d(p odd) vanish.

The precision doubles with every iteration, the derivative of g is needed to half of it only, so
that the cost is about that of the last iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, inf, isfinite, log2
from typing import Any

import mpmath
import numpy as np

from explore.frames import Frame, Parity, RefinementFailure, bifurcation_frame, parity_of
from explore.half_return import HalfReturn, half_return, iterate_derivatives
from explore.jets import JetBasis
from explore.reduction import BranchGeometry, box_radii, branch_geometry, level_jet, start_jets
from explore.taylor import IntegrationFailure
from shared.formats import KINDS, Candidate
from shared.numbers import round_dyadic
from shared.systems import ReversibleSystem

__all__ = ["RefinedPoint", "RefinementFailure", "refine"]

GUARD_BITS = 48
"""Working precision beyond the accuracy aimed at: what the flow and the reduction may lose."""

MARGIN_DIGITS = 8
"""Digits by which the centre is more accurate than asked for; radii of second order need them."""

GEOMETRY_BITS = 150
"""Working precision of the jets that give slopes, curvatures and radii."""

NEIGHBOURHOOD = 1e-3
"""Largest distance from the guess, relative where a coordinate exceeds 1."""

SINGULAR = 1e-9
"""Ratio of singular values below which an iterate P^i, i < k, counts as resonant itself."""

MAXIMAL_ITERATIONS = 14


@dataclass(frozen=True)
class RefinedPoint:
    """A bifurcation point to high precision, with the box in which it is to be proved.

    Attributes:
        system, parameters, kind, k, symmetry: what was asked for.
        centre: the point, dyadic, in the order of `ReversibleSystem.centre_coordinates`.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows.
        radii: half-widths of P_0, P_1, P_2, powers of two.
        residual: Newton correction at the centre, in the frame's coordinates, from a last evaluation.
        digits: accuracy asked for.
        iterations: (bits of working precision, size of the correction) of each Newton step.
        half_period: time from the centre to the next crossing of the section, nondimensional.
        first_integral: its value at the centre, or `None` if the system has none.
        geometry: slopes and curvatures of the two branches.
        margins: for i = 1 .. k - 1 the ratio of the smallest to the largest singular value of
            D_(p1,p2) pi_q P^i: how far the iterate is from being resonant.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    symmetry: str | None
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    kernel_frame: tuple[tuple[Fraction, ...], ...]
    radii: tuple[Fraction, ...]
    residual: float
    digits: int
    iterations: tuple[tuple[int, float], ...]
    half_period: float
    first_integral: Fraction | None
    geometry: BranchGeometry
    margins: tuple[float, ...] = field(default=())

    def to_candidate(self, id: str, provenance: Mapping[str, Any]) -> Candidate:
        """The claim for the verifier; `provenance` is extended by what the refinement found."""
        found = {
            "digits": self.digits,
            "residual": self.residual,
            "half_period": self.half_period,
            "iterations": [[bits, size] for bits, size in self.iterations],
            "branch_slope": self.geometry.branch_slope,
            "branch_curvature": self.geometry.branch_curvature,
            "margins": list(self.margins),
        }
        return Candidate(
            id=id, system=self.system, parameters=dict(self.parameters), kind=self.kind, k=self.k,
            centre=self.centre, frame=self.frame, kernel_frame=self.kernel_frame, radii=self.radii,
            symmetry=self.symmetry, provenance={**found, **provenance},
        )  # fmt: skip


def refine(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    kind: str,
    k: int,
    guess: Sequence[float],
    *,
    digits: int = 50,
    symmetry: str | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> RefinedPoint:
    """Refine a float64 approximation of a bifurcation point and build the box for the verifier.

    Arguments:
        kind, k: as in `shared.formats.Candidate`; k = 1 exactly for symmetry breaking.
        guess: 1 + n numbers in the order of `centre_coordinates`, off by 1e-5 or less.
        digits: decimal digits of the centre.
        symmetry: the symmetry that breaks, for k = 1; may be left out if the system has only one.
        progress: called with a message and the fraction done.

    Raises `RefinementFailure`, with one line of reason, if Newton's method does not converge or leaves the
    neighbourhood of the guess, or if the point is not a simple 1:k resonance.
    """
    report = progress if progress is not None else (lambda _message, _fraction: None)
    parity, symmetry = _checked(system, kind, k, guess, symmetry)
    problem = _Problem(system, dict(parameters), k, kind != "touch_and_go", parity)
    try:
        return _refine(problem, kind, guess, digits, symmetry, report)
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None


def _checked(
    system: ReversibleSystem, kind: str, k: int, guess: Sequence[float], symmetry: str | None
) -> tuple[Parity | None, str | None]:
    if kind not in KINDS or k < 1 or (kind == "symmetry_breaking") != (k == 1):
        raise RefinementFailure(f"{kind} with k = {k} is not a bifurcation that can be refined")
    if len(guess) != len(system.centre_coordinates) or not all(isfinite(x) for x in guess):
        wanted = ", ".join(system.centre_coordinates)
        raise RefinementFailure(f"the guess needs finite numbers for {wanted}")
    if k > 1:
        return None, None
    if symmetry is None and len(system.symmetries) == 1:
        symmetry = next(iter(system.symmetries))
    if symmetry not in system.symmetries:
        raise RefinementFailure(f"symmetry breaking needs a symmetry of {system.name}, not {symmetry}")
    return parity_of(system, symmetry), symmetry


@dataclass(frozen=True)
class _Problem:
    system: ReversibleSystem
    parameters: dict[str, Fraction]
    k: int
    tangential: bool
    parity: Parity | None

    @property
    def unknowns(self) -> tuple[int, ...]:
        return self.parity.even if self.parity is not None else tuple(range(len(self.system.centre_coordinates)))

    @property
    def equations(self) -> tuple[int, ...]:
        kernel = tuple(range(len(self.system.kernel_coordinates)))
        return self.parity.kernel_even if self.parity is not None else kernel

    def evaluate(self, point: Sequence[Fraction], bits: int, second: bool) -> tuple[HalfReturn, Any]:
        context = _context(bits)
        return half_return(self.system, self.parameters, point, context, second), context

    def frame(self, point: Sequence[Fraction], half: HalfReturn, context: mpmath.MPContext) -> Frame:
        matrices = iterate_derivatives(half, self.k, context).matrices
        gradient = self.level(point, context, True).coefficients[1:]
        return bifurcation_frame(
            self.system, matrices[0], matrices[-1], gradient, self.tangential, self.parity, context
        )

    def level(self, point: Sequence[Fraction], context: mpmath.MPContext, gradient: bool) -> Any:
        size = len(point)
        basis = JetBasis.graded([1] * size, int(gradient))
        n = size - 1
        unit = [[context.mpf(int(i == j)) for i in range(size + n)] for j in range(size)]
        values = [context.mpf(u.numerator) / u.denominator for u in point]
        start, parameter = start_jets(self.system, values, unit, basis)
        jet = level_jet(self.system, self.parameters, start, parameter, context)
        # Monomials of degree 1 come in the order of the variables.
        return jet


def _context(bits: int) -> mpmath.MPContext:
    context = mpmath.MPContext()
    context.prec = bits
    return context


def _fraction(value: Any) -> Fraction:
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent


def _newton_step(
    problem: _Problem,
    frame: Frame,
    half: HalfReturn,
    context: mpmath.MPContext,
    rough: HalfReturn,
    rough_context: mpmath.MPContext,
) -> list[Any]:
    """The correction to u: residuals from `half`, derivatives from the second-order `rough`."""
    n = len(problem.system.kernel_coordinates)
    derivative = iterate_derivatives(half, problem.k, context)
    rough_derivative = iterate_derivatives(rough, problem.k, rough_context)
    left, right = _schur_vectors(frame, rough_derivative.matrices[-1], rough_context)
    sharp_left, sharp_right = _schur_vectors(frame, derivative.matrices[-1], context)
    g = (sharp_left.T * derivative.matrices[-1] * sharp_right)[0]
    assert rough_derivative.slopes is not None
    rows, residuals = [], []
    for i in problem.equations:
        rows.append([derivative.matrices[0][i, j] for j in problem.unknowns])
        residuals.append(half.kernel_values[i])
    rows.append([(left.T * rough_derivative.slopes[j] * right)[0] for j in problem.unknowns])
    residuals.append(g)
    try:
        step = context.lu_solve(context.matrix(rows), context.matrix(residuals))
    except ZeroDivisionError:
        raise RefinementFailure("Newton's matrix is singular: not a simple resonance, or one degenerate") from None
    correction = [context.mpf(0)] * (n + 1)
    for index, j in enumerate(problem.unknowns):
        correction[j] = -step[index]
    return correction


def _schur_vectors(frame: Frame, matrix: Any, context: mpmath.MPContext) -> tuple[Any, Any]:
    """Left and right vectors that give the Schur complement g = left M right and its derivatives."""
    n = matrix.rows
    # The frame may come from another context; mpmath does not mix their matrices.
    columns = context.matrix(frame.columns[:, 1:].tolist())
    rows = context.matrix(frame.rows.tolist())
    if n == 1:
        return rows.T, columns
    local = rows * matrix * columns
    try:
        inverse = context.inverse(local[1:, 1:])
    except ZeroDivisionError:
        raise RefinementFailure("the kernel of D pi_q P^k is not simple") from None
    right = context.matrix(n, 1)
    left = context.matrix(n, 1)
    right[0] = left[0] = context.mpf(1)
    right[1:, 0] = -(inverse * local[1:, 0])
    left[1:, 0] = -(local[0, 1:] * inverse).T
    return rows.T * left, columns * right


def _refine(
    problem: _Problem,
    kind: str,
    guess: Sequence[float],
    digits: int,
    symmetry: str | None,
    report: Callable[[str, float], None],
) -> RefinedPoint:
    goal = ceil((digits + MARGIN_DIGITS) * log2(10))
    guard = GUARD_BITS
    point = [Fraction(float(x)) for x in guess]
    if problem.parity is not None:
        if abs(point[problem.parity.odd[0]]) > NEIGHBOURHOOD:
            raise RefinementFailure(f"the guess is not symmetric under {symmetry}")
        point[problem.parity.odd[0]] = Fraction(0)
    seed = list(point)
    iterations: list[tuple[int, float]] = []
    target, known = 60, 20.0
    previous = inf
    while True:
        if len(iterations) == MAXIMAL_ITERATIONS:
            raise RefinementFailure(f"Newton's method did not converge in {MAXIMAL_ITERATIONS} iterations")
        report(f"Newton step {len(iterations) + 1} with {target + guard} bits", 0.7 * known / goal)
        rough_bits = min(target, ceil(max(60.0, target / 2 + 8))) + guard
        rough, rough_context = problem.evaluate(point, rough_bits, True)
        sharp = rough_bits >= target + guard
        half, context = (rough, rough_context) if sharp else problem.evaluate(point, target + guard, False)
        frame = problem.frame(point, rough, rough_context)
        correction = _newton_step(problem, frame, half, context, rough, rough_context)
        size = _relative_size(correction, point)
        iterations.append((target + guard, size))
        if not size < NEIGHBOURHOOD or (size > 1e-4 and size > previous):
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        point = [_moved(u, c, target + guard) for u, c in zip(point, correction, strict=True)]
        if any(abs(u - s) > NEIGHBOURHOOD * max(1, abs(s)) for u, s in zip(point, seed, strict=True)):
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        # Quadratic convergence, with the constant seen in the last two steps.
        constant = max(0.0, log2(size / previous**2)) if 0 < size and isfinite(previous) else 0.0
        known = min(float(target), -2 * log2(size) - constant) if size > 0 else float(target)
        previous = size if size > 0 else 2.0**-target
        if known < goal - 1:
            target = min(goal, max(60, int(2 * known)))
            continue
        report("checking", 0.75)
        half, context = problem.evaluate(point, goal + guard, False)
        frame = problem.frame(point, half, context)
        correction = _newton_step(problem, frame, half, context, rough, rough_context)
        local = context.lu_solve(frame.columns, context.matrix(correction))
        residual = float(max(abs(x) for x in local))
        if residual < 10.0 ** -(digits + MARGIN_DIGITS / 2):
            break
        # The flow loses more digits than the guard bits allow for: carry more and go on.
        known, target = -log2(residual), goal
        guard += max(0, ceil(log2(residual) + goal)) + 10
    margins = _checked_iterates(problem, frame, half, context, digits)
    report("curvatures", 0.85)
    geometry = branch_geometry(
        problem.system, problem.parameters, point, frame, problem.k, problem.tangential, _context(GEOMETRY_BITS)
    )
    accuracy = max(residual, 10.0 ** -(digits + MARGIN_DIGITS))
    n = len(problem.system.kernel_coordinates)
    radii = box_radii(geometry, digits, accuracy, n)
    value = None
    if problem.system.first_integral is not None:
        value = round_dyadic(_fraction(problem.level(point, context, False).coefficients[0]), goal + guard)
    report("done", 1.0)
    return RefinedPoint(
        system=problem.system, parameters=problem.parameters, kind=kind, k=problem.k, symmetry=symmetry,
        centre=tuple(point), frame=_exact_rows(frame.columns), kernel_frame=_exact_rows(frame.rows), radii=radii,
        residual=residual, digits=digits, iterations=tuple(iterations), half_period=half.time,
        first_integral=value, geometry=geometry, margins=margins,
    )  # fmt: skip


def _relative_size(correction: Sequence[Any], point: Sequence[Fraction]) -> float:
    return max(float(abs(c)) / max(1.0, abs(float(u))) for c, u in zip(correction, point, strict=True))


def _moved(value: Fraction, correction: Any, bits: int) -> Fraction:
    moved = value + _fraction(correction)
    scale = 1 << bits
    return Fraction(round(moved * scale), scale)


def _exact_rows(matrix: Any) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(_fraction(matrix[i, j]) for j in range(matrix.cols)) for i in range(matrix.rows))


def _checked_iterates(
    problem: _Problem, frame: Frame, half: HalfReturn, context: mpmath.MPContext, digits: int
) -> tuple[float, ...]:
    """Singular values of D_(p1,p2) pi_q P^i: simple kernel for i = k, none for i < k."""
    derivatives = iterate_derivatives(half, problem.k, context).matrices
    margins = []
    for i, matrix in enumerate(derivatives, start=1):
        local = frame.rows * matrix * frame.columns[:, 1:]
        entries = np.array([[float(local[a, b]) for b in range(local.cols)] for a in range(local.rows)])
        values = np.linalg.svd(entries, compute_uv=False)
        if i < problem.k:
            margins.append(float(values[-1] / max(values[0], 1.0)))
            if not margins[-1] > SINGULAR:
                raise RefinementFailure(f"the point is a bifurcation with k = {i} already, not with k = {problem.k}")
        elif problem.k > 1 and len(values) > 1 and not values[-2] > SINGULAR * values[0]:
            raise RefinementFailure("the kernel of D pi_q P^k is not simple")
    return tuple(margins)
