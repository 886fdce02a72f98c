"""One rigorous step of the flow in the graded algebra (sections 3 and 4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpz

from orbitproof.verify.algebra import GradedNorm, PreparedProgram, Series, fraction_above, inflate
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow.expansion import Expansion
from orbitproof.verify.flow.field_along import FieldAlong
from orbitproof.verify.flow.gronwall import Floats, centre_and_norms, derivative_bounds, grown, norm_arithmetic

_ATTEMPTS = 6

Bound = Callable[[Sequence[dict[int, Series]], Floats, Floats, Fraction], Floats]
"""As `grown`; the defects, which the second argument contains, are the third one."""


@dataclass(frozen=True)
class FlowStep:
    """An enclosure of the flow over one step.

    Attributes:
        solution: known parts over theta in [0, 1], one series per state component, errors included
            that hold on the whole step.
        slopes: the vector field over the step's tube, in the norm arithmetic.
        end: the state at theta = 1, constant in theta.
    """

    solution: tuple[Series, ...]
    slopes: tuple[Series, ...]
    end: tuple[Series, ...]


def advance(
    program: PreparedProgram,
    state: Sequence[Series],
    parameters: Sequence[Series],
    expansion: Expansion,
    step: Fraction,
) -> FlowStep:
    """Enclose the solutions of x' = f(x, parameters), x(0) = state, over time `step` > 0.

    Args:
        program: the vector field.
        state: initial values, constant in theta.
        parameters: constants of motion that the program takes after the state.
        expansion: finds an approximate solution; nothing is believed of it.

    Raises `IntegrationFailure` if no tube was found in which the solution provably stays.
    """
    along = FieldAlong(program, state[0].arithmetic, state, parameters)
    expansion.solve(along, step)
    return enclose_step(along, step)


def enclose_step(along: FieldAlong, step: Fraction, bound: Bound | None = None) -> FlowStep:
    """Enclose the solutions around an approximate one, whatever it is (as `advance`).

    Args:
        along: the approximate solution, with the vector field on it.
        bound: of the errors of the step, for which they are not taken entry by entry (section 4.4).
    """
    if not step > 0:
        raise ValueError("a step is positive")
    exact, field = along.enclosed()
    defects = np.array([_defect(solution, slope, step) for solution, slope in zip(exact, field, strict=True)])
    errors, slopes = _tube(along, exact, defects, step, bound)
    solution = tuple(x.with_errors(row) for x, row in zip(exact, errors.tolist(), strict=True))
    return FlowStep(solution, tuple(slopes), tuple(x.at_end() for x in solution))


def _defect(solution: Series, field: Series, step: Fraction) -> GradedNorm:
    """Graded norm of ``step * f(x) - dx/dtheta``."""
    arithmetic = solution.arithmetic
    numerator, denominator = fmpz(step.numerator), fmpz(step.denominator)
    shift = step.denominator.bit_length() - 1
    result = arithmetic.zero_errors()
    for position, (f, x) in enumerate(zip(field.coefs, solution.coefs, strict=True)):
        difference = f * numerator - arithmetic.derivative(x) * denominator
        if difference.length():
            result[arithmetic.grading.grades[position]] += arithmetic.size(
                difference, arithmetic.scales[position] + shift
            )
    length = fraction_above(step)
    return [inflate(known + length * error) for known, error in zip(result, field.errors, strict=True)]


@np.errstate(over="ignore", invalid="ignore")
def _tube(
    along: FieldAlong, solution: Sequence[Series], defects: Floats, step: Fraction, bound: Bound | None
) -> tuple[Floats, list[Series]]:
    """Errors that hold on the whole step, and the vector field on the tube (section 4.3)."""
    arithmetic = along.arithmetic
    coarse = norm_arithmetic(arithmetic)
    start = np.array([[*map(inflate, x.errors + row)] for x, row in zip(along.state, defects, strict=True)])
    constants = [centre_and_norms(coarse, p, arithmetic.zero_errors()) for p in along.parameters]
    tube = 16.0 * start + 2.0**-950
    for _ in range(_ATTEMPTS):
        inputs = [centre_and_norms(coarse, x, row) for x, row in zip(solution, tube.tolist(), strict=True)]
        derivatives, slopes = derivative_bounds(along.program, len(solution), [*inputs, *constants])
        errors = grown(derivatives, start, step) if bound is None else bound(derivatives, start, defects, step)
        if bool(np.all(errors < tube)) and bool(np.all(np.isfinite(tube))):
            return errors, slopes
        tube = 4.0 * errors
        if not bool(np.all(np.isfinite(tube))):
            break
    raise IntegrationFailure(
        "tube",
        "no tube around the approximate solution holds all orbits over one step",
        "the box is too large for its orbit: give smaller radii",
        needs_precision=True,
    )
