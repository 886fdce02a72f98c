"""Atlases of axial families, from their birth on the planar family to that on the vertical one.

In the equations of `shared.systems.LIFTED` the family is a curve over eps2, the square of the speed across the plane
with which an orbit leaves the axis, that begins at the planar orbit of eps2 = 0. Near the vertical orbit from which
axial orbits are born it is a curve over the amplitude with which they leave vertical ones (`BirthPiece`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from operator import attrgetter

import numpy as np

from orbitproof.explore.atlases import FARTHEST, HalfReturns, LibrationFailure, orbit_at, zero_near
from orbitproof.explore.flow import Matrix, Vector, flow_of
from orbitproof.explore.three_body.atlases.births import (
    VX,
    VY,
    VZ,
    OrbitsAtBirth,
    X,
    Y,
    Z,
    birth_piece,
    is_down_to_noise,
)
from orbitproof.explore.three_body.atlases.graphs import pieces_of
from orbitproof.explore.three_body.atlases.lyapunov import LyapunovFamily
from orbitproof.explore.three_body.atlases.vertical import VerticalFamily, VerticalOrbit
from orbitproof.shared.formats import Atlas, Claim, Covers
from orbitproof.shared.systems import CR3BP, LIFTED, ReversibleSystem

"""Newton's method ends with a step below the tolerance, or one below the noise that is no shorter than the last."""
STEPS = 60
"""So many steps lead from the planar orbit to the end."""
OUTER = {"L1": -1, "L2": 1, "L3": -1}
"""On which side of the libration point the planar orbit starts: where eps2 increases all the way."""
BEFORE = 0.01
"""How far the pieces go beyond eps2 = 0 on the other side, relative to the end."""
WIDEST = {"L1": 0.28, "L2": 0.28, "L3": 0.16}
"""Part of the family that one piece may hold: where multipliers are in the hundreds, lists want narrow pieces, and
around L3, where derivatives across the family are nearly singular, what is left out along it has to be small."""
AMPLITUDE, LEAVES = 0.3, 0.85
"""Half-width of the piece of the birth, relative to the speed of the vertical orbit; up to which part it is used."""
WIDER, DIRECTION = {"L1": 5, "L2": 5, "L3": 40}, 10
"""Its tubes in x, z and vy in units of the relative ones of others, and that in the direction in units of those."""


@dataclass(frozen=True)
class AxialOrbit:
    """An axial orbit in the coordinates of `LIFTED`, with the slopes of the family there.

    Attributes:
        eps2: the square of its speed across the plane on the axis.
        x, vy: where it leaves the axis, and its speed in the plane.
        half_period: until it is on the axis again.
        slopes: shape (3,), derivatives of x, vy and the half period in eps2.
    """

    eps2: float
    x: float
    vy: float
    half_period: float
    slopes: Vector

    def is_far_from(self, other: AxialOrbit) -> bool:
        """Whether Newton's method may have led from one to another family."""
        return abs(self.half_period - other.half_period) > FARTHEST * other.half_period


