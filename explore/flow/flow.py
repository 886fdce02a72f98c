"""Half returns of a reversible system in float64, compiled once per system.

The flow map over a given time and its derivative in the initial state and in the family parameter
come from one call. Parameters and times are traced arguments, so that every mass parameter and
every orbit shares the compiled code. The vector field stands once in it: with diffrax, which has it four times and
much around it, the first orbit takes three times as long, most of it for tracing and compiling, and diffrax has to be
loaded. The steps, their errors and their limits are those of diffrax but for the first; the error of the orbit chooses
them, and that of its derivatives where these are much larger.
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
from orbitproof.explore.flow.fields import beginning, extended_field
from orbitproof.explore.flow.runge_kutta import MAX_STEPS, growth, measured, square_tableau
from orbitproof.shared.systems import ReversibleSystem

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_FIRST_STEP = 0.01
"""Length of the first step that is tried, as a part of the time."""


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
    lower, error_weights = square_tableau()

    def half_return(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        slopes, start = extended_field(system, parameters), jnp.asarray(beginning(system, initial, parameters))
        whole, sign = jnp.abs(time), jnp.sign(time)

        def goes_on(at: tuple[jax.Array, ...]) -> jax.Array:
            elapsed, attempts = at[0], at[5]
            return (attempts == 0) | ((elapsed < whole) & (attempts < MAX_STEPS))

        def step(at: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
            elapsed, extended, slope, length, accepted, attempts, path = at

            def moved(weights: jax.Array, stages: jax.Array) -> jax.Array:
                return sign * length * (weights @ stages.reshape(len(stages), -1)).reshape(start.shape)

            def stage(number: jax.Array, carry: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
                end = extended + moved(jnp.asarray(lower)[number], carry[1])
                return end, carry[1].at[number].set(slopes(end))

            # The slope at the start of a step is that at the end of the one before; only the first has to find it.
            stages = jnp.zeros((len(lower), *start.shape)).at[0].set(slope)
            end, stages = jax.lax.fori_loop(jnp.minimum(attempts, 1), len(lower), stage, (extended, stages))
            error = measured(moved(jnp.asarray(error_weights), stages), extended, end)
            good, left = error <= 1, whole - elapsed
            elapsed = jnp.where(good, jnp.where(length >= left, whole, elapsed + length), elapsed)
            extended = jnp.where(good, end, extended)
            slope = jnp.where(good, stages[-1], stages[0])
            accepted = accepted + (good & (left > 0))
            path = path.at[accepted].set(extended[0])
            length = jnp.minimum(length * growth(error), whole - elapsed)
            return elapsed, extended, slope, length, accepted, attempts + 1, path

        path = jnp.zeros((MAX_STEPS + 1, len(initial))).at[0].set(start[0])
        first = 0.0, start, jnp.zeros_like(start), _FIRST_STEP * whole, 0, 0, path
        elapsed, end, slope, _, accepted, _, path = jax.lax.while_loop(goes_on, step, first)
        reached = (elapsed >= whole) & jnp.all(jnp.isfinite(end))
        return end, slope[0], path, accepted + 1, reached

    return Flow(system, compiled(half_return))
