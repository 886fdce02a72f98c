"""Newton refinement of bifurcation points to high precision, up to the box for the verifier.

The equations are those of `explore.refinement.resonance` (Appendix B of the paper). Only the last evaluation has full
precision: the precision of the others is what the point is good for, and the derivative of g has half of it. Where half
of the digits are known, jets give the box, and the box says how many digits the centre needs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, isfinite, log2
from typing import Any

import numpy as np

from orbitproof.explore.numerics import (
    GrowingDigits,
    Linearised,
    Solution,
    bits_of,
    fraction,
    newton_with_digits,
    working_context,
)
from orbitproof.explore.refinement.crossing import shorter_coordinates
from orbitproof.explore.refinement.frames import Directions, Parity, RefinementFailure, parity_of
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
    newton_equations,
    resonance_slope,
)
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import KINDS, LEADING_POWERS, ONCE, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.shared.systems import ReversibleSystem

__all__ = ["RefinedPoint", "RefinementFailure", "refine"]

GUARD_BITS = 12
"""Working precision beyond the accuracy aimed at and beyond the bits that are lost on the way."""

MARGIN_DIGITS = 6
"""Digits by which the centre is more accurate than asked for; radii of second order need them."""

NEIGHBOURHOOD = 1e-3
"""Largest distance from the guess, relative where a coordinate exceeds 1."""

SINGULAR = 1e-9
"""Margin (see `RefinedPoint`) below which an iterate P^i, i < k, counts as resonant itself."""

FIRST_PRECISIONS = (80, 160, 320)
"""Bits of working precision that are tried for the first step."""

FINER_BITS = 48
"""So many more has the evaluation that tells how many of them are lost."""

KNOWN_BITS = 90
"""The box is made for a point that is known to so many bits or more."""

GEOMETRY_BITS = 60
"""Accuracy of slopes and curvatures of the branches, which are needed as floats."""

ASSUMED_LOSS = 8
"""Bits that a step is thought to leave of the square of the last."""

SLOPE_BITS = 8
"""Bits of the derivative of g beyond half of those aimed at."""

TOO_MANY_LOST = "the orbit loses too many digits; it is too unstable or too close to a singularity"


@dataclass(frozen=True)
class RefinedPoint:
    """A bifurcation point to high precision, with the box in which it is to be proved.

    Attributes:
        system, parameters, kind, k, symmetry, crossings: what was asked for.
        centre: the point, dyadic, in the order of `ReversibleSystem.centre_coordinates`.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows.
        radii: half-widths of P_0, P_1, P_2, powers of two.
        residual: Newton correction that is left at the centre, in the frame's coordinates: the square of the last one,
            with some to spare.
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
        symmetry: the symmetry that breaks, for symmetry breaking, or that fixes the family, for period tupling with
            k = 3; may be left out if the system has only one.
        crossings: of the section in the half orbit, its end included.
        progress: called with a message and the fraction done.

    Raises `RefinementFailure`, with one line of reason, if Newton's method does not converge or leaves the
    neighbourhood of the guess, or if the point is neither a simple 1:k resonance nor a fold.
    """
    report = progress if progress is not None else (lambda _message, _fraction: None)
    parity, symmetry = _checked(system, kind, k, guess, symmetry)
    try:
        regularisation = shorter_coordinates(system, parameters, guess, crossings)
        problem = Resonance(system, dict(parameters), k, LEADING_POWERS[kind] > 1, parity, regularisation, crossings)
        report("digits that the orbit loses", 0.0)
        equations = _Equations(problem, guess)
        half = bits_of(digits) // 2 + ASSUMED_LOSS
        near = _solved(equations, equations.start, max(KNOWN_BITS, half), equations.first_bits, _part(report, 0.0))
        point, at = equations.point(near.unknowns), near.last.found
        frame = problem.frame(point, at.iterates, at.context, problem.tangential)
        margins = _checked_iterates(problem, frame, at.iterates)
        report("curvatures", 0.5)
        geometry = _geometry(problem, point, frame, working_context(GEOMETRY_BITS + equations.guard_bits))
        bits, length = near.iterations[-1]
        known = min(-2 * log2(max(length, 2.0**-bits)) - ASSUMED_LOSS, bits - equations.guard_bits)
        lost = equations.lost_in_own_coordinates(point, known)
        width = half_width(geometry, digits, k, lost, system.family_parameter is None)
        digits_of_centre = max(digits, digits_for(width) - MARGIN_DIGITS // 2)
        goal = bits_of(digits_of_centre)
        bits = min(ceil(2 * known), goal) + equations.guard_bits
        found = _solved(equations, near.unknowns, goal, bits, _part(report, 0.5))
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None
    point, at = equations.point(found.unknowns), found.last.found
    frame = problem.frame(point, at.iterates, at.context, problem.tangential)
    last = found.iterations[-1][1]
    correction = at.context.lu_solve(frame.columns, at.context.matrix(newton_correction(problem, at, equations.slope)))
    residual = max(max(float(abs(x)) for x in correction) * last * 2.0**ASSUMED_LOSS, 2.0**-goal)
    accuracy = max(residual, 10.0 ** -(digits_of_centre + MARGIN_DIGITS))
    value = None
    if system.family_parameter is None:
        value = round_dyadic(fraction(problem.level(point, at.context, 0).coefficients[0]), at.context.prec)
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
        residual=residual,
        digits=digits,
        iterations=near.iterations + found.iterations,
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
    if kind != "symmetry_breaking" and not (kind == "period_tupling" and k == 3):
        return None, None
    if symmetry is None and len(system.symmetries) == 1:
        symmetry = next(iter(system.symmetries))
    if symmetry not in system.symmetries:
        what = "symmetry breaking" if k == 1 else "period tupling with k = 3"
        raise RefinementFailure(f"{what} needs a symmetry of {system.name}, not {symmetry}")
    return parity_of(system, symmetry), symmetry


class _Equations:
    """What Newton's method solves, in the coordinates that it moves.

    Attributes:
        start: of these coordinates.
        lost_bits: of working precision, which do not reach the correction at the guess.
        first_bits: working precision of the evaluation there.
    """

    def __init__(self, problem: Resonance, guess: Sequence[float]) -> None:
        self.problem, self._seed = problem, [Fraction(float(x)) for x in guess]
        if problem.parity is not None:
            if abs(self._seed[problem.parity.odd[0]]) > NEIGHBOURHOOD:
                raise RefinementFailure("the symmetry does not fix the guess")
            self._seed[problem.parity.odd[0]] = Fraction(0)
        self.start = [self._seed[j] for j in problem.unknowns]
        for bits in FIRST_PRECISIONS:
            coarse, self._first = (linearise(problem, self._seed, b) for b in (bits, bits + FINER_BITS))
            self.slope = resonance_slope(problem, self._seed, coarse, bits)
            self.lost_bits = _lost_bits(self._corrections(coarse, self._first), self._seed, bits)
            if self.lost_bits < bits / 2:
                self.first_bits = bits + FINER_BITS
                self._slope_place, self._slope_bits = self._seed, bits - self.guard_bits
                return
        raise RefinementFailure(TOO_MANY_LOST)

    @property
    def guard_bits(self) -> int:
        """Working precision beyond the accuracy aimed at."""
        return GUARD_BITS + self.lost_bits

    def point(self, unknowns: Sequence[Fraction]) -> list[Fraction]:
        """All coordinates u."""
        point = list(self._seed)
        for j, value in zip(self.problem.unknowns, unknowns, strict=True):
            point[j] = value
        return point

    def linearised(self, unknowns: Sequence[Fraction], context: Any) -> Linearised:
        """The equations at a point; the derivative of g, with half the bits, is an old one from as near as that."""
        problem, point = self.problem, self.point(unknowns)
        at = self._first if point == self._seed and context.prec == self.first_bits else None
        at = linearise(problem, point, context.prec) if at is None else at
        needed = (context.prec - self.guard_bits) // 2
        moved = max(abs(u - s) for u, s in zip(point, self._slope_place, strict=True))
        if needed > self._slope_bits or moved > Fraction(1, 2 ** (needed - ASSUMED_LOSS)):
            self._slope_place, self._slope_bits = point, needed + SLOPE_BITS
            self.slope = resonance_slope(problem, point, at, self._slope_bits + self.guard_bits)
        return Linearised(*newton_equations(problem, at, self.slope), 2.0**self.lost_bits, at)

    def lost_in_own_coordinates(self, point: Sequence[Fraction], known: float) -> int:
        """How the box has to shrink was found from the bits that are lost in the system's own coordinates."""
        if self.problem.regularisation is None:
            return self.lost_bits
        own = replace(self.problem, regularisation=None)
        for bits in FIRST_PRECISIONS:
            coarse = linearise(own, point, bits)
            # Where the point is known to more bits its correction is the error.
            fine = None if known > bits + 8 else linearise(own, point, bits + FINER_BITS)
            lost = _lost_bits(self._corrections(coarse, fine), point, bits)
            if lost < bits / 2:
                return lost
        raise RefinementFailure(TOO_MANY_LOST)

    def _corrections(self, coarse: LinearisedResonance, fine: LinearisedResonance | None) -> list[Any]:
        """The difference of Newton's corrections from two evaluations, or of one from none."""
        first = newton_correction(self.problem, coarse, self.slope)
        second = [0] * len(first) if fine is None else newton_correction(self.problem, fine, self.slope)
        return [a - b for a, b in zip(first, second, strict=True)]


