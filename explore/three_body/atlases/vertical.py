"""Atlases of vertical families from their libration point, through the birth of the axial orbits.

In the equations of `shared.systems.VERTICAL` the family is a curve over eps2, the square of the speed across the plane
on the axis, through eps2 = 0, where z is that of the linear centre and drives a small orbit in the plane. That of L3
turns around in eps2 before axial orbits are born, and is a curve over vy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from operator import attrgetter

import numpy as np

from orbitproof.explore.atlases import FARTHEST, NOT_FOUND, LibrationFailure, orbit_at, zero_near
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.numerics import bracketed_zero
from orbitproof.explore.three_body.atlases.lyapunov import LibrationFamily, pieces_over
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.shared.formats import Atlas, Claim, Covers
from orbitproof.shared.systems import CR3BP, VERTICAL, ReversibleSystem

TOLERANCE = 1e-10
STEP = 0.05
"""Step of the continuation in eps2, in units of the force scale c d^2, d the distance of the nearest primary."""
BEYOND, BEFORE = 0.06, 0.02
"""So far the pieces go beyond the birth, and beyond eps2 = 0 on the other side, relative to the birth's eps2 or vy."""
VY = 2
"""Index of the coordinate over which a family that turns around is a curve."""
Y, VX, V = 1, 2, 5
"""Indices of what vanishes after a quarter of the period."""
VELOCITY_STEP, LARGEST_VELOCITY = 0.02, 4.0
"""Step and end of the continuation of a family that turns around, in units of the speed of the primaries."""


@dataclass(frozen=True)
class VerticalOrbit:
    """A vertical orbit in the coordinates of `shared.systems.VERTICAL`.

    Attributes:
        eps2: the square of its speed across the plane where it crosses the axis.
        x, vy: where it does so, and the speed in the plane, in units of eps2.
        half_period: up to z -> -z: a quarter of its period.
    """

    eps2: float
    x: float
    vy: float
    half_period: float

    def is_far_from(self, other: VerticalOrbit) -> bool:
        """Whether Newton's method may have led from one to another family."""
        return abs(self.x - other.x) + abs(self.vy - other.vy) > FARTHEST * (abs(other.x) + abs(other.vy))


@dataclass(frozen=True)
class VerticalFamily(LibrationFamily):
    """The vertical family, over eps2."""

    _known: list[VerticalOrbit] = field(default_factory=list, compare=False)

    @property
    def system(self) -> ReversibleSystem:
        """The equations around the point."""
        return VERTICAL[self.point]

    @cached_property
    def step(self) -> float:
        """Step of the continuation."""
        return STEP * self.libration.stiffness * self.libration.distance**2

    @cached_property
    def first(self) -> VerticalOrbit:
        """Orbit of eps2 = 0, as in Lemma 16.4 (iv): z = sin(n t)/n with n^2 = c, and what z^2 drives in the plane."""
        c, mu = self.libration.stiffness, float(self.mu)
        distances = [self.libration.x - float(place[0]) for place in primaries(mu)]
        force = 1.5 * sum(m / abs(d) ** 3 / d for m, d in zip((1 - mu, mu), distances, strict=True)) / (2 * c)
        rate = 2 * np.sqrt(c)
        matrix = np.array([[-(rate**2) - (1 + 2 * c), -2 * rate], [-2 * rate, -(rate**2) - (1 - c)]])
        x, y = np.linalg.solve(matrix, [-force, 0.0])
        return self._correct(0.0, -force / (1 + 2 * c) + float(x), float(y * rate), float(np.pi / rate))

    def orbit(self, place: float) -> VerticalOrbit:
        """The orbit of eps2 = `place`, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            self._known.append(self.first)
        return orbit_at(place, self._known, self.step, attrgetter("eps2"), self._beside, VerticalOrbit.is_far_from)

    def values(self, place: float) -> tuple[float, float]:
        """x and vy."""
        orbit = self.orbit(place)
        return orbit.x, orbit.vy

    def _beside(self, near: VerticalOrbit, eps2: float) -> VerticalOrbit:
        return self._correct(eps2, near.x, near.vy, near.half_period)

    def _correct(self, eps2: float, x: float, vy: float, quarter: float) -> VerticalOrbit:
        """Newton's method for x, vy and the time: y, vx and z vz vanish at its end."""
        flow, wanted = flow_of(self.system), [Y, VX, V]

        def linearised(unknowns: Vector) -> tuple[Vector, Matrix, None]:
            place, speed, time = unknowns.tolist()
            if time <= 0:
                raise FlowFailure(NOT_FOUND)
            result = flow.derivative([place, 0.0, 0.0, speed, 0.0, 0.0, 1.0], time, [*self.constants, eps2])
            columns = (result.state_transition[wanted, 0], result.state_transition[wanted, 3], result.velocity[wanted])
            return result.state[wanted], np.stack(columns, axis=1), None

        found, _, _ = zero_near(
            np.array([x, vy, quarter]),
            linearised,
            lambda step, found, _: np.abs(step).max() < TOLERANCE * (abs(found[0]) + abs(found[1])),
            f"at eps2 = {eps2:.6g}",
        )
        return VerticalOrbit(eps2, *found.tolist())

    def state(self, orbit: VerticalOrbit) -> list[float]:
        """State of the CR3BP on the axis, of an orbit of eps2 > 0."""
        eps2 = orbit.eps2
        return [self.libration.x + eps2 * orbit.x, 0.0, 0.0, 0.0, eps2 * orbit.vy, float(np.sqrt(eps2))]

    def breaking_function(self, orbit: VerticalOrbit) -> float:
        """Zero where axial orbits are born, eps2 > 0.

        It is the determinant of the quarter map's derivative from Fix(R S) to the coordinates that R fixes.
        """
        start, mu = self.state(orbit), float(self.mu)
        transition = flow_of(CR3BP).derivative(start, orbit.half_period, [mu]).state_transition
        return float(np.linalg.det(transition[np.ix_([0, 2, 4], [0, 4, 5])]))

    def birth(self) -> VerticalOrbit:
        """The first orbit where axial orbits are born, from rest on. Raises `LibrationFailure`."""
        if self.point == "L3":
            return birth_along(self, TurningVerticalFamily(self).orbit, self.first.vy, VELOCITY_STEP, LARGEST_VELOCITY)
        return birth_along(self, self.orbit, 0.0, self.step, 4 / STEP * self.step)


