"""Orbits of the return map on the level of a symmetric orbit with n = 1, by iterating it: for drawing only."""

from __future__ import annotations

from fractions import Fraction
from math import pi, sin, sqrt

import numpy as np

from orbitproof.figures.orbits.fixed_set import Array, parameter_values, state_on_fixed_set
from orbitproof.figures.orbits.orbit import OrbitNotClosed
from orbitproof.figures.orbits.return_map import ReturnMap
from orbitproof.shared.formats import Candidate, PeriodicOrbit
from orbitproof.shared.systems import System
from orbitproof.verify.twist import StableOrbitResults

_TURN = 0.5
"""By how much of a radian the outermost orbit turns more or less in a period, to first order."""
_ORBITS = 9
_ITERATIONS = 120
_SMALL = 1e-5
_SHRINKINGS = 6
_NEWTON = 20
_TOLERANCE = 1e-8


def section_iterates(claim: Candidate, found: StableOrbitResults, iterations: int = _ITERATIONS) -> Array:
    """Coordinates (t, q) of orbits of the return map that begin on Fix(R), shape (orbits, 1 + iterations, 2).

    Raises `OrbitNotClosed` if no orbits near it can be followed.
    """
    system = claim.system
    point = [float(found.point[name].mid()) for name in system.centre_coordinates]
    values = [float(value) for value in parameter_values(system, claim.parameters, point)]
    start = np.array(state_on_fixed_set(system, claim.parameters, point), dtype=float)
    t, q = (system.state.index(name) for name in (found.twist_coordinate, found.twist_momentum))
    section = _Section(claim, values, start, t, q)
    turned = ReturnMap(_claim(claim), values, float(found.period.mid()), _TOLERANCE)
    omega, twist = 2 * pi * float(found.rotation_number.mid()), float(found.twist.mid())
    image = turned.images(section.states(np.array([[start[t], _SMALL]])))[0]
    scale = sqrt(abs(image[t] - start[t]) / _SMALL / sin(omega))
    reach = sqrt(_TURN / abs(twist)) * scale
    for _ in range(_SHRINKINGS):
        away = reach * np.arange(1, _ORBITS + 1) / _ORBITS
        points = np.stack([start[t] + away, np.zeros(_ORBITS)], axis=1)
        rows = [points]
        try:
            for _ in range(iterations):
                states = turned.images(section.states(rows[-1]))
                rows.append(states[:, [t, q]])
            return np.stack(rows, axis=1)
        except OrbitNotClosed:
            reach /= 2
    raise OrbitNotClosed("orbits near it cannot be followed in double precision")


def _claim(claim: Candidate) -> PeriodicOrbit:
    """The section as that of an orbit without symmetry."""
    system = claim.system
    size = len(system.state)
    unit = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    return PeriodicOrbit(
        id="section",
        system=System(system.name, system.title, system.state, system.parameters, system.vector_field),
        parameters={name: Fraction(claim.parameters.get(name, 0)) for name in system.parameters},
        normal=tuple(unit[system.section_index]),
        offset=Fraction(0),
        direction=1,
        crossings=1,
        centre=(Fraction(0),) * size,
        frame=tuple(tuple(row[: size - 1]) for row in unit),
        radii=(Fraction(1),) * (size - 1),
    )


class _Section:
    """States of the section on the level of an orbit, by (t, q)."""

    def __init__(self, claim: Candidate, values: list[float], start: Array, t: int, q: int) -> None:
        system = claim.system
        self.program, self.values, self.start, self.t, self.q = system.first_integral_program, values, start, t, q
        even = [i for i, sign in enumerate(system.reversing_symmetry) if sign == 1 and i != t and system.is_given(i)]
        self.level = self._integral(start[None])[0]
        self.free = max(even, key=lambda i: abs(self._slope(start[None], i)[0])) if self.program is not None else None

    def states(self, points: Array) -> Array:
        """Shape (M, 2) to (M, N). Raises `OrbitNotClosed` where the level does not reach."""
        states = np.repeat(self.start[None], len(points), axis=0)
        states[:, self.t], states[:, self.q] = points[:, 0], points[:, 1]
        if self.free is None:
            return states
        for _ in range(_NEWTON):
            states[:, self.free] -= (self._integral(states) - self.level) / self._slope(states, self.free)
        if not np.all(np.isfinite(states)):
            raise OrbitNotClosed("the level does not reach so far")
        return states

    def _integral(self, states: Array) -> Array:
        if self.program is None:
            return np.zeros(len(states))
        (value,) = self.program.evaluate([*states.T, *self.values])
        return np.asarray(value, dtype=float)

    def _slope(self, states: Array, place: int) -> Array:
        step = np.zeros(states.shape[1])
        step[place] = 1e-6
        return np.asarray((self._integral(states + step) - self._integral(states - step)) / 2e-6)
