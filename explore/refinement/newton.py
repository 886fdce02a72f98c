"""Newton refinement of bifurcation points to high precision, up to the box for the verifier.

The equations are those of `explore.refinement.resonance` (Appendix B of the paper). Only the last evaluation has full
precision: the precision of the others is what the point is good for, and the derivative of g is computed anew only
where an old one would take more evaluations. The jets that give the box give it along the family as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil, inf, isfinite, log2
from typing import Any

import numpy as np

from orbitproof.explore.numerics import fraction, working_context
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
)
from orbitproof.explore.refinement.taylor import IntegrationFailure
from orbitproof.shared.formats import KINDS, LEADING_POWERS, ONCE, Candidate
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

NEIGHBOURHOOD = 1e-3
"""Largest distance from the guess, relative where a coordinate exceeds 1."""

SINGULAR = 1e-9
"""Margin (see `RefinedPoint`) below which an iterate P^i, i < k, counts as resonant itself."""

MAXIMAL_ITERATIONS = 14

FIRST_PRECISIONS = (80, 160, 320)
"""Bits of working precision that are tried for the first step."""

KNOWN_BITS = 90
"""The box is made for a point that is known to so many bits or more."""

ASSUMED_LOSS = 8
"""Bits that a step is thought to leave of the square of the last, until two steps show it."""

SLOPE_MARGIN = 8
"""Bits of a slope beyond those that are needed."""

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
        residual: Newton correction that is left at the centre, in the frame's coordinates: the last one, times what
            the steps before it say about the next.
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
        newton = _Newton(problem, guess, report)
        newton.approach(2 / 3 * _enough(digits), _enough(digits))
        margins = _checked_iterates(problem, newton.frame(), newton.at.iterates)
        geometry = newton.geometry(_enough(digits) / 3)
        width = half_width(geometry, digits, k, _lost_in_own_coordinates(newton), system.family_parameter is None)
        digits_of_centre = max(digits, digits_for(width) - MARGIN_DIGITS // 2)
        residual = newton.finish(digits_of_centre)
    except IntegrationFailure as failure:
        raise RefinementFailure(str(failure)) from None
    point, frame, at = newton.point, newton.frame(), newton.at
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


@dataclass(frozen=True)
class _FirstStep:
    """The first Newton step, with `bits` of working precision of which `lost_bits` did not reach the correction."""

    at: LinearisedResonance
    correction: list[Any]
    slope: list[Any]
    bits: int
    lost_bits: int


def _first_step(problem: Resonance, point: Sequence[Fraction]) -> _FirstStep:
    """Newton's correction at the guess, and the precision that the flow loses, from two evaluations."""
    for bits in FIRST_PRECISIONS:
        coarse, fine = (linearise(problem, point, b) for b in (bits, bits + 32))
        slope = resonance_slope(problem, point, coarse, bits)
        corrections = [newton_correction(problem, at, slope) for at in (coarse, fine)]
        lost = _lost_bits([a - b for a, b in zip(*corrections, strict=True)], point, bits)
        if lost < bits / 2:
            return _FirstStep(fine, corrections[1], slope, bits + 32, lost)
    raise RefinementFailure(TOO_MANY_LOST)


def _lost_bits(error: Sequence[Any], point: Sequence[Fraction], bits: int) -> int:
    return bits + ceil(log2(max(_relative_size(error, point), 2.0**-bits)))


