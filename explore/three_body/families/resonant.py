"""Planar resonant orbits: p times round the larger primary while the smaller one goes round q times.

Without the smaller mass they are Kepler's ellipses of every eccentricity, seen in the turning frame. Symmetric ones
have an apse on the axis; there are two phases, in one of which the orbit keeps farther away from the smaller primary.
With the mass one family of each phase remains: an ellipse is followed to the mass that is asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from orbitproof.explore.families import Family, Stop, crossings
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.explore.three_body.seeds import primaries
from orbitproof.shared.systems import CR3BP

_ECCENTRICITIES = tuple(tenth / 10 for tenth in range(2, 8))
_SHORTEST = 1.0 / 256
_NEAR = 0.05
"""An orbit moves at most so far while a part of the mass is added."""

_OFF_RESONANCE = 0.1
"""A family ends where the period is so far, relatively, from q turns of the primaries."""

_ACROSS = np.array([1.0, 0.0, 0.0, 0.0])


def resonant_seed(parameters: Mapping[str, Fraction], p: int, q: int, near: bool, tolerance: float) -> Family:
    """The family of one resonant orbit, not traced yet.

    Of the ellipses that can be followed to the mass the one is taken whose period changes least. Arguments:
        near: the phase in which the orbit comes closer to the smaller primary.

    Raises `CorrectionFailure`.
    """
    found = []
    for at_perigee, side in ((True, 1), (True, -1)) if p % 2 else ((True, 1), (False, 1)):
        orbits = []
        for eccentricity in _ECCENTRICITIES:
            try:
                orbit = _with_mass(parameters, q, _ellipse(p, q, eccentricity, at_perigee, side), tolerance)
            except (CorrectionFailure, FlowFailure):
                continue
            if half_turns(_samples(orbit), float(parameters["mu"])) == p - q:
                orbits.append(orbit)
        if orbits:
            best = min(orbits, key=lambda family: abs(family.orbits[0].half_period - np.pi * q))
            found.append((_nearest(best), best))
    # A phase of which no ellipse can be followed is the one that comes close.
    if len(found) < (2 if near else 1):
        raise CorrectionFailure(f"no ellipse in {p}:{q} resonance could be followed to this mass")
    return (min if near else max)(found, key=lambda each: each[0])[1]


def while_resonant(p: int, q: int, mass: float, limits: Stop) -> Stop:
    """Stops a family where its orbits go round the larger primary another number of times, or where `limits` does."""

    def stop(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        ratio = orbit.half_period / (np.pi * q)
        if abs(ratio - 1) > _OFF_RESONANCE:
            return f"the period is {ratio:.3g} times that of the resonance"
        if half_turns(states, mass) != p - q:
            return "the orbit goes round the larger primary another number of times"
        return limits(orbit, states)

    return stop


def half_turns(states: Matrix, mass: float) -> int:
    """How many half turns about the larger primary the half of a symmetric orbit makes in the turning frame."""
    angles = np.unwrap(np.arctan2(states[:, 1], states[:, 0] + mass))
    return round(float(angles[-1] - angles[0]) / np.pi)


def _ellipse(p: int, q: int, eccentricity: float, at_perigee: bool, side: int) -> Vector:
    """x and vy in the turning frame at an apse on the axis, on the side of the smaller primary or (-1) on the other."""
    axis, e = (q / p) ** (2 / 3), eccentricity if at_perigee else -eccentricity
    distance = axis * (1 - e)
    return side * np.array([distance, np.sqrt((1 + e) / (axis * (1 - e))) - distance])


def _with_mass(parameters: Mapping[str, Fraction], q: int, apse: Vector, tolerance: float) -> Family:
    """The orbit of an ellipse for the mass, with the apse where it was, mass by mass from 0."""
    mass, done, step = float(parameters["mu"]), 0.0, 1.0
    unknowns = np.array([apse[0], 0.0, apse[1], np.pi * q])
    while True:
        further = min(1.0, done + step)
        exact = parameters["mu"] if further == 1.0 else Fraction(further * mass)
        problem = ShootingProblem(CR3BP, {"mu": exact}, "S", (1.0, 1.0, 1.0, 1.0), tolerance)
        try:
            correction = problem.correct(unknowns, _ACROSS)
            if float(np.linalg.norm(correction.unknowns - unknowns)) > _NEAR:
                raise CorrectionFailure("another orbit")
        except (CorrectionFailure, FlowFailure):
            step /= 2
            if step < _SHORTEST:
                raise
            continue
        done, unknowns = further, correction.unknowns
        if done == 1.0:
            number = crossings(problem, problem.samples(unknowns))
            tangent = problem.tangent(correction.jacobian, _ACROSS)
            return Family(problem, (problem.orbit(correction, 0.0, number),), (tangent,), "limit", "started")


def _samples(family: Family) -> Matrix:
    return family.problem.samples(family.orbits[0].unknowns)


def _nearest(family: Family) -> float:
    """Least distance of an orbit from the smaller primary."""
    _, smaller = primaries(float(family.problem.parameters["mu"]))
    return float(np.min(np.linalg.norm(_samples(family)[:, :3] - smaller, axis=1)))
