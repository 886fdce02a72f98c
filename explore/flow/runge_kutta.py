"""Adaptive Runge-Kutta steps for an orbit and its derivatives: Dormand-Prince 8, its tableau from diffrax.

The derivatives are carried by the linearised field (forward mode); the error of the orbit alone chooses the steps.
An extended state holds the orbit first and its tangents after it, shape (1 + d, m) or, for many orbits at once,
(1 + d, m, W): the same code serves both. Everything here is called while JAX traces a loop.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from orbitproof.explore.flow.fields import field_of
from orbitproof.shared.systems import ReversibleSystem

RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = 1e-14
MAX_STEPS = 5000
"""Attempted steps. Some 4200 lead through the orbits closest to a primary that shooting in float64 reaches."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0

Slopes = Callable[[jax.Array], jax.Array]


class Step(NamedTuple):
    """An attempted step: extended state and slope at its end, its error in units of the tolerance."""

    end: jax.Array
    slope: jax.Array
    error: jax.Array


@cache
def _tableau() -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Rows of the stages after the first, the last of which is the step, and the weights of the error."""
    tableau = diffrax.Dopri8.tableau
    if not tableau.fsal:
        raise RuntimeError("the last stage has to be the field at the end of the step")
    return tuple(tuple(map(float, row)) for row in tableau.a_lower), tuple(map(float, tableau.b_error))


def family_parameter_index(system: ReversibleSystem) -> int | None:
    """Position of the family parameter among the parameters, or `None`."""
    return None if system.family_parameter is None else tuple(system.parameters).index(system.family_parameter)


def identity(system: ReversibleSystem) -> np.ndarray:
    """The derivatives of the state at time 0 in the initial state and the family parameter, shape (d, m)."""
    m = len(system.state)
    return np.eye(m + (system.family_parameter is not None), m)


def extended_field(system: ReversibleSystem, parameters: jax.Array) -> Slopes:
    """The field of an extended state: at the orbit, and its derivative along each tangent.

    The tangents are in the initial state and, last, in the family parameter if the system has one.
    """
    field, index = field_of(system), family_parameter_index(system)

    def slopes(extended: jax.Array) -> jax.Array:
        if index is None:
            value, push = jax.linearize(lambda state: field(state, parameters), extended[0])
            return jnp.concatenate([value[None], jax.vmap(push)(extended[1:])])
        shifts = jnp.zeros((extended.shape[0] - 1, *parameters.shape[1:])).at[-1].set(1.0)
        value, push = jax.linearize(
            lambda state, shift: field(state, parameters.at[index].add(shift)), extended[0], shifts[0]
        )
        return jnp.concatenate([value[None], jax.vmap(push)(extended[1:], shifts)])

    return slopes


def first_step(extended: jax.Array, slope: jax.Array, times: jax.Array) -> jax.Array:
    """A length of the first step, over which the orbit moves by some percent of its distance from the origin."""
    length = 0.03 * _norm(extended[0]) / _norm(slope[0])
    return jnp.where(length > 0, jnp.minimum(times, length), times)


def attempt(slopes: Slopes, extended: jax.Array, slope: jax.Array, length: jax.Array) -> Step:
    """One step of the given length (of any sign) from an extended state and its slope."""
    rows, error_weights = _tableau()
    stages, end = [slope], extended
    for row in rows:
        end = extended + length * _combination(row, stages)
        stages.append(slopes(end))
    scale = ABSOLUTE_TOLERANCE + RELATIVE_TOLERANCE * jnp.maximum(jnp.abs(extended[0]), jnp.abs(end[0]))
    error = _norm(length * _combination(error_weights, [stage[0] for stage in stages]) / scale)
    return Step(end, stages[-1], jnp.where(jnp.isfinite(error), error, jnp.inf))


def growth(error: jax.Array) -> jax.Array:
    """Factor for the next step's length after a step with this error; a step is accepted up to error 1."""
    return jnp.clip(SAFETY * jnp.maximum(error, 1e-12) ** -0.125, SHRINK, GROW)


def _combination(weights: Sequence[float], stages: Sequence[jax.Array]) -> jax.Array:
    first, *others = ((weight, stage) for weight, stage in zip(weights, stages, strict=True) if weight != 0.0)
    total = first[0] * first[1]
    for weight, stage in others:
        total = total + weight * stage
    return total


def _norm(values: jax.Array) -> jax.Array:
    return jnp.sqrt(jnp.mean(values * values, axis=0))
