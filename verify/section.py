"""Onto the section: the section coordinate as the independent variable (docs/method.md, section 5.1).

From a state near the section, with section coordinate y_0, the flow is followed with
y = (1 - lambda) y_0, lambda in [0, 1]: dX/dlambda = -y_0 f(X) / f_y(X). The elapsed time is one more
component. This is again a straight-line program, so one more step of `verify.step` does it.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import Any

from shared.program import record
from shared.systems import ReversibleSystem
from verify.algebra import Arithmetic, Series
from verify.centre import fixed_coefficients
from verify.evaluation import PreparedProgram, prepare
from verify.step import advance


@cache
def section_program(name: str) -> PreparedProgram:
    """The field dX/dlambda of a system; inputs: state, elapsed time, parameters, y_0."""
    from shared.systems import SYSTEMS

    return build_section_program(SYSTEMS[name])


def build_section_program(system: ReversibleSystem) -> PreparedProgram:
    """The field dX/dlambda; inputs: state, elapsed time, parameters, y_0; outputs: state, elapsed time."""
    size = len(system.state)
    section = system.section_index

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        *own, distance = parameters
        velocity = system.vector_field(state[:size], own)
        elapsed = -(distance / velocity[section])
        slopes = [elapsed * component for component in velocity]
        slopes[section] = -distance
        return [*slopes, elapsed]

    state = (*system.state, "elapsed time")
    return prepare(record(field, state, (*system.parameters, "distance")))


def onto_section(
    system: ReversibleSystem,
    program: PreparedProgram,
    arithmetic: Arithmetic,
    state: Sequence[Series],
    parameters: Sequence[Series],
) -> tuple[list[Series], Series]:
    """The state where the orbit meets the section, and the time that this takes (of either sign).

    Raises `IntegrationFailure` if the velocity across the section is not bounded away from zero.
    """
    degree = 2 * arithmetic.grading.top + 4
    short = Arithmetic(arithmetic.grading, arithmetic.bits, arithmetic.grade_bits, degree)
    start = [Series(short, x.coefs, x.errors) for x in state] + [short.constant(Fraction(0))]
    distance = start[system.section_index]
    constants = [Series(short, p.coefs, p.errors) for p in parameters] + [distance]
    centre = fixed_coefficients(
        program, [int(x.coefs[0][0]) for x in start], [int(p.coefs[0][0]) for p in constants],
        degree, short.bits, Fraction(1),
    )  # fmt: skip
    end = advance(program, short, centre, start, constants, Fraction(1)).end
    return [Series(arithmetic, x.coefs, x.errors) for x in end[:-1]], end[-1]