@dataclass(frozen=True)
class AxialFamily:
    """The axial family of a collinear libration point, beginning at a planar orbit.

    Attributes:
        mu: the mass parameter, exact.
        planar: x, vy and half period of the planar orbit.
        step: of the continuation in eps2.
    """

    mu: Fraction
    planar: tuple[float, float, float]
    step: float
    _known: list[AxialOrbit] = field(default_factory=list, compare=False)

    @cached_property
    def returns(self) -> HalfReturns:
        """Half returns of the equations."""
        return HalfReturns(LIFTED, {"mu": self.mu})

    def orbit(self, place: float) -> AxialOrbit:
        """The orbit of eps2 = `place`, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            self._known.append(self._correct(0.0, *self.planar))
        return orbit_at(place, self._known, self.step, attrgetter("eps2"), self._beside, AxialOrbit.is_far_from)

    def _beside(self, near: AxialOrbit, eps2: float) -> AxialOrbit:
        x, vy, time = np.array([near.x, near.vy, near.half_period]) + (eps2 - near.eps2) * near.slopes
        return self._correct(eps2, float(x), float(vy), float(time))

    @property
    def system(self) -> ReversibleSystem:
        """The equations."""
        return LIFTED

    @property
    def constants(self) -> list[float]:
        """The parameters before eps2."""
        return [float(self.mu)]

    def start(self, place: float) -> tuple[float, float, float]:
        """x, vy and half period."""
        orbit = self.orbit(place)
        return orbit.x, orbit.vy, orbit.half_period

    def _correct(self, eps2: float, x: float, vy: float, time: float) -> AxialOrbit:
        """Newton's method for x, vy and the half period: y, z and vx vanish at its end."""
        wanted = [Y, Z, VX]

        def linearised(unknowns: Vector) -> tuple[Vector, Matrix, Vector]:
            start = [unknowns[0], 0.0, 0.0, 0.0, unknowns[1], 1.0]
            result = flow_of(LIFTED).derivative(start, unknowns[2], [float(self.mu), eps2])
            transition = result.state_transition
            columns = (transition[wanted, X], transition[wanted, VY], result.velocity[wanted])
            return result.state[wanted], np.stack(columns, axis=1), result.parameter_derivative[wanted]

        guess, where = np.array([x, vy, time]), f"at eps2 = {eps2:.6g}"
        unknowns, jacobian, rates = zero_near(guess, linearised, is_down_to_noise, where)
        return AxialOrbit(eps2, *map(float, unknowns), -np.linalg.solve(jacobian, rates))


def axial_atlas(point: str, mu: Fraction, label: str, tube: float) -> Atlas:
    """The atlas of an axial family from its birth on the planar family to that on the vertical one.

    Arguments:
        label: the mass as people call it.
        tube: half-width of the tubes relative to x and vy.

    Raises `LibrationFailure`.
    """
    planar = LyapunovFamily(point, mu)
    eps = planar.symmetry_breaking(OUTER[point], "axial")
    first = planar.orbit(eps)
    vertical = VerticalFamily(point, mu)
    born_at = vertical.birth()
    width = AMPLITUDE * float(np.sqrt(born_at.eps2))
    used = LEAVES * width
    sizes = WIDER[point] * np.array([1, 1, 1, DIRECTION])
    piece, ends = birth_piece(_at_vertical_orbit(vertical, born_at), width, used, tube * sizes)
    # Of the two points of an orbit on the axis the one that it leaves more slowly across the plane.
    end = min(ends, key=lambda each: abs(each[VZ]))
    goal = float(end[VZ] ** 2)
    start = planar.libration.x + eps, eps * first.vy, first.half_period
    family = AxialFamily(mu, start, goal / STEPS)
    arrived = family.orbit(goal)
    if max(abs(arrived.x - end[X]), abs(arrived.vy - end[VY])) > 1e-6:
        raise LibrationFailure(f"the axial family of {point} does not lead to the vertical family")
    return Atlas(
        id=f"axial-family-{point.lower()}-{label}",
        title=f"axial orbits of {point}, {label}, from the planar to the vertical family",
        system=LIFTED,
        parameters={"mu": mu},
        # A short number for the statement; the pieces go beyond it.
        claim=Claim("arc", None, ("eps2",), Covers("eps2", Fraction(0), Fraction(f"{0.9999 * goal:.5e}"))),
        pieces=(*pieces_of(family, -BEFORE * goal, goal, tube, WIDEST[point]), piece),
        provenance={"planar_birth": start[0], "vertical_birth": born_at.eps2, "amplitude": used},
    )


def _at_vertical_orbit(family: VerticalFamily, orbit: VerticalOrbit) -> OrbitsAtBirth:
    """Axial orbits near a vertical one."""
    state = flow_of(CR3BP).derivative(family.state(orbit), orbit.half_period, [float(family.mu)]).state
    return OrbitsAtBirth(family.mu, state[[X, Z, VY]], orbit.half_period, (Z, VX))
