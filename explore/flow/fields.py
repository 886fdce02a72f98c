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

from orbitproof.shared.systems import ReversibleSystem

LARGEST_HALF_INTEGER = 8


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


def field_of(system: ReversibleSystem) -> Callable[[jax.Array, jax.Array], jax.Array]:
    """The vector field, called with a state of shape (m, ...) and parameters (P, ...), returns shape (m, ...)."""
    program = system.program

    def field(state: jax.Array, parameters: jax.Array) -> jax.Array:
        values = program.evaluate([*state, *parameters], power=power)
        return jnp.stack(jnp.broadcast_arrays(*map(jnp.asarray, values)))

    return field
