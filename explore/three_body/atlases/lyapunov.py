"""Atlases of planar Lyapunov families down to their libration point.

In the equations of `shared.systems.libration` the family is a curve vy(eps) through eps = 0, where the orbit is that
of the linear centre. It is followed by Newton's method and written as pieces over eps.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from operator import attrgetter
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from orbitproof.explore.atlases import FARTHEST, NOT_FOUND, LibrationFailure, orbit_at, zero_near
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.numerics import bracketed_zero
from orbitproof.explore.three_body.seeds import LibrationPoint, libration_point, lyapunov_orbit
from orbitproof.shared.formats import Atlas, Claim, Covers, Piece
from orbitproof.shared.systems import AROUND, CR3BP, ReversibleSystem

ComplexArray = NDArray[np.complex128]

VY_TOLERANCE = 1e-11
STEP = 0.02
"""Step of the continuation in eps, in units of the distance of the libration point from the nearest primary."""
NODES = 48
NOISE = 3e-15
"""Size, relative to vy, below which Chebyshev coefficients are rounding."""
CIRCLE, FROM, TO = 64, 8, 20
TIME_STEPS = 300
SMALL = 1e-10
LEAST_DECAY = 2.95
"""A piece is narrow enough if the Taylor coefficients of the half return in s decay by this factor from degree to
degree; then degree 32 is enough for a proof, as was found for all three points."""
SHRINK, NARROWEST = 0.8, 1e-3
BEYOND = {"halo": 0.06, "axial": 0.02}
"""So far the pieces go beyond the first birth of these orbits, relative to its eps."""
BEFORE = 0.12
"""How far they go beyond eps = 0, relative to the end on the other side."""
BIRTHS = {"halo": (5, 2), "axial": (2, 5)}
"""Row and column of the variation over the half return that vanishes at the births: dvz/dz, dz/dvz."""
OVERLAP = 0.04
"""The part of a piece's half-width by which its neighbours reach into it."""


@dataclass(frozen=True)
class PlanarOrbit:
    """A planar orbit around a libration point in the coordinates of `shared.systems.libration`.

    Attributes:
        eps: the distance from the libration point at which it starts on the axis, negative on the left.
        vy: the speed there, in units of eps.
        half_period: nondimensional time.
        slopes: shape (2,), derivatives of vy and the half period in eps.
    """

    eps: float
    vy: float
    half_period: float
    slopes: Vector

    def is_far_from(self, other: PlanarOrbit) -> bool:
        """Whether Newton's method may have led from one to another family."""
        pairs = ((self.vy, other.vy), (self.half_period, other.half_period))
        return any(abs(mine - its) > FARTHEST * abs(its) for mine, its in pairs)


@dataclass(frozen=True)
class LibrationFamily:
    """A family of a collinear libration point.

    Attributes:
        point: "L1", "L2" or "L3".
        mu: the mass parameter, exact.
    """

    point: str
    mu: Fraction

    @cached_property
    def libration(self) -> LibrationPoint:
        """The libration point in float64."""
        return libration_point(self.point, self.mu)

    @property
    def constants(self) -> list[float]:
        """The parameters before the size of the orbits."""
        return [float(self.mu), self.libration.x]


