"""Invariant curves of the return map of the CR3BP at fixed Jacobi constant: Newton's method on Fourier coefficients.

The section is y = 0 with the sign of vy kept; at a Jacobi constant C its coordinates are p = (x, z, vx, vz), and vy
follows. F is the return to the same side, the second crossing of the section. An invariant curve u with rotation
number rho satisfies F(u(theta)) = u(theta + rho); the orbits through it fill a torus. F is reversible under R, which
negates vx and vz, and the curves that are looked for are symmetric, u(-theta) = R u(theta):

    x, z = sum a_k cos(k theta), k = 0 .. N,      vx, vz = sum b_k sin(k theta), k = 1 .. N,

which leaves no freedom of phase. The equations at 2N + 1 equidistant angles are more than the 4N + 3 unknowns, which
include rho; Gauss-Newton steps solve them, with one more row that picks a curve from the family. The time of each
return is found together with the rest. Double precision; nothing here is proved.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orbitproof.explore.flow import Matrices, Matrix, Vector, flow_batch
from orbitproof.explore.numerics import NewtonRule
from orbitproof.shared.systems import CR3BP

PLANE = (0, 2, 3, 5)
"""Indices of x, z, vx, vz in the state."""

RULE = NewtonRule(tolerance=1e-12, accepted=3e-9, steps=12)
"""For the largest residual of the equations, nondimensional. Orbits that pass near a primary leave rounding errors of
some 1e-10 in it; what the curve is worth is measured apart (`measured`)."""


class NoCurve(Exception):
    """Newton's method found no invariant curve; one line says why."""


