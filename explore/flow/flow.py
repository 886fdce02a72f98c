"""Half returns of a reversible system in float64, compiled once per system.

The flow map over a given time and its derivative in the initial state and in the family parameter
come from one call. Parameters and times are traced arguments, so that every mass parameter and
every orbit shares the compiled code. diffrax integrates; the error of the orbit alone chooses the steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import diffrax
import jax
import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow.compilation import compiled, configure_jax
from orbitproof.explore.flow.fields import beginning, extended_field
from orbitproof.explore.flow.integration import integrate
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
    steps = diffrax.SubSaveAt(t0=True, steps=True, fn=lambda _time, extended, _arguments: extended[0])

    def half_return(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        slopes = extended_field(system, parameters)
        end, solution, reached = integrate(
            lambda _time, extended, _arguments: slopes(extended),
            beginning(system, initial, parameters),
            time,
            extended=True,
            save=steps,
        )
        return end, slopes(end)[0], solution.ys[1], solution.stats["num_accepted_steps"] + 1, reached

    return Flow(system, compiled(half_return))
