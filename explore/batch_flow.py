"""The flow of many orbits at once, with derivatives: one adaptive Runge-Kutta loop over lanes.

Each orbit is a lane with a step size, a parameter and a time of its own. Arrays have the lanes last, so that each
operation of the vector field works on neighbouring numbers. The derivatives are carried by the linearised field
(forward mode), and the error that chooses the steps is that of the orbit alone, as in `explore.flow`: same method
(Dormand-Prince 8, its tableau from diffrax), same tolerances.

Lanes are handed to the device in blocks: small ones that stay in the processor's cache, large ones on a GPU. A block
advances a few steps at a time. Between these rounds the unfinished orbits are grouped anew by the steps that they
still need: an orbit close to a collision needs twenty times as many as another, which does not have to wait for it.
"""

from __future__ import annotations

from collections import deque
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
"""Blocks under way at the same time."""

ROUND = 48
"""Steps of a round."""

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


@dataclass(frozen=True)
class _Lanes:
    """Where N orbits are; the lanes come last.

    `extended`, shape (1 + d, m, N), is the state and its derivatives; `length` the next step, 0 before the first;
    `started` tells the first accepted step, which leaves the section, from those that may cross it.
    """

    time: np.ndarray
    extended: np.ndarray
    slope: np.ndarray
    length: np.ndarray
    crossings: np.ndarray
    steps: np.ndarray
    started: np.ndarray

    def arrays(self) -> tuple[np.ndarray, ...]:
        return tuple(vars(self).values())


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
        times: shape (N,), nondimensional units of the system; an orbit with a time that is not positive fails.
        parameters: shape (N, P), all parameters of the vector field, in its order.
        progress: called with the number of orbits done.
    """
    configure_jax()
    advance = _compiled(system)
    lanes = _start(system, initial)
    pending = np.flatnonzero(times > 0)
    while len(pending):
        _round(advance, lanes, times, parameters, pending)
        left = times[pending] - lanes.time[pending]
        going = (left > 0) & (lanes.steps[pending] < MAX_STEPS)
        needed = (lanes.steps[pending] * left)[going] / np.maximum(lanes.time[pending][going], 1e-300)
        pending = pending[going][np.argsort(needed, kind="stable")]
        if progress is not None:
            progress(len(times) - len(pending))
    return _result(system, lanes, times)


def _start(system: ReversibleSystem, initial: Matrix) -> _Lanes:
    count, m = initial.shape
    extended = np.zeros((1 + m + (system.family_parameter is not None), m, count))
    extended[0] = initial.T
    extended[1 + np.arange(m), np.arange(m)] = 1.0
    none = np.zeros(count, dtype=np.int64)
    return _Lanes(
        time=np.zeros(count), extended=extended, slope=np.zeros((m, count)), length=np.zeros(count),
        crossings=none, steps=none.copy(), started=np.zeros(count, dtype=bool),
    )  # fmt: skip


def _result(system: ReversibleSystem, lanes: _Lanes, times: Vector) -> FlowBatch:
    m = len(system.state)
    columns = np.moveaxis(lanes.extended, -1, 0)
    finished = (times > 0) & (lanes.time >= times) & np.all(np.isfinite(columns), axis=(1, 2))
    return FlowBatch(
        states=columns[:, 0], velocities=lanes.slope.T, state_transitions=np.swapaxes(columns[:, 1 : 1 + m], 1, 2),
        parameter_derivatives=columns[:, -1] if columns.shape[1] > 1 + m else np.zeros((len(times), m)),
        crossings=lanes.crossings + 1, steps=lanes.steps, finished=finished,
    )  # fmt: skip


def _round(advance: Callable[..., Any], lanes: _Lanes, times: Vector, parameters: Matrix, pending: np.ndarray) -> None:
    """Advance the pending orbits by at most `ROUND` steps each."""
    on_processor = jax.default_backend() == "cpu"
    width = BLOCK if on_processor else min(GPU_BLOCK, max(BLOCK, 1 << (len(pending) - 1).bit_length()))
    waiting: deque[tuple[np.ndarray, Any]] = deque()

    def collect() -> None:
        block, values = waiting.popleft()
        for whole, part in zip(lanes.arrays(), values, strict=True):
            whole[..., block] = np.asarray(part)[..., : len(block)]

    for start in range(0, len(pending), width):
        block = pending[start : start + width]
        # Lanes that fill up the last block have no time to go and take no part.
        fill = np.append(block, np.full(width - len(block), block[0]))
        end = times[fill]
        end[len(block) :] = 0.0
        with compiling():
            waiting.append(
                (block, advance(end, parameters.T[:, fill], *(array[..., fill] for array in lanes.arrays())))
            )
        if len(waiting) == QUEUE:
            collect()
    while waiting:
        collect()


_COMPILED: dict[int, Callable[..., Any]] = {}


def _compiled(system: ReversibleSystem) -> Callable[..., Any]:
    advance = _COMPILED.get(id(system))
    if advance is None:
        advance = _COMPILED[id(system)] = jax.jit(_integrator(system))
    return advance


@cache
def _tableau() -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Rows of the stages after the first, the last of which is the step, and the weights of the error."""
    tableau = diffrax.Dopri8.tableau
    if not tableau.fsal:
        raise RuntimeError("the last stage has to be the field at the end of the step")
    return tuple(tuple(map(float, row)) for row in tableau.a_lower), tuple(map(float, tableau.b_error))


