"""Newton's method with many digits: what is known doubles with each step, and the working precision follows it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, log2
from typing import Any

import mpmath

from orbitproof.explore.numerics.newton import STALLED
from orbitproof.explore.numerics.precision import fraction, working_context
from orbitproof.shared.numbers import round_dyadic

_MOST_STEPS = 24
_MARGIN_DIGITS = 6


@dataclass(frozen=True)
class Linearised:
    """Equations at a point.

    Attributes:
        residual: shape (m,), of mpmath.
        matrix: the derivatives, shape (m, n) with m >= n, of mpmath.
        spread: how many times the error of a solution is larger than that of the arithmetic.
        found: what else the caller wants to know about the last point.
    """

    residual: Any
    matrix: Any
    spread: float
    found: Any = None


@dataclass(frozen=True)
class GrowingDigits:
    """How far Newton's method may go, and with how many bits.

    Attributes:
        failure: raised, with one line, where there is no solution near the guess.
        farthest: largest distance from the guess, relative where an unknown exceeds 1.
        first_bits: working precision of the first step.
        guard_bits: working precision beyond the bits that are known after a step and those that the spread loses.
        growth: how many times the bits that are known before a step are aimed at.
    """

    failure: type[Exception]
    farthest: float
    first_bits: int = 90
    guard_bits: int = 40
    growth: int = 2


@dataclass(frozen=True)
class Solution:
    """Where Newton's method converged.

    Attributes:
        unknowns: exact numbers, close to the solution.
        iterations: working precision and length of each step.
        last: the equations before the last step, with the derivatives that it took.
    """

    unknowns: list[Fraction]
    iterations: tuple[tuple[int, float], ...]
    last: Linearised

    @property
    def bits(self) -> int:
        """Working precision of the last step."""
        return self.iterations[-1][0]

    @property
    def steps(self) -> int:
        """How many there were."""
        return len(self.iterations)


def bits_of(digits: int) -> int:
    """Bits of unknowns from which so many decimal digits are read, with some to spare."""
    return ceil((digits + _MARGIN_DIGITS) * log2(10))


def newton_with_digits(
    equations: Callable[[Sequence[Fraction], mpmath.MPContext], Linearised],
    guess: Sequence[Fraction],
    goal: int,
    rule: GrowingDigits,
    progress: Callable[[str, float], None] | None = None,
    *,
    enough: float | None = None,
    residual: Callable[[Sequence[Fraction], mpmath.MPContext], Any] | None = None,
) -> Solution:
    """The solution near a guess to `goal` bits; more equations than unknowns are solved in the sense of least squares.

    Arguments:
        equations: at unknowns, with the precision of a context.
        enough: a step with all bits that is shorter than 2^-enough is the last; by default than 2^-goal.
        residual: that of the equations alone, where derivatives are most of the work. They are kept as soon as one
            step more with them leads to the goal: after a step of length L they lead from an error L^2 to about L^3.

    Raises `rule.failure`, and what `equations` raises.
    """
    unknowns, bits, lost, iterations = list(guess), rule.first_bits, 0, []
    enough = goal if enough is None else enough
    here, before, kept, whole = None, 0.0, False, []
    for step in range(1, _MOST_STEPS + 1):
        if progress is not None:
            progress(f"Newton step {step} with {bits} bits", min(0.9, 1 - 0.7 ** (step - 1)))
        context = working_context(bits)
        if kept and here is not None and residual is not None:
            here = replace(here, residual=residual(unknowns, context), matrix=context.matrix(here.matrix.tolist()))
        else:
            here = equations(unknowns, context)
        correction = _correction(here, context, rule.failure)
        unknowns = [value + round_dyadic(change, bits) for value, change in zip(unknowns, correction, strict=True)]
        if any(abs(u - g) > rule.farthest * max(1.0, abs(float(g))) for u, g in zip(unknowns, guess, strict=True)):
            raise rule.failure("Newton's method leaves the neighbourhood of the guess")
        length = max(float(abs(change)) for change in correction)
        iterations.append((bits, length))
        if not kept:
            whole.append((bits, length))
        guard = rule.guard_bits + max(lost, ceil(log2(max(here.spread, 1.0))))
        if bits >= goal + guard:
            if length < 2.0**-enough:
                return Solution(unknowns, tuple(iterations), here)
            if not kept and [bits] == [each for each, last in whole[-2:-1] if STALLED * last < length < 1]:
                # Errors grow on the way by more than the spread tells, and decay again.
                lost = ceil(bits + log2(length))
                guard = rule.guard_bits + lost
        size = -log2(max(length, 2.0**-bits))
        if kept and size <= before + 10:
            residual = None  # derivatives that do not lead on are found anew from here on
        kept = residual is not None and (kept or 3 * size >= goal + guard)
        bits = goal + guard if kept else min(max(bits, ceil(rule.growth * size) + guard), goal + guard)
        before = size
    raise rule.failure(f"Newton's method did not converge in {_MOST_STEPS} steps")


def _correction(here: Linearised, context: mpmath.MPContext, failure: type[Exception]) -> list[Fraction]:
    """The x with the least |matrix x + residual|.

    mpmath's QR decomposition takes a matrix with a zero on the way down its diagonal for a singular one; so for more
    equations than unknowns the normal equations are solved, with twice the precision.
    """
    matrix, residual = here.matrix, here.residual
    try:
        if matrix.rows == matrix.cols:
            solved = context.lu_solve(matrix, residual)
        else:
            with context.workprec(2 * context.prec + 24):
                solved = context.lu_solve(matrix.T * matrix, matrix.T * residual)
        return [-fraction(value) for value in solved]
    except (ZeroDivisionError, ValueError):
        raise failure("Newton's matrix is singular: the solution is degenerate") from None
