"""Many symmetric periodic orbits at once: Newton's method for each, all in the same few calls to the flow.

For catalogues of orbits, sweeps over mass parameters and seeds of any kind: orbits that do not depend on each other.
A family, whose orbits do, is traced by `explore.families.continuation`.

The shooting equations are those of `explore.orbits.shooting`. They have one solution curve through each orbit; the
correction is the shortest step to it (least norm in scaled unknowns), or, with `normals`, the step in a hyperplane.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.flow import Counts, Flags, FlowBatch, Matrices, Matrix, Vector, flow_batch
from orbitproof.explore.numerics import SHOOTING
from orbitproof.explore.orbits.batch_algebra import (
    characteristic_coefficients,
    half_returns,
    least_norm,
    roots,
    solve,
    stability_indices,
    stability_matrices,
)
from orbitproof.explore.orbits.shooting import RESIDUAL, CorrectionFailure, ShootingProblem, SymmetricOrbit
from orbitproof.explore.orbits.stability import HalfReturn
from orbitproof.shared.systems import ReversibleSystem, with_functions

_FUNCTIONS = {"sin": np.sin, "cos": np.cos, "exp": np.exp, "log": np.log}


@dataclass(frozen=True)
class OrbitBatch:
    """N symmetric periodic orbits; nothing is left out, what failed is marked.

    Attributes:
        unknowns: shape (N, 2 + n): family parameter (if any), Fix(R) coordinates, half period.
        states: shape (N, m), the first points on Fix(R).
        second_points: shape (N, number of Fix(R) coordinates), where the orbits meet Fix(R) again.
        first_integrals: shape (N,), or `None` for a system without one.
        derivatives: shape (N, m - 1, m - 1), the derivatives DP of the half returns as in `HalfReturn`.
        coefficients: shape (N, n + 1), characteristic polynomials of the stability matrices.
        residuals: shape (N,), largest magnitude of a shooting equation.
        crossings: shape (N,), how often the half orbit meets the section after its start.
        iterations: shape (N,), Newton steps.
        converged: shape (N,).
        failures: N texts, why an orbit did not converge; "" for one that did. The quantities of an orbit that
            failed are those of its last iterate, NaN where it could not be integrated.
    """

    unknowns: Matrix
    states: Matrix
    second_points: Matrix
    first_integrals: Vector | None
    derivatives: Matrices
    coefficients: Matrix
    residuals: Vector
    crossings: Counts
    iterations: Counts
    converged: Flags
    failures: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.unknowns)

    @property
    def stability(self) -> np.ndarray:
        """The stability parameters s = (lambda + 1/lambda)/2, complex, shape (N, n), sorted as for one orbit."""
        return roots(self.coefficients)

    @property
    def stability_indices(self) -> Vector:
        """Shape (N,), of the multipliers with the largest magnitudes."""
        return stability_indices(self.stability)

    def orbit(self, index: int) -> SymmetricOrbit:
        """One orbit; raises `CorrectionFailure` if it did not converge."""
        if not self.converged[index]:
            raise CorrectionFailure(self.failures[index])
        return SymmetricOrbit(
            unknowns=self.unknowns[index].copy(),
            second_point=self.second_points[index].copy(),
            first_integral=None if self.first_integrals is None else float(self.first_integrals[index]),
            coefficients=self.coefficients[index].copy(),
            crossings=int(self.crossings[index]),
            derivative=HalfReturn(self.derivatives[index].copy(), self.second_points.shape[1]),
        )


def correct_batch(
    system: ReversibleSystem,
    parameters: Mapping[str, Any],
    unknowns: Matrix,
    *,
    symmetry: str | None = None,
    scale: Matrix | Vector | None = None,
    normals: Matrix | None = None,
    tolerance: float = SHOOTING.tolerance,
    progress: Progress | None = None,
) -> OrbitBatch:
    """Correct N approximate symmetric orbits.

    Arguments:
        system: the reversible system.
        parameters: its fixed parameters by name, one number or N numbers each (mass parameters).
        unknowns: shape (N, 2 + n), approximations, nondimensional units.
        symmetry: name of a symmetry S of the system: only orbits in Fix(S); `None`: all.
        scale: shape (2 + n,) or (N, 2 + n), typical sizes of the unknowns; ones by default.
        normals: shape (N, 2 + n), scaled normals of hyperplanes through the approximations in which the orbits are
            looked for; by default each orbit is found by steps of least norm.
        tolerance: as for `ShootingProblem`.
        progress: called with what is being done and the fraction done.

    Raises `ValueError` for shapes that do not fit; failures of single orbits are values.
    """
    unknowns = np.array(unknowns, dtype=float)
    count = len(unknowns)
    if set(parameters) != set(system.fixed_parameters):
        wanted = ", ".join(system.fixed_parameters) or "none"
        raise ValueError(
            f"parameters {', '.join(parameters) or 'none'}: the fixed parameters of {system.name} are {wanted}"
        )
    fixed = {name: np.broadcast_to(np.asarray(parameters[name], float), count) for name in system.fixed_parameters}
    problem = ShootingProblem(system, dict.fromkeys(fixed, Fraction(0)), symmetry=symmetry, tolerance=tolerance)
    if unknowns.shape != (count, problem.size):
        raise ValueError(f"unknowns of shape {unknowns.shape}: {system.name} needs (N, {problem.size})")
    newton = _Newton(problem, fixed, unknowns, scale, normals)
    return newton.run(progress)


class _Newton:
    """The state of the iteration: which orbits are still moving, and the last evaluation of each."""

    def __init__(
        self,
        problem: ShootingProblem,
        fixed: Mapping[str, Vector],
        unknowns: Matrix,
        scale: Matrix | Vector | None,
        normals: Matrix | None,
    ) -> None:
        count, m = len(unknowns), len(problem.system.state)
        self.problem, self.fixed, self.rule = problem, fixed, problem.rule
        self.unknowns, self.predictions = unknowns, unknowns.copy()
        self.free = list(problem.free_unknowns)
        odd = [i for i in range(problem.size) if i not in self.free]
        self.unknowns[:, odd] = 0.0
        self.scales = np.broadcast_to(np.ones(problem.size) if scale is None else np.asarray(scale), unknowns.shape)
        self.rows = None if normals is None else (np.asarray(normals) / self.scales)[:, self.free]
        self.flow = FlowBatch(
            np.full((count, m), np.nan),
            np.full((count, m), np.nan),
            np.full((count, m, m), np.nan),
            np.full((count, m), np.nan),
            np.zeros(count, dtype=int),
            np.zeros(count, dtype=int),
            np.zeros(count, dtype=bool),
        )
        self.residuals = np.full(count, np.nan)
        self.last = np.full(count, np.inf)
        self.iterations = np.zeros(count, dtype=int)
        self.failures = [""] * count

    def run(self, progress: Progress | None) -> OrbitBatch:
        moving = np.arange(len(self.unknowns))
        for iteration in range(self.rule.steps):
            if not len(moving):
                break
            self._evaluate(moving, progress, iteration)
            self.iterations[moving] = iteration
            moving = self._step(moving, iteration)
        for i in moving:
            self.failures[i] = "Newton's method does not converge to a symmetric orbit"
        return self._result()

    def _parameters(self, which: np.ndarray) -> Matrix:
        system = self.problem.system
        columns = [
            self.unknowns[which, 0] if name == system.family_parameter else self.fixed[name][which]
            for name in system.parameters
        ]
        return np.stack(columns, axis=1)

    def _initial(self, which: np.ndarray) -> Matrix:
        system = self.problem.system
        states = np.zeros((len(which), len(system.state)))
        fixed = list(system.fixed_coordinates)
        states[:, fixed] = self.unknowns[which][:, self.problem.size - 1 - len(fixed) : -1]
        columns = with_functions(system, [*states.T], [*self._parameters(which).T], _FUNCTIONS)
        return np.stack(np.broadcast_arrays(*columns), axis=1)

    def _evaluate(self, which: np.ndarray, progress: Progress | None, iteration: int) -> None:
        # Orbits that take about as many steps go into one block, so that few lanes wait for others.
        which = which[np.argsort(self.flow.steps[which], kind="stable")]

        def report(done: int) -> None:
            if progress is not None:
                whole = len(self.unknowns)
                settled = whole - len(which)
                progress(f"correcting, step {iteration + 1}", (settled + 0.5 * done) / whole)

        new = flow_batch(
            self.problem.system, self._initial(which), self.unknowns[which, -1], self._parameters(which), report
        )
        for name, values in vars(self.flow).items():
            values[which] = getattr(new, name)

    def _step(self, which: np.ndarray, iteration: int) -> np.ndarray:
        """One Newton step for each of the orbits; returns those that go on."""
        problem, flow, free = self.problem, self.flow, self.free
        for i in which[~flow.finished[which]]:
            self.failures[i] = (
                f"the orbit could not be integrated over time {self.unknowns[i, -1]:.6g} (near a singularity)"
            )
        which = which[flow.finished[which]]
        columns = [flow.state_transitions[which][:, :, list(problem.system.fixed_coordinates)]]
        columns.append(flow.velocities[which][:, :, None])
        if problem.system.family_parameter is not None:
            columns.insert(0, flow.parameter_derivatives[which][:, :, None])
        equations = list(problem.equations)
        jacobian = np.concatenate(columns, axis=2)[:, equations][:, :, free]
        residual = flow.states[which][:, equations]
        self.residuals[which] = np.max(np.abs(residual), axis=1)
        scales = self.scales[which][:, free]
        if self.rows is None:
            step = scales * least_norm(jacobian * scales[:, None, :], residual)
        else:
            rows = self.rows[which]
            offset = np.sum(rows * (self.unknowns - self.predictions)[which][:, free], axis=1)
            step = solve(np.concatenate([jacobian, rows[:, None]], axis=1), np.append(residual, offset[:, None], 1))
        size = np.linalg.norm(step / scales, axis=1)
        found, lost = self.rule.judge(
            size,
            self.last[which],
            accepted=self.rule.accepted * (1.0 + np.linalg.norm(self.unknowns[which] / self.scales[which], axis=1)),
            exact=self.residuals[which] < RESIDUAL * self.rule.tolerance,
        )
        self.last[which] = size
        proposal = self.unknowns[which]
        proposal[:, free] -= step
        reversed_time = ~found & ~lost & (proposal[:, -1] <= 0)
        for flags, reason in (
            (lost, "Newton's method does not converge to a symmetric orbit"),
            (reversed_time, "the half period became negative"),
        ):
            for i in which[flags]:
                self.failures[i] = reason
        going = ~(found | lost | reversed_time)
        if iteration + 1 < self.rule.steps:
            self.unknowns[which[going]] = proposal[going]
        return which[going]

    def _result(self) -> OrbitBatch:
        system, flow = self.problem.system, self.flow
        everything = np.arange(len(self.unknowns))
        integrals, states = None, self._initial(everything)
        if system.first_integral is not None:
            with np.errstate(all="ignore"):
                integrals = np.asarray(system.first_integral(states.T, self._parameters(everything).T)[0])
        derivatives = half_returns(system, flow)
        return OrbitBatch(
            unknowns=self.unknowns,
            states=states,
            second_points=flow.states[:, list(system.fixed_coordinates)],
            first_integrals=integrals,
            derivatives=derivatives,
            coefficients=characteristic_coefficients(stability_matrices(derivatives, len(system.fixed_coordinates))),
            residuals=self.residuals,
            crossings=flow.crossings,
            iterations=self.iterations,
            converged=np.array([not failure for failure in self.failures]),
            failures=tuple(self.failures),
        )
