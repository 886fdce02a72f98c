"""Symmetry breaking of planar Lyapunov orbits of the CR3BP as three equations in four unknowns, one of them mu.

A planar orbit that starts on Fix(R) at (x, vy) is symmetric if it crosses the axis y = 0 perpendicularly after the
half period T. There the symmetry S breaks if zeta'(T) = 0, where zeta solves the variational equation across the plane,
zeta'' = -((1 - mu)/r_1^3 + mu/r_2^3) zeta, zeta(0) = 1, zeta'(0) = 0 (Remark in Appendix B of the paper). As mu tends
to 0 these equations degenerate in double precision; two charts keep them regular down to mu = 0.

Near the smaller mass (L1, L2). Positions relative to it and all lengths in units of h = mu^(1/3), so that the distance
to it is of size 1 and nothing cancels. With u = 2 xi + h rho^2, s = r_1 = sqrt(1 + h u) and
c = u (1 + s + s^2)/((1 + s) s^3) = (1 - s^-3)/h the equations of motion are exactly

    xi'' - 2 eta' = mu xi + (1 - mu)(1 + h xi) c - xi/rho^3,   eta'' + 2 xi' = (mu + (1 - mu) h c) eta - eta/rho^3,

and become Hill's equations at mu = 0. Axial orbits are born where the half turn about the axis still maps the orbit to
itself and S does not: zeta(0) = 0, zeta'(0) = 1, and zeta(T) = 0 instead.

Around the larger mass (L3). At mu = 0 all ellipses of period 2 pi are symmetric orbits with zeta'(T) = 0 and T = pi:
T - pi and zeta'(T) are of order mu. The unknown is tau = (T - pi)/mu instead of T. With the radius vector R from
the larger mass in inertial directions, that to the smaller mass d = (cos t, sin t), the perturbation
p = -(R - d)/r_2^3 - d and the angular momentum l, the eccentricity vector A = R' x l - (1 - mu) R/r_1 and the Wronskian
of zeta and R_1 obey

    A' = mu (p x l + R' x (R x p)),     (R_1 zeta' - R_1' zeta)' = mu cos t (1 - 1/r_2^3) zeta.

mu times the integrals of the right hand sides, E = A_2/mu and w, are what the conditions compare: A points along the
axis at a perpendicular crossing, and zeta'(T) = 0 gives the Wronskian -R_1'(T) zeta(T). Divided by mu they read

    E + A_x sin(mu tau)/mu = 0,     w + (vy + X) zeta sin(mu tau)/mu = 0,

with everything of size 1, A_x along the rotating axis, X = x + mu.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrix, Vector, compiled, configure_jax, integrate

UNKNOWNS = 4
FAMILIES = ("halo", "axial")
HALO, AXIAL = FAMILIES
"""Families of the orbits that are born on the planar ones."""
LOG_MU = 3
"""Number of the unknown log mu; the others are position, velocity and time, each as the chart scales it."""


@dataclass(frozen=True)
class MassChart:
    """Coordinates for the symmetry-breaking curve of a libration point.

    The unknowns are u = (a, v, s, log mu): position and velocity of the start on Fix(R), and time.

    Attributes:
        smaller: whether it belongs to the smaller mass (L1, L2) or to the larger one (L3).
        family: of the orbits that are born: one of `FAMILIES`, `AXIAL` near the smaller mass only.
    """

    smaller: bool
    family: str = HALO

    def __post_init__(self) -> None:
        if self.family not in FAMILIES or (self.family == AXIAL and not self.smaller):
            raise ValueError(f"no chart for births of {self.family!r} orbits there")

    def unit(self, mu: float) -> float:
        """The unit of position and velocity, nondimensional."""
        return float(np.cbrt(mu)) if self.smaller else 1.0

    def origin(self, mu: float) -> float:
        """The x coordinate from which a is counted."""
        return 1.0 - mu if self.smaller else -mu

    def origin_exact(self, mu: Fraction) -> Fraction:
        """`origin` without rounding."""
        return 1 - mu if self.smaller else -mu

    def unknowns(self, x: float, velocity: float, half_period: float, mu: float) -> Vector:
        """The unknowns of an orbit, shape (4,)."""
        unit = self.unit(mu)
        time = half_period if self.smaller else (half_period - np.pi) / mu
        return np.array([(x - self.origin(mu)) / unit, velocity / unit, time, np.log(mu)])

    def half_period(self, unknowns: Vector) -> float:
        """T, nondimensional."""
        return float(unknowns[2] if self.smaller else np.pi + np.exp(unknowns[LOG_MU]) * unknowns[2])

    def point(self, place: Vector, mu: float) -> tuple[float, float]:
        """x and vy of a scaled position and velocity."""
        unit = self.unit(mu)
        return self.origin(mu) + unit * float(place[0]), unit * float(place[1])


@dataclass(frozen=True)
class Evaluation:
    """The equations at one point.

    Attributes:
        residual: shape (3,), scaled by the chart.
        jacobian: shape (3, 4), in the chart's unknowns.
        jacobi_constant: of the start.
        jacobi_gradient: shape (4,), its derivative in the unknowns.
        second: shape (2,), scaled position and velocity half a period later.
    """

    residual: Vector
    jacobian: Matrix
    jacobi_constant: float
    jacobi_gradient: Vector
    second: Vector


def evaluate(chart: MassChart, unknowns: Vector) -> Evaluation:
    """The equations of symmetry breaking with their derivatives; raises `FlowFailure` near a singularity."""
    residual, jacobian, level, gradient, second, ok = _equations_of(chart)(unknowns)
    result = Evaluation(
        np.asarray(residual), np.asarray(jacobian).T, float(level), np.asarray(gradient), np.asarray(second)
    )
    if not bool(ok) or not np.all(np.isfinite(result.jacobian)):
        raise FlowFailure(f"the orbit at mu = {np.exp(unknowns[LOG_MU]):.3g} could not be integrated")
    return result


@cache
def _equations_of(of: MassChart) -> Callable[[Vector], Any]:
    configure_jax()
    chart: Any = _NEAR_SMALLER[of.family] if of.smaller else _AroundLarger

    def flow(unknowns: jax.Array) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
        mu = jnp.exp(unknowns[LOG_MU])
        duration = chart.duration(unknowns[2], mu)

        # Time runs from 0 to 1: the end of the integration must not depend on what is differentiated.
        def field(fraction: Any, state: Any, arguments: Any) -> Any:
            duration, mu = arguments
            return duration * jnp.stack(chart.field(duration * fraction, state, mu))

        start = jnp.stack(chart.start(unknowns[0], unknowns[1]))
        end, _, reached = integrate(field, start, 1.0, (duration, mu))
        second = jnp.stack([end[0], end[3]])
        return jnp.stack(chart.equations(end, unknowns[2], mu)), (second, reached)

    def level(unknowns: jax.Array) -> Any:
        return chart.jacobi_constant(unknowns[0], unknowns[1], jnp.exp(unknowns[LOG_MU]))

    def everything(unknowns: jax.Array) -> tuple[jax.Array, ...]:
        def push(direction: jax.Array) -> tuple[jax.Array, jax.Array, tuple[jax.Array, jax.Array]]:
            return jax.jvp(flow, (unknowns,), (direction,), has_aux=True)

        residual, columns, (second, ok) = jax.vmap(push, out_axes=(None, 0, None))(jnp.eye(UNKNOWNS))
        return residual, columns, level(unknowns), jax.grad(level)(unknowns), second, ok

    return compiled(everything)


class _NearSmaller:
    """State (xi, eta, xi', eta', zeta, zeta')."""

    @staticmethod
    def duration(time: Any, mu: Any) -> Any:
        return time

    @staticmethod
    def start(a: Any, v: Any) -> list[Any]:
        zero = jnp.zeros(())
        return [a, zero, zero, v, zero + 1.0, zero]

    @staticmethod
    def field(t: Any, state: Any, mu: Any) -> list[Any]:
        xi, eta, vx, vy, zeta, slope = state
        h = jnp.cbrt(mu)
        square = xi * xi + eta * eta
        u = 2.0 * xi + h * square
        s = jnp.sqrt(1.0 + h * u)
        c = u * (1.0 + s + s * s) / ((1.0 + s) * s**3)
        near = square**-1.5
        return [
            vx,
            vy,
            2.0 * vy + mu * xi + (1.0 - mu) * (1.0 + h * xi) * c - near * xi,
            -2.0 * vx + (mu + (1.0 - mu) * h * c) * eta - near * eta,
            slope,
            -((1.0 - mu) * (1.0 - h * c) + near) * zeta,
        ]

    @staticmethod
    def equations(end: Any, time: Any, mu: Any) -> list[Any]:
        return [end[1], end[2], end[5]]

    @staticmethod
    def jacobi_constant(a: Any, v: Any, mu: Any) -> Any:
        # The terms of order 1 and h, multiplied out so that they do not cancel.
        h = jnp.cbrt(mu)
        scaled = a * a + 2.0 / jnp.abs(a) - v * v + 2.0 * (1.0 - mu) * a * a / (1.0 + h * a)
        return (1.0 - mu) * (3.0 - mu) + h * h * scaled


class _AxialNearSmaller(_NearSmaller):
    """Near the smaller primary, where axial orbits are born: zeta(0) = 0, zeta'(0) = 1, and zeta(T) = 0."""

    @staticmethod
    def start(a: Any, v: Any) -> list[Any]:
        zero = jnp.zeros(())
        return [a, zero, zero, v, zero, zero + 1.0]

    @staticmethod
    def equations(end: Any, time: Any, mu: Any) -> list[Any]:
        return [end[1], end[2], end[4]]


_NEAR_SMALLER = {HALO: _NearSmaller, AXIAL: _AxialNearSmaller}


class _AroundLarger:
    """State (X, y, vx, vy, zeta, zeta', E, w)."""

    @staticmethod
    def duration(time: Any, mu: Any) -> Any:
        return jnp.pi + mu * time

    @staticmethod
    def start(a: Any, v: Any) -> list[Any]:
        zero = jnp.zeros(())
        return [a, zero, zero, v, zero + 1.0, zero, zero, zero]

    @staticmethod
    def field(t: Any, state: Any, mu: Any) -> list[Any]:
        big_x, y, vx, vy, zeta, slope, _, _ = state
        far = (big_x * big_x + y * y) ** -1.5
        near = ((big_x - 1.0) * (big_x - 1.0) + y * y) ** -1.5
        # In the rotating directions, which are the inertial ones turned by t.
        force_x, force_y = -(big_x - 1.0) * near - 1.0, -y * near
        speed_x, speed_y = vx - y, vy + big_x
        momentum = big_x * speed_y - y * speed_x
        torque = big_x * force_y - y * force_x
        turn_x = force_y * momentum + speed_y * torque
        turn_y = -force_x * momentum - speed_x * torque
        return [
            vx,
            vy,
            2.0 * vy + big_x - (1.0 - mu) * far * big_x + mu * force_x,
            -2.0 * vx + y - (1.0 - mu) * far * y + mu * force_y,
            slope,
            -((1.0 - mu) * far + mu * near) * zeta,
            jnp.sin(t) * turn_x + jnp.cos(t) * turn_y,
            jnp.cos(t) * (1.0 - near) * zeta,
        ]

    @staticmethod
    def equations(end: Any, time: Any, mu: Any) -> list[Any]:
        big_x, y, vx, vy, zeta, _, e, w = end
        momentum = big_x * (vy + big_x) - y * (vx - y)
        along = (vy + big_x) * momentum - (1.0 - mu) * big_x / jnp.sqrt(big_x * big_x + y * y)
        shift = time * jnp.sinc(mu * time / jnp.pi)  # sin(mu tau)/mu; the time at the end is pi + mu tau
        return [y, e + along * shift, w + (vy + big_x) * zeta * shift]

    @staticmethod
    def jacobi_constant(a: Any, v: Any, mu: Any) -> Any:
        x = a - mu
        return x * x + 2.0 * (1.0 - mu) / jnp.abs(a) + 2.0 * mu / jnp.abs(a - 1.0) - v * v
