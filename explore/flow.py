"""Half returns of a reversible system in float64: diffrax, compiled once per system.

The flow map over a given time and its derivative in the initial state and in the family parameter
come from one call. Parameters and times are traced arguments, so that every mass parameter and
every orbit shares the compiled code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from explore.compilation import compiled, configure_jax
from explore.fields import field_of
from shared.systems import ReversibleSystem

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = 1e-14
MAX_STEPS = 4000


class FlowFailure(Exception):
    """The integration did not reach its end: too many steps or a non-finite state (a collision)."""


@dataclass(frozen=True)
class FlowResult:
    """The flow map at one point.

    Attributes:
        state: shape (m,), the state at the end.
        velocity: shape (m,), the vector field there.
        state_transition: shape (m, m), derivative of `state` in the initial state.
        parameter_derivative: shape (m,), derivative of `state` in the family parameter; zeros
            for a system without one.
    """

    state: Vector
    velocity: Vector
    state_transition: Matrix
    parameter_derivative: Vector


@dataclass(frozen=True)
class Flow:
    """The flow of a system, compiled; made by `flow_of`."""

    system: ReversibleSystem
    _derivative: Callable[..., Any]
    _samples: Callable[..., Any]

    def derivative(self, initial: Sequence[float] | Vector, time: float, parameters: Sequence[float]) -> FlowResult:
        """Flow over `time` (any sign) with its derivatives.

        Arguments:
            initial: shape (m,), state at time 0.
            time: nondimensional units of the system.
            parameters: all parameters of the vector field, in its order.

        Raises `FlowFailure` near a singularity.
        """
        state, velocity, columns, ok = self._derivative(
            np.asarray(initial, dtype=float), float(time), np.asarray(parameters, dtype=float)
        )
        m = len(self.system.state)
        jacobian = np.asarray(columns)
        if not bool(ok) or not np.all(np.isfinite(jacobian)) or not np.all(np.isfinite(np.asarray(state))):
            raise FlowFailure(f"the orbit could not be integrated over time {float(time):.6g} (near a singularity)")
        parameter_derivative = jacobian[m] if len(jacobian) > m else np.zeros(m)
        return FlowResult(np.asarray(state), np.asarray(velocity), jacobian[:m].T, parameter_derivative)

    def samples(self, initial: Sequence[float] | Vector, time: float, parameters: Sequence[float]) -> Matrix:
        """States at the integrator's own steps from 0 to `time`, both ends included, shape (steps + 1, m).

        The steps are short where the orbit passes a singularity. Raises `FlowFailure` as above.
        """
        states, count, ok = self._samples(
            np.asarray(initial, dtype=float), float(time), np.asarray(parameters, dtype=float)
        )
        result = np.asarray(states)[: int(count)]
        if not bool(ok) or not np.all(np.isfinite(result)):
            raise FlowFailure(f"the orbit could not be integrated over time {float(time):.6g} (near a singularity)")
        return result


_FLOWS: dict[int, Flow] = {}


def flow_of(system: ReversibleSystem) -> Flow:
    """The compiled flow of `system`; compiled at its first use, then shared."""
    flow = _FLOWS.get(id(system))
    if flow is None:
        flow = _FLOWS[id(system)] = _compile(system)
    return flow


def _compile(system: ReversibleSystem) -> Flow:
    configure_jax()
    field = field_of(system)
    m = len(system.state)
    names = tuple(system.parameters)
    parameter_index = None if system.family_parameter is None else names.index(system.family_parameter)
    directions = m + (parameter_index is not None)
    term = diffrax.ODETerm(lambda t, state, parameters: field(state, parameters))
    controller = diffrax.PIDController(rtol=RELATIVE_TOLERANCE, atol=ABSOLUTE_TOLERANCE)

    def solve(initial: jax.Array, time: jax.Array, parameters: jax.Array, save: diffrax.SaveAt) -> diffrax.Solution:
        return diffrax.diffeqsolve(
            term,
            diffrax.Dopri8(),
            t0=0.0,
            t1=time,
            dt0=None,
            y0=initial,
            args=parameters,
            saveat=save,
            stepsize_controller=controller,
            adjoint=diffrax.ForwardMode(),
            max_steps=MAX_STEPS,
            throw=False,
        )

    def derivative(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        def end(state: jax.Array, shift: jax.Array) -> tuple[jax.Array, jax.Array]:
            moved = parameters if parameter_index is None else parameters.at[parameter_index].add(shift)
            solution = solve(state, time, moved, diffrax.SaveAt(t1=True))
            return solution.ys[0], solution.result == diffrax.RESULTS.successful

        def push(direction: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
            value, tangent, ok = jax.jvp(end, (initial, jnp.zeros(())), (direction[:m], direction[m]), has_aux=True)
            return value, tangent, ok

        values, tangents, ok = jax.vmap(push, out_axes=(None, 0, None))(jnp.eye(directions, m + 1))
        return values, field(values, parameters), tangents, ok

    def samples(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        solution = solve(initial, time, parameters, diffrax.SaveAt(t0=True, steps=True))
        return solution.ys, 1 + solution.stats["num_accepted_steps"], solution.result == diffrax.RESULTS.successful

    return Flow(system, compiled(derivative), compiled(samples))
