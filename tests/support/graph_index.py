"""The Conley-Zehnder index in double precision by another way: the graph of the linearised flow over the whole orbit.

Nothing of the code under test is used, nor that the orbit is symmetric: the index is that of the path of graphs with
respect to the diagonal.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import logm

_TIMES = 801


def canonical(vector: Any) -> Any:
    """q - i p of variations of (x, y, z, vx, vy, vz), or of a state but for constants."""
    x, y, z, vx, vy, vz = vector
    return np.array([x - 1j * (vx - y), y - 1j * (vy + x), z - 1j * vz])


class Problem:
    """The CR3BP with its variations, in time."""

    def __init__(self, mu: float) -> None:
        self.masses = ((1 - mu, -mu), (mu, 1 - mu))
        self.turning = np.array([[0, 2, 0], [-2, 0, 0], [0, 0, 0]])

    def forces(self, place: Any) -> tuple[Any, Any]:
        """Those that depend on the place, and their derivatives."""
        force, slope = place * [1, 1, 0], np.diag([1.0, 1.0, 0.0])
        for mass, centre in self.masses:
            along = place - [centre, 0, 0]
            distance = np.linalg.norm(along)
            force = force - mass * along / distance**3
            slope = slope - mass * (np.eye(3) / distance**3 - 3 * np.outer(along, along) / distance**5)
        return force, slope

    def field(self, _: float, flat: Any) -> Any:
        """Of the state, and of the matrix of its variations if that follows."""
        place, velocity, change = flat[:3], flat[3:6], flat[6:].reshape(6, -1)
        force, slope = self.forces(place)
        rates = np.vstack([change[3:], slope @ change[:3] + self.turning @ change[3:]])
        return np.concatenate([velocity, force + self.turning @ velocity, rates.ravel()])

    def time_of_crossing(self, state: Any, number: int, section: int) -> float:
        """Of the plane where a coordinate is 0, after the start."""

        def height(_: float, flat: Any) -> Any:
            return flat[section]

        # The start may count as one.
        height.terminal = number + 1  # type: ignore[attr-defined]
        run = solve_ivp(self.field, (0, 20), state, "DOP853", events=height, rtol=1e-12, atol=1e-13)
        return float(run.t_events[0][run.t_events[0] > 1e-6][number - 1])

    def linearised(self, state: Any, period: float) -> tuple[Any, Any]:
        """The gradient of the energy, and Psi(t) of a basis, in C^3, over one period; shapes (3, K), (3, 6, K)."""
        begun, times = np.concatenate([state, np.eye(6).ravel()]), np.linspace(0, period, _TIMES)
        run = solve_ivp(self.field, (0, period), begun, "DOP853", times, rtol=1e-11, atol=1e-12)
        vx, vy, vz = run.y[3:6]
        force = np.array([self.forces(place)[0] for place in run.y[:3].T]).T
        # H = (p_x + y)^2/2 + (p_y - x)^2/2 + p_z^2/2 + ..; the velocities are its derivatives by p.
        by_place = np.array([-vy - force[0], vx - force[1], -force[2]])
        gradient = by_place - 1j * np.array([vx, vy, vz])
        changes = run.y[6:].reshape(6, 6, -1)
        return gradient, np.array([canonical(changes[:, column]) for column in range(6)]).transpose(1, 0, 2)


def closed_frame(gradient: Any) -> Any:
    """Unitary matrices along a closed orbit, the first column the unit vector of the gradient, of degree 0."""
    unit = gradient / np.linalg.norm(gradient, axis=0)
    size, count = unit.shape
    frames = np.zeros((count, size, size), complex)
    basis = np.linalg.svd(unit[:, :1].conj().T)[2].conj().T[:, 1:]
    for number in range(count):
        normal = unit[:, number : number + 1]
        basis = basis - normal @ (normal.conj().T @ basis)
        left, _, right = np.linalg.svd(basis, full_matrices=False)
        basis = left @ right
        frames[number] = np.hstack([normal, basis])
    turned = logm(frames[0, :, 1:].conj().T @ frames[-1, :, 1:])
    values, vectors = np.linalg.eig(turned)
    share = np.linspace(0, 1, count)
    for number in range(count):
        undone = vectors @ np.diag(np.exp(-values * share[number])) @ np.linalg.inv(vectors)
        frames[number, :, 1:] = frames[number, :, 1:] @ undone
    # Frames and phases have to be followed in small steps.
    assert np.abs(np.diff(np.unwrap(np.angle(np.linalg.det(frames))))).max() < 0.5
    degree = round(float(np.unwrap(np.angle(np.linalg.det(frames)))[[0, -1]] @ [-1, 1]) / (2 * np.pi))
    frames[:, :, 1] *= np.exp(-2j * np.pi * degree * share)[:, None]
    return frames


def index_of_path(path: Any) -> int:
    """Of symplectic maps of C^n from the identity, by the images of a real basis; shape (K, n, 2n)."""
    basis = path[0]
    reference = np.vstack([basis.conj(), basis])
    turned = reference @ np.linalg.inv(reference.conj())
    phases = []
    for images in path:
        graph = np.vstack([basis.conj(), images])
        relative = graph @ np.linalg.inv(graph.conj()) @ np.linalg.inv(turned)
        phases.append(np.linalg.eigvals(relative))
    total = np.unwrap(np.angle(np.prod(phases, axis=1)))
    ends = np.mod(np.angle(phases[-1]), 2 * np.pi)
    assert np.abs(np.diff(total)).max() < 2.0
    turns = (total[-1] - total[0] - ends.sum()) / (2 * np.pi)
    assert abs(turns - round(turns)) < 1e-3
    found = round(turns) + len(basis)
    # Where double precision does not follow variations well, the parity is that of no such map.
    begun, ended = (np.vstack([images.real, images.imag]) for images in (basis, path[-1]))
    assert np.linalg.det((ended - begun) @ np.linalg.inv(begun)) * (-1) ** (found - len(basis)) > 0
    return found


def index_of_orbit(state: Any, mu: float, crossings: int, section: int = 1) -> tuple[int, ...]:
    """Of a periodic orbit of the CR3BP whose half meets {y = 0}, or another plane, so often.

    Of a planar one that in the plane and that across it.
    """
    problem = Problem(mu)
    gradient, flow = problem.linearised(state, 2 * problem.time_of_crossing(state, crossings, section))
    if state[2] or state[5]:
        return (_transverse(gradient, flow, (0, 1, 2), range(6)),)
    across = flow[2:, [2, 5]].transpose(2, 0, 1)
    return _transverse(gradient[:2], flow[:2], (0, 1), (0, 1, 3, 4)), index_of_path(across)


def _transverse(gradient: Any, flow: Any, axes: Any, columns: Any) -> int:
    """In a closed frame of degree 0."""
    frames = closed_frame(gradient)
    flow = flow[:, list(columns)]
    # Real combinations of the basis that are the frame of the complement at the start, and i times it.
    wanted = np.hstack([frames[0, :, 1:], 1j * frames[0, :, 1:]])
    real = np.vstack([flow[:, :, 0].real, flow[:, :, 0].imag])
    factors = np.linalg.solve(real, np.vstack([wanted.real, wanted.imag]))
    images = np.einsum("kaj,akb,bc->kjc", frames.conj(), flow.transpose(0, 2, 1), factors)
    return index_of_path(images[:, 1:])
