"""Symmetric periodic orbits by shooting from Fix(R) to Fix(R).

An orbit that starts on Fix(R) and meets it again after the time T is periodic with period 2T. The
unknowns are the family parameter (if the system has one), the coordinates of Fix(R) and T; the
equations are that the section coordinate and the kernel coordinates vanish at time T. There is one
more unknown than equations: solutions form curves. No event location is needed, T is an unknown.

Within the fixed space of a further symmetry S (planar orbits) the same equations hold with the
S-odd unknowns and equations left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from orbitproof.explore.flow import FlowFailure, FlowResult, Matrix, Vector, flow_of
from orbitproof.explore.numerics import SHOOTING, NewtonRule
from orbitproof.explore.orbits.along_level import along_level
from orbitproof.explore.orbits.stability import (
    HalfReturn,
    Side,
    characteristic_coefficients,
    half_return,
    stability_parameters,
)
from orbitproof.shared.systems import ReversibleSystem, completed

RESIDUAL = 1e3
"""How far the equations may be off, in units of the tolerance of a step (orbits close to a collision are sensitive)."""


class CorrectionFailure(Exception):
    """Newton's method found no symmetric orbit near the prediction; one line says why."""


@dataclass(frozen=True)
class SymmetricOrbit:
    """A symmetric periodic orbit.

    Attributes:
        unknowns: shape (2 + n,): family parameter (if any), Fix(R) coordinates, half period.
        second_point: shape (number of Fix(R) coordinates,), where the orbit meets Fix(R) again.
        first_integral: its value, or `None` for a system with a family parameter.
        coefficients: shape (n + 1,), characteristic polynomial of the stability matrix.
        arclength: along the family from its first orbit, in the problem's scaled unknowns.
        crossings: how often the half orbit meets the section after its start (1: its end only).
        derivative: the half return's derivative at the first point; `None` in an orbit read from a file.
    """

    unknowns: Vector
    second_point: Vector
    first_integral: float | None
    coefficients: Vector
    arclength: float = 0.0
    crossings: int = 1
    derivative: HalfReturn | None = field(default=None, compare=False)

    @property
    def half_period(self) -> float:
        """T, in the system's time units."""
        return float(self.unknowns[-1])

    @property
    def period(self) -> float:
        """2 T, in the system's time units."""
        return 2 * self.half_period

    @property
    def stability(self) -> tuple[complex, ...]:
        """The n stability parameters s = (lambda + 1/lambda)/2."""
        return stability_parameters(self.coefficients)

    def centre(self, side: Side = "first") -> Vector:
        """A point of the orbit on Fix(R), in the order of `ReversibleSystem.centre_coordinates`."""
        first = self.unknowns[:-1]
        if side == "first":
            return first.copy()
        return np.concatenate([first[: len(first) - len(self.second_point)], self.second_point])


@dataclass(frozen=True)
class Correction:
    """A solution of the shooting equations with what the last evaluation gave."""

    unknowns: Vector
    jacobian: Matrix
    flow: FlowResult
    iterations: int


