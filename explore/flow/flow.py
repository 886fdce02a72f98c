"""Half returns of a reversible system in float64, compiled once per system.

The flow map over a given time and its derivative in the initial state and in the family parameter
come from one call. Parameters and times are traced arguments, so that every mass parameter and
every orbit shares the compiled code. The error of the orbit chooses the steps, and those of its derivatives where
nearby orbits move faster (`runge_kutta.VARIATION_WEIGHT`).

The loop is our own: diffrax's took three times as long to load and to compile, and as long to run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow.compilation import compiled, configure_jax
from orbitproof.explore.flow.fields import beginning, extended_field, field_of
from orbitproof.explore.flow.runge_kutta import MAX_STEPS, extended_in_loop, first_step, growth
from orbitproof.shared.systems import ReversibleSystem

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


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


@dataclass
class Flow:
    """The flow of a system, compiled; made by `flow_of`."""

    system: ReversibleSystem
    _integrate: Callable[..., Any]
    _last: tuple[tuple[bytes, float, bytes], Matrix] | None = None

    def derivative(self, initial: Sequence[float] | Vector, time: float, parameters: Sequence[float]) -> FlowResult:
        """Flow over `time` (any sign) with its derivatives.

        Arguments:
            initial: shape (m,), state at time 0.
            time: nondimensional units of the system.
            parameters: all parameters of the vector field, in its order.

        Raises `FlowFailure` near a singularity.
        """
        start, values = np.asarray(initial, dtype=float), np.asarray(parameters, dtype=float)
        extended, velocity, path, count, done = (
            np.asarray(part) for part in self._integrate(start, float(time), values)
        )
        if not done:
            raise FlowFailure(f"the orbit could not be integrated over time {float(time):.6g} (near a singularity)")
        self._last = (start.tobytes(), float(time), values.tobytes()), path[:count].copy()
        m = len(start)
        parameter_derivative = extended[1 + m] if len(extended) > 1 + m else np.zeros(m)
        return FlowResult(extended[0], velocity, extended[1 : 1 + m].T, parameter_derivative)

    def samples(self, initial: Sequence[float] | Vector, time: float, parameters: Sequence[float]) -> Matrix:
        """States at the integrator's own steps from 0 to `time`, both ends included, shape (steps + 1, m).

        The steps are short where the orbit passes a singularity. Those of the last `derivative` are at hand.
        Raises `FlowFailure` as above.
        """
        start, values = np.asarray(initial, dtype=float), np.asarray(parameters, dtype=float)
        key = start.tobytes(), float(time), values.tobytes()
        if self._last is None or self._last[0] != key:
            self.derivative(start, time, values)
        assert self._last is not None
        return self._last[1].copy()


_FLOWS: dict[int, Flow] = {}


def flow_of(system: ReversibleSystem) -> Flow:
    """The compiled flow of `system`; compiled at its first use, then shared."""
    flow = _FLOWS.get(id(system))
    if flow is None:
        flow = _FLOWS[id(system)] = _compile(system)
    return flow


def _compile(system: ReversibleSystem) -> Flow:
    configure_jax()
    return Flow(system, compiled(_integrator(system)))


def _integrator(system: ReversibleSystem) -> Callable[..., tuple[jax.Array, ...]]:
    """From a state, a time and parameters to the extended state and the velocity at the end, the path, its number of
    states, and whether the end was reached."""
    field = field_of(system)

    def half_return(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        forward, sign, whole = extended_field(system, parameters), jnp.where(time < 0, -1.0, 1.0), jnp.abs(time)
        start = beginning(system, initial, parameters)

        def going(carry: tuple[jax.Array, ...]) -> jax.Array:
            time, _, _, _, steps, _, _ = carry
            return (time < whole) & (steps < MAX_STEPS)

        def step(carry: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
            time, now, velocity, length, steps, count, path = carry
            left = whole - time
            last = length >= left
            taken = jnp.where(last, left, length)
            end, slope, error = extended_in_loop(lambda extended: sign * forward(extended), now, taken)
            accepted = error <= 1.0
            stuck = ~(time + taken > time)
            count = count + accepted
            return (
                jnp.where(accepted, jnp.where(last, whole, time + taken), time),
                jnp.where(accepted, end, now),
                jnp.where(accepted, sign * slope[0], velocity),
                taken * growth(error),
                jnp.where(stuck, MAX_STEPS, steps + 1),
                count,
                path.at[count].set(jnp.where(accepted, end[0], path[count])),
            )

        velocity = field(start[0], parameters)
        path = jnp.zeros((MAX_STEPS + 1, start.shape[1])).at[0].set(start[0])
        time, end, velocity, _, _, count, path = jax.lax.while_loop(
            going, step, (0.0, start, velocity, first_step(start[0], velocity, whole), 0, 0, path)
        )
        return end, velocity, path, count + 1, (time >= whole) & jnp.all(jnp.isfinite(end))

    return half_return
