"""The vector field with the section coordinate as the independent variable (section 5.1).

From a state near the section, with section coordinate y_0, the flow is followed with
y = (1 - lambda) y_0, lambda in [0, 1]: dX/dlambda = -y_0 f(X) / f_y(X). The elapsed time is one more
component. This is again a straight-line program.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from orbitproof.shared.systems import Program, own_name, record
from orbitproof.verify.algebra import PreparedProgram, prepare


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

    state = (*program.inputs[:size], own_name("elapsed time"))
    return prepare(record(field, state, (*program.inputs[size:], own_name("distance"))))
