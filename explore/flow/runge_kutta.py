"""Adaptive Runge-Kutta steps for many orbits at once: Dormand-Prince 8, its tableau from diffrax.

A loop over orbits with steps of their own, or with something to watch on the way, is written with these; a single
orbit is integrated by diffrax (`explore.flow.flow`) with the same tolerances. Everything here is called while JAX
traces a loop. Arrays have the state coordinates second to last and the orbits last.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import diffrax
import jax
import jax.numpy as jnp

from orbitproof.explore.flow.fields import Slopes

RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = 1e-14
MAX_STEPS = 5000
"""Attempted steps. Some 4200 lead through the orbits closest to a primary that shooting in float64 reaches."""

VARIATION_WEIGHT = 1e-3
"""Weight of the errors of derivatives of an orbit, each relative to the size of its row, beside those of the orbit: it
makes steps shorter only where nearby orbits move faster than the orbit, as across a linear mode."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0


@cache
def _tableau() -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Rows of the stages after the first, the last of which is the step, and the weights of the error."""
    tableau = diffrax.Dopri8.tableau
    if not tableau.fsal:
        raise RuntimeError("the last stage has to be the field at the end of the step")
    return tuple(tuple(map(float, row)) for row in tableau.a_lower), tuple(map(float, tableau.b_error))


def first_step(state: jax.Array, velocity: jax.Array, times: jax.Array) -> jax.Array:
    """A length of the first step, over which the orbit moves by some percent of its distance from the origin."""
    length = 0.03 * norm(state) / norm(velocity)
    return jnp.where(length > 0, jnp.minimum(times, length), times)


def attempt(slopes: Slopes, start: jax.Array, slope: jax.Array, length: jax.Array) -> tuple[jax.Array, list[jax.Array]]:
    """Where a step of the given length leads, and the slopes at its stages, the last of them that at its end."""
    stages, end = [slope], start
    for row in _tableau()[0]:
        end = start + length * _combination(row, stages)
        stages.append(slopes(end))
    return end, stages


def extended_error(start: jax.Array, end: jax.Array, stages: Sequence[jax.Array], length: jax.Array) -> jax.Array:
    """The error of a step of extended states, shape (1 + d, m, ..), in units of the tolerance, one for each orbit."""
    error = _scaled(
        length * _combination(_tableau()[1], stages), scales(start), scales(end), RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE
    )
    return weighted(error)


def scales(extended: jax.Array) -> jax.Array:
    """What errors of an extended state are relative to: each coordinate of the orbit, the size of each derivative."""
    rows = jnp.maximum(1.0, jnp.max(jnp.abs(extended[1:]), axis=1, keepdims=True))
    return jnp.concatenate([extended[:1], jnp.broadcast_to(rows, extended[1:].shape)])


def weighted(error: jax.Array) -> jax.Array:
    """The error of an extended state from its scaled parts."""
    variations = jnp.max(norm(jnp.moveaxis(error[1:], 1, 0)), axis=0)
    return jnp.maximum(norm(error[0]), VARIATION_WEIGHT * variations)


def attempt_in_loop(
    slopes: Slopes, start: jax.Array, slope: jax.Array, length: jax.Array, relative: float, absolute: float
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """A step of complex states of shape (m, N), like `attempt`: where it leads, the slope there, its scaled error.

    The vector field stands once in the compiled code, which takes an eighth of the time to compile. The stages are
    rows of real numbers: their combinations are then products with a real matrix, as fast as those written out.
    """
    rows, error_weights = _tableau()
    lower = jnp.array([[*row, *[0.0] * (1 + len(rows) - len(row))] for row in rows])

    def real(values: jax.Array) -> jax.Array:
        return jnp.stack([values.real, values.imag]).reshape(-1)

    def complex_(row: jax.Array) -> jax.Array:
        return jax.lax.complex(*row.reshape(2, *start.shape))

    def stage(number: jax.Array, carry: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        stages = carry[1]
        end = real(start) + length * (lower[number] @ stages)
        return end, stages.at[number + 1].set(real(slopes(complex_(end))))

    first = jnp.zeros((1 + len(rows), 2 * start.size)).at[0].set(real(slope))
    end, stages = jax.lax.fori_loop(0, len(rows), stage, (real(start), first))
    error = length * complex_(jnp.array(error_weights) @ stages)
    return complex_(end), complex_(stages[-1]), _scaled(error, start, complex_(end), relative, absolute)


def _scaled(error: jax.Array, start: jax.Array, end: jax.Array, relative: float, absolute: float) -> jax.Array:
    return jnp.abs(error) / (absolute + relative * jnp.maximum(jnp.abs(start), jnp.abs(end)))


def growth(error: jax.Array, largest: float = GROW) -> jax.Array:
    """Factor for the next step's length after a step with this error; a step is accepted up to error 1."""
    finite = jnp.where(jnp.isfinite(error), error, jnp.inf)
    return jnp.clip(SAFETY * jnp.maximum(finite, 1e-12) ** -0.125, SHRINK, largest)


def norm(values: jax.Array) -> jax.Array:
    """Root mean square over the state coordinates, the first axis."""
    return jnp.sqrt(jnp.mean(values * values, axis=0))


def _combination(weights: Sequence[float], stages: Sequence[jax.Array]) -> jax.Array:
    first, *others = ((weight, stage) for weight, stage in zip(weights, stages, strict=True) if weight != 0.0)
    total = first[0] * first[1]
    for weight, stage in others:
        total = total + weight * stage
    return total