def _solved(
    equations: _Equations, start: Sequence[Fraction], goal: int, first_bits: int, report: Callable[[str, float], None]
) -> Solution:
    """The point to so many bits. A step is the last whose square is small enough."""
    rule = GrowingDigits(RefinementFailure, NEIGHBOURHOOD, first_bits, GUARD_BITS)
    return newton_with_digits(equations.linearised, start, goal, rule, report, enough=(goal + ASSUMED_LOSS) / 2)


def _part(report: Callable[[str, float], None], done: float) -> Callable[[str, float], None]:
    """The progress of half the work."""
    return lambda message, fraction: report(message, done + fraction / 2)


def _geometry(problem: Resonance, point: Sequence[Fraction], frame: Directions, context: Any) -> BranchGeometry:
    about = problem.system, problem.parameters, point, frame
    if problem.is_fold:
        return fold_geometry(*about, context, problem.regularisation, problem.crossings)
    return branch_geometry(*about, problem.k, problem.tangential, context, problem.regularisation, problem.crossings)


def _lost_bits(error: Sequence[Any], point: Sequence[Fraction], bits: int) -> int:
    return bits + ceil(log2(max(_relative_size(error, point), 2.0**-bits)))


def _relative_size(correction: Sequence[Any], point: Sequence[Fraction]) -> float:
    return max(float(abs(c)) / max(1.0, abs(float(u))) for c, u in zip(correction, point, strict=True))


def _exact_rows(matrix: Any) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(fraction(matrix[i, j]) for j in range(matrix.cols)) for i in range(matrix.rows))


def _checked_iterates(problem: Resonance, frame: Directions, iterates: LinearIterates) -> tuple[float, ...]:
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
