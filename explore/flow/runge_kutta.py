"""Adaptive Runge-Kutta steps of Prince and Dormand, of order 8, with the numbers that diffrax has.

A loop over orbits with steps of their own, or with something to watch on the way, is written with these, and so is that
over one orbit (`explore.flow.flow`). Everything here is called while JAX traces a loop. Arrays have the state
coordinates second to last and the orbits last.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import jax
import jax.numpy as jnp
import numpy as np

from orbitproof.explore.flow.fields import Slopes

RELATIVE_TOLERANCE = 1e-13
ABSOLUTE_TOLERANCE = 1e-14
MAX_STEPS = 5000
"""Attempted steps. Some 4200 lead through the orbits closest to a primary that shooting in float64 reaches."""

VARIATION_WEIGHT = 1e-3
"""Weight of the errors of derivatives of an orbit, each relative to the size of its row, beside those of the orbit: it
makes steps shorter only where nearby orbits move faster than the orbit, as across a linear mode."""

SAFETY, SHRINK, GROW = 0.9, 0.2, 10.0


_STAGES = (
    "1/18",
    "1/48 1/16",
    "1/32 0 3/32",
    "5/16 0 -75/64 75/64",
    "3/80 0 0 3/16 3/20",
    "29443841/614563906 0 0 77736538/692538347 -28693883/1125000000 23124283/1800000000",
    "16016141/946692911 0 0 61564180/158732637 22789713/633445777 545815736/2771057229 -180193667/1043307555",
    "39632708/573591083 0 0 -433636366/683701615 -421739975/2616292301 100302831/723423059 790204164/839813087"
    " 800635310/3783071287",
    "246121993/1340847787 0 0 -37695042795/15268766246 -309121744/1061227803 -12992083/490766935"
    " 6005943493/2108947869 393006217/1396673457 123872331/1001029789",
    "-1028468189/846180014 0 0 8478235783/508512852 1311729495/1432422823 -10304129995/1701304382"
    " -48777925059/3047939560 15336726248/1032824649 -45442868181/3398467696 3065993473/597172653",
    "185892177/718116043 0 0 -3185094517/667107341 -477755414/1098053517 -703635378/230739211 5731566787/1027545527"
    " 5232866602/850066563 -4093664535/808688257 3962137247/1805957418 65686358/487910083",
    "403863854/491063109 0 0 -5068492393/434740067 -411421997/543043805 652783627/914296604 11173962825/925320556"
    " -13158990841/6184727034 3936647629/1978049680 -160528059/685178525 248638103/1413531060 0",
    "14005451/335480064 0 0 0 0 -59238493/1068277825 181606767/758867731 561292985/797845732 -1041891430/1371343529"
    " 760417239/1151165299 118820643/751138087 -528747749/2220607170 1/4",
)
"""Weights of the slopes before each stage after the first; the last stage is the end of the step."""
_LOWER_ORDER = (
    "13451932/455176623 0 0 0 0 -808719846/976000145 1757004468/5645159321 656045339/265891186 -3867574721/1518517206"
    " 465885868/322736535 53011238/667516719 2/45 0 0"
)
"""Weights of the step of order 7, whose distance from the other one is the error."""


def _weights(row: str) -> tuple[float, ...]:
    return tuple(int(top) / int(bottom or 1) for top, _, bottom in (each.partition("/") for each in row.split()))


@cache
def tableau() -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
    """Rows of the stages after the first, the last of which is the step, and the weights of the error."""
    rows = tuple(map(_weights, _STAGES))
    return rows, tuple(a - b for a, b in zip((*rows[-1], 0.0), _weights(_LOWER_ORDER), strict=True))


def square_tableau() -> tuple[np.ndarray, np.ndarray]:
    """Rows of all S stages, the first and what is behind each filled with zeros, shape (S, S); weights of the error."""
    rows, error = tableau()
    return np.array([[*row, *[0.0] * (len(error) - len(row))] for row in ((), *rows)]), np.array(error)


def first_step(state: jax.Array, velocity: jax.Array, times: jax.Array) -> jax.Array:
    """A length of the first step, over which the orbit moves by some percent of its distance from the origin."""
    length = 0.03 * norm(state) / norm(velocity)
    return jnp.where(length > 0, jnp.minimum(times, length), times)


def attempt(slopes: Slopes, start: jax.Array, slope: jax.Array, length: jax.Array) -> tuple[jax.Array, list[jax.Array]]:
    """Where a step of the given length leads, and the slopes at its stages, the last of them that at its end."""
    stages, end = [slope], start
    for row in tableau()[0]:
        end = start + length * _combination(row, stages)
        stages.append(slopes(end))
    return end, stages


def extended_error(start: jax.Array, end: jax.Array, stages: Sequence[jax.Array], length: jax.Array) -> jax.Array:
    """The error of a step of extended states, shape (1 + d, m, ..), in units of the tolerance, one for each orbit."""
    return measured(length * _combination(tableau()[1], stages), start, end)


def measured(error: jax.Array, start: jax.Array, end: jax.Array) -> jax.Array:
    """A difference between two orders, of the shape of an extended state, in units of the tolerance, for each orbit."""
    return weighted(_scaled(error, scales(start), scales(end), RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE))


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
    lower, error_weights = map(jnp.asarray, square_tableau())

    def real(values: jax.Array) -> jax.Array:
        return jnp.stack([values.real, values.imag]).reshape(-1)

    def complex_(row: jax.Array) -> jax.Array:
        return jax.lax.complex(*row.reshape(2, *start.shape))

    def stage(number: jax.Array, carry: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        stages = carry[1]
        end = real(start) + length * (lower[number] @ stages)
        return end, stages.at[number].set(real(slopes(complex_(end))))

    first = jnp.zeros((len(lower), 2 * start.size)).at[0].set(real(slope))
    end, stages = jax.lax.fori_loop(1, len(lower), stage, (real(start), first))
    error = length * complex_(error_weights @ stages)
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
