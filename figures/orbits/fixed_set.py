"""Points of Fix(R) as states, in double precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np
from flint import arb
from numpy.typing import NDArray

from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import ReversibleSystem, completed
from orbitproof.verify.claim import point_on_fixed_set
from orbitproof.verify.evidence import enclose

Array = NDArray[np.float64]


def state_on_fixed_set(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float]
) -> list[float]:
    """The full state, length m, of a point in the order of `ReversibleSystem.centre_coordinates`."""
    values = list(point)[len(point) - len(system.fixed_coordinates) :]
    state = [0.0] * len(system.state)
    for index, value in zip(system.fixed_coordinates, values, strict=True):
        state[index] = float(value)
    return completed(system, state, parameter_values(system, parameters, point))


def parameter_values(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], point: Sequence[float]
) -> list[float]:
    """All parameters of the vector field in its order, the family parameter taken from `point`."""
    return [
        float(point[0]) if name == system.family_parameter else float(parameters[name]) for name in system.parameters
    ]


def parameters_of(candidate: Candidate) -> dict[str, Fraction]:
    """The fixed parameters of a claim, where two resonances meet with that one which is its first coordinate."""
    own = {candidate.varying: candidate.centre[0]} if candidate.resonances_meet else {}
    return {**candidate.parameters, **own}


def centre_on_fixed_set(candidate: Candidate) -> list[arb]:
    """The centre of a claim in the coordinates of Fix(R), of which one follows from the level if that is its first."""
    if candidate.resonances_meet:
        return [enclose(value) for value in candidate.centre[1:]]
    if candidate.level_sign is None:
        return [enclose(value) for value in candidate.centre]
    where = {name: enclose(value) for name, value in zip(candidate.coordinates, candidate.centre, strict=True)}
    return list(point_on_fixed_set(candidate, where).values())
