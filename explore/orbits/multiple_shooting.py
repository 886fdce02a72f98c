"""Symmetric periodic orbits that meet the section several times, by multiple shooting.

A symmetric orbit starts on Fix(R), crosses the section k - 1 times and is on Fix(R) again at the k-th
crossing, half a period later. The states at the crossings and the times between them are unknowns of their
own: the errors of one half return are amplified by that half return only, where single shooting over k of them
would lose what k half returns of an unstable orbit amplify.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations

import numpy as np

from orbitproof.explore.flow import FlowFailure, FlowResult, Matrix, Vector, flow_of
from orbitproof.explore.numerics import SEGMENTS
from orbitproof.explore.orbits.along_level import along_level
from orbitproof.explore.orbits.shooting import CorrectionFailure
from orbitproof.explore.orbits.stability import half_return
from orbitproof.shared.systems import ReversibleSystem, completed


@dataclass(frozen=True)
class Evaluation:
    """Residual and Jacobian of the shooting equations, and the flow over each segment."""

    residual: Vector
    jacobian: Matrix
    flows: tuple[FlowResult, ...]


@dataclass(frozen=True)
class SegmentedOrbit:
    """A solution: the unknowns of `MultipleShooting` with what the last evaluation gave.

    Attributes:
        correction: Newton's step at the solution, which was not taken: how well it is known.
    """

    unknowns: Vector
    evaluation: Evaluation
    correction: Vector


@dataclass(frozen=True)
class MultipleShooting:
    """Shooting from Fix(R) to Fix(R) in `segments` half returns.

    The vector of unknowns holds the 1 + n numbers of `ReversibleSystem.centre_coordinates` (the *point*), the
    section's m - 1 coordinates at each of the k - 1 crossings between, and the k times; one more than equations.

    Attributes:
        system: the reversible system.
        parameters: exact values of its fixed parameters, by name.
        segments: k.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    segments: int

    @cached_property
    def point_size(self) -> int:
        """1 + n."""
        return len(self.system.centre_coordinates)

    @cached_property
    def section_coordinates(self) -> tuple[int, ...]:
        """Indices of the state coordinates of the section, m - 1 of them."""
        return tuple(i for i in range(len(self.system.state)) if i != self.system.section_index)

    @cached_property
    def size(self) -> int:
        """Number of unknowns."""
        return self.point_size + (self.segments - 1) * len(self.section_coordinates) + self.segments

    def initial_state(self, point: Vector) -> Vector:
        """The state on Fix(R) that belongs to a point, shape (m,)."""
        state = np.zeros(len(self.system.state))
        fixed = self.system.fixed_coordinates
        state[list(fixed)] = point[self.point_size - len(fixed) : self.point_size]
        return np.array(completed(self.system, state.tolist(), self.parameter_values(point)))

    def parameter_values(self, point: Vector) -> Vector:
        """All parameters of the vector field in its order, as doubles."""
        family = self.system.family_parameter
        return np.array(
            [point[0] if name == family else float(self.parameters[name]) for name in self.system.parameters]
        )

    def states(self, unknowns: Vector) -> Matrix:
        """States at the start of each segment, shape (k, m)."""
        width, m = len(self.section_coordinates), len(self.system.state)
        result = np.zeros((self.segments, m))
        result[0] = self.initial_state(unknowns)
        inner = unknowns[self.point_size : self.point_size + (self.segments - 1) * width]
        result[1:, list(self.section_coordinates)] = inner.reshape(-1, width)
        return result

    def times(self, unknowns: Vector) -> Vector:
        """Durations of the segments, shape (k,)."""
        return unknowns[self.size - self.segments :]

    def assemble(self, point: Vector, states: Matrix, times: Vector) -> Vector:
        """The vector of unknowns; `states` are those at the k - 1 crossings between, shape (k - 1, m)."""
        return np.concatenate([point, states[:, list(self.section_coordinates)].ravel(), times])

    def evaluate(self, unknowns: Vector) -> Evaluation:
        """The equations: each segment ends where the next begins, the last one on Fix(R).

        Raises `FlowFailure` near a singularity.
        """
        system, k, width = self.system, self.segments, len(self.section_coordinates)
        m, lead = len(system.state), int(system.family_parameter is not None)
        states, times, values = self.states(unknowns), self.times(unknowns), self.parameter_values(unknowns)
        ends = [system.section_index, *system.kernel_coordinates]
        residual, jacobian = np.zeros(self.size - 1), np.zeros((self.size - 1, self.size))
        flow, flows = flow_of(system), []
        for i in range(k):
            result = flow.derivative(states[i], float(times[i]), values)
            flows.append(result)
            if i == 0:
                result = along_level(system, states[0], values, result)
            rows = list(range(m)) if i < k - 1 else ends
            here = slice(i * m, i * m + len(rows))
            next_columns = slice(self.point_size + i * width, self.point_size + (i + 1) * width)
            residual[here] = result.state[rows]
            if lead:
                jacobian[here, 0] = result.parameter_derivative[rows]
            if i == 0:
                jacobian[here, lead : self.point_size] = result.state_transition[
                    np.ix_(rows, list(system.fixed_coordinates))
                ]
            else:
                own = slice(next_columns.start - width, next_columns.start)
                jacobian[here, own] = result.state_transition[np.ix_(rows, list(self.section_coordinates))]
            jacobian[here, self.size - k + i] = result.velocity[rows]
            if i < k - 1:
                residual[here] -= states[i + 1]
                jacobian[here, next_columns] -= np.eye(m)[:, list(self.section_coordinates)]
        return Evaluation(residual, jacobian, tuple(flows))

    def correct(self, prediction: Vector, normal: Vector, resolved: float = 0.0) -> SegmentedOrbit:
        """The orbit on the hyperplane normal . (point - predicted point) = 0; `normal` has shape (1 + n,).

        Newton's method, until its steps no longer become smaller, relative where an unknown exceeds 1; what is left of
        them may be up to `resolved` if that is more than `SEGMENTS` accepts. Raises `CorrectionFailure`.
        """
        unknowns, last = prediction.copy(), np.inf
        row = np.zeros(self.size)
        row[: self.point_size] = normal / np.linalg.norm(normal)
        for _ in range(SEGMENTS.steps):
            try:
                evaluation = self.evaluate(unknowns)
                matrix = np.vstack([evaluation.jacobian, row])
                step = self._solved(matrix, np.append(evaluation.residual, row @ (unknowns - prediction)))
            except FlowFailure as error:
                raise CorrectionFailure(str(error)) from None
            except np.linalg.LinAlgError:
                raise CorrectionFailure("the shooting equations are singular") from None
            size = float(np.max(np.abs(step) / (1.0 + np.abs(unknowns))))
            found, lost = SEGMENTS.judge(size, last, accepted=max(SEGMENTS.accepted, resolved))
            if found:
                return SegmentedOrbit(unknowns, evaluation, step)
            if lost:
                break
            last = size
            unknowns = unknowns - step
            if np.min(self.times(unknowns)) <= 0:
                raise CorrectionFailure("a half return takes no time")
        raise CorrectionFailure("Newton's method does not converge to a periodic orbit")

    def _solved(self, matrix: Matrix, residual: Vector) -> Vector:
        """Newton's step, from as many equations as unknowns."""
        return np.linalg.solve(matrix, residual)

    def tangent(self, evaluation: Evaluation, scales: Vector, direction: Vector) -> Vector:
        """Tangent of the curve of solutions, on the side of `direction`; both of the size of the unknowns.

        Its point has length 1 in units of `scales`, shape (1 + n,). Raises `CorrectionFailure` where there is no
        unique tangent.
        """
        # The columns are brought to similar sizes, so that the rank can be seen.
        norms = np.maximum(np.linalg.norm(evaluation.jacobian, axis=0), 1e-300)
        _, values, rows = np.linalg.svd(evaluation.jacobian / norms)
        vector = rows[-1] / norms
        length = float(np.linalg.norm(vector[: self.point_size] / scales))
        if values[self.size - 2] <= 1e-14 * values[0] or length == 0:
            raise CorrectionFailure("the branch has no unique tangent (a branch point)")
        vector = vector / length
        own, other = (v[: self.point_size] / scales for v in (vector, direction))
        return vector if float(own @ other) >= 0 else -vector

    def crosses_once(self, unknowns: Vector) -> bool:
        """Whether each segment meets the section at its ends only. Raises `FlowFailure`."""
        flow, values = flow_of(self.system), self.parameter_values(unknowns)
        for state, time in zip(self.states(unknowns), self.times(unknowns), strict=True):
            inner = flow.samples(state, float(time), values)[1:-1, self.system.section_index]
            if np.any(inner[1:] * inner[:-1] <= 0):
                return False
        return True

    def end(self, orbit: SegmentedOrbit) -> Vector:
        """The point of the orbit on Fix(R) half a period after the start, in the order of a point."""
        lead = orbit.unknowns[: self.point_size - len(self.system.fixed_coordinates)]
        return np.concatenate([lead, orbit.evaluation.flows[-1].state[list(self.system.fixed_coordinates)]])

    def stability(self, orbit: SegmentedOrbit) -> tuple[complex, ...]:
        """The n stability parameters s = (lambda + 1/lambda)/2 of the orbit, sorted by real, then imaginary part.

        With W = D P^k, a product of k factors, and X = W_qp (W^-1)_pq the s are 1 - 2 r for the eigenvalues r
        of X (`explore.orbits.stability`). The elementary symmetric functions of these are sums of minors of W and of
        its inverse. Minors of a product are products of minors (Cauchy and Binet); computed this way a small r
        beside a large one is not lost in the rounding errors of the large one.
        """
        values = self.parameter_values(orbit.unknowns)
        flows = [
            along_level(self.system, state, values, flow)
            for state, flow in zip(self.states(orbit.unknowns), orbit.evaluation.flows, strict=True)
        ]
        returns = [half_return(self.system, flow).derivative for flow in flows]
        p, n = len(self.system.fixed_coordinates), len(self.system.kernel_coordinates)
        sums = []
        for order in range(1, n + 1):
            there = back = None
            for derivative in returns:
                factor, inverse = _compound(derivative, order), _compound(np.linalg.inv(derivative), order)
                there = factor if there is None else factor @ there
                back = inverse if back is None else back @ inverse
            assert there is not None
            assert back is not None
            subsets = list(combinations(range(p + n), order))
            along = [i for i, subset in enumerate(subsets) if subset[-1] < p]
            across = [i for i, subset in enumerate(subsets) if subset[0] >= p]
            sums.append(float(np.trace(there[np.ix_(across, along)] @ back[np.ix_(along, across)])))
        values = [1 - 2 * root for root in _roots(sums)]
        return tuple(sorted(values, key=lambda s: (s.real, s.imag)))


def _compound(matrix: Matrix, order: int) -> Matrix:
    """The matrix of all minors of the given order, rows and columns in lexicographic order."""
    subsets = list(combinations(range(len(matrix)), order))
    return np.array([[np.linalg.det(matrix[np.ix_(rows, columns)]) for columns in subsets] for rows in subsets])


def _roots(sums: list[float]) -> list[complex]:
    """The numbers with these elementary symmetric functions."""
    if len(sums) != 2:
        signs = [(-1) ** (i + 1) for i in range(len(sums))]
        return [complex(root) for root in np.roots([1.0, *(s * e for s, e in zip(signs, sums, strict=True))])]
    total, product = sums
    discriminant = complex(total * total - 4 * product) ** 0.5
    # The larger root without cancellation, the smaller one from the product.
    large = (total + (discriminant if total >= 0 else -discriminant)) / 2
    return [large, product / large if large else 0j]
