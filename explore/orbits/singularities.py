"""Places in space at which the vector field of a system is not defined: the primaries, as far as systems are known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from orbitproof.explore.flow import Vector
from orbitproof.shared.systems import CR3BP_PLANAR, THREE_BODY, System


@dataclass(frozen=True)
class Singularities:
    """Where the field of a system is not defined.

    Attributes:
        places: vectors of shape (d,); the first d coordinates of a state are its place, the others its velocity.
        size: a length in which distances from the smaller primary are measured, (mu/3)^(1/3) of its mass.
    """

    places: tuple[Vector, ...]
    size: float

    def distance(self, states: Vector) -> float:
        """The smallest distance of the states, shape (..., m), to one of the places."""
        return min(float(np.linalg.norm(states[..., : len(place)] - place, axis=-1).min()) for place in self.places)


def singularities_of(system: System, parameters: Mapping[str, Fraction | float]) -> Singularities | None:
    """Where the field of a system with these parameters is not defined; `None`: no such place is known."""
    if system not in (*THREE_BODY, CR3BP_PLANAR):
        return None
    mass, size = float(parameters["mu"]), len(system.state) // 2
    places = tuple(np.array([x, *[0.0] * (size - 1)]) for x in (-mass, 1.0 - mass))
    return Singularities(places, float((min(mass, 1.0 - mass) / 3) ** (1 / 3)))
