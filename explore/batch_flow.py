"""The flow of many orbits at once, with derivatives: one adaptive Runge-Kutta loop over lanes.

Each orbit is a lane with a step size, a parameter and a time of its own; finished lanes wait for the others. Arrays
have the lanes last, so that each operation of the vector field works on neighbouring numbers. The derivatives are
carried by the linearised field (forward mode), and the error that chooses the steps is that of the orbit alone, as in
`explore.flow`: same method (Dormand-Prince 8, its tableau from diffrax), same tolerances.

Orbits are handed to the device in blocks: small ones that stay in the processor's cache, large ones on a GPU.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from explore.compilation import compiling, configure_jax
from explore.fields import field_of
from explore.flow import ABSOLUTE_TOLERANCE, MAX_STEPS, RELATIVE_TOLERANCE, Matrix, Vector
from shared.systems import ReversibleSystem

BLOCK = 64
GPU_BLOCK = 16384
QUEUE = 4
"""Blocks under way at the same time on the processor: enough for two cores, few enough to interrupt."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0


Matrices = np.ndarray[tuple[int, int, int], np.dtype[np.float64]]
Counts = np.ndarray[tuple[int], np.dtype[np.int64]]
Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]


@dataclass(frozen=True)
class FlowBatch:
    """The flow map at N points; quantities of orbits that failed are not meaningful.

    Attributes:
        states: shape (N, m), the states at the end.
        velocities: shape (N, m), the vector field there.
        state_transitions: shape (N, m, m), derivatives in the initial states.
        parameter_derivatives: shape (N, m), derivatives in the family parameter; zeros without one.
        crossings: shape (N,), how often the section is met after the start, the end included, at the resolution
            of the steps.
        steps: shape (N,), accepted and rejected steps; `MAX_STEPS` for an orbit that could not go on.
        finished: shape (N,), whether the end was reached with finite values.
    """

    states: Matrix
    velocities: Matrix
    state_transitions: Matrices
    parameter_derivatives: Matrix
    crossings: Counts
    steps: Counts
    finished: Flags


def flow_batch(
    system: ReversibleSystem,
    initial: Matrix,
    times: Vector,
    parameters: Matrix,
    progress: Callable[[int], None] | None = None,
) -> FlowBatch:
    """The flow of N orbits with its derivatives.

    Arguments:
        initial: shape (N, m), states at time 0.
        times: shape (N,), positive, nondimensional units of the system.
        parameters: shape (N, P), all parameters of the vector field, in its order.
        progress: called with the number of orbits done.
    """
    configure_jax()
    count, m = initial.shape
    on_processor = jax.default_backend() == "cpu"
    width = BLOCK if on_processor else min(GPU_BLOCK, max(BLOCK, 1 << (count - 1).bit_length()))
    run = _compiled(system)
    waiting: list[Any] = []
    blocks: list[tuple[np.ndarray, ...]] = []

    def collect() -> None:
        blocks.append(tuple(np.asarray(value) for value in waiting.pop(0)))
        if progress is not None:
            progress(min(count, len(blocks) * width))

    for start in range(0, count, width):
        part = slice(start, start + width)
        # Lanes that fill up the last block have time 0 and no part in it.
        fill = (0, width - len(times[part]))
        arguments = (
            np.pad(initial[part].T, ((0, 0), fill), mode="edge"),
            np.pad(times[part], fill),
            np.pad(parameters[part].T, ((0, 0), fill), mode="edge"),
        )
        with compiling():
            waiting.append(run(*arguments))
        if len(waiting) == QUEUE:
            collect()
    while waiting:
        collect()
    states, velocities, tangents, crossings, steps, finished = (
        np.concatenate([block[i] for block in blocks], axis=-1)[..., :count] for i in range(6)
    )
    extended = np.moveaxis(tangents, -1, 0)
    finished = finished & np.all(np.isfinite(extended), axis=(1, 2)) & np.all(np.isfinite(states), axis=0)
    extra = extended[:, m] if extended.shape[1] > m else np.zeros((count, m))
    return FlowBatch(
        states.T, velocities.T, np.swapaxes(extended[:, :m], 1, 2), extra, crossings.astype(np.int64),
        steps.astype(np.int64), finished,
    )  # fmt: skip


_FLOWS: dict[int, Callable[..., Any]] = {}