def _combination(weights: Sequence[float], stages: Sequence[jax.Array]) -> jax.Array:
    first, *others = ((weight, stage) for weight, stage in zip(weights, stages, strict=True) if weight != 0.0)
    total = first[0] * first[1]
    for weight, stage in others:
        total = total + weight * stage
    return total


def _norm(values: jax.Array) -> jax.Array:
    return jnp.sqrt(jnp.mean(values * values, axis=0))


def _integrator(system: ReversibleSystem) -> Callable[..., Any]:
    """A round for a block of W lanes: times (W,), parameters (P, W) and the arrays of `_Lanes` to new ones."""
    field = field_of(system)
    section, family = system.section_index, system.family_parameter
    parameter_index = None if family is None else tuple(system.parameters).index(family)
    rows, error_weights = _tableau()

    def advance(times: jax.Array, parameters: jax.Array, *lanes: jax.Array) -> tuple[jax.Array, ...]:
        def slopes(extended: jax.Array) -> jax.Array:
            """The field at the orbit and its derivative along each tangent, shape (1 + d, m, W)."""
            if parameter_index is None:
                value, push = jax.linearize(lambda state: field(state, parameters), extended[0])
                return jnp.concatenate([value[None], jax.vmap(push)(extended[1:])])

            def moved(state: jax.Array, shift: jax.Array) -> jax.Array:
                return field(state, parameters.at[parameter_index].add(shift))

            shifts = jnp.zeros((extended.shape[0] - 1, len(times))).at[-1].set(1.0)
            value, push = jax.linearize(moved, extended[0], shifts[0])
            return jnp.concatenate([value[None], jax.vmap(push)(extended[1:], shifts)])

        def going(carry: tuple[jax.Array, ...]) -> jax.Array:
            time, _, _, _, _, steps, _, rounds = carry
            return jnp.any((time < times) & (steps < MAX_STEPS)) & (rounds < ROUND)

        def step(carry: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
            time, now, slope, length, crossings, steps, started, rounds = carry
            left = times - time
            active = (left > 0) & (steps < MAX_STEPS)
            stuck = active & ~(time + length > time)
            last = length >= left
            taken = jnp.where(last, left, length)
            stages, new = [slope], now
            for row in rows:
                new = now + taken * _combination(row, stages)
                stages.append(slopes(new))
            scale = ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * jnp.maximum(jnp.abs(now[0]), jnp.abs(new[0]))
            error = _norm(taken * _combination(error_weights, [stage[0] for stage in stages]) / scale)
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
                rounds + 1,
            )

        time, now, _, length, crossings, steps, started = lanes
        slope = slopes(now)
        # A first step over which the orbit moves by some percent of its distance from the origin.
        first = 0.03 * _norm(now[0]) / _norm(slope[0])
        length = jnp.where(length > 0, length, jnp.where(first > 0, jnp.minimum(times, first), times))
        time, now, slope, length, crossings, steps, started, _ = jax.lax.while_loop(
            going, step, (time, now, slope, length, crossings, steps, started, 0)
        )
        return time, now, slope[0], length, crossings, steps, started

    return advance
