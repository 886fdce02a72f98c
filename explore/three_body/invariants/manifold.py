"""Stable and unstable manifolds of a periodic orbit of the CR3BP, as tubes of orbits up to a section.

Orbits start at points along the periodic orbit, moved by a small distance along the eigenvector of its largest
(unstable) or smallest (stable) real multiplier, and run forwards or backwards in time to a plane. Double precision, to
first order in the distance; nothing here is proved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import FlowFailure, Matrices, Matrix, Vector, flow_of
from orbitproof.explore.orbits import PeriodicSolution
from orbitproof.explore.three_body.seeds import distance_to_primaries
from orbitproof.shared.systems import ReversibleSystem

TOLERANCE = 1e-12
ROWS = 120
_FINE, _LEAST = 16, 1e-300
HYPERBOLIC = 1.05
"""Stability index above which there is a manifold that a tube can be drawn of."""


class NoManifold(Exception):
    """There is no tube; one line says why."""


@dataclass(frozen=True)
class Plane:
    """The section: a state coordinate (index 0, 1, 2 for x, y, z) that takes a value."""

    index: int
    value: float

    def __str__(self) -> str:
        return f"{'xyz'[self.index]} = {self.value:.12g}"


@dataclass(frozen=True)
class Manifold:
    """A tube of N orbits.

    Attributes:
        kind: "unstable" or "stable".
        side: +1 or -1, the side of the periodic orbit on which they start: the sign of the eigenvector's x there.
        multiplier: the multiplier that belongs to the manifold.
        offset: distance in space of the starting points from the periodic orbit.
        plane: the section.
        starts: shape (N, 6), the first states.
        ends: shape (N, 6), the states on the section; NaN for an orbit that does not reach it.
        times: shape (N,), from start to section, negative for a stable manifold; NaN likewise.
        paths: shape (N, `ROWS`, 3), places up to the section or the longest time, closer where an orbit turns.
        drift: largest change of the Jacobi constant along an orbit that reaches the section.
    """

    kind: str
    side: int
    multiplier: float
    offset: float
    plane: Plane
    starts: Matrix
    ends: Matrix
    times: Vector
    paths: Matrices
    drift: float

    @property
    def reached(self) -> np.ndarray:
        """Shape (N,), which orbits reach the section."""
        return np.isfinite(self.times)


def manifold_of(
    solution: PeriodicSolution,
    mass: float,
    *,
    index: float | None = None,
    kind: str,
    side: int,
    plane: Plane,
    count: int = 60,
    offset: float = 1e-5,
    longest: float = 20.0,
    progress: Callable[[str, float], None] | None = None,
) -> Manifold:
    """The tube of a periodic orbit on one side of it.

    Arguments:
        solution: the orbit, of one of `shared.systems.THREE_BODY`.
        index: stability index, if it is known better than from one integration along the orbit.
        kind, side, plane, offset: as in `Manifold`.
        count: orbits of the tube.
        longest: time after which an orbit that has not reached the plane is given up.

    Raises `NoManifold` if the orbit has no real multiplier far from the unit circle.
    """
    system, start, period = solution.system, solution.starts[0], solution.period
    assert isinstance(system, ReversibleSystem)
    flow = flow_of(system)
    try:
        monodromy = flow.derivative(start, period, [mass]).state_transition
    except FlowFailure as failure:
        raise NoManifold(str(failure)) from None
    values, vectors = np.linalg.eig(monodromy if kind == "unstable" else np.linalg.inv(monodromy))
    place = int(np.argmax(np.abs(values)))
    size = float(np.abs(values[place]))
    index = (size + 1 / size) / 2 if index is None else index
    if index < HYPERBOLIC:
        raise NoManifold(f"the orbit is not unstable: stability index {index:.6g}")
    if abs(values[place].imag) > 1e-6 * size:
        raise NoManifold("the largest multiplier is not real: its manifold has three dimensions")
    vector = vectors[:, place].real
    multiplier = float(values[place].real) if kind == "unstable" else 1 / float(values[place].real)
    vector = vector if vector[0] * side > 0 else -vector
    phases = np.arange(count) * period / count
    starts = np.empty((count, 6))
    for row, phase in enumerate(phases):
        here = flow.derivative(start, float(phase), [mass]) if phase else None
        state = start if here is None else here.state
        along = vector if here is None else here.state_transition @ vector
        starts[row] = state + offset * along / np.linalg.norm(along[:3])
    direction = 1.0 if kind == "unstable" else -1.0
    lines = []
    for row in range(count):
        lines.append(_run(system, starts[row], mass, plane, direction * longest))
        if progress is not None:
            progress(f"orbit {row + 1} of {count}", (row + 1) / count)
    ends, times = np.array([line[0] for line in lines]), np.array([line[1] for line in lines])
    reached = np.isfinite(times)
    assert system.first_integral is not None
    levels = [np.asarray(system.first_integral(rows[reached].T, [mass])[0]) for rows in (starts, ends)]
    drift = float(np.abs(levels[1] - levels[0]).max()) if reached.any() else float("nan")
    paths = np.array([line[2] for line in lines])
    return Manifold(kind, side, multiplier, offset, plane, starts, ends, times, paths, drift)


def _run(
    system: ReversibleSystem, start: Vector, mass: float, plane: Plane, time: float
) -> tuple[Vector, float, Matrix]:
    """The state on the plane and the time there, NaN if it is not reached, and places on the way."""
    # Only now: scipy takes a moment to load.
    from scipy.integrate import solve_ivp

    def field(_: float, state: Vector) -> Sequence[float]:
        return system.vector_field(state.tolist(), [mass])

    def height(_: float, state: Vector) -> float:
        return float(state[plane.index] - plane.value)

    def collision(_: float, state: Vector) -> float:
        return distance_to_primaries(state, mass) - 1e-4

    height.terminal = collision.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        field, (0.0, time), start, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE, dense_output=True,
        events=(height, collision),
    )  # fmt: skip
    last = float(solution.t[-1])
    path = solution.sol(_times(solution.sol, last))[:3].T
    if len(solution.t_events[0]):
        return solution.y_events[0][0], float(solution.t_events[0][0]), path
    return np.full(6, np.nan), float("nan"), path


def _times(places: Callable[[Vector], Matrix], last: float) -> Vector:
    """Times from 0 to the last one, shape (`ROWS`,): closer where an orbit is fast or turns: smooth lines."""
    times = np.linspace(0.0, last, _FINE * ROWS)
    steps = np.diff(places(times)[:3].T, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    ahead = steps / np.maximum(lengths, np.finfo(float).tiny)[:, None]
    turns = np.append(0.0, np.linalg.norm(np.diff(ahead, axis=0), axis=1))
    done = np.append(0.0, np.cumsum(lengths / max(lengths.sum(), _LEAST) + turns / max(turns.sum(), _LEAST)))
    return np.interp(np.linspace(0.0, done[-1], ROWS), done, times)
