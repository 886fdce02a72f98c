"""Newton refinement of bifurcation points to high precision, up to the box for the verifier.

The equations are those of `explore.refinement.resonance` (Appendix B of the paper). Floats find the derivative of g,
and two evaluations with few bits what the orbit loses and the point to half of its digits. There jets in floats give
the box, and the box says how many digits the centre needs: one more evaluation gives them. The derivative of g that it
needs is that in the direction of the last step alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, floor, inf, isfinite, log2
from typing import Any

import numpy as np

from orbitproof.explore.numerics import bits_of, fraction, working_context
from orbitproof.explore.refinement.crossing import shorter_coordinates
from orbitproof.explore.refinement.floats import FLOAT_BITS
from orbitproof.explore.refinement.frames import Directions, Parity, RefinementFailure, dot, parity_of
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
    solved_step,
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

PRECISIONS = ((FLOAT_BITS, 88), (80, 128), (160, 208), (320, 368))
"""Bits of the derivative of g and of the first step with it that are tried; the first are those of floats."""

OWN_PRECISIONS = (80, 160, 320)
"""Bits that are tried to learn what is lost in the system's own coordinates."""

FINER_BITS = 48
"""So many more has the evaluation that tells how many of them are lost where the point is not known so well."""

CLOSE = 32
"""Bits to which the guess is improved by steps with as few bits as the derivative of g."""

FLOAT_BITS_LEFT = 10
"""Bits that floats have to leave, by an estimate that was found to be twenty too low."""

GEOMETRY_BITS = 60
"""Accuracy of slopes and curvatures of the branches where floats leave too little."""

ASSUMED_LOSS = 8
"""Bits that a step is thought to leave of the square of the last."""

