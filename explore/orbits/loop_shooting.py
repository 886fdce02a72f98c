"""Periodic orbits without symmetry that meet the section several times, by multiple shooting over the whole period.

The unknowns are the states at all crossings of the section and the times between them. With a first integral one of the
equations follows from the others: what is left of them determines a curve of orbits, over the levels; with a family
parameter, which is an unknown too, one over its values. Each leg is integrated from the end at which the orbit is
slower: orbits that come out of a close passage magnify rounding more than those that go into it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orbitproof.explore.flow import Matrix, Vector, flow_of
from orbitproof.explore.orbits.along_level import level_gradient
from orbitproof.explore.orbits.multiple_shooting import Evaluation, MultipleShooting, SegmentedOrbit
from orbitproof.shared.systems import functions_in_floats

_SHORTEST = 1e-3
"""A leg that takes a smaller part of the period: the orbit is about to leave the section, where it is tangent to it."""


@dataclass(frozen=True)
class LoopShooting(MultipleShooting):
    """Shooting from the section to itself in `segments` half returns.

    The *point* of the unknowns is the family parameter, if there is one, and the start's coordinates in the section;
    such coordinates of the other crossings follow, then the times.
    """

    @cached_property
    def lead(self) -> int:
        """1 with a family parameter, else 0."""
        return int(self.system.family_parameter is not None)

    @cached_property
    def section_coordinates(self) -> tuple[int, ...]:
        """Indices of the coordinates of the section that are not functions of others."""
        return tuple(i for i in range(len(self.system.given_state)) if i != self.system.section_index)

    @cached_property
    def point_size(self) -> int:
        """How many numbers a start has, with the parameter."""
        return self.lead + len(self.section_coordinates)

    def initial_state(self, point: Vector) -> Vector:
        """The state on the section that belongs to a point, shape (m,)."""
        state = np.zeros(len(self.system.state))
        state[list(self.section_coordinates)] = point[self.lead : self.point_size]
        return np.array(functions_in_floats(self.system, state, self.parameter_values(point)))

    def states(self, unknowns: Vector) -> Matrix:
        """States at all crossings, shape (k, m)."""
        points = unknowns[self.lead : self.size - self.segments].reshape(self.segments, -1)
        return np.array([self.initial_state(np.concatenate([unknowns[: self.lead], each])) for each in points])

    def legs(self, unknowns: Vector) -> list[tuple[int, int, float]]:
        """From crossing to crossing, k of them: where the integration begins and ends, and its time, of either sign."""
        states, values, k = self.states(unknowns), self.parameter_values(unknowns), self.segments
        speeds = [float(np.linalg.norm(self.system.vector_field(state.tolist(), values.tolist()))) for state in states]
        ends = [(i, (i + 1) % k, float(time)) for i, time in enumerate(self.times(unknowns))]
        return [(a, b, time) if speeds[a] <= speeds[b] else (b, a, -time) for a, b, time in ends]

    def crosses_once(self, unknowns: Vector) -> bool:
        """Whether each leg meets the section at its ends only. Raises `FlowFailure`."""
        states, values, times = self.states(unknowns), self.parameter_values(unknowns), self.times(unknowns)
        if times.min() < _SHORTEST * times.sum():
            return False
        for begin, _, time in self.legs(unknowns):
            inner = flow_of(self.system).samples(states[begin], time, values)[1:-1, self.system.section_index]
            if np.any(inner[1:] * inner[:-1] <= 0):
                return False
        return True

    def evaluate(self, unknowns: Vector) -> Evaluation:
        """The equations: each segment ends where the next one begins, the last one where the first does.

        On a fixed level one more says that the start is on it. Raises `FlowFailure` near a singularity.
        """
        system, k, width = self.system, self.segments, len(self.section_coordinates)
        m, own = len(system.given_state), list(self.section_coordinates)
        states, values = self.states(unknowns), self.parameter_values(unknowns)
        residual, jacobian = np.zeros(k * m), np.zeros((k * m, self.size))
        flows = []
        for i, (begin, end, time) in enumerate(self.legs(unknowns)):
            result = flow_of(system).derivative(states[begin], time, values)
            flows.append(result)
            here = slice(i * m, (i + 1) * m)
            columns = [slice(self.lead + j * width, self.lead + (j + 1) * width) for j in (begin, end)]
            residual[here] = (result.state - states[end])[:m]
            jacobian[here, : self.lead] = result.parameter_derivative[:m, None]
            jacobian[here, columns[0]] += result.state_transition[:m, own]
            jacobian[here, columns[1]] -= np.eye(m)[:, own]
            jacobian[here, self.size - k + i] = np.sign(time) * result.velocity[:m]
        if system.fixed_level is not None:
            assert system.first_integral is not None
            row, gradient = np.zeros(self.size), level_gradient(system, states[0], values)
            row[0] = gradient[len(system.state) + list(system.parameters).index(str(system.family_parameter))]
            row[self.lead : self.point_size] = gradient[own]
            level = float(system.first_integral(states[0].tolist(), values.tolist())[0])
            residual = np.append(residual, level - float(system.fixed_level.value))
            jacobian = np.vstack([jacobian, row])
        return Evaluation(residual, jacobian, tuple(flows))

    def end(self, orbit: SegmentedOrbit) -> Vector:
        """Where the orbit is half of its crossings later, in the coordinates of Fix(R)."""
        return self.on_fixed_set(orbit, self.segments // 2)

    def on_fixed_set(self, orbit: SegmentedOrbit, number: int) -> Vector:
        """A crossing in the coordinates of Fix(R), in the order of `ReversibleSystem.centre_coordinates`."""
        state = self.states(orbit.unknowns)[number]
        return np.concatenate([orbit.unknowns[: self.lead], state[list(self.system.fixed_coordinates)]])

    def stability(self, orbit: SegmentedOrbit) -> tuple[complex, ...]:
        """(lambda + 1/lambda)/2 of one multiplier of each pair, of the return map, on the level if there is one.

        With a first integral the two of a pair are inverse; without, the mirror image has the inverses.
        """
        own, section = list(self.section_coordinates), self.system.section_index
        whole = np.eye(len(own))
        for flow, (_, _, time) in zip(orbit.evaluation.flows, self.legs(orbit.unknowns), strict=True):
            across = (
                flow.state_transition
                - np.outer(flow.velocity, flow.state_transition[section]) / (flow.velocity[section])
            )
            leg = across[np.ix_(own, own)]
            whole = leg @ whole if time > 0 else np.linalg.solve(leg, whole)
        if self.system.first_integral is not None:
            given = self.parameter_values(orbit.unknowns)
            gradient = level_gradient(self.system, self.states(orbit.unknowns)[0], given)[own]
            basis = np.linalg.svd(gradient[None])[2][1:]
            whole = basis @ whole @ basis.T
        found, values = sorted(map(complex, np.linalg.eigvals(whole)), key=lambda value: -abs(value)), list[complex]()
        while found:
            largest = found.pop(0)
            inverse = 1 / largest
            if found:
                partner = min(found, key=lambda value: abs(value * largest - 1))
                found.remove(partner)
                # The sum of a pair on the circle is real without rounding.
                inverse = inverse if self.system.first_integral is None else partner
            values.append((largest + inverse) / 2)
        return tuple(sorted(values, key=lambda s: (s.real, s.imag)))

    def _solved(self, matrix: Matrix, residual: Vector) -> Vector:
        # Where directions are hardly determined, as close to a birth, the step shall show it: none is left out.
        norms = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        return np.linalg.lstsq(matrix / norms, residual, rcond=0.0)[0] / norms
