"""How far a family is traced."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite

from orbitproof.explore.flow import Matrix
from orbitproof.explore.names import told_apart
from orbitproof.explore.orbits import ShootingProblem, Singularities, SymmetricOrbit, singularities_of
from orbitproof.shared.systems import ReversibleSystem

SMALLEST_DISTANCE = 1e-5
SMALLEST_RELATIVE_DISTANCE = 1e-4
"""Distance to a primary at which a family ends unless told otherwise; the second in units of (mu/3)^(1/3)."""

TYPICAL_ORBITS = 150
"""For the progress display only: of this order is the number of orbits of a family that no limit cuts short."""


@dataclass(frozen=True)
class Limits:
    """How far a family is traced; it ends with the first orbit beyond a limit.

    Attributes:
        max_orbits: number of orbits.
        coordinate_max: largest magnitude of a Fix(R) coordinate of the first point, by name.
        parameter_min, parameter_max: range of the family parameter, if the system has one.
        bounds: smallest and largest value of a coordinate of the first point, of the family parameter, of the
            first integral or of the half period, by name (see `limited_names`).
        integral_min: smallest value of the first integral (the Jacobi constant).
        min_distance: smallest distance to a primary; by default 1e-5, less for small mass parameters.
    """

    max_orbits: int = 1000
    coordinate_max: Mapping[str, float] = field(default_factory=dict)
    parameter_min: float = -inf
    parameter_max: float = inf
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    integral_min: float | None = None
    min_distance: float | None = None

    def reached(self, problem: ShootingProblem, orbit: SymmetricOrbit, states: Matrix) -> str | None:
        """Which limit the orbit lies beyond, in words, or `None`."""
        system = problem.system
        names = system.centre_coordinates
        for name, bound in self.coordinate_max.items():
            if abs(orbit.unknowns[names.index(name)]) >= bound:
                return f"limit {name} = {bound:g}"
        if system.family_parameter is not None and not self.parameter_min <= orbit.unknowns[0] <= self.parameter_max:
            bound = self.parameter_max if orbit.unknowns[0] > self.parameter_max else self.parameter_min
            return f"limit {system.family_parameter} = {bound:g}"
        for name, value in zip(limited_names(system), _limited_values(orbit), strict=True):
            low, high = self.bounds.get(name, (-inf, inf))
            if not low <= value <= high:
                return f"limit {name} = {low if value < low else high:g}"
        if system.family_parameter is not None:
            declared = system.parameters[system.family_parameter]
            value = float(orbit.unknowns[0])
            if declared.lower is not None and value <= declared.lower:
                return f"limit {system.family_parameter} = {float(declared.lower):g}, where its declared range ends"
            if declared.upper is not None and value >= declared.upper:
                return f"limit {system.family_parameter} = {float(declared.upper):g}, where its declared range ends"
        integral = orbit.first_integral
        if self.integral_min is not None and integral is not None and integral <= self.integral_min:
            return f"limit {system.first_integral_name} = {self.integral_min:g}"
        places = singularities_of(system, problem.parameters)
        if places is not None and places.distance(states) <= (bound := self._distance(places)):
            return f"limit distance to a primary = {bound:g}"
        return None

    def _distance(self, places: Singularities) -> float:
        if self.min_distance is not None:
            return self.min_distance
        return min(SMALLEST_DISTANCE, SMALLEST_RELATIVE_DISTANCE * places.size)

    def fraction(self, problem: ShootingProblem, orbit: SymmetricOrbit, count: int) -> float:
        """How much of the way to the nearest limit is done, roughly, 0 to 1."""
        system = problem.system
        names = system.centre_coordinates
        parts = [max(count / self.max_orbits, count / (count + TYPICAL_ORBITS))]
        parts += [abs(orbit.unknowns[names.index(name)]) / bound for name, bound in self.coordinate_max.items()]
        if system.family_parameter is not None:
            span = self.parameter_max - self.parameter_min
            parts += [(orbit.unknowns[0] - self.parameter_min) / span] if isfinite(span) else []
        return min(1.0, max(parts))


def limited_names(system: ReversibleSystem) -> tuple[str, ...]:
    """What of an orbit can be limited by name: centre coordinates, ``half-period``, ``integral`` if there is one.

    The latter is ``(integral)`` where a coordinate is called so.
    """
    names = system.centre_coordinates
    ours = ("half-period",) if system.first_integral is None else ("half-period", "integral")
    return (*names, *told_apart(ours, names))


def _limited_values(orbit: SymmetricOrbit) -> tuple[float, ...]:
    values = tuple(float(value) for value in orbit.unknowns)
    return values if orbit.first_integral is None else (*values, orbit.first_integral)