@dataclass(frozen=True)
class InvariantCurve:
    """A symmetric invariant curve of the return map.

    Attributes:
        mass: mass parameter.
        jacobi_constant: of all its points.
        side: sign of vy on the section.
        even: shape (2, N + 1), cosine coefficients of x and z.
        odd: shape (2, N), sine coefficients of vx and vz.
        rotation: rho, radians.
        times: shape (2N + 1,), times of return of the points at `angles`.
        error: largest distance between F(u(theta)) and u(theta + rho) at four times as many angles between them; NaN
            before it is measured.
    """

    mass: float
    jacobi_constant: float
    side: float
    even: Matrix
    odd: Matrix
    rotation: float
    times: Vector
    error: float = float("nan")

    @property
    def modes(self) -> int:
        """N."""
        return self.odd.shape[1]

    @property
    def angles(self) -> Vector:
        """Shape (2N + 1,), equidistant."""
        return np.arange(2 * self.modes + 1) * 2 * np.pi / (2 * self.modes + 1)

    @property
    def amplitude(self) -> float:
        """The length of all coefficients but the means."""
        return float(np.sqrt(np.sum(self.even[:, 1:] ** 2) + np.sum(self.odd**2)))

    @property
    def tail(self) -> float:
        """The largest coefficient in the upper fourth of the modes over the largest of all modes."""
        sizes = np.maximum(np.abs(self.even[:, 1:]).max(axis=0), np.abs(self.odd).max(axis=0))
        return float(sizes[-max(1, self.modes // 4) :].max() / sizes.max())

    @cached_property
    def unknowns(self) -> Vector:
        """Shape (4N + 3,): even, odd, rho."""
        return np.concatenate([self.even.ravel(), self.odd.ravel(), [self.rotation]])

    def with_unknowns(self, unknowns: Vector, times: Vector) -> InvariantCurve:
        """The curve with other coefficients and rotation number."""
        size = 2 * (self.modes + 1)
        return InvariantCurve(
            self.mass,
            self.jacobi_constant,
            self.side,
            unknowns[:size].reshape(2, -1),
            unknowns[size:-1].reshape(2, -1),
            float(unknowns[-1]),
            times,
        )

    def with_modes(self, modes: int) -> InvariantCurve:
        """This curve with more modes, the new coefficients zero."""
        more = modes - self.modes
        angles = np.arange(2 * modes + 1) * 2 * np.pi / (2 * modes + 1)
        times = np.interp(angles, np.append(self.angles, 2 * np.pi), np.append(self.times, self.times[0]))
        pad = ((0, 0), (0, more))
        return InvariantCurve(
            self.mass,
            self.jacobi_constant,
            self.side,
            np.pad(self.even, pad),
            np.pad(self.odd, pad),
            self.rotation,
            times,
        )

    def basis(self, angles: Vector) -> Matrices:
        """Derivatives of the points at angles in all coefficients, shape (len(angles), 4, 4N + 2)."""
        n = self.modes
        cosines = np.cos(np.outer(angles, np.arange(n + 1)))
        sines = np.sin(np.outer(angles, np.arange(1, n + 1)))
        rows = np.zeros((len(angles), 4, 4 * n + 2))
        for index in range(2):
            rows[:, index, index * (n + 1) : (index + 1) * (n + 1)] = cosines
            start = 2 * (n + 1) + index * n
            rows[:, 2 + index, start : start + n] = sines
        return rows

    def points(self, angles: Vector) -> Matrix:
        """x, z, vx, vz at angles, shape (len(angles), 4)."""
        return np.asarray(self.basis(angles) @ self.unknowns[:-1])

    def slopes(self, angles: Vector) -> Matrix:
        """Derivatives of the points in the angle, shape (len(angles), 4)."""
        orders = np.arange(1, self.modes + 1)
        sines, cosines = np.sin(np.outer(angles, orders)), np.cos(np.outer(angles, orders))
        return np.hstack([-sines @ (orders * self.even[:, 1:]).T, cosines @ (orders * self.odd).T])

    def states(self, angles: Vector) -> Matrix:
        """Full states at angles, shape (len(angles), 6). Raises `NoCurve` where there is no vy."""
        return _lifted(self.points(angles), self.mass, self.jacobi_constant, self.side)[0]


def _lifted(points: Matrix, mass: float, level: float, side: float) -> tuple[Matrix, Matrices]:
    """States of points of the section, shape (M, 6), and their derivatives in the points, shape (M, 6, 4)."""
    x, z, vx, vz = points.T
    first, second = np.hypot(x + mass, z), np.hypot(x + mass - 1, z)
    potential = x * x + 2 * (1 - mass) / first + 2 * mass / second
    square = potential - level - vx * vx - vz * vz
    if not np.all(square > 0):
        raise NoCurve("the curve leaves the part of the section that its Jacobi constant allows")
    vy = side * np.sqrt(square)
    states = np.zeros((len(points), 6))
    states[:, list(PLANE)] = points
    states[:, 4] = vy
    slope_x = 2 * x - 2 * (1 - mass) * (x + mass) / first**3 - 2 * mass * (x + mass - 1) / second**3
    slope_z = -2 * z * ((1 - mass) / first**3 + mass / second**3)
    lift = np.zeros((len(points), 6, 4))
    for column, row in enumerate(PLANE):
        lift[:, row, column] = 1.0
    lift[:, 4, :] = np.column_stack([slope_x, slope_z, -2 * vx, -2 * vz]) / (2 * vy[:, None])
    return states, lift


def returns(
    points: Matrix, times: Vector, mass: float, level: float, side: float
) -> tuple[Matrix, Matrices, Vector, Vector]:
    """The return map at M points, from guesses of the times of return.

    Returns the images, shape (M, 4), corrected to first order in what the times are off; the derivatives, shape
    (M, 4, 4); corrected times, and how far y is from 0 at the guesses. Raises `NoCurve` near a collision.
    """
    states, lift = _lifted(points, mass, level, side)
    flow = flow_batch(CR3BP, states, times, np.full((len(points), 1), mass))
    if not np.all(flow.finished):
        raise NoCurve("an orbit of the torus could not be integrated (near a collision)")
    speed = flow.velocities[:, 1]
    if not np.all(side * speed > 0):
        raise NoCurve("an orbit of the torus becomes tangent to the section")
    late = flow.states[:, 1] / speed
    images = flow.states - flow.velocities * late[:, None]
    projected = (
        flow.state_transitions
        - flow.velocities[:, :, None] * (flow.state_transitions[:, 1] / speed[:, None])[:, None, :]
    )
    derivatives = (projected @ lift)[:, list(PLANE)]
    return images[:, list(PLANE)], derivatives, times - late, np.abs(flow.states[:, 1])


def equations(curve: InvariantCurve) -> tuple[Vector, Matrix, Vector, float]:
    """Residuals, shape (4 (2N + 1),), their derivatives in the unknowns, corrected times, how far these were off."""
    angles = curve.angles
    images, derivatives, times, late = returns(
        curve.points(angles), curve.times, curve.mass, curve.jacobi_constant, curve.side
    )
    ahead = angles + curve.rotation
    residual = images - curve.points(ahead)
    jacobian = derivatives @ curve.basis(angles) - curve.basis(ahead)
    matrix = np.concatenate([jacobian, -curve.slopes(ahead)[:, :, None]], axis=2)
    return residual.ravel(), matrix.reshape(-1, matrix.shape[2]), times, float(late.max())


def correct(guess: InvariantCurve, normal: Vector) -> InvariantCurve:
    """The invariant curve in the hyperplane through a guess with the given normal, shape (4N + 3,).

    Raises `NoCurve`.
    """
    curve, last = guess, np.inf
    for _ in range(RULE.steps):
        residual, jacobian, times, late = equations(curve)
        size = max(float(np.abs(residual).max()), late)
        found, lost = RULE.judge(size, last)
        if found:
            return curve.with_unknowns(curve.unknowns, times)
        if lost:
            break
        offset = float(normal @ (curve.unknowns - guess.unknowns))
        step, *_ = np.linalg.lstsq(np.vstack([jacobian, normal]), np.append(residual, offset), rcond=1e-12)
        curve, last = curve.with_unknowns(curve.unknowns - step, times), size
    raise NoCurve(f"Newton's method does not converge: the equations hold to {last:.1e}")


def measured(curve: InvariantCurve, parts: int = 4) -> float:
    """The error of invariance at `parts` times as many angles, most of them between those of the equations."""
    count = parts * len(curve.angles)
    angles = (np.arange(count) + 0.5) * 2 * np.pi / count
    times = np.interp(angles, np.append(curve.angles, 2 * np.pi), np.append(curve.times, curve.times[0]))
    points = curve.points(angles)
    for _ in range(3):
        images, _, times, _ = returns(points, times, curve.mass, curve.jacobi_constant, curve.side)
    return float(np.abs(images - curve.points(angles + curve.rotation)).max())


def tangent(curve: InvariantCurve, direction: Vector) -> Vector:
    """Unit tangent of the family at a curve, on the side of `direction`, shape (4N + 3,)."""
    _, jacobian, _, _ = equations(curve)
    result = np.linalg.svd(jacobian)[2][-1]
    return np.asarray(result if result @ direction >= 0 else -result)
