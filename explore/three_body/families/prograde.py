"""Planar orbits that go round the smaller primary the way it goes round the larger one.

In Hill's problem, the limit of small masses, circles around the primary grow into a family of orbits that are symmetric
about both axes (M. Hénon's g), from which two families branch off, mirror images of one another, one to each side. With
a mass the point breaks up into two curves. On one of them the small circles become orbits that reach out to L1: the
low prograde orbits of the west. The other curve has a greatest Jacobi constant: on one side of it lie those that reach
out to L2, of the east, on the other what remains of the doubly symmetric orbits: the distant prograde orbits.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from orbitproof.explore.families import CONTROL, Course, Family, Start, Stop, crossings, trace
from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.orbits import CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.shared.systems import HILL

PROGRADE = ("dpo", "lpo-east", "lpo-west")

_RADIUS = 0.1
"""Radius of the first circle, in units of mu^(1/3)."""

_UNSTABLE = 3.0
"""The doubly symmetric orbit that is carried over to a mass has a stability parameter beyond it."""

_MOST, _SHORTEST = 200, 1.0 / 1024


def prograde_circle(mass: float, radius: float) -> tuple[Vector, Vector]:
    """A small circle from its crossing between the primaries: the unknowns in Fix(S), and the way outwards."""
    turning = float(np.sqrt(mass / radius**3)) - 1.0
    unknowns = np.array([1.0 - mass - radius, 0.0, -turning * radius, np.pi / turning])
    return unknowns, np.array([-1.0, 0.0, 0.0, 0.0])


def distant_prograde(problem: ShootingProblem) -> Family:
    """One distant prograde orbit of a mass, in Fix(S), its tangent towards the greatest Jacobi constant.

    It is found in Hill's problem and carried over, unit by unit of mu^(1/3). Raises `CorrectionFailure`.
    """
    mass = float(problem.parameters["mu"])
    goal = mass ** (1 / 3)
    in_hill = _carried(_doubly_symmetric(), goal)
    across = np.array([1.0, 0.0, 0.0, 0.0])
    guess = in_hill * np.array([goal, goal, goal, 1.0]) + np.array([1.0 - mass, 0.0, 0.0, 0.0])
    correction = problem.correct(guess, across)
    # Outwards from the primary the orbits become rounder, and shorter.
    tangent = problem.tangent(correction.jacobian, np.array([0.0, 0.0, 0.0, -1.0]))
    number = crossings(problem, problem.samples(correction.unknowns))
    return Family(problem, (problem.orbit(correction, 0.0, number),), (tangent,), "limit", "started")


def greatest_level(limits: Stop) -> Stop:
    """Stops a family after the orbit with its greatest first integral, or where `limits` does."""
    last = -np.inf

    def stop(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        nonlocal last
        assert orbit.first_integral is not None
        fell, last = orbit.first_integral < last, orbit.first_integral
        return "the Jacobi constant is greatest" if fell else limits(orbit, states)

    return stop


def _in_hill(parameters: Mapping[str, Fraction]) -> ShootingProblem:
    return ShootingProblem(HILL, parameters, "S", (1.0, 1.0, 1.0, 1.0))


def _doubly_symmetric() -> Vector:
    """The unknowns of an orbit of Hill's problem that is symmetric about both axes, beyond the branching."""
    turning = _RADIUS**-1.5 - 1.0
    circle = np.array([-_RADIUS, 0.0, -turning * _RADIUS, np.pi / turning])

    def unstable(orbit: SymmetricOrbit, states: Matrix) -> str | None:
        return "unstable" if max(value.real for value in orbit.stability) > _UNSTABLE else None

    start = Start(circle, np.array([-1.0, 0.0, 0.0, 0.0]))
    family = trace(_in_hill({"h": Fraction(0)}), start, Course(unstable, CONTROL, _MOST))
    if family.reason.startswith("unstable"):
        return family.orbits[-1].unknowns
    raise CorrectionFailure(f"no distant prograde orbit in Hill's problem: {family.reason}")


def _carried(unknowns: Vector, goal: float) -> Vector:
    """The orbit with the same crossing where the parameter of Hill's problem, from 0 on, is `goal`."""
    done, step, across = 0.0, 1.0, np.array([1.0, 0.0, 0.0, 0.0])
    while done < 1.0:
        further = min(1.0, done + step)
        try:
            unknowns = _in_hill({"h": Fraction(further * goal)}).correct(unknowns, across).unknowns
        except CorrectionFailure:
            step /= 2
            if step < _SHORTEST:
                raise
            continue
        done = further
    return unknowns
