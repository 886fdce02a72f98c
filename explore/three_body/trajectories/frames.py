"""Frames of the restricted three-body problem: axes that turn with the bodies or do not, and where the origin is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.shared.formats import InputError

AXES = ("rotating", "inertial")
ORIGINS = ("barycentre", "larger", "smaller")


@dataclass(frozen=True)
class Frame:
    """Axes and origin; axes that do not turn are at time 0 those that do.

    Attributes:
        axes: one of `AXES`.
        origin: one of `ORIGINS`.
    """

    axes: str = "rotating"
    origin: str = "barycentre"

    def states(self, times: Vector, states: Matrix, mass: float) -> Matrix:
        """States of the rotating barycentric frame, shape (N, 6), in this one; nondimensional."""
        result = states.copy()
        if self.origin != "barycentre":
            result[:, :3] -= primaries(mass)[ORIGINS.index(self.origin) - 1]
        if self.axes == "rotating":
            return result
        x, y, z, vx, vy, vz = result.T
        vx, vy = vx - y, vy + x
        cos, sin = np.cos(times), np.sin(times)
        return np.column_stack([cos * x - sin * y, sin * x + cos * y, z, cos * vx - sin * vy, sin * vx + cos * vy, vz])

    def described(self, bodies: Sequence[str]) -> str:
        """The frame in words."""
        where = {"barycentre": "their centre of mass", "larger": bodies[0], "smaller": bodies[1]}[self.origin]
        if self.axes == "rotating":
            return f"turns with the primaries, origin in {where}, x towards the smaller one"
        axes = f"x points from {bodies[0]} to {bodies[1]}, z is normal to their orbits"
        return f"does not turn, origin in {where}; at time 0 {axes}"


def origin_named(name: str, bodies: Sequence[str] | None) -> str:
    """One of `ORIGINS` from its name or that of a body, in any case. Raises `InputError`."""
    wanted = name.lower()
    names = {each.lower(): origin for each, origin in zip(bodies or (), ORIGINS[1:], strict=False)}
    if wanted not in ORIGINS and wanted not in names:
        known = ", ".join([*ORIGINS, *names])
        raise InputError(f"--origin {name}: unknown; give one of {known}")
    return names.get(wanted, wanted)
