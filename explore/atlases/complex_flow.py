"""Half returns of many nearby complex points at once.

The solution of an analytic differential equation is analytic in its initial point: integrated from the points of a
circle in the complex plane of a curve's parameter, it gives the Taylor coefficients in that parameter by a discrete
Fourier transform, each to the accuracy of the integration. All points share the steps of one Runge-Kutta method
(Dormand-Prince 8), and the largest Fourier coefficients on the way are watched, which diffrax could only do by keeping
all steps. CR3BP orbits are followed in physical or in regularised coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.flow import (
    FlowFailure,
    Vector,
    attempt_in_loop,
    compiling,
    configure_jax,
    growth,
    norm,
    power,
)
from orbitproof.shared.systems import (
    REGULARISATIONS,
    Program,
    Regularisation,
    ReversibleSystem,
    completed,
    with_functions,
    with_slope,
)

Coordinates = Literal["physical", "regularised"]

ComplexArray = NDArray[np.complexfloating[Any, Any]]

RELATIVE_TOLERANCE = 1e-14
ABSOLUTE_TOLERANCE = 1e-15
MAX_STEPS = 4000
GROW = 5.0

POWER_COST = 8

_NEWTON_STEPS = 30

_FUNCTIONS = {"sin": np.sin, "cos": np.cos, "exp": np.exp, "log": np.log}

LANES = 96
"""Points that are followed at once."""


@dataclass(frozen=True)
class Returns:
    """What N points do until given times.

    Attributes:
        values: shape (1 + n, N), the section coordinate and the kernel coordinates at the times.
        rates: shape (1 + n, N), their derivatives in the time.
        clocks: shape (N,), the system's time.
        spectrum: shape (N',), for each column of the transform the largest magnitude of a transformed state coordinate
            during the integration, relative to the largest magnitude of that coordinate.
        steps: Runge-Kutta steps.
    """

    values: ComplexArray
    rates: ComplexArray
    clocks: ComplexArray
    spectrum: NDArray[np.float64]
    steps: int


@dataclass(frozen=True)
class HalfReturns:
    """Half returns of points of Fix(R) of a system at given parameters, in given coordinates.

    Attributes:
        parameters: exact values of the fixed parameters, by name.
        coordinates: those in which the orbits are followed; the time of `evaluate` is theirs.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    coordinates: Coordinates = "physical"

    @cached_property
    def regularisation(self) -> Regularisation | None:
        """The coordinates, if they are not the system's own."""
        return REGULARISATIONS[self.system.name] if self.coordinates == "regularised" else None

    @cached_property
    def products(self) -> int:
        """What the vector field costs a verifier, in multiplications: a power of a series is worth several."""
        program = self.system.program if self.regularisation is None else self.regularisation.program
        costs = {"mul": 1, "div": POWER_COST, "pow": POWER_COST}
        return sum(costs.get(step.operation, 0) for step in program.instructions)

    def evaluate(self, points: ComplexArray, times: ComplexArray, transform: ComplexArray | None = None) -> Returns:
        """Follow the orbits of `points` over `times`.

        Arguments:
            points: shape (1 + n, N), in the order of `ReversibleSystem.centre_coordinates`.
            times: shape (N,), in the units of the coordinates.
            transform: shape (N // (1 + n), N'), a linear map of functions on the first points, see `Returns.spectrum`.

        Raises `FlowFailure` where an orbit does not get through.
        """
        system = self.system
        size, count = points.shape
        if transform is None:
            transform = np.zeros((count // size, 2 * (count // size)), dtype=complex)
        inputs = np.array(
            [
                points[0] if name == system.family_parameter else np.full(count, _long(self.parameters[name]))
                for name in system.parameters
            ]
        )
        states = np.zeros((len(system.state), count), dtype=np.clongdouble)
        for name, value in system.normalised.items():
            states[system.state.index(name)] = float(value)
        states[list(system.fixed_coordinates)] = points[int(system.family_parameter is not None) :]
        if system.fixed_level is not None:
            self._put_on_level(states, inputs)
        states = self._with_functions(states, inputs)
        constants, start = inputs, states
        if self.regularisation is not None:
            assert system.first_integral_program is not None
            with np.errstate(all="ignore"):
                level = _run(system.first_integral_program, [*states, *inputs])
                branch = self.regularisation.branch(
                    [float(value) for value in np.mean(states.real, axis=1)], [float(inputs[0, 0].real)]
                )
                start = _run(self.regularisation.embedding_program(branch), [*states, *inputs])
            constants = np.concatenate([inputs, level])
        end, slope, spectrum, steps, done = (
            np.asarray(part)
            for part in self._integrate(
                start.astype(complex), times.astype(complex), constants.astype(complex), transform.astype(complex)
            )
        )
        if not done or not np.all(np.isfinite(end)):
            raise FlowFailure("an orbit with a complex initial point runs into a singularity")
        # The derivative along the slope by a difference: exact for the system's own coordinates.
        small = 1e-6 * np.abs(times)
        values = self._section(end, inputs)
        rates = (self._section(end + small * slope, inputs) - values) / small
        clocks = times if self.regularisation is None else end[self.regularisation.time_index]
        return Returns(values, rates, clocks, spectrum, int(steps))

    def clocks(self, point: Vector, times: Vector) -> Vector:
        """The system's times after times of the coordinates, shape (LANES,), of one orbit. Raises `FlowFailure`."""
        points = np.repeat(point.astype(np.clongdouble)[:, None], len(times), axis=1)
        return np.asarray(self.evaluate(points, times.astype(complex)).clocks.real)

    def _put_on_level(self, states: ComplexArray, inputs: ComplexArray) -> None:
        """Fill in the level coordinate w of states that are given but for it, by H = A + b w^2 or Newton's method."""
        level, integral = self.system.fixed_level, self.system.first_integral_program
        assert level is not None
        assert integral is not None
        w = states[self.system.state.index(str(self.system.level_coordinate))]
        if level.between is not None:
            self._solve_level(w, states, inputs)
            return
        values = []
        for number in (0, 1):
            w[:] = number
            values.append(_run(integral, [*self._with_functions(states, inputs), *inputs])[0])
        with np.errstate(invalid="ignore"):
            w[:] = level.sign * np.sqrt((_long(level.value) - values[0]) / (values[1] - values[0]))

    def _solve_level(self, w: ComplexArray, states: ComplexArray, inputs: ComplexArray) -> None:
        """The level coordinate w for any H, from the point of the level over the mean; NaN where there is none."""
        system = self.system
        means = [np.mean(rows.real, axis=1).astype(float).tolist() for rows in (states, inputs)]
        w[:] = completed(system, *means)[system.state.index(str(system.level_coordinate))]
        assert system.fixed_level is not None
        assert system.first_integral_program is not None
        both = with_slope(system.first_integral_program, str(system.level_coordinate))
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON_STEPS):
                height, slope = _run(both, [*self._with_functions(states, inputs), *inputs])
                w[:] = w - (height - _long(system.fixed_level.value)) / slope

    def _with_functions(self, states: ComplexArray, inputs: ComplexArray) -> ComplexArray:
        """The states with the values of the coordinates that are functions of others."""
        if not self.system.defined:
            return states
        with np.errstate(all="ignore"):
            rows = with_functions(self.system, [*states], [*inputs], _FUNCTIONS, _long, _power)
        return np.array(np.broadcast_arrays(*rows), dtype=states.dtype)

    def _section(self, states: ComplexArray, inputs: ComplexArray) -> ComplexArray:
        system = self.system
        if self.regularisation is not None:
            states = _run(self.regularisation.projection_program, [*states, *inputs])
        return states[[system.section_index, *system.kernel_coordinates]].astype(complex)

    def _integrate(self, *arguments: ComplexArray) -> Any:
        program = self.system.program if self.regularisation is None else self.regularisation.program
        integrator = _INTEGRATORS.get(program.inputs)
        if integrator is None:
            configure_jax()
            integrator = _INTEGRATORS[program.inputs] = jax.jit(_integrator(program))
        with compiling(), jax.default_device(jax.local_devices(backend="cpu")[0]):
            return integrator(*arguments)


_INTEGRATORS: dict[tuple[str, ...], Callable[..., Any]] = {}


def _long(value: Fraction) -> np.longdouble:
    """`value` in extended precision: near a primary the distance from it is a small difference."""
    head = float(value)
    return np.longdouble(head) + np.longdouble(float(value - Fraction(head)))


def _power(base: Any, exponent: Fraction) -> Any:
    return base ** int(exponent) if exponent.denominator == 1 else base ** float(exponent)


def _run(program: Program, arguments: Sequence[Any]) -> ComplexArray:
    values = program.evaluate(arguments, constant=_long, power=_power)
    shape = np.shape(arguments[0])
    return np.array([np.broadcast_to(value, shape) for value in values], dtype=np.result_type(arguments[0]))


def _integrator(program: Program) -> Callable[..., Any]:
    """From states (m, N) over times (N,) with further inputs (P, N); see `HalfReturns.evaluate`."""

    def integrate(initial: jax.Array, times: jax.Array, inputs: jax.Array, transform: jax.Array) -> tuple[Any, ...]:
        def slopes(states: jax.Array) -> jax.Array:
            values = program.evaluate([*states, *inputs], power=power)
            return times * jnp.stack([jnp.broadcast_to(value, times.shape) for value in values])

        def sizes(states: jax.Array, before: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
            transformed = jnp.abs((states[:, : len(transform)] @ transform).real)
            return jnp.maximum(before[0], transformed), jnp.maximum(before[1], jnp.max(jnp.abs(states), axis=1))

        def going(carry: tuple[Any, ...]) -> jax.Array:
            place, _, _, length, _, steps = carry
            return (place < 1.0) & (place + 1e-3 * length > place) & (steps < MAX_STEPS)

        def step(carry: tuple[Any, ...]) -> tuple[Any, ...]:
            place, now, slope, length, largest, steps = carry
            last = length >= 1.0 - place
            taken = jnp.where(last, 1.0 - place, length)
            end, new_slope, errors = attempt_in_loop(slopes, now, slope, taken, RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE)
            error = jnp.max(norm(errors))
            accepted = error <= 1.0
            new = sizes(end, largest)
            return (
                jnp.where(accepted, jnp.where(last, 1.0, place + taken), place),
                jnp.where(accepted, end, now),
                jnp.where(accepted, new_slope, slope),
                taken * growth(error, GROW),
                tuple(jnp.where(accepted, a, b) for a, b in zip(new, largest, strict=True)),
                steps + 1,
            )

        none = jnp.zeros(len(initial))
        largest = sizes(initial, (jnp.zeros((len(initial), transform.shape[1])), none))
        start = (jnp.zeros(()), initial, slopes(initial), jnp.full((), 1e-3), largest, jnp.zeros((), dtype=int))
        place, end, slope, _, largest, steps = jax.lax.while_loop(going, step, start)
        spectrum = jnp.max(largest[0] / jnp.where(largest[1] > 0, largest[1], 1.0)[:, None], axis=0)
        return end, slope / times, spectrum, steps, place >= 1.0

    return integrate