class _Newton:
    """Newton's method on its way to a bifurcation point.

    Attributes:
        point, at: after the last correction, and the evaluation that gave it, at the point before.
        known: bits to which the point is known.
        iterations: see `RefinedPoint`.
        lost_bits: bits of working precision that the flow loses.
    """

    def __init__(self, problem: Resonance, guess: Sequence[float], report: Callable[[str, float], None]) -> None:
        self.problem, self._report = problem, report
        self.point = [Fraction(float(x)) for x in guess]
        if problem.parity is not None:
            if abs(self.point[problem.parity.odd[0]]) > NEIGHBOURHOOD:
                raise RefinementFailure("the symmetry does not fix the guess")
            self.point[problem.parity.odd[0]] = Fraction(0)
        self._seed = list(self.point)
        self.iterations: list[tuple[int, float]] = []
        self._last = self._expected = inf
        self._loss = float(ASSUMED_LOSS)
        self.report("first Newton step")
        first = _first_step(problem, self.point)
        self.lost_bits = first.lost_bits
        self._guard = GUARD_BITS + first.lost_bits
        self._slope, self._slope_bits = first.slope, float(FIRST_BITS)
        self._slope_place = self._across = self._on_family = 0.0
        self._move(first.at, first.correction, first.bits - self._guard, fresh=True)

    def report(self, message: str) -> None:
        """What is done now, with a fraction that nobody knows before."""
        self._report(message, 1 - 0.7 ** len(self.iterations))

    def approach(self, wanted: float, enough: float) -> None:
        """Go on until the point is known to `wanted` bits, from where one step with a new slope leads to `enough`."""
        wanted = max(wanted, KNOWN_BITS)
        while self.known < wanted:
            reach = self.known + min(self.known, self._slope_place)
            if reach - self._loss > wanted and self._across > enough / 6:
                reach = max(reach, enough + self._loss - self._across)
            self._step(max(FIRST_BITS, ceil(reach)), self.known / 4)

    def geometry(self, slope_bits: float) -> BranchGeometry:
        """The branches at the point; their jets give a slope of so many bits as well."""
        self.report("curvatures")
        problem, frame = self.problem, self.frame()
        about = problem.system, problem.parameters, self.point, frame
        context = working_context(ceil(slope_bits) + SLOPE_MARGIN + self._guard)
        if problem.is_fold:
            return fold_geometry(*about, context, problem.regularisation, problem.crossings)
        found = branch_geometry(
            *about, problem.k, problem.tangential, context, problem.regularisation, problem.crossings
        )
        # Along the family the derivative of g is G_01 for p_1 of the length that it has in g. Across it the old slope
        # does: there the equations pi_q P = 0 have their own derivatives, which are always new.
        (_, share, *_) = context.lu_solve(frame.columns, context.matrix(self.at.right))
        tangent = [frame.columns[j, 0] for j in problem.unknowns]
        change = found.mixed * share - sum(a * t for a, t in zip(self._slope, tangent, strict=True))
        length = sum(t * t for t in tangent)
        self._slope = [a + change * t / length for a, t in zip(self._slope, tangent, strict=True)]
        self._slope_bits, self._slope_place = slope_bits + SLOPE_MARGIN, -log2(self._last)
        return found

    def finish(self, digits: int) -> float:
        """The point to so many digits; returns how far it is from Newton's limit, in the frame's coordinates."""
        goal, enough = _goal(digits), _enough(digits)
        self.approach((enough + self._loss) / 2 + SLOPE_MARGIN, enough)
        while True:
            # With other bits than the step before, whose rounding errors this one sees.
            self._step(goal + CHECK_BITS, enough - self.known)
            if self.known >= enough:
                columns, correction = self.frame().columns, self.at.context.matrix(self._correction)
                size = max(abs(x) for x in self.at.context.lu_solve(columns, correction))
                return max(float(size) / self._last * 2.0**-self.known, 2.0 ** -(goal + CHECK_BITS))
            # The flow may lose more digits than the guard bits allow for.
            self._guard += ceil(enough - self.known)

    def correction_in(self, problem: Resonance, bits: int) -> list[Any]:
        """The correction at the point, followed in the coordinates of another problem."""
        return newton_correction(problem, linearise(problem, self.point, bits), self._slope)

    def frame(self) -> Frame:
        """The frame for a box about the point."""
        return self.problem.frame(self.point, self.at.iterates, self.at.context, self.problem.tangential)

    def _step(self, target: int, slope_bits: float) -> None:
        """A step with working precision for `target` bits, by a slope of so many bits: a new one if it has to be."""
        if len(self.iterations) == MAXIMAL_ITERATIONS:
            raise RefinementFailure(f"Newton's method did not converge in {MAXIMAL_ITERATIONS} iterations")
        bits = target + self._guard
        self.report(f"Newton step {len(self.iterations) + 1} with {bits} bits")
        at = linearise(self.problem, self.point, bits)
        # The old slope has to be good enough for what is left across the family, too.
        across = self._on_family + self._across - self._loss < self.known + slope_bits
        fresh = across or slope_bits > min(self._slope_bits, self._slope_place - self._loss)
        if fresh:
            self._slope_bits = max(FIRST_BITS, slope_bits + SLOPE_MARGIN)
            self._slope = resonance_slope(self.problem, self.point, at, ceil(self._slope_bits) + self._guard)
        self._move(at, newton_correction(self.problem, at, self._slope), target, fresh)

    def _move(self, at: LinearisedResonance, correction: list[Any], target: int, fresh: bool) -> None:
        """Apply a correction from an evaluation that is right to `target` bits; `fresh`: by a slope at its point."""
        size = _relative_size(correction, self.point)
        self.iterations.append((target + self._guard, size))
        self.at, self._correction = at, correction
        self.point = [_moved(u, c, target + self._guard) for u, c in zip(self.point, correction, strict=True)]
        strays = any(abs(u - s) > NEIGHBOURHOOD * max(1, abs(s)) for u, s in zip(self.point, self._seed, strict=True))
        if strays or not size < NEIGHBOURHOOD or (size > 1e-4 and size > self._last):
            raise RefinementFailure("Newton's method leaves the neighbourhood of the guess")
        size = max(size, 2.0**-target)
        near = -log2(size)
        if self._last < inf:
            self._loss = max(0.0, -near - log2(self._expected))
        if fresh:
            self._slope_place = self._across = near
        # Quadratic convergence, or linear with an older slope, with the constant seen in the last two steps.
        best = min(near, self._slope_place)
        gain = min(best - self._loss, self._slope_bits)
        self.known = min(float(target), near + gain, max(near, self._on_family) + self._across - self._loss)
        self._on_family = min(float(target), 2 * near - self._loss)
        self._last, self._expected = size, max(size * 2.0 ** -min(best, self._slope_bits), 2.0**-target)


