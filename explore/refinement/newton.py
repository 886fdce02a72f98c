"""Newton refinement of bifurcation points to high precision, up to the box for the verifier.

The equations are those of `explore.refinement.resonance` (Appendix B of the paper). The precision doubles with
every iteration and the derivative of g is needed to half of it only, so that the cost is about that
of the last iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, inf, isfinite, log2
from typing import Any

import numpy as np

from orbitproof.explore.refinement.crossing import shorter_coordinates
from orbitproof.explore.refinement.frames import Frame, Parity, RefinementFailure, parity_of
from orbitproof.explore.refinement.half_return import LinearIterates
from orbitproof.explore.refinement.reduction import (
    BranchGeometry,
    box_radii,
    branch_geometry,
    digits_for,
    fold_geometry,
    half_width,
)
from orbitproof.explore.refinement.resonance import (
    LinearisedResonance,
    Resonance,
    linearise,
    newton_correction,
    resonance_slope,
    working_context,
)
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import KINDS, ONCE, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem

__all__ = ["RefinedPoint", "RefinementFailure", "refine"]

FIRST_BITS = 60
"""Accuracy that an iteration aims at, at least: more than that of a float64 guess, and cheap."""

GUARD_BITS = 12
"""Working precision beyond the accuracy aimed at and beyond the bits that are lost on the way."""

CHECK_BITS = 12
"""Working precision that the last evaluation has beyond that of the last iteration."""

MARGIN_DIGITS = 6
"""Digits by which the centre is more accurate than asked for; radii of second order need them."""

GEOMETRY_BITS = 100
"""Working precision of the jets that give slopes, curvatures and radii."""

NEIGHBOURHOOD = 1e-3
"""Largest distance from the guess, relative where a coordinate exceeds 1."""

SINGULAR = 1e-9
"""Margin (see `RefinedPoint`) below which an iterate P^i, i < k, counts as resonant itself."""

MAXIMAL_ITERATIONS = 14


@dataclass(frozen=True)
class RefinedPoint:
    """A bifurcation point to high precision, with the box in which it is to be proved.

    Attributes:
        system, parameters, kind, k, symmetry, crossings: what was asked for.
        centre: the point, dyadic, in the order of `ReversibleSystem.centre_coordinates`.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows.
        radii: half-widths of P_0, P_1, P_2, powers of two.
        residual: Newton correction at the centre, in the frame's coordinates, from a last evaluation.
        digits: accuracy asked for.
        iterations: (bits of working precision, size of the correction) of each Newton step.
        half_period: time from the centre to the end of the half orbit, nondimensional.
        first_integral: its value at the centre, or `None` if the system has none.
        geometry: slopes and curvatures of the two branches.
        margins: for i = 1 .. k - 1 how far D_(p1,p2) pi_q P^i is from singular: the smallest part of a column
            that is orthogonal to the others, relative to the column if that is longer than 1.
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
    crossings: int = 1

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
            id=id,
            system=self.system,
            parameters=dict(self.parameters),
            kind=self.kind,
            k=self.k,
            centre=self.centre,
            frame=self.frame,
            kernel_frame=self.kernel_frame,
            radii=self.radii,
            symmetry=self.symmetry,
            crossings=self.crossings,
            provenance={**found, **provenance},
        )


