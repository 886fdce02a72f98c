"""Onto the section: the section coordinate as the independent variable (section 5.1).

From a state near the section, with section coordinate y_0, the flow is followed with
y = (1 - lambda) y_0, lambda in [0, 1]: dX/dlambda = -y_0 f(X) / f_y(X). The elapsed time is one more
component. This is again a straight-line program, so one more step of `verify.flow.step` does it.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from orbitproof.shared.systems import Program, record
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import (
    advance,
    dyadic_below,
    element_at_points,
    enclose_step,
    fixed_coefficients,
    solve_wide,
    taylor_at_points,
    wide_step_size,
)

_MOST_STEPS = 16


def build_section_program(program: Program, size: int, section: int) -> PreparedProgram:
    """The field dX/dlambda from the vector field's program, whose first `size` inputs are the state.

    Inputs: state, elapsed time, the program's other inputs, y_0; outputs: state, elapsed time.
    """

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        *own, distance = parameters
        velocity = program.evaluate([*state[:size], *own], lambda value: value, lambda base, exponent: base**exponent)
        elapsed = -(distance / velocity[section])
        slopes = [elapsed * component for component in velocity]
        slopes[section] = -distance
        return [*slopes, elapsed]

    state = (*program.inputs[:size], "elapsed time")
    return prepare(record(field, state, (*program.inputs[size:], "distance")))


def onto_section(
    program: PreparedProgram,
    section: int,
    arithmetic: Arithmetic,
    state: Sequence[Series],
    parameters: Sequence[Series],
) -> tuple[list[Series], Series]:
    """The state where the orbit meets the section, and the time that this takes (of either sign).

    Arguments:
        program: from `build_section_program`, with the same `section`.

    Raises `IntegrationFailure` if the velocity across the section is not bounded away from zero.
    """
    if arithmetic.width:
        return _wide_onto_section(program, section, arithmetic, state, parameters)
    degree = 2 * arithmetic.grading.top + 4
    short = Arithmetic(arithmetic.grading, arithmetic.bits, arithmetic.grade_bits, degree)
    start = [Series(short, x.coefs, x.errors) for x in state] + [short.constant(Fraction(0))]
    distance = start[section]
    constants = [Series(short, p.coefs, p.errors) for p in parameters] + [distance]
    centre = fixed_coefficients(
        program, [int(x.coefs[0][0]) for x in start], [int(p.coefs[0][0]) for p in constants],
        degree, short.bits, Fraction(1),
    )  # fmt: skip
    end = advance(program, short, centre, start, constants, Fraction(1)).end
    return [Series(arithmetic, x.coefs, x.errors) for x in end[:-1]], end[-1]


def _wide_onto_section(
    program: PreparedProgram,
    section: int,
    arithmetic: Arithmetic,
    state: Sequence[Series],
    parameters: Sequence[Series],
) -> tuple[list[Series], Series]:
    """The same with a wide variable: y_0 is not small, and lambda goes to 1 in steps like those of the integration."""
    current = [*state, arithmetic.constant(Fraction(0))]
    constants = [*parameters, state[section]]
    fixed = np.array([element_at_points(p) for p in constants])
    way, share = Fraction(0), 1.0
    for _ in range(_MOST_STEPS):
        start = np.array([element_at_points(x) for x in current])
        taylor = taylor_at_points(program, arithmetic.grading, start, fixed, arithmetic.degree)
        step = min(dyadic_below(share * wide_step_size(arithmetic, taylor)), 1 - way)
        try:
            approximate = solve_wide(program, arithmetic, taylor, current, constants, step)
            current = list(enclose_step(program, arithmetic, approximate, current, constants, step).end)
        except IntegrationFailure:
            share /= 2
            continue
        way += step
        if way == 1:
            return current[:-1], current[-1]
    raise IntegrationFailure(
        "section", f"the orbits of the piece were not brought onto the section in {_MOST_STEPS} steps",
        "the times of their returns differ too much: give a narrower piece",
    )  # fmt: skip