def _goal(digits: int) -> int:
    return ceil((digits + MARGIN_DIGITS) * log2(10))


def _enough(digits: int) -> int:
    return ceil((digits + MARGIN_DIGITS / 2) * log2(10)) + 4


def _lost_in_own_coordinates(newton: _Newton) -> int:
    """How the box has to shrink was found from the bits that are lost in the system's own coordinates."""
    if newton.problem.regularisation is None:
        return newton.lost_bits
    own = replace(newton.problem, regularisation=None)
    for bits in FIRST_PRECISIONS:
        coarse = newton.correction_in(own, bits)
        # Where the point is known to more bits its correction is the error.
        fine = [0] * len(coarse) if newton.known > bits + 8 else newton.correction_in(own, bits + 32)
        lost = _lost_bits([a - b for a, b in zip(coarse, fine, strict=True)], newton.point, bits)
        if lost < bits / 2:
            return lost
    raise RefinementFailure(TOO_MANY_LOST)


def _relative_size(correction: Sequence[Any], point: Sequence[Fraction]) -> float:
    return max(float(abs(c)) / max(1.0, abs(float(u))) for c, u in zip(correction, point, strict=True))


def _moved(value: Fraction, correction: Any, bits: int) -> Fraction:
    moved = value + fraction(correction)
    scale = 1 << bits
    return Fraction(round(moved * scale), scale)


def _exact_rows(matrix: Any) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(fraction(matrix[i, j]) for j in range(matrix.cols)) for i in range(matrix.rows))


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