@dataclass(frozen=True)
class ShootingProblem:
    """Shooting for the symmetric orbits of a system at given parameters.

    Attributes:
        system: the reversible system.
        parameters: exact values of its fixed parameters, by name.
        symmetry: name of a symmetry S of the system: only orbits in Fix(S); `None`: all.
        scale: shape (2 + n,), typical sizes of the unknowns; arclength is measured in units of them.
        tolerance: length of the last Newton step in scaled unknowns at which an orbit counts as found, if the
            equations hold to `RESIDUAL` times as much; a longer one that no further step makes shorter also counts,
            up to the one that `SHOOTING` accepts.
    """

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    symmetry: str | None = None
    scale: tuple[float, ...] | None = None
    tolerance: float = SHOOTING.tolerance

    @property
    def rule(self) -> NewtonRule:
        """When a correction ends."""
        return replace(SHOOTING, tolerance=self.tolerance, accepted=max(SHOOTING.accepted, self.tolerance))

    @cached_property
    def size(self) -> int:
        """Number of unknowns, 2 + n."""
        return len(self.system.centre_coordinates) + 1

    @cached_property
    def scales(self) -> Vector:
        """`scale` as an array, ones by default."""
        return np.ones(self.size) if self.scale is None else np.asarray(self.scale, dtype=float)

    @cached_property
    def parities(self) -> tuple[int, ...]:
        """Sign of each state coordinate under the problem's symmetry (all 1 without one)."""
        return (1,) * len(self.system.state) if self.symmetry is None else self.system.symmetries[self.symmetry]

    @cached_property
    def free_unknowns(self) -> tuple[int, ...]:
        """Indices of the unknowns that are solved for; the others are S-odd and zero."""
        odd = () if self.symmetry is None else self.odd_unknowns(self.symmetry)
        return tuple(i for i in range(self.size) if i not in odd)

    @cached_property
    def equations(self) -> tuple[int, ...]:
        """Indices of the state coordinates that have to vanish at the half period."""
        system = self.system
        return (system.section_index, *(i for i in system.kernel_coordinates if self.parities[i] == 1))

    def initial_state(self, unknowns: Vector) -> Vector:
        """The state on Fix(R) that belongs to the unknowns, shape (m,)."""
        state = np.zeros(len(self.system.state))
        fixed = self.system.fixed_coordinates
        state[list(fixed)] = unknowns[self.size - 1 - len(fixed) : -1]
        return np.array(completed(self.system, state.tolist(), self.parameter_values(unknowns)))

    def parameter_values(self, unknowns: Vector) -> Vector:
        """All parameters of the vector field in its order, as doubles."""
        family = self.system.family_parameter
        return np.array(
            [unknowns[0] if name == family else float(self.parameters[name]) for name in self.system.parameters]
        )

    def evaluate(self, unknowns: Vector) -> tuple[Vector, Matrix, FlowResult]:
        """Residual, its Jacobian in the free unknowns and the flow over the half period.

        Raises `FlowFailure` near a singularity.
        """
        system = self.system
        flow = flow_of(system).derivative(
            self.initial_state(unknowns), float(unknowns[-1]), self.parameter_values(unknowns)
        )
        flow = along_level(system, self.initial_state(unknowns), self.parameter_values(unknowns), flow)
        columns = [flow.state_transition[:, list(system.fixed_coordinates)], flow.velocity[:, None]]
        if system.family_parameter is not None:
            columns.insert(0, flow.parameter_derivative[:, None])
        rows = list(self.equations)
        jacobian = np.hstack(columns)[np.ix_(rows, list(self.free_unknowns))]
        return flow.state[rows], jacobian, flow

    def correct(self, prediction: Vector, normal: Vector) -> Correction:
        """The symmetric orbit on the hyperplane through `prediction` with the scaled `normal`.

        Newton's method; `normal` has shape (2 + n,) in units of `scale`. Raises `CorrectionFailure`.
        """
        free = list(self.free_unknowns)
        unknowns = prediction.copy()
        row = (normal / self.scales)[free]
        last = np.inf
        for iteration in range(self.rule.steps):
            try:
                residual, jacobian, flow = self.evaluate(unknowns)
            except FlowFailure as error:
                raise CorrectionFailure(str(error)) from None
            offset = float(row @ (unknowns - prediction)[free])
            try:
                step = np.linalg.solve(np.vstack([jacobian, row]), np.append(residual, offset))
            except np.linalg.LinAlgError:
                raise CorrectionFailure("the shooting equations are singular") from None
            size = float(np.linalg.norm(step / self.scales[free]))
            found, lost = self.rule.judge(
                size,
                last,
                accepted=self.rule.accepted * (1.0 + float(np.linalg.norm(unknowns / self.scales))),
                exact=float(np.max(np.abs(residual))) < RESIDUAL * self.tolerance,
            )
            if found:
                return Correction(unknowns, jacobian, flow, iteration)
            if lost:
                break
            last = size
            unknowns = unknowns.copy()
            unknowns[free] -= step
            if unknowns[-1] <= 0:
                raise CorrectionFailure("the half period became negative")
        raise CorrectionFailure("Newton's method does not converge to a symmetric orbit")

    def tangent(self, jacobian: Matrix, direction: Vector) -> Vector:
        """Unit tangent of the family in scaled unknowns, on the side of `direction`, shape (2 + n,).

        `jacobian` as in `evaluate`. Raises `CorrectionFailure` where the family has no unique tangent.
        """
        free = list(self.free_unknowns)
        scaled = jacobian * self.scales[free]
        # Near a collision the equations are of very different sizes, which says nothing about the family.
        sizes = np.linalg.norm(scaled, axis=1, keepdims=True)
        _, values, rows = np.linalg.svd(scaled / np.where(sizes > 0, sizes, 1.0))
        if values[-1] <= 1e-12 * values[0]:
            raise CorrectionFailure("the family's tangent cannot be told: a branch point, or an orbit near a collision")
        result = np.zeros(self.size)
        result[free] = rows[-1]
        return result if float(result @ direction) >= 0 else -result

    def orbit(self, correction: Correction, arclength: float = 0.0, crossings: int = 1) -> SymmetricOrbit:
        """The orbit of a solution, with its stability data."""
        system, flow = self.system, correction.flow
        derivative = half_return(system, flow)
        integral = None
        if system.first_integral is not None:
            values = self.parameter_values(correction.unknowns)
            integral = float(system.first_integral(self.initial_state(correction.unknowns), values)[0])
        return SymmetricOrbit(
            unknowns=correction.unknowns,
            second_point=flow.state[list(system.fixed_coordinates)],
            first_integral=integral,
            coefficients=characteristic_coefficients(derivative.stability_matrix),
            arclength=arclength,
            crossings=crossings,
            derivative=derivative,
        )

    def samples(self, unknowns: Vector) -> Matrix:
        """States along the half orbit, both ends included, shape (N, m). Raises `FlowFailure`."""
        initial, values = self.initial_state(unknowns), self.parameter_values(unknowns)
        return flow_of(self.system).samples(initial, float(unknowns[-1]), values)

    def odd_unknowns(self, symmetry: str) -> tuple[int, ...]:
        """Indices of the unknowns that the symmetry negates."""
        signs, lead = self.system.symmetries[symmetry], self.size - 1 - len(self.system.fixed_coordinates)
        return tuple(lead + i for i, state in enumerate(self.system.fixed_coordinates) if signs[state] == -1)

    def with_derivative(self, orbit: SymmetricOrbit) -> SymmetricOrbit:
        """The orbit with its half return's derivative, computed if it is missing."""
        if orbit.derivative is not None:
            return orbit
        _, _, flow = self.evaluate(orbit.unknowns)
        return replace(orbit, derivative=half_return(self.system, flow))

    def symmetry_breaking_function(self, orbit: SymmetricOrbit) -> float:
        """det of the S-odd block of D_p pi_q P for an orbit in Fix(S); zero where S breaks.

        S is the problem's symmetry. New symmetric orbits outside Fix(S) branch off where it changes
        sign (Remark in Appendix B of the paper). Raises `ValueError` if the problem has no symmetry
        or if the S-odd block is not square: S does not break then.
        """
        rows = [i for i, state in enumerate(self.system.kernel_coordinates) if self.parities[state] == -1]
        columns = [i for i, state in enumerate(self.system.fixed_coordinates) if self.parities[state] == -1]
        if not rows or len(rows) != len(columns) or orbit.derivative is None:
            raise ValueError(f"{self.symmetry} does not split the shooting equations into square blocks")
        return float(np.linalg.det(orbit.derivative.kernel_block[np.ix_(rows, columns)]))