@dataclass(frozen=True)
class LyapunovFamily(LibrationFamily):
    """The planar Lyapunov family, over eps."""

    _known: list[PlanarOrbit] = field(default_factory=list, compare=False)

    @property
    def system(self) -> ReversibleSystem:
        """The equations around the point."""
        return AROUND[self.point]

    def orbit(self, eps: float) -> PlanarOrbit:
        """The orbit that starts at eps, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            linear = lyapunov_orbit(self.libration, 1.0, 1)
            self._known.append(self._correct(0.0, float(linear.direction[4]), linear.half_period))
        step = STEP * self.libration.distance
        return orbit_at(eps, self._known, step, attrgetter("eps"), self._beside, PlanarOrbit.is_far_from)

    def _beside(self, near: PlanarOrbit, eps: float) -> PlanarOrbit:
        vy, half_period = np.array([near.vy, near.half_period]) + (eps - near.eps) * near.slopes
        return self._correct(eps, float(vy), float(half_period))

    def _correct(self, eps: float, vy: float, half_period: float) -> PlanarOrbit:
        """Newton's method for vy and the half period: y and vx vanish at its end."""
        flow, parameters = flow_of(self.system), [*self.constants, eps]

        def linearised(unknowns: Vector) -> tuple[Vector, Matrix, Vector]:
            speed, time = unknowns.tolist()
            if time <= 0:
                raise FlowFailure(NOT_FOUND)
            result = flow.derivative([1.0, 0.0, 0.0, speed], time, parameters)
            jacobian = np.stack([result.state_transition[1:3, 3], result.velocity[1:3]], axis=1)
            return result.state[1:3], jacobian, result.parameter_derivative[1:3]

        found, jacobian, rates = zero_near(
            np.array([vy, half_period]),
            linearised,
            lambda step, found, _: abs(step[0]) < VY_TOLERANCE * abs(found[0]),
            f"at eps = {eps:.6g}",
        )
        return PlanarOrbit(eps, *found.tolist(), -np.linalg.solve(jacobian, rates))

    def breaking_function(self, eps: float, born: str = "halo") -> float:
        """The variation of `BIRTHS`; zero where the symmetry S breaks and such orbits branch off. eps != 0."""
        orbit = self.orbit(eps)
        state = [self.libration.x + eps, 0.0, 0.0, 0.0, eps * orbit.vy, 0.0]
        transition = flow_of(CR3BP).derivative(state, orbit.half_period, [float(self.mu)]).state_transition
        return float(transition[BIRTHS[born]])

    def symmetry_breaking(self, side: int, born: str = "halo") -> float:
        """The first eps of the sign `side` where such orbits (`BIRTHS`) branch off. Raises `LibrationFailure`."""

        def breaking(eps: float) -> float:
            return self.breaking_function(eps, born)

        step = STEP * self.libration.distance
        last, value = side * step, breaking(side * step)
        while abs(last) < self.libration.distance:
            place = last + side * step
            try:
                new = breaking(place)
            except FlowFailure as error:
                raise LibrationFailure(f"at eps = {place:.6g}: {error}") from None
            if (new < 0) != (value < 0):
                return bracketed_zero(breaking, (last, place), (value, new), 1e-12 * step)
            last, value = place, new
        raise LibrationFailure(f"S does not break at any abs(eps) < {self.libration.distance:.6g}; give the end")

    def values(self, eps: float) -> tuple[float, ...]:
        """What is known of the orbit besides eps: vy."""
        return (self.orbit(eps).vy,)


class OrbitsOfSizes(Protocol):
    """A family as a curve over the size of its orbits, the last parameter of its equations."""

    @property
    def system(self) -> ReversibleSystem:
        """The equations."""

    @property
    def constants(self) -> list[float]:
        """Their parameters before the size."""

    def orbit(self, place: float) -> AnyOrbit:
        """The orbit of this size. Raises `LibrationFailure`."""


class FamilyOfSizes(OrbitsOfSizes, Protocol):
    """One whose points are found one by one."""

    def values(self, place: float) -> tuple[float, ...]:
        """Coordinates of the point over a value of the parameter."""


class AnyOrbit(Protocol):
    """An orbit of such a family."""

    @property
    def half_period(self) -> float:
        """From Fix(R) to Fix(R)."""


def expansion(family: FamilyOfSizes, low: float, high: float) -> list[Vector]:
    """Chebyshev coefficients of the coordinates after the first on [low, high], those above the rounding."""
    nodes = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    values = np.array([family.values(middle + half * node) for node in nodes])
    rows = [np.asarray(chebyshev.chebfit(nodes, column, NODES - 1)) for column in values.T]
    # Coordinates are found together: a small one has the rounding of the large ones.
    rounding = NOISE * max(float(np.abs(row).max()) for row in rows)
    return [row[: np.flatnonzero(np.abs(row) > min(rounding, 0.5 * np.abs(row).max()))[-1] + 1] for row in rows]


