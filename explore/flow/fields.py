"""Vector fields for JAX, with cheap powers.

``x ** -1.5`` is a general power to JAX, a logarithm and an exponential, and so is its derivative; together they would
take most of an integration. The exponents of a system's program are known exactly, and half-integers among them, the
powers of distances, need one square root and a few products.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from orbitproof.shared.systems import ReversibleSystem, System, with_functions

LARGEST_HALF_INTEGER = 8

_FUNCTIONS = {"sin": jnp.sin, "cos": jnp.cos, "exp": jnp.exp, "log": jnp.log}

Slopes = Callable[[jax.Array], jax.Array]
"""From an extended state, the orbit first and its tangents after it, to its derivative in time."""


@partial(jax.custom_jvp, nondiff_argnums=(1,))
def power(base: jax.Array, exponent: Fraction) -> jax.Array:
    """``base ** exponent``; the derivative reuses the value."""
    size = abs(exponent)
    if size.denominator > 2 or size > LARGEST_HALF_INTEGER:
        return base ** float(exponent)
    factors = [base] * int(size) + [jnp.sqrt(base)] * (size.denominator - 1)
    value = jnp.ones_like(base)
    for factor in factors:
        value = value * factor
    return value if exponent >= 0 else 1 / value


@power.defjvp
def _power_derivative(exponent: Fraction, primals: tuple[Any], tangents: tuple[Any]) -> tuple[jax.Array, jax.Array]:
    (base,), (change,) = primals, tangents
    value = power(base, exponent)
    slope = float(exponent) * (power(base, exponent - 1) if exponent >= 1 else value / base)
    return value, slope * change


def field_of(system: System) -> Callable[[jax.Array, jax.Array], jax.Array]:
    """The vector field, called with a state of shape (m, ...) and parameters (P, ...), returns shape (m, ...)."""
    program = system.program

    def field(state: jax.Array, parameters: jax.Array) -> jax.Array:
        values = program.evaluate([*state, *parameters], power=power)
        return jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, values)))

    return field


def given_field(system: System) -> Callable[[jax.Array, jax.Array], jax.Array]:
    """The vector field of the coordinates that are given, as it is written: those that are functions have their values.

    Called with these, shape (G,), and parameters, shape (P,); returns shape (G,).
    """
    field, given = field_of(system), len(system.given_state)
    if not system.defined:
        return field
    return lambda state, parameters: field(_with_functions(system, state, parameters), parameters)[:given]


def _with_functions(system: System, state: jax.Array, parameters: jax.Array) -> jax.Array:
    """The whole state for the coordinates that are given, shape (G, ...) or (m, ...), at parameters (P, ...)."""
    places = [*state[: len(system.given_state)], *[0.0] * len(system.defined)]
    found = with_functions(system, places, [*parameters], _FUNCTIONS, power=power)
    return jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, found)))


def family_parameter_index(system: ReversibleSystem) -> int | None:
    """Position of the family parameter among the parameters, or `None`."""
    return None if system.family_parameter is None else tuple(system.parameters).index(system.family_parameter)


def identity(system: ReversibleSystem) -> np.ndarray:
    """The derivatives of the state at time 0 in the initial state and the family parameter, shape (d, m)."""
    m = len(system.state)
    return np.eye(m + (system.family_parameter is not None), m)


def beginning(system: ReversibleSystem, initial: Any, parameters: Any) -> Any:
    """Initial states of shape (m, ...) with their derivatives after them, shape (1 + d, m, ...).

    Coordinates that are functions of others have their values, whatever is given for them, and move with the others.
    Where there are none, arrays of numpy stay such, and nothing is compiled for their shape.
    """
    tangents = identity(system)
    tangents = np.broadcast_to(
        tangents.reshape(*tangents.shape, *[1] * (initial.ndim - 1)), (*tangents.shape, *initial.shape[1:])
    )
    if not system.defined:
        concatenate = np.concatenate if isinstance(initial, np.ndarray) else jnp.concatenate
        return concatenate([initial[None], tangents])
    index = family_parameter_index(system)
    shifts = jnp.zeros((len(tangents), *parameters.shape))
    if index is not None:
        shifts = shifts.at[-1, index].set(1.0)
    value, push = jax.linearize(partial(_with_functions, system), initial, parameters)
    return jnp.concatenate([value[None], jax.vmap(push)(jnp.asarray(tangents), shifts)])


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
