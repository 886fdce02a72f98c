"""Regularised coordinates near the smaller primary of the CR3BP: Kustaanheimo-Stiefel (KS).

With rho = r - (1 - mu, 0, 0) and r_2 = |rho|, put (rho, 0) = L(u) u, |u|^2 = r_2, and take the time s with
dt = r_2 ds. The equations of u and w = du/ds have no singularity at the smaller primary, and orbits that
pass close to it are expanded in long steps. They are a way to compute the Poincare map of the CR3BP,
not another statement: section 14, proves that the orbits are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from orbitproof.shared.systems.names import LEVEL_NAME
from orbitproof.shared.systems.program import Program, record
from orbitproof.shared.systems.system import ReversibleSystem
from orbitproof.shared.systems.three_body import CR3BP

_HALF = Fraction(1, 2)

Embedding = Callable[[Sequence[Any], Sequence[Any], int], Sequence[Any]]


@dataclass(frozen=True)
class Regularisation:
    """Coordinates v and a time s in which the orbits of a system are followed.

    Attributes:
        name: what certificates call them.
        system: the system whose orbits they are.
        state: names of the coordinates; one of them is the system's section coordinate, one the system's time.
        time: the coordinate that is the system's time; its derivative is positive as long as v describes an orbit.
        vector_field: dv/ds, called with (v, parameters, level of the first integral).
        embedding: v of a point of the section, called with (state, parameters, branch). `branch` = 1 or -1 chooses
            one of two formulas, each valid on a part of the section.
        branch: which of them suits a point, called with float values (state, parameters).
        projection: the system's state, called with (v, parameters).
        section: the section coordinate as it follows from the others, called with v.
    """

    name: str
    system: ReversibleSystem
    state: tuple[str, ...]
    time: str
    vector_field: Callable[[Sequence[Any], Sequence[Any], Sequence[Any]], Sequence[Any]]
    embedding: Embedding
    branch: Callable[[Sequence[float], Sequence[float]], int]
    projection: Callable[[Sequence[Any], Sequence[Any]], Sequence[Any]]
    section: Callable[[Sequence[Any]], Any]

    @cached_property
    def section_index(self) -> int:
        """Index of the section coordinate in `state`."""
        return self.state.index(self.system.section)

    @cached_property
    def time_index(self) -> int:
        """Index of the system's time in `state`."""
        return self.state.index(self.time)

    @cached_property
    def program(self) -> Program:
        """The vector field; inputs: v, parameters, level of the first integral."""
        return record(self.vector_field, self.state, tuple(self.system.parameters), (LEVEL_NAME,))

    def embedding_program(self, branch: int) -> Program:
        """v of a point of the section; inputs: the system's state, parameters."""

        def embed(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
            return self.embedding(state, parameters, branch)

        return record(embed, self.system.state, tuple(self.system.parameters))

    @cached_property
    def projection_program(self) -> Program:
        """The system's state; inputs: v, parameters."""
        return record(self.projection, self.state, tuple(self.system.parameters))

    @cached_property
    def section_program(self) -> Program:
        """The section coordinate from the others; inputs: v."""
        return record(lambda v: (self.section(v),), self.state)


def _square(value: Any) -> Any:
    return value * value


def _quadratics(v: Sequence[Any]) -> tuple[Any, Any, Any]:
    """r_2, rho_1 and rho_3: |u|^2 and two components of L(u) u."""
    u1, u2, u3, u4 = v[:4]
    outer, inner = _square(u1) + _square(u4), _square(u2) + _square(u3)
    return outer + inner, outer - inner, 2 * (u1 * u3 + u2 * u4)


def _conjugate_product(a: Any, b: Any, c: Any, d: Any) -> tuple[Any, Any]:
    """Real and imaginary part of (a + i b)(c - i d), by three products."""
    shared = (a + b) * c
    return shared + b * (d - c), shared - a * (c + d)


def _symmetric_product(a: Any, c: Any, b: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """a x - b y and c y - b x, by three products."""
    shared = b * (x + y)
    return (a + b) * x - shared, (c + b) * y - shared


def _kustaanheimo_stiefel(v: Sequence[Any], parameters: Sequence[Any], level: Sequence[Any]) -> Sequence[Any]:
    u1, u2, u3, u4, w1, w2, w3, w4, _, _ = v
    (mu,) = parameters
    (jacobi,) = level
    larger = 1 - mu
    distance, rho1, rho3 = _quadratics(v)
    square = _square(distance)
    # r_1^2 - r_2^2, which also multiplies T in P and M.
    difference = 1 + 2 * rho1
    pull = larger * (difference + square) ** -1.5
    common = _HALF * (3 * square - _square(rho3) + 2 * larger * rho1 + _square(larger) - jacobi) + pull * difference
    along = distance * (larger - pull)
    off_plane = _HALF * (distance * rho3)
    outer, inner = _HALF * (common + along), _HALF * (common - along)
    force1, force3 = _symmetric_product(outer, inner, off_plane, u1, u3)
    force4, force2 = _symmetric_product(outer, inner, off_plane, u4, u2)
    (slope3, slope_y), (more3, more_y) = _conjugate_product(w3, w2, u1, u4), _conjugate_product(u3, u2, w1, w4)
    turn = 2 * distance
    twist = 2 * (slope3 + more3)
    return (
        w1,
        w2,
        w3,
        w4,
        force1 + turn * w2 - twist * u4,
        force2 - turn * w1 + twist * u3,
        force3 + turn * w4 - twist * u2,
        force4 - turn * w3 + twist * u1,
        2 * (slope_y + more_y),
        distance,
    )


def _onto_spinors(state: Sequence[Any], parameters: Sequence[Any], branch: int) -> Sequence[Any]:
    x, y, z, vx, vy, vz = state
    (mu,) = parameters
    rho1 = x - (1 - mu)
    distance = (_square(rho1) + _square(z)) ** _HALF
    if branch > 0:
        a = (_HALF * (distance + rho1)) ** _HALF
        c = _HALF * (z / a)
    else:
        c = (_HALF * (distance - rho1)) ** _HALF
        a = _HALF * (z / c)
    # w = L(u)^T v / 2, from rho' = 2 L(u) w and L(u) L(u)^T = r_2.
    half_x, half_y, half_z = _HALF * vx, _HALF * vy, _HALF * vz
    return (a, 0, c, 0, half_x * a + half_z * c, half_y * a, half_z * a - half_x * c, -(half_y * c), y, 0)


def _branch(state: Sequence[float], parameters: Sequence[float]) -> int:
    return 1 if state[0] - (1 - parameters[0]) >= 0 else -1


def _second_coordinate(v: Sequence[Any]) -> Any:
    u1, u2, u3, u4 = v[:4]
    return 2 * (u1 * u2 - u3 * u4)


def _from_spinors(v: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    u1, u2, u3, u4, w1, w2, w3, w4, y, _ = v
    (mu,) = parameters
    distance, rho1, rho3 = _quadratics(v)
    rate = 2 / distance
    return (
        rho1 + (1 - mu),
        y,
        rho3,
        rate * (u1 * w1 - u2 * w2 - u3 * w3 + u4 * w4),
        rate * (u2 * w1 + u1 * w2 - u4 * w3 - u3 * w4),
        rate * (u3 * w1 + u4 * w2 + u1 * w3 + u2 * w4),
    )


KUSTAANHEIMO_STIEFEL = Regularisation(
    name="Kustaanheimo-Stiefel",
    system=CR3BP,
    state=("u1", "u2", "u3", "u4", "w1", "w2", "w3", "w4", "y", "t"),
    time="t",
    vector_field=_kustaanheimo_stiefel,
    embedding=_onto_spinors,
    branch=_branch,
    projection=_from_spinors,
    section=_second_coordinate,
)

REGULARISATIONS: Mapping[str, Regularisation] = {CR3BP.name: KUSTAANHEIMO_STIEFEL}
"""The regularisation of a system, by the system's name."""
