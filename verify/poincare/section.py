"""Onto the section: the section coordinate as the independent variable (section 5.1).

From a state near the section, with section coordinate y_0, the flow is followed with
y = (1 - lambda) y_0, lambda in [0, 1]: dX/dlambda = -y_0 f(X) / f_y(X). The elapsed time is one more
component. This is again a straight-line program, so one more step of `verify.flow.step` does it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems import Program, record
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, WideArithmetic, prepare
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import advance, dyadic_below
from orbitproof.verify.poincare.oracle import Oracle

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
    oracle: Oracle,
) -> tuple[list[Series], Series]:
    """The state where the orbit meets the section, and the time that this takes (of either sign).

    Arguments:
        program: from `build_section_program`, with the same `section`.

    Raises `IntegrationFailure` if the velocity across the section is not bounded away from zero.
    """
    # Next to the section one step of low degree is enough; with a wide variable y_0 is not small.
    wide = isinstance(arithmetic, WideArithmetic)
    degree = arithmetic.degree if wide else 2 * arithmetic.grading.top + 4
    inner = replace(arithmetic, degree=degree, grade_loss=0)
    current = [Series(inner, x.coefs, x.errors) for x in state] + [inner.constant(Fraction(0))]
    constants = [Series(inner, p.coefs, p.errors) for p in parameters] + [current[section]]
    way, share = Fraction(0), 1.0
    for _ in range(_MOST_STEPS):
        expansion = oracle.expand(program, inner, current, constants)
        step = min(dyadic_below(share * expansion.step_size), 1 - way)
        try:
            current = list(advance(program, current, constants, expansion, step).end)
        except IntegrationFailure:
            if not wide:
                raise
            share /= 2
            continue
        way += step
        if way == 1:
            return [Series(arithmetic, x.coefs, x.errors) for x in current[:-1]], current[-1]
    raise IntegrationFailure(
        "section",
        f"the orbits were not brought onto the section in {_MOST_STEPS} steps",
        "the times of their returns differ too much: give a narrower piece",
    )