def decay(family: OrbitsOfSizes, low: float, high: float, coefficients: list[Vector], over: int = 0) -> float:
    """The factor by which the Taylor coefficients of the half return in s decay on the piece over [low, high].

    `over`: index of the coordinate whose range that is; the coefficients are those of the others. The orbits are
    followed from the points of the unit circle of s by the classical Runge-Kutta method, whose errors are below the
    coefficients of the degrees `FROM` and `TO` that are compared; infinite if the latter is `SMALL`.
    """
    s = np.exp(2j * np.pi * np.arange(CIRCLE) / CIRCLE)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    program, system = family.system.program, family.system
    rows = [chebyshev.chebval(s, row) for row in coefficients]
    size, *others = [*rows[:over], middle + half * s, *rows[over:]]
    parameters = [*family.constants, size]

    def slope(state: ComplexArray) -> ComplexArray:
        return np.array(program.evaluate([*state, *parameters]))

    step = family.orbit(middle).half_period / TIME_STEPS
    ones = np.ones(CIRCLE, dtype=complex)
    known = {name: float(value) * ones for name, value in system.normalised.items()}
    known |= dict(zip(system.centre_coordinates[1:], others, strict=True))
    state = np.array([known.get(name, 0 * ones) for name in system.state])
    with np.errstate(all="ignore"):
        for _ in range(TIME_STEPS):
            first = slope(state)
            second = slope(state + 0.5 * step * first)
            third = slope(state + 0.5 * step * second)
            fourth = slope(state + step * third)
            state = state + step / 6 * (first + 2 * (second + third) + fourth)
    if not np.all(np.isfinite(state)):
        return 0.0
    sizes = np.abs(np.fft.fft(state, axis=1)).max(axis=0)
    if sizes[TO] < SMALL * sizes[0]:
        return np.inf
    return float((sizes[FROM] / sizes[TO]) ** (1 / (TO - FROM)))


def pieces_over(family: FamilyOfSizes, low: float, high: float, tube: float, over: int = 0) -> tuple[Piece, ...]:
    """Pieces over [low, high] from left to right, each as wide as is narrow enough. Raises `LibrationFailure`.

    `over`: index of the coordinate whose range that is.
    """
    pieces: list[Piece] = []
    begin = low
    while True:
        end = high
        while True:
            coefficients = expansion(family, begin, end)
            if decay(family, begin, end, coefficients, over) >= LEAST_DECAY:
                break
            end = begin + SHRINK * (end - begin)
            if end - begin < NARROWEST * (high - low):
                raise LibrationFailure(f"at eps = {begin:.6g}: no piece is narrow enough (near a singularity)")
        name = f"p{len(pieces) + 1:03d}"
        pieces.append(graph_piece(name, 0.5 * (begin + end), 0.5 * (end - begin), coefficients, tube, over))
        if end == high:
            return tuple(pieces)
        begin = end - OVERLAP * (end - begin)


def graph_piece(name: str, middle: float, half: float, coefficients: list[Vector], tube: float, over: int = 0) -> Piece:
    """A piece over |c - middle| <= half, c the coordinate `over`, given by Chebyshev coefficients of the others."""
    rows = [chebyshev.cheb2poly(row) for row in coefficients]
    centre = [Fraction(float(row[0])) for row in rows]
    centre.insert(over, Fraction(middle))
    order = [over, *(i for i in range(len(centre)) if i != over)]
    return Piece(
        id=name,
        kind="regular",
        centre=tuple(centre),
        frame=tuple(tuple(Fraction(int(i == j)) for j in order) for i in range(len(centre))),
        half_width=Fraction(half),
        polynomial=tuple((Fraction(0), *(Fraction(float(value)) for value in row[1:])) for row in rows),
        tube=tuple(Fraction(tube * float(np.abs(row).max())) for row in coefficients),
        coordinates="physical",
    )


def lyapunov_atlas(
    family: LyapunovFamily, label: str, end: float | None, side: int, tube: float, through: str = "halo"
) -> Atlas:
    """The atlas of the family from the libration point to `end`, by default a bit beyond a birth.

    Arguments:
        label: the mass as people call it.
        end: an eps, of either sign; `None`: to the first birth on the given side.
        side: -1 or 1, the sign of eps.
        tube: half-width of the tubes relative to vy.
        through: of what orbits, one of `BIRTHS`.

    Raises `LibrationFailure`.
    """
    breaking = family.symmetry_breaking(side, through) if end is None else None
    goal = end if breaking is None else (1 + BEYOND[through]) * breaking
    assert goal is not None
    ends = sorted((goal, -BEFORE * goal))
    pieces = pieces_over(family, ends[0], ends[1], tube)
    # Short numbers for the statement; the pieces go beyond them.
    covered = sorted((_short(0.9999 * goal), Fraction(0)))
    name = f"lyapunov-{family.point.lower()}-{label}"
    return Atlas(
        id=name,
        title=f"planar Lyapunov orbits of {family.point}, {label}, down to the libration point",
        system=family.system,
        parameters={"mu": family.mu},
        claim=Claim("arc", None, ("eps",), Covers("eps", covered[0], covered[1])),
        pieces=pieces,
        provenance={"libration_point": family.libration.x, "symmetry_breaking": breaking},
    )


def _short(value: float) -> Fraction:
    """A decimal number of a few digits near `value`."""
    return Fraction(f"{value:.5e}")
