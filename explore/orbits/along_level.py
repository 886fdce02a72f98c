"""Derivatives of the flow along a fixed level of the first integral, in double precision."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from orbitproof.explore.flow import FlowResult, Vector
from orbitproof.shared.systems import ReversibleSystem, functions_in_floats

_DIFFERENCE = 1e-6


def along_level(system: ReversibleSystem, state: Vector, values: Vector, flow: FlowResult) -> FlowResult:
    """The flow with its derivatives along the level of its initial state, if the system has a fixed level.

    The level coordinate w moves with each other coordinate and with the family parameter: dw = - H_i dx_i / H_w.

    Args:
        state: shape (m,), the initial state.
        values: all parameters, in the order of the system.
    """
    if system.fixed_level is None:
        return flow
    place, count = system.state.index(str(system.level_coordinate)), len(system.state)
    own = count + list(system.parameters).index(str(system.family_parameter))
    gradient = level_gradient(system, state, values)
    if gradient[place] == 0.0:
        # As at an equilibrium: the level does not say how w moves.
        return flow
    slopes = -gradient / gradient[place]
    slopes[place] = 0.0
    along = flow.state_transition[:, place]
    return replace(
        flow,
        state_transition=flow.state_transition + np.outer(along, slopes[:count]),
        parameter_derivative=flow.parameter_derivative + along * slopes[own],
    )


def level_gradient(system: ReversibleSystem, state: Vector, values: Vector) -> Vector:
    """Derivatives of the first integral in state and parameters, by differences."""
    assert system.first_integral is not None
    point, count, slopes = np.concatenate([state, values]), len(state), []
    for i, value in enumerate(point):
        step = np.zeros(len(point))
        step[i] = _DIFFERENCE * (1 + abs(float(value)))
        ends = [
            float(system.first_integral(functions_in_floats(system, end[:count], end[count:]), end[count:].tolist())[0])
            for end in (point + step, point - step)
        ]
        slopes.append((ends[0] - ends[1]) / (2 * step[i]))
    return np.array(slopes)