def refine(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    kind: str,
    k: int,
    guess: Sequence[float],
    *,
    digits: int = 50,
    symmetry: str | None = None,
    crossings: int = 1,
    progress: Callable[[str, float], None] | None = None,
) -> RefinedPoint:
    """Refine a float64 approximation of a bifurcation point and build the box for the verifier.

    Arguments:
        kind, k: as in `shared.formats.candidates.Candidate`; k = 1 exactly for symmetry breaking and folds.
        guess: 1 + n numbers in the order of `centre_coordinates`, off by 1e-5 or less.
        digits: decimal digits of the centre; a box that has to be small for its orbit gets more.
        symmetry: the symmetry that breaks, for symmetry breaking; may be left out if the system has only one.
        crossings: of the section in the half orbit, its end included.
        progress: called with a message and the fraction done.

    Raises `RefinementFailure`, with one line of reason, if Newton's method does not converge or leaves the
    neighbourhood of the guess, or if the point is neither a simple 1:k resonance nor a fold.
    """
    report = progress if progress is not None else (lambda _message, _fraction: None)
    parity, symmetry = _checked(system, kind, k, guess, symmetry)
    try:
        regularisation = shorter_coordinates(system, parameters, guess, crossings)
        problem = Resonance(system, dict(parameters), k, kind != "touch_and_go", parity, regularisation, crossings)
        solution = _solve(problem, guess, digits, report)
        margins = _checked_iterates(problem, solution.frame, solution.at.iterates)
        report("curvatures", 0.85)
        about = system, problem.parameters, solution.point, solution.frame
        context = working_context(GEOMETRY_BITS)
        if problem.is_fold:
            geometry = fold_geometry(*about, context, problem.regularisation, crossings)
        else:
            geometry = branch_geometry(*about, k, problem.tangential, context, problem.regularisation, crossings)
        lost_bits = solution.first.lost_bits
        if regularisation is not None:
            # How the box has to shrink was found from the bits that are lost in the system's own coordinates.
            own = replace(problem, regularisation=None)
            lost_bits = _first_step(own, solution.point, solution.first.slope).lost_bits
        width = half_width(geometry, digits, k, lost_bits, system.family_parameter is None)
        if digits_for(width) > digits + MARGIN_DIGITS:
            solution = _solve(
                problem,
                solution.point,
                digits_for(width) - MARGIN_DIGITS // 2,
                lambda message, fraction: report(message, 0.85 + 0.14 * fraction),
            )
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None
    point, frame, at = solution.point, solution.frame, solution.at
    accuracy = max(solution.residual, 10.0 ** -(max(digits, digits_for(width) - MARGIN_DIGITS // 2) + MARGIN_DIGITS))
    value = None
    if system.family_parameter is None:
        value = round_dyadic(_fraction(problem.level(point, at.context, 0).coefficients[0]), at.context.prec)
    report("done", 1.0)
    return RefinedPoint(
        system=system,
        parameters=problem.parameters,
        kind=kind,
        k=k,
        symmetry=symmetry,
        centre=tuple(point),
        frame=_exact_rows(frame.columns),
        kernel_frame=_exact_rows(frame.rows),
        radii=box_radii(geometry, width, accuracy, len(system.kernel_coordinates)),
        residual=solution.residual,
        digits=digits,
        iterations=solution.iterations,
        half_period=at.half.time,
        first_integral=value,
        geometry=geometry,
        margins=margins,
        crossings=crossings,
    )


def _checked(
    system: ReversibleSystem, kind: str, k: int, guess: Sequence[float], symmetry: str | None
) -> tuple[Parity | None, str | None]:
    if kind not in KINDS or k < 1 or (kind in ONCE) != (k == 1):
        raise RefinementFailure(f"{kind} with k = {k} is not a bifurcation that can be refined")
    if len(guess) != len(system.centre_coordinates) or not all(isfinite(x) for x in guess):
        wanted = ", ".join(system.centre_coordinates)
        raise RefinementFailure(f"the guess needs finite numbers for {wanted}")
    if kind != "symmetry_breaking":
        return None, None
    if symmetry is None and len(system.symmetries) == 1:
        symmetry = next(iter(system.symmetries))
    if symmetry not in system.symmetries:
        raise RefinementFailure(f"symmetry breaking needs a symmetry of {system.name}, not {symmetry}")
    return parity_of(system, symmetry), symmetry


def _fraction(value: Any) -> Fraction:
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent


@dataclass(frozen=True)
class _FirstStep:
    """The first Newton step, with `bits` of working precision of which `lost_bits` did not reach the correction."""

    correction: list[Any]
    slope: list[Any]
    bits: int
    lost_bits: int


def _first_step(problem: Resonance, point: Sequence[Fraction], known_slope: list[Any] | None = None) -> _FirstStep:
    """Newton's correction at the guess, and the precision that the flow loses, from two evaluations."""
    for bits in (80, 160, 320):
        coarse, fine = (linearise(problem, point, b) for b in (bits, bits + 32))
        slope = resonance_slope(problem, point, coarse, bits) if known_slope is None else known_slope
        corrections = [newton_correction(problem, at, slope) for at in (coarse, fine)]
        difference = _relative_size([a - b for a, b in zip(*corrections, strict=True)], point)
        lost = bits + ceil(log2(max(difference, 2.0**-bits)))
        if lost < bits / 2:
            return _FirstStep(corrections[1], slope, bits + 32, lost)
    raise RefinementFailure("the orbit loses too many digits; it is too unstable or too close to a singularity")


@dataclass(frozen=True)
class _Solution:
    """Where Newton's method ended, with the evaluation that checked it."""

    point: list[Fraction]
    at: LinearisedResonance
    frame: Frame
    residual: float
    iterations: tuple[tuple[int, float], ...]
    first: _FirstStep


def _solve(
    problem: Resonance, guess: Sequence[float | Fraction], digits: int, report: Callable[[str, float], None]
) -> _Solution:
    goal = ceil((digits + MARGIN_DIGITS) * log2(10))
    enough = ceil((digits + MARGIN_DIGITS / 2) * log2(10))
    point = [x if isinstance(x, Fraction) else Fraction(float(x)) for x in guess]
    if problem.parity is not None:
        if abs(point[problem.parity.odd[0]]) > NEIGHBOURHOOD:
            raise RefinementFailure("the guess does not have the symmetry that is to break")
        point[problem.parity.odd[0]] = Fraction(0)
    seed = list(point)
    iterations: list[tuple[int, float]] = []
    report("first Newton step", 0.0)
    first = _first_step(problem, point)
    guard = GUARD_BITS + first.lost_bits
    target, slope, correction = first.bits - guard, first.slope, first.correction
    slope_bits = FIRST_BITS
    previous, expected = inf, inf
    while True:
        size = _relative_size(correction, point)
        iterations.append((target + guard, size))
        point = [_moved(u, c, target + guard) for u, c in zip(point, correction, strict=True)]
        strays = any(abs(u - s) > NEIGHBOURHOOD * max(1, abs(s)) for u, s in zip(point, seed, strict=True))
        if strays or not size < NEIGHBOURHOOD or (size > 1e-4 and size > previous):
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        # Quadratic convergence, with the constant seen in the last two steps.
        size = max(size, 2.0**-target)
        loss = max(0.0, log2(size) - log2(expected))
        known = min(float(target), -2 * log2(size) - loss)
        previous, expected = size, max(size**2, 2.0**-target)
        if known >= enough + 4:
            report("checking", 0.75)
            # At the same precision the evaluation would repeat its own rounding errors and see none of them.
            at = linearise(problem, point, goal + guard + CHECK_BITS)
            frame = problem.frame(point, at.iterates, at.context, problem.tangential)
            local = at.context.lu_solve(frame.columns, at.context.matrix(newton_correction(problem, at, slope)))
            residual = float(max(abs(x) for x in local))
            if residual < 2.0**-enough:
                return _Solution(point, at, frame, residual, tuple(iterations), first)
            # The flow loses more digits than the guard bits allow for: carry more and go on.
            known = -log2(residual)
            guard += max(0, ceil(goal - known)) + 10
        if len(iterations) == MAXIMAL_ITERATIONS:
            raise RefinementFailure(f"Newton's method did not converge in {MAXIMAL_ITERATIONS} iterations")
        target = min(goal, max(FIRST_BITS, int(2 * known)))
        report(f"Newton step {len(iterations) + 1} with {target + guard} bits", min(0.7, 0.7 * known / goal))
        at = linearise(problem, point, target + guard)
        # A slope as wrong as the last point leaves an error of third order: mostly the last step needs no new one.
        if known + min(-log2(size) - loss, slope_bits) < enough + 4:
            slope_bits = max(FIRST_BITS, target // 2 + 8)
            slope = resonance_slope(problem, point, at, slope_bits + guard)
        correction = newton_correction(problem, at, slope)


def _relative_size(correction: Sequence[Any], point: Sequence[Fraction]) -> float:
    return max(float(abs(c)) / max(1.0, abs(float(u))) for c, u in zip(correction, point, strict=True))


def _moved(value: Fraction, correction: Any, bits: int) -> Fraction:
    moved = value + _fraction(correction)
    scale = 1 << bits
    return Fraction(round(moved * scale), scale)


def _exact_rows(matrix: Any) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(_fraction(matrix[i, j]) for j in range(matrix.cols)) for i in range(matrix.rows))


def _checked_iterates(problem: Resonance, frame: Frame, iterates: LinearIterates) -> tuple[float, ...]:
    """Margins of D_(p1,p2) pi_q P^i for i < k, and a simple kernel for i = k."""
    margins = []
    for i, matrix in enumerate(iterates.matrices, start=1):
        local = frame.rows * matrix * frame.columns[:, 1:]
        entries = np.array([[float(local[a, b]) for b in range(local.cols)] for a in range(local.rows)])
        if i < problem.k:
            margins.append(_margin(entries))
            if not margins[-1] > SINGULAR:
                raise RefinementFailure(f"the point is a bifurcation with k = {i} already, not with k = {problem.k}")
        elif problem.k > 1 and len(entries) > 1:
            values = np.linalg.svd(entries, compute_uv=False)
            if not values[-2] > SINGULAR * values[0]:
                raise RefinementFailure("the kernel of D pi_q P^k is not simple")
    return tuple(margins)


def _margin(matrix: Any) -> float:
    """See `RefinedPoint.margins`. Near a collision the columns differ by orders of magnitude: no ratio of
    singular values tells that from a kernel.
    """
    margins = []
    for j, column in enumerate(matrix.T):
        others = np.delete(matrix, j, axis=1)
        lengths = np.linalg.norm(others, axis=0)
        basis, _ = np.linalg.qr(others / np.where(lengths > 0, lengths, 1.0))
        rest = column - basis @ (basis.T @ column)
        margins.append(float(np.linalg.norm(rest)) / max(1.0, float(np.linalg.norm(column))))
    return min(margins)