MOST_STEPS = 12

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
        newton = _Newton(problem, guess)
        newton.begin()
        at = newton.at
        frame = problem.frame(newton.point, at.iterates, at.context, problem.tangential)
        margins = _checked_iterates(problem, frame, at.iterates)
        report("curvatures", 0.3)
        geometry = newton.geometry(frame)
        lost = newton.lost_in_own_coordinates()
        width = half_width(geometry, digits, k, lost, system.family_parameter is None)
        digits_of_centre = max(digits, digits_for(width) - MARGIN_DIGITS // 2)
        goal = bits_of(digits_of_centre)
        report(f"Newton's method with {goal + newton.guard_bits} bits", 0.5)
        correction, error = newton.finish(goal)
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None
    point, at = newton.point, newton.at
    frame = problem.frame(point, at.iterates, at.context, problem.tangential)
    correction = at.context.lu_solve(frame.columns, at.context.matrix(correction))
    residual = max(max(float(abs(x)) for x in correction) * error, 2.0**-goal)
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
        iterations=tuple(newton.iterations),
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


class _Newton:
    """Newton's method, in the coordinates that it moves.

    Attributes:
        point: where it is.
        at: the equations at the point before.
        iterations: precision and length of each step.
        lost_bits: of working precision, which do not reach the correction.
        known_bits: of the point.
    """

    at: LinearisedResonance

    def __init__(self, problem: Resonance, guess: Sequence[float]) -> None:
        self.problem, self._seed = problem, [Fraction(float(x)) for x in guess]
        if problem.parity is not None:
            if abs(self._seed[problem.parity.odd[0]]) > NEIGHBOURHOOD:
                raise RefinementFailure("the symmetry does not fix the guess")
            self._seed[problem.parity.odd[0]] = Fraction(0)
        self.point, self.iterations = self._seed, list[tuple[int, float]]()
        self.lost_bits, self.known_bits, self._slope_bits, self._slope = 0, 0, 0, list[Any]()
        self._floats_do, self._bend = False, 2.0**ASSUMED_LOSS

    @property
    def guard_bits(self) -> int:
        """Working precision beyond the accuracy aimed at."""
        return GUARD_BITS + self.lost_bits

    def begin(self) -> None:
        """To the point with half of its digits or so."""
        for few, first in PRECISIONS:
            self.point, self.iterations = self._seed, []
            try:
                if self._approached(few, first):
                    self._floats_do = few == FLOAT_BITS
                    return
            except IntegrationFailure:
                if (few, first) == PRECISIONS[-1]:
                    raise
        raise RefinementFailure(TOO_MANY_LOST)

    def _approached(self, few: int, first: int) -> bool:
        """Whether so many bits are enough: improve the guess, and then make two steps with one derivative of g."""
        problem, before = self.problem, inf
        while True:
            self.at = linearise(problem, self.point, few)
            self._slope = resonance_slope(problem, self.point, self.at, few)
            coarse = newton_correction(problem, self.at, self._slope)
            length = _relative_size(coarse, self.point)
            if length < 2.0**-CLOSE:
                break
            if length > before / 4 or len(self.iterations) == MOST_STEPS:
                return False
            before = length
            self._move(coarse)
        at = linearise(problem, self.point, first)
        fine = newton_correction(problem, at, self._slope)
        lost = _lost_bits([a - b for a, b in zip(coarse, fine, strict=True)], self.point, few)
        if lost >= few / 2:
            return False
        self.at, self._slope_bits = at, few - lost - ASSUMED_LOSS
        self._move(fine)
        # The next step tells how many bits the one before lost, and how the derivative of g, found anew, has changed.
        # Where the square of a step is longer than what can be lost, it is one more step on the way.
        bits = first + self._slope_bits + 2 * ASSUMED_LOSS
        while True:
            self.at = linearise(problem, self.point, bits)
            stale = newton_correction(problem, self.at, self._slope)
            self._slope = resonance_slope(problem, self.point, linearise(problem, self.point, few), few)
            step = newton_correction(problem, self.at, self._slope)
            self.lost_bits = _lost_bits(step, self.point, first)
            length, before = max(_size(step), 2.0**-bits), _size(fine)
            self._bend = max(self._bend, _size([a - b for a, b in zip(stale, step, strict=True)]) / (length * before))
            self.known_bits = min(floor(self._slope_bits - log2(length)), bits - self.guard_bits)
            self._move(step)
            if self.lost_bits < first / 2:
                return True
            if length > before / 4:
                return False
            fine, first = step, bits

    def finish(self, goal: int) -> tuple[list[Any], float]:
        """To the point with so many bits: the last correction, and which part of it is left as an error."""
        problem, bits = self.problem, goal + self.guard_bits
        for _ in range(MOST_STEPS):
            self.at = linearise(problem, self.point, bits)
            step = newton_correction(problem, self.at, self._slope)
            length = max(_size(step), 2.0**-bits)
            needed = max(ceil(goal + ASSUMED_LOSS + log2(length)), ASSUMED_LOSS)
            change, left = self._exact_in_its_direction(step, needed)
            step = [a + b for a, b in zip(step, change, strict=True)]
            self._move(step)
            error = left + self._bend * length + 2.0**-needed
            if error * length < 2.0**-goal:
                return step, error
        raise RefinementFailure(f"Newton's method did not converge in {MOST_STEPS} steps")

    def _exact_in_its_direction(self, step: Sequence[Any], bits: int) -> tuple[list[Any], float]:
        """What the derivative of g in the direction of a step, with so many bits, changes about the step; the part of
        the step that is left as an error.

        The change is along the curve of symmetric orbits. The derivative there is that along the step, and the old one
        for the part of the curve's tangent that is across it.
        """
        problem, moving = self.problem, self.problem.unknowns
        residual, matrix = newton_equations(problem, self.at, self._slope)
        size = max(abs(x) for x in step)
        if not size:
            return list(step), 0.0
        along = [x / size for x in step]
        (slope,) = resonance_slope(problem, self.point, self.at, bits + self.guard_bits, [along])
        last = matrix.rows - 1
        tangent = solved_step(problem, self.at, matrix, [0] * last + [-1])
        part = dot(tangent, along) / dot(along, along)
        across = [a - part * b for a, b in zip(tangent, along, strict=True)]
        slope_of_tangent = part * slope + sum(each * across[j] for each, j in zip(self._slope, moving, strict=True))
        change = [-(residual[last] + slope * size) / slope_of_tangent * x for x in tangent]
        left = _size(change) / float(size)
        return change, left * max(left, 2.0**-self._slope_bits) * _size(across) / _size(tangent)

    def _move(self, correction: Sequence[Any]) -> None:
        bits = self.at.context.prec
        self.iterations.append((bits, _size(correction)))
        self.point = [u + round_dyadic(fraction(c), bits) for u, c in zip(self.point, correction, strict=True)]
        if any(
            abs(u - g) > NEIGHBOURHOOD * max(1.0, abs(float(g))) for u, g in zip(self.point, self._seed, strict=True)
        ):
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")

    def geometry(self, frame: Directions) -> BranchGeometry:
        """Slopes and curvatures at the point, in floats where they leave enough."""
        growth = max(float(abs(value)) for value in self.at.iterates.matrices[-1])
        left = self._slope_bits - log2(max(growth, 1.0))
        floats = self._floats_do and left > FLOAT_BITS_LEFT
        context = working_context(FLOAT_BITS if floats else GEOMETRY_BITS + self.guard_bits)
        problem = self.problem
        about = problem.system, problem.parameters, self.point, frame
        if problem.is_fold:
            return fold_geometry(*about, context, problem.regularisation, problem.crossings)
        how = problem.k, problem.tangential, context, problem.regularisation, problem.crossings
        return branch_geometry(*about, *how)

    def lost_in_own_coordinates(self) -> int:
        """How the box has to shrink was found from the bits that are lost in the system's own coordinates."""
        if self.problem.regularisation is None:
            return self.lost_bits
        own = replace(self.problem, regularisation=None)
        for bits in OWN_PRECISIONS:
            error = newton_correction(own, linearise(own, self.point, bits), self._slope)
            if self.known_bits < bits + ASSUMED_LOSS:
                exact = newton_correction(own, linearise(own, self.point, bits + FINER_BITS), self._slope)
                error = [a - b for a, b in zip(error, exact, strict=True)]
            lost = _lost_bits(error, self.point, bits)
            if lost < bits / 2:
                return lost
        raise RefinementFailure(TOO_MANY_LOST)


def _size(vector: Sequence[Any]) -> float:
    return max(float(abs(value)) for value in vector)


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
