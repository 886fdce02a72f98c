"""Atlases of axial families, from their birth on the planar family to that on the vertical one.

In the equations of `shared.systems.LIFTED` the family is a curve over eps2, the square of the speed across the plane
with which an orbit leaves the axis, that begins at the planar orbit of eps2 = 0. Near the vertical orbit from which
axial orbits are born it is a curve over the amplitude with which they leave vertical ones (`BirthPiece`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

import numpy as np

from orbitproof.explore.atlases.complex_flow import HalfReturns
from orbitproof.explore.atlases.graphs import pieces_of
from orbitproof.explore.atlases.lyapunov import LibrationFailure, LyapunovFamily
from orbitproof.explore.atlases.vertical import VerticalFamily
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.shared.formats import Atlas, BirthPiece, Claim, Covers
from orbitproof.shared.systems import CR3BP, LIFTED, ReversibleSystem

NEWTON_STEPS, TOLERANCE = 15, 1e-11
STEPS = 60
"""So many steps lead from the planar orbit to the end."""
OUTER = {"L1": -1, "L2": 1}
"""On which side of the libration point the planar orbit starts: where eps2 increases all the way."""
BEFORE = 0.01
"""How far the pieces go beyond eps2 = 0 on the other side, relative to the end."""
WIDEST = 0.28
"""Of all of the family on one piece: where multipliers are in the hundreds, lists want narrow pieces."""
AMPLITUDE, LEAVES = 0.3, 0.85
"""Half-width of the piece of the birth, relative to the speed of the vertical orbit; up to which part it is used."""
NODES = 10
"""Amplitudes at which its orbits are found, and as many coefficients of powers of their squares."""
WIDER, DIRECTION = 5, 10
"""Its tubes in x, z and vy in units of the relative ones of others, and that in the direction in units of those."""
X, Y, Z, VX, VY, VZ = range(6)


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
        """Of the equations."""
        return HalfReturns(LIFTED, {"mu": self.mu})

    def orbit(self, place: float) -> AxialOrbit:
        """The orbit of eps2 = `place`, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            self._known.append(self._correct(0.0, *self.planar))
        near = min(self._known, key=lambda orbit: abs(orbit.eps2 - place))
        count = int(np.ceil(abs(place - near.eps2) / self.step))
        for goal in np.linspace(near.eps2, place, count + 1)[1:]:
            x, vy, time = np.array([near.x, near.vy, near.half_period]) + (goal - near.eps2) * near.slopes
            near = self._correct(float(goal), float(x), float(vy), float(time))
            self._known.append(near)
        return near

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
        wanted, unknowns = [Y, Z, VX], np.array([x, vy, time])
        for _ in range(NEWTON_STEPS):
            start = [unknowns[0], 0.0, 0.0, 0.0, unknowns[1], 1.0]
            try:
                result = flow_of(LIFTED).derivative(start, unknowns[2], [float(self.mu), eps2])
            except FlowFailure as error:
                raise LibrationFailure(f"at eps2 = {eps2:.6g}: {error}") from None
            transition = result.state_transition
            columns = (transition[wanted, X], transition[wanted, VY], result.velocity[wanted])
            jacobian = np.stack(columns, axis=1)
            step = np.linalg.solve(jacobian, result.state[wanted])
            unknowns = unknowns - step
            if np.abs(step).max() < TOLERANCE:
                slopes = -np.linalg.solve(jacobian, result.parameter_derivative[wanted])
                return AxialOrbit(eps2, *map(float, unknowns), slopes)
        raise LibrationFailure(f"at eps2 = {eps2:.6g}: Newton's method does not converge")