def birth_along(
    family: VerticalFamily, orbit: Callable[[float], VerticalOrbit], first: float, step: float, longest: float
) -> VerticalOrbit:
    """The first orbit where axial ones are born, of those over the values beyond `first`. Raises `LibrationFailure`."""

    def breaking(place: float) -> float:
        return family.breaking_function(orbit(place))

    last, value = first + step, breaking(first + step)
    while last < longest:
        place = last + step
        new = breaking(place)
        if (new < 0) != (value < 0):
            return orbit(bracketed_zero(breaking, (last, place), (value, new), 1e-12 * place))
        last, value = place, new
    raise LibrationFailure(f"no axial orbits are born up to {last:.6g}; give the end")


@dataclass(frozen=True)
class TurningVerticalFamily:
    """A vertical family as a curve over vy, which increases where eps2 turns around.

    Attributes:
        family: as a curve over eps2, from which it starts at eps2 = 0.
    """

    family: VerticalFamily
    _known: list[VerticalOrbit] = field(default_factory=list, compare=False)

    @property
    def system(self) -> ReversibleSystem:
        """The equations around the point."""
        return self.family.system

    @property
    def constants(self) -> list[float]:
        """The parameters before eps2."""
        return self.family.constants

    def orbit(self, place: float) -> VerticalOrbit:
        """The orbit of vy = `place`, from its nearest known neighbour in steps. Raises `LibrationFailure`."""
        if not self._known:
            self._known.append(self.family.first)
        near = min(self._known, key=lambda orbit: abs(orbit.vy - place))
        count = int(np.ceil(abs(place - near.vy) / VELOCITY_STEP))
        for goal in np.linspace(near.vy, place, count + 1)[1:]:
            near = self._correct(float(goal), near)
            self._known.append(near)
        return near

    def values(self, place: float) -> tuple[float, float]:
        """eps2 and x."""
        orbit = self.orbit(place)
        return orbit.eps2, orbit.x

    def _correct(self, vy: float, near: VerticalOrbit) -> VerticalOrbit:
        """Newton's method for eps2, x and the time: y, vx and z vz vanish at its end."""
        flow, wanted = flow_of(self.system), [Y, VX, V]

        def linearised(unknowns: Vector) -> tuple[Vector, Matrix, None]:
            eps2, x, quarter = unknowns.tolist()
            result = flow.derivative([x, 0.0, 0.0, vy, 0.0, 0.0, 1.0], quarter, [*self.constants, eps2])
            columns = (result.parameter_derivative, result.state_transition[:, 0], result.velocity)
            return result.state[wanted], np.stack(columns, axis=1)[wanted], None

        guess, where = np.array([near.eps2, near.x, near.half_period]), f"at vy = {vy:.6g}"
        found, _, _ = zero_near(guess, linearised, lambda step, *_: np.abs(step).max() < TOLERANCE, where)
        eps2, x, quarter = found.tolist()
        return VerticalOrbit(eps2, x, vy, quarter)


def vertical_atlas(family: VerticalFamily, label: str, end: float | None, tube: float) -> Atlas:
    """The atlas of the family from the libration point to eps2 = `end`, by default beyond the birth of axial orbits.

    Arguments:
        label: the mass as people call it.
        tube: half-width of the tubes relative to x and vy.

    Raises `LibrationFailure`.
    """
    birth = family.birth() if end is None else None
    if birth is not None and family.point == "L3":
        turning, size = TurningVerticalFamily(family), birth.vy - family.first.vy
        low, high = family.first.vy - BEFORE * size, family.first.vy + (1 + BEYOND) * size
        pieces, goal, increasing = pieces_over(turning, low, high, tube, over=VY), turning.orbit(high).eps2, "vy"
    else:
        goal = float(end) if birth is None else (1 + BEYOND) * birth.eps2
        pieces, increasing = pieces_over(family, -BEFORE * goal, goal, tube), "eps2"
    return Atlas(
        id=f"vertical-{family.point.lower()}-{label}",
        title=f"vertical orbits of {family.point}, {label}, from the libration point",
        system=family.system,
        parameters={"mu": family.mu},
        # Short numbers for the statement; the pieces go beyond them.
        claim=Claim("arc", None, (increasing,), Covers("eps2", Fraction(0), Fraction(f"{0.9999 * goal:.5e}"))),
        pieces=pieces,
        provenance={"libration_point": family.libration.x, "axial_birth": birth and birth.eps2},
    )