def _compiled(system: ReversibleSystem) -> Callable[..., Any]:
    run = _FLOWS.get(id(system))
    if run is None:
        run = _FLOWS[id(system)] = jax.jit(_integrator(system))
    return run


@cache
def _tableau() -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Rows of the stages after the first and the weights of the error, both per unit step."""
    tableau = diffrax.Dopri8.tableau
    rows = tuple(tuple(map(float, row)) for row in tableau.a_lower)
    if not tableau.fsal:
        raise RuntimeError("the last stage has to be the field at the end of the step")
    return rows, tuple(map(float, tableau.b_error))


def _combination(weights: Sequence[float], stages: Sequence[jax.Array]) -> jax.Array:
    total = jnp.zeros_like(stages[0])
    for weight, stage in zip(weights, stages, strict=True):
        if weight != 0.0:
            total = total + weight * stage
    return total


def _norm(values: jax.Array) -> jax.Array:
    return jnp.sqrt(jnp.mean(values * values, axis=0))


def _integrator(system: ReversibleSystem) -> Callable[..., Any]:
    """The integration of one block: (m, W), (W,), (P, W) to states, velocities, tangents (d, m, W), counts."""
    field = field_of(system)
    m, section = len(system.state), system.section_index
    family = system.family_parameter
    parameter_index = None if family is None else tuple(system.parameters).index(family)
    directions = m + (parameter_index is not None)
    rows, error_weights = _tableau()

    def integrate(initial: jax.Array, times: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        width = times.shape[0]
        shift = jnp.zeros((directions, len(parameters), width))
        if parameter_index is not None:
            shift = shift.at[m, parameter_index].set(1.0)

        def slopes(extended: jax.Array) -> jax.Array:
            """The field at the orbit and its derivative along the tangents, shape (1 + d, m, W)."""
            value, push = jax.linearize(field, extended[0], parameters)
            return jnp.concatenate([value[None], jax.vmap(push)(extended[1:], shift)])

        def size(values: jax.Array, *states: jax.Array) -> jax.Array:
            """Root mean square in units of the tolerance."""
            magnitude = jnp.max(jnp.abs(jnp.stack(states)), axis=0)
            return _norm(values / (ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * magnitude))

        def going(carry: tuple[jax.Array, ...]) -> jax.Array:
            time, *_, steps, _ = carry
            return jnp.any((time < times) & (steps < MAX_STEPS))

        def step(carry: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
            time, now, slope, length, crossings, steps, started = carry
            left = times - time
            active = (left > 0) & (steps < MAX_STEPS)
            stuck = active & ~(time + length > time)
            last = length >= left
            taken = jnp.where(last, left, length)
            stages, new = [slope], now
            for row in rows:
                new = now + taken * _combination(row, stages)
                stages.append(slopes(new))
            error = size(taken * _combination(error_weights, [stage[0] for stage in stages]), now[0], new[0])
            error = jnp.where(jnp.isfinite(error), error, jnp.inf)
            accepted = active & (error <= 1.0)
            factor = jnp.clip(SAFETY * jnp.maximum(error, 1e-12) ** -0.125, SHRINK, GROW)
            crossed = accepted & started & ~last & (now[0, section] * new[0, section] < 0)
            return (
                jnp.where(accepted, jnp.where(last, times, time + taken), time),
                jnp.where(accepted, new, now),
                jnp.where(accepted, stages[-1], slope),
                jnp.where(active, taken * factor, length),
                crossings + crossed,
                jnp.where(stuck, MAX_STEPS, steps + active),
                started | accepted,
            )

        start = jnp.concatenate([initial[None], jnp.zeros((directions, m, width))])
        start = start.at[1 : 1 + m].set(jnp.broadcast_to(jnp.eye(m)[:, :, None], (m, m, width)))
        slope = slopes(start)
        # A first step over which the orbit moves by some percent of its distance from the origin.
        length = 0.03 * _norm(initial) / _norm(slope[0])
        length = jnp.where(length > 0, jnp.minimum(times, length), times)
        none = jnp.zeros(width, dtype=int)
        time, end, slope, _, crossings, steps, _ = jax.lax.while_loop(
            going, step, (jnp.zeros(width), start, slope, length, none, none, jnp.zeros(width, dtype=bool))
        )
        return end[0], slope[0], end[1:], crossings + 1, steps, time >= times

    return integrate