@dataclass(frozen=True)
class BirthOfAxial:
    """Axial orbits near the vertical one from which they are born: at s they cross y = 0 off the axis with (vx, vz) =
    s directions (1, b).

    Attributes:
        mu: the mass parameter, exact.
        eps2: of the vertical orbit.
        middle: shape (3,), x, z and vy where it meets y = 0 off the axis.
        quarter: a quarter of its period.
    """

    mu: Fraction
    eps2: float
    middle: Vector
    quarter: float

    @classmethod
    def of(cls, family: VerticalFamily) -> BirthOfAxial:
        """The first on a vertical family. Raises `LibrationFailure`."""
        eps2 = family.birth()
        orbit = family.orbit(eps2)
        start = [family.libration.x + eps2 * orbit.x, 0.0, 0.0, 0.0, eps2 * orbit.vy, float(np.sqrt(eps2))]
        state = flow_of(CR3BP).derivative(start, orbit.half_period, [float(family.mu)]).state
        return cls(family.mu, eps2, state[[X, Z, VY]], orbit.half_period)

    @cached_property
    def directions(self) -> Matrix:
        """Columns: that in which axial orbits leave vertical ones, and a perpendicular one."""
        x, z, vy = self.middle
        result = flow_of(CR3BP).derivative([x, 0.0, z, 0.0, vy, 0.0], self.quarter, [float(self.mu)])
        rates = result.state_transition[np.ix_([Y, Z, VX], [VX, VZ])]
        # Until the orbits are in y = 0 again.
        at_section = rates[1:] - np.outer(result.velocity[[Z, VX]] / result.velocity[Y], rates[0])
        direction = np.linalg.svd(at_section)[2][-1]
        return np.array([[direction[0], -direction[1]], [direction[1], direction[0]]])

    def orbits(self, amplitudes: Vector) -> tuple[Matrix, Matrix]:
        """x, z, vy and b for each amplitude, from the smallest on, and the ends (x, vy, vz, time) of s and of -s."""
        unknowns = np.array([*self.middle, 0.0, self.quarter, self.quarter])
        rows, ends = [], []
        for s in amplitudes:
            for _ in range(NEWTON_STEPS):
                values, jacobian, last = self._equations(unknowns, float(s))
                step = np.linalg.solve(jacobian, values)
                unknowns = unknowns - step
                if np.abs(step).max() < TOLERANCE:
                    break
            else:
                raise LibrationFailure(f"Newton's method does not converge at the amplitude {s:.6g} of the birth")
            rows.append(unknowns[:4])
            ends.append(last)
        return np.array(rows), np.array(ends)

    def _equations(self, unknowns: Vector, s: float) -> tuple[Vector, Matrix, Vector]:
        """Means, and differences by s, of y, z and vx at the ends of s and -s; their derivatives; the ends."""
        x, z, vy, b = unknowns[:4]
        turn = self.directions[:, 1]
        velocity = self.directions @ [1.0, b]
        values, slopes, ends = [], [], []
        for number, side in enumerate((s, -s)):
            start = [x, 0.0, z, side * velocity[0], vy, side * velocity[1]]
            try:
                result = flow_of(CR3BP).derivative(start, unknowns[4 + number], [float(self.mu)])
            except FlowFailure as error:
                raise LibrationFailure(f"at the amplitude {s:.6g} of the birth: {error}") from None
            rates = result.state_transition[[Y, Z, VX]]
            times = [result.velocity[[Y, Z, VX]] if which == number else np.zeros(3) for which in (0, 1)]
            columns = [rates[:, X], rates[:, Z], rates[:, VY], side * rates[:, [VX, VZ]] @ turn, *times]
            values.append(result.state[[Y, Z, VX]])
            slopes.append(np.stack(columns, axis=1))
            ends.append([*result.state[[X, VY, VZ]], unknowns[4 + number]])
        joined = [np.concatenate([0.5 * (a + c), 0.5 * (a - c) / s]) for a, c in (values, slopes)]
        return joined[0], joined[1], np.array(ends)


def axial_atlas(point: str, mu: Fraction, label: str, tube: float) -> Atlas:
    """The atlas of the axial family of L1 or L2 from its birth on the planar family to that on the vertical one.

    Arguments:
        label: the mass as people call it.
        tube: half-width of the tubes relative to x and vy.

    Raises `LibrationFailure`.
    """
    planar = LyapunovFamily(point, mu)
    eps = planar.symmetry_breaking(OUTER[point], "axial")
    first = planar.orbit(eps)
    birth = BirthOfAxial.of(VerticalFamily(point, mu))
    piece, end, used = _birth_piece(birth, tube)
    goal = float(end[2] ** 2)
    start = planar.libration.x + eps, eps * first.vy, first.half_period
    family = AxialFamily(mu, start, goal / STEPS)
    arrived = family.orbit(goal)
    if max(abs(arrived.x - end[0]), abs(arrived.vy - end[1])) > 1e-6:
        raise LibrationFailure(f"the axial family of {point} does not lead to the vertical family")
    return Atlas(
        id=f"axial-family-{point.lower()}-{label}",
        title=f"axial orbits of {point}, {label}, from the planar to the vertical family",
        system=LIFTED,
        parameters={"mu": mu},
        # A short number for the statement; the pieces go beyond it.
        claim=Claim("arc", None, ("eps2",), Covers("eps2", Fraction(0), Fraction(f"{0.9999 * goal:.5e}"))),
        pieces=(*pieces_of(family, -BEFORE * goal, goal, tube, WIDEST), piece),
        provenance={"planar_birth": start[0], "vertical_birth": float(birth.eps2), "amplitude": used},
    )


def _birth_piece(birth: BirthOfAxial, tube: float) -> tuple[BirthPiece, Vector, float]:
    """The piece, and x, vy and vz on the axis of the orbit up to which it is used, with its amplitude."""
    width = AMPLITUDE * float(np.sqrt(birth.eps2))
    used = LEAVES * width
    nodes = np.append(width * np.sin(np.pi * (np.arange(NODES) + 0.5) / (2 * NODES)), used)
    order = np.argsort(nodes)
    rows, ends = birth.orbits(nodes[order])
    back = np.argsort(order)
    rows, ends = rows[back], ends[back]
    # Of the two points of an orbit on the axis the one that it leaves more slowly across the plane.
    end = min(ends[-1], key=lambda each: abs(each[2]))
    powers = np.vander((nodes[:-1] / width) ** 2, NODES, increasing=True)
    coefficients = np.linalg.solve(powers, rows[:-1])
    polynomial = tuple(
        tuple(Fraction(float(column[n // 2])) if n % 2 == 0 else Fraction(0) for n in range(2 * NODES - 1))
        for column in coefficients.T
    )
    sizes = WIDER * np.array([1, 1, 1, DIRECTION])
    piece = BirthPiece(
        id="birth",
        directions=tuple(tuple(Fraction(float(value)) for value in row) for row in birth.directions),
        half_width=Fraction(width),
        polynomial=polynomial,
        tube=tuple(Fraction(float(f"{tube * float(size):.1e}")) for size in sizes),
    )
    return piece, end, used
