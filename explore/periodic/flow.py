"""The flow of any vector field in float64, with its derivatives in the initial state and in all parameters.

diffrax integrates; compiled once for each system. States have the given coordinates alone: those that are functions of
others (`System.defined`) follow from them. Derivatives count when the steps are chosen: without a symmetry that
halves the way, they may grow a thousandfold over a period.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log10
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow import FlowFailure, compiled, configure_jax, given_field
from orbitproof.shared.systems import Program, System, functions_in_floats, with_functions

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_COMPLEX = {"sin": cmath.sin, "cos": cmath.cos, "exp": cmath.exp, "log": cmath.log}
_STEP, _ROUNDING = 1e-30, 1e-9
_MOST_STEPS = 32_000
"""Steps of the explicit method, which are short in stiff fields: some twenty for each time of the fastest decay."""
SAMPLES = 2048
"""States at equal times that an integration keeps, both ends included."""


@dataclass(frozen=True)
class Arc:
    """The orbit of a point over a time.

    Attributes:
        end: shape (N,), the state at the end.
        velocity: shape (N,), the vector field there.
        by_state: shape (N, N), derivatives of `end` in the initial state.
        by_parameters: shape (N, P), the same in the parameters.
        samples: shape (`SAMPLES`, N), the states at equal times.
    """

    end: Vector
    velocity: Vector
    by_state: Matrix
    by_parameters: Matrix
    samples: Matrix


_COMPILED: dict[int, tuple[System, Callable[..., Any]]] = {}
_COMPILED_STIFF: dict[int, tuple[System, Callable[..., Any]]] = {}


def arc_of(system: System, point: Sequence[float] | Vector, time: float, parameters: Sequence[float]) -> Arc:
    """The orbit of a point over a positive time.

    Arguments:
        point: shape (N,).
        parameters: shape (P,), all of them, in the vector field's order.

    Raises `FlowFailure` where the orbit runs away or into a singularity.
    """
    configure_jax()
    if id(system) not in _COMPILED:
        _COMPILED[id(system)] = system, compiled(_integrator(system))
    start, values = np.asarray(point, dtype=float), np.asarray(parameters, dtype=float)
    extended, velocity, samples, done = map(np.asarray, _COMPILED[id(system)][1](start, float(time), values))
    if not done or not np.all(np.isfinite(extended)):
        raise FlowFailure(f"the orbit could not be integrated over time {float(time):.6g}")
    m = len(start)
    return Arc(extended[0], velocity, extended[1 : 1 + m].T, extended[1 + m :].T, samples)


def stiff_path(
    system: System, point: Sequence[float] | Vector, time: float, parameters: Sequence[float]
) -> tuple[Vector, Matrix]:
    """The end of an orbit over a positive time, and its states at equal times, by an implicit method; no derivatives.

    To some 8 digits, also where the field is stiff. Raises `FlowFailure`.
    """
    configure_jax()
    if id(system) not in _COMPILED_STIFF:
        _COMPILED_STIFF[id(system)] = system, compiled(_stiff_integrator(system))
    start, values = np.asarray(point, dtype=float), np.asarray(parameters, dtype=float)
    end, samples, done = map(np.asarray, _COMPILED_STIFF[id(system)][1](start, float(time), values))
    if not done or not np.all(np.isfinite(samples)):
        raise FlowFailure(f"the orbit could not be integrated over time {float(time):.6g}")
    return end, samples


def velocity_at(system: System, point: Sequence[float] | Vector, parameters: Sequence[float]) -> Vector:
    """The vector field at a point, shape (N,). Raises `FlowFailure` where it is not defined."""
    return values_of(system, system.program, point, parameters)[: len(system.given_state)]


def values_of(system: System, program: Program, point: Sequence[float] | Vector, parameters: Sequence[float]) -> Vector:
    """What a program of state and parameters gives at a point. Raises `FlowFailure` where it is not defined."""
    try:
        inputs = [*whole_state(system, point, parameters), *map(float, parameters)]
        found = np.array([float(value) for value in program.evaluate(inputs)])
    except (ArithmeticError, TypeError, ValueError):
        found = np.array([np.nan])
    if not np.all(np.isfinite(found)):
        values = [*zip(system.given_state, point, strict=True), *zip(system.parameters, parameters, strict=False)]
        place = ", ".join(f"{name} = {value:.6g}" for name, value in values)
        raise FlowFailure(f"the formulas of {system.name} have no value at {place}{_in_place(system, program, inputs)}")
    return found


def _in_place(system: System, program: Program, inputs: Sequence[float]) -> str:
    """What to give where formulas have no value: for a parameter that is 0, another value, if that is the reason."""
    first = len(inputs) - len(system.parameters)
    for place, name in enumerate(system.parameters, start=first):
        if inputs[place] == 0:
            changed = [*inputs[:place], 1.0, *inputs[place + 1 :]]
            try:
                if np.all(np.isfinite([float(value) for value in program.evaluate(changed)])):
                    return f": {name} = 0 is divided by; give {name} another value"
            except (ArithmeticError, TypeError, ValueError):
                pass
    return "; give another start"


def whole_state(system: System, point: Sequence[float] | Vector, parameters: Sequence[float] | Vector) -> list[float]:
    """The state with the coordinates that are functions of others, at a point that is given without them."""
    values = [float(value) for value in parameters]
    return functions_in_floats(system, [*map(float, point), *[0.0] * len(system.defined)], values)


def slopes_of_state(system: System, point: Vector, parameters: Vector) -> Matrix:
    """Derivatives of the whole state and the parameters in the given state and the parameters, by complex steps."""
    inputs, given, rows = np.append(point, parameters).astype(complex), len(point), []
    for shift in np.eye(len(inputs)) * 1j * _STEP:
        state, values = np.split(inputs + shift, [given])
        whole = with_functions(system, [*state, *[0j] * len(system.defined)], values, _COMPLEX)
        rows.append(np.array([*whole, *values]).imag / _STEP)
    return np.array(rows).T


def stretching(system: System, states: Matrix, parameters: Sequence[float]) -> float:
    """The mean over states of the fastest rate at which neighbours move apart, where they do."""
    slopes = _slopes(system, states, parameters)
    rates = np.linalg.eigvalsh((slopes + slopes.transpose(0, 2, 1)) / 2)[:, -1]
    return float(np.mean(np.maximum(rates, 0.0)))


def growth_of_bounds(system: System, states: Matrix, parameters: Sequence[float]) -> float:
    """The mean over states of the rate at which the verifier's bounds of errors grow.

    In a flow that preserves volume they are kept entry by entry and grow by |Df|, those of what contracts too; in other
    flows they are carried in a frame and grow no faster than neighbours move apart.
    """
    if not preserves_volume(system, states, parameters):
        return stretching(system, states, parameters)
    rates = np.max(np.abs(np.linalg.eigvals(np.abs(_slopes(system, states, parameters)))), axis=1)
    return float(np.mean(rates))


def growth_in_frames(system: System, states: Matrix, time: float, parameters: Sequence[float]) -> float:
    """By how many digits errors grow along states at equal times, both ends included, if a frame is carried with them.

    As the verifier does it where volume is not preserved: a QR factorisation with the longest edge first (4.4).
    """
    # Only now: scipy takes a moment to load.
    from scipy.linalg import expm

    slopes = _slopes(system, states, parameters)
    bounds, frame, most = np.ones(slopes.shape[1]), np.eye(slopes.shape[1]), 0.0
    for step in expm(slopes[:-1] * (time / (len(states) - 1))):
        ends = step @ frame
        frame = np.linalg.qr(ends[:, np.argsort(-np.linalg.norm(ends, axis=0) * bounds)])[0]
        # Errors are made on the way, too.
        bounds = np.maximum(np.abs(frame.T @ ends) @ bounds, 1.0)
        most = max(most, log10(bounds.max()))
    return most


def preserves_volume(system: System, states: Matrix, parameters: Sequence[float]) -> bool:
    """Whether the divergence of the field vanishes at all states, up to rounding."""
    slopes = _slopes(system, states, parameters)
    return bool(np.all(np.abs(np.trace(slopes, axis1=1, axis2=2)) <= _ROUNDING * np.abs(slopes).max()))


def _slopes(system: System, states: Matrix, parameters: Sequence[float]) -> Matrix:
    """Df at each state, shape (states, N, N)."""
    field, values = given_field(system), jnp.asarray(parameters, dtype=float)
    return np.asarray(jax.vmap(jax.jacfwd(lambda state: field(state, values)))(jnp.asarray(states)))


def _integrator(system: System) -> Callable[..., Any]:
    # Only now: diffrax takes a moment to load.
    import diffrax

    from orbitproof.explore.flow import integrate

    field, m, count = given_field(system), len(system.given_state), len(system.parameters)
    shifts = jnp.concatenate([jnp.zeros((m, count)), jnp.eye(count)])

    def run(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        def slopes(_time: Any, extended: jax.Array, _arguments: Any) -> jax.Array:
            value, push = jax.linearize(field, extended[0], parameters)
            return jnp.concatenate([value[None], jax.vmap(push)(extended[1:], shifts)])

        keep = diffrax.SubSaveAt(ts=time * jnp.linspace(0.0, 1.0, SAMPLES), fn=lambda _t, extended, _a: extended[0])
        start = jnp.concatenate([initial[None], jnp.eye(m + count, m)])
        end, solution, reached = integrate(slopes, start, time, save=keep, most=_MOST_STEPS)
        return end, slopes(None, end, None)[0], solution.ys[1], reached

    return run


def _stiff_integrator(system: System) -> Callable[..., Any]:
    import diffrax

    from orbitproof.explore.flow import integrate

    field = given_field(system)

    def run(initial: jax.Array, time: jax.Array, parameters: jax.Array) -> tuple[jax.Array, ...]:
        keep = diffrax.SubSaveAt(ts=time * jnp.linspace(0.0, 1.0, SAMPLES))
        end, solution, reached = integrate(
            lambda _time, state, values: field(state, values), initial, time, parameters, save=keep, implicit=True
        )
        return end, solution.ys[1], reached

    return run
