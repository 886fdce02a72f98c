"""A periodic orbit as a function of time, in double precision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from orbitproof.explore.flow import Matrix, Vector
from orbitproof.explore.flow.runge_kutta import MAX_STEPS, square_tableau
from orbitproof.shared.systems import ReversibleSystem, System

TOLERANCE = 1e-13
"""Relative and absolute, of a step in time."""


@dataclass(frozen=True)
class PeriodicSolution:
    """A solution in legs, each integrated from a start of its own, which repeats itself.

    Of an orbit that starts on Fix(R) the legs are half of it, the other half is their image under R. Starts of their
    own keep an orbit that was found by multiple shooting from being amplified beyond what it is known to.

    Attributes:
        parameters: all parameters of the vector field, in its order.
        starts: shape (k, m), the state at time 0 and those where the further legs begin.
        durations: shape (k,), times of the legs, in the system's units.
        mirrored: whether the legs are half of the orbit.
    """

    system: ReversibleSystem | System
    parameters: Sequence[float]
    starts: Matrix
    durations: Vector
    mirrored: bool = True

    @classmethod
    def symmetric(
        cls, system: ReversibleSystem, parameters: Sequence[float], point: Vector, period: float
    ) -> PeriodicSolution:
        """The solution through a point of Fix(R), shape (m,), that meets Fix(R) again after half a period."""
        return cls(system, parameters, np.asarray(point, dtype=float)[None, :], np.array([period / 2]))

    @property
    def period(self) -> float:
        """In the system's time units."""
        return float(self.durations.sum()) * (2 if self.mirrored else 1)

    def states(self, times: ArrayLike) -> Matrix:
        """The states at N times of any sign, shape (N, m). Raises `ValueError` for times that are not finite."""
        instants = np.atleast_1d(np.asarray(times, dtype=float))
        if instants.ndim != 1 or not np.all(np.isfinite(instants)):
            raise ValueError("times: give a list of finite numbers")
        phase = np.mod(instants, self.period)
        if not self.mirrored:
            return self._along(phase)
        # An orbit that does not close, a homoclinic one, ends at the image of its start.
        phase[instants == self.period] = self.period
        assert isinstance(self.system, ReversibleSystem)
        later = phase > self.period / 2
        signs = np.array(self.system.reversing_symmetry, dtype=float)
        found = self._along(np.where(later, self.period - phase, phase))
        return np.where(later[:, None], found * signs + 0.0, found)

    @property
    def defect(self) -> float:
        """The largest gap between the end of a leg and what comes next, in a coordinate: another start, Fix(R)
        (coordinates that vanish there), or the state at time 0.
        """
        ends = np.array(
            [leg(np.array([duration]))[:, 0] for leg, duration in zip(self._legs, self.durations, strict=True)]
        )
        gaps = [np.abs(ends[:-1] - self.starts[1:]).ravel()]
        if self.mirrored:
            assert isinstance(self.system, ReversibleSystem)
            gaps.append(np.abs(ends[-1][np.array(self.system.reversing_symmetry) == -1]))
        else:
            gaps.append(np.abs(ends[-1] - self.starts[0]))
        return float(np.concatenate(gaps).max())

    def _along(self, times: Vector) -> Matrix:
        """The states at times within the legs."""
        borders = np.cumsum(self.durations)
        which = np.minimum(np.searchsorted(borders, times), len(borders) - 1)
        result = np.empty((len(times), self.starts.shape[1]))
        for number, leg in enumerate(self._legs):
            here = which == number
            if np.any(here):
                result[here] = leg(times[here] - borders[number] + self.durations[number]).T
        return result

    @cached_property
    def _legs(self) -> list[_Leg]:
        return [self._leg(start, duration) for start, duration in zip(self.starts, self.durations, strict=True)]

    def _leg(self, start: Vector, duration: float) -> _Leg:
        return _Leg(lambda states: self.system.vector_field(list(states), self.parameters), start, float(duration))


class _Leg:
    """A solution from time 0 on: steps of a method of order 8, and from the last of their ends to any time between.

    Many times are one step of as many orbits. Raises `ArithmeticError` where the solution cannot be followed.
    """

    def __init__(self, field: Callable[[Matrix], Sequence[Any]], start: Vector, duration: float) -> None:
        self.field = field
        self.lower, self.error_weights = square_tableau()
        times, states, length, attempts = [0.0], [np.asarray(start, dtype=float)], 0.01 * duration, 0
        while times[-1] < duration:
            attempts += 1
            if attempts > MAX_STEPS or times[-1] + length == times[-1]:
                raise ArithmeticError(f"the orbit cannot be followed beyond time {times[-1]:.6g} (near a singularity)")
            ends, errors = self._step(states[-1][:, None], np.array([length]))
            sizes = TOLERANCE * (1 + np.maximum(np.abs(ends[:, 0]), np.abs(states[-1])))
            error = float(np.sqrt(np.mean((errors[:, 0] / sizes) ** 2)))
            if error <= 1:
                left = duration - times[-1]
                times.append(duration if length >= left else times[-1] + length)
                states.append(ends[:, 0])
            growth = min(max(0.9 * max(error, 1e-12) ** -0.125, 0.2), 10.0) if isfinite(error) else 0.2
            length = min(length * growth, duration - times[-1])
        self.times, self.states = np.array(times), np.array(states).T

    def __call__(self, times: Vector) -> Matrix:
        """The states at times of the leg, shape (m, N)."""
        last = np.maximum(np.searchsorted(self.times, times, side="right") - 1, 0)
        return self._step(self.states[:, last], times - self.times[last])[0]

    def _step(self, states: Matrix, lengths: Vector) -> tuple[Matrix, Matrix]:
        """Where one step leads from states of shape (m, N), and how far that is from what the lower order says."""
        slopes, ends = np.zeros((len(self.lower), *states.shape)), states
        with np.errstate(all="ignore"):
            for number, weights in enumerate(self.lower):
                ends = states + lengths * np.tensordot(weights[:number], slopes[:number], 1)
                for place, value in enumerate(self.field(ends)):
                    slopes[number, place] = value
            return ends, lengths * np.tensordot(self.error_weights, slopes, 1)
