"""Adaptive Runge-Kutta steps: Dormand and Prince's method of order 8, RK8(7)13M.

A loop over orbits with steps of their own, or with something to watch on the way, is written with these. Everything
here is called while JAX traces a loop. Arrays have the state coordinates second to last and the orbits last.

The method: P. J. Prince and J. R. Dormand, High order embedded Runge-Kutta formulae, Journal of Computational and
Applied Mathematics 7 (1981), 67-75; a test compares the numbers with those of diffrax.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

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


# fmt: off
_ROWS: tuple[tuple[float, ...], ...] = (
    (1 / 18,),
    (1 / 48, 1 / 16),
    (1 / 32, 0, 3 / 32),
    (5 / 16, 0, -75 / 64, 75 / 64),
    (3 / 80, 0, 0, 3 / 16, 3 / 20),
    (29443841 / 614563906, 0, 0, 77736538 / 692538347, -28693883 / 1125000000, 23124283 / 1800000000),
    (
        16016141 / 946692911, 0, 0, 61564180 / 158732637, 22789713 / 633445777, 545815736 / 2771057229,
        -180193667 / 1043307555,
    ),
    (
        39632708 / 573591083, 0, 0, -433636366 / 683701615, -421739975 / 2616292301, 100302831 / 723423059,
        790204164 / 839813087, 800635310 / 3783071287,
    ),
    (
        246121993 / 1340847787, 0, 0, -37695042795 / 15268766246, -309121744 / 1061227803, -12992083 / 490766935,
        6005943493 / 2108947869, 393006217 / 1396673457, 123872331 / 1001029789,
    ),
    (
        -1028468189 / 846180014, 0, 0, 8478235783 / 508512852, 1311729495 / 1432422823, -10304129995 / 1701304382,
        -48777925059 / 3047939560, 15336726248 / 1032824649, -45442868181 / 3398467696, 3065993473 / 597172653,
    ),
    (
        185892177 / 718116043, 0, 0, -3185094517 / 667107341, -477755414 / 1098053517, -703635378 / 230739211,
        5731566787 / 1027545527, 5232866602 / 850066563, -4093664535 / 808688257, 3962137247 / 1805957418,
        65686358 / 487910083,
    ),
    (
        403863854 / 491063109, 0, 0, -5068492393 / 434740067, -411421997 / 543043805, 652783627 / 914296604,
        11173962825 / 925320556, -13158990841 / 6184727034, 3936647629 / 1978049680, -160528059 / 685178525,
        248638103 / 1413531060, 0,
    ),
    (
        14005451 / 335480064, 0, 0, 0, 0, -59238493 / 1068277825, 181606767 / 758867731, 561292985 / 797845732,
        -1041891430 / 1371343529, 760417239 / 1151165299, 118820643 / 751138087, -528747749 / 2220607170, 1 / 4,
    ),
)
"""Weights of the stages after the first, the last of which is the step: its slope is the first one of the next."""

_ERROR: tuple[float, ...] = (
    14005451 / 335480064 - 13451932 / 455176623, 0, 0, 0, 0, -59238493 / 1068277825 - -808719846 / 976000145,
    181606767 / 758867731 - 1757004468 / 5645159321, 561292985 / 797845732 - 656045339 / 265891186,
    -1041891430 / 1371343529 - -3867574721 / 1518517206, 760417239 / 1151165299 - 465885868 / 322736535,
    118820643 / 751138087 - 53011238 / 667516719, -528747749 / 2220607170 - 2 / 45, 1 / 4, 0,
)
"""Weights of the error."""
# fmt: on


def first_step(state: jax.Array, velocity: jax.Array, times: jax.Array) -> jax.Array:
    """A length of the first step, over which the orbit moves by some percent of its distance from the origin."""
    length = 0.03 * norm(state) / norm(velocity)
    return jnp.where(length > 0, jnp.minimum(times, length), times)


def attempt(slopes: Slopes, start: jax.Array, slope: jax.Array, length: jax.Array) -> tuple[jax.Array, list[jax.Array]]:
    """Where a step of the given length leads, and the slopes at its stages, the last of them that at its end."""
    stages, end = [slope], start
    for row in _ROWS:
        end = start + length * _combination(row, stages)
        stages.append(slopes(end))
    return end, stages


def extended_error(start: jax.Array, end: jax.Array, stages: Sequence[jax.Array], length: jax.Array) -> jax.Array:
    """The error of a step of extended states, shape (1 + d, m, ..), in units of the tolerance, one for each orbit."""
    error = _scaled(
        length * _combination(_ERROR, stages), scales(start), scales(end), RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE
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
    """A step of complex states of shape (m, N), like `attempt`: where it leads, the slope there, its scaled error."""

    def real(values: jax.Array) -> jax.Array:
        return jnp.stack([values.real, values.imag]).reshape(-1)

    def complex_(row: jax.Array) -> jax.Array:
        return jax.lax.complex(*row.reshape(2, *start.shape))

    row, stages = _looped(lambda row: real(slopes(complex_(row))), real(start), length, real(slope))
    end, error = complex_(row), length * complex_(jnp.array(_ERROR) @ stages)
    return end, complex_(stages[-1]), _scaled(error, start, end, relative, absolute)


def extended_in_loop(slopes: Slopes, start: jax.Array, length: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """A step of an extended state, shape (1 + d, m): where it leads, the slope there, its error as `extended_error`."""
    row, stages = _looped(lambda row: slopes(row.reshape(start.shape)).reshape(-1), start.reshape(-1), length)
    end, error = row.reshape(start.shape), length * (jnp.array(_ERROR) @ stages).reshape(start.shape)
    scaled = _scaled(error, scales(start), scales(end), RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE)
    return end, stages[-1].reshape(start.shape), weighted(scaled)


def _looped(
    slopes: Callable[[jax.Array], jax.Array], start: jax.Array, length: jax.Array, slope: jax.Array | None = None
) -> tuple[jax.Array, jax.Array]:
    """Where a step leads, and the slopes at its stages, as rows of real numbers.

    The vector field stands once in the compiled code, which takes an eighth of the time to compile. The stages are
    rows: their combinations are then products with a matrix, as fast as those written out. A slope at the start that is
    not given is found in the same loop.
    """
    count = 1 + len(_ROWS)
    lower = jnp.array([[0.0] * count, *([*row, *[0.0] * (count - len(row))] for row in _ROWS)])

    def stage(number: jax.Array, carry: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        end = start + length * (lower[number] @ carry[1])
        return end, carry[1].at[number].set(slopes(end))

    stages = jnp.zeros((count, start.size))
    if slope is not None:
        stages = stages.at[0].set(slope)
    end, stages = jax.lax.fori_loop(0 if slope is None else 1, count, stage, (start, stages))
    return end, stages


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
