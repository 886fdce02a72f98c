"""Equilibria, their folds and Hopf points with many digits, as claims for the verifier.

At a fold A q = 0 for a vector q besides f(x, a) = 0, at a Hopf point A q = i omega q; a is the parameter, A the
derivative of f in x. A given vector k normalises q: conj(k) . (q - k) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.engines import Progress
from orbitproof.explore.numerics import Linearised, Solution, mpf
from orbitproof.explore.periodic.correction import PeriodicProblem
from orbitproof.explore.periodic.flow import Vector
from orbitproof.explore.periodic.refinement import RULE, evaluated, solved, whole_jets
from orbitproof.explore.refinement import Jet, JetBasis
from orbitproof.explore.refinement.frames import dot
from orbitproof.shared.systems import System


@dataclass(frozen=True)
class EquilibriumEquations:
    """What is solved for x; for (x, a, u) at a fold; for (x, a, omega, u, v) with q = u + i v at a Hopf point.

    Attributes:
        parameters: all of the system's, exact; that of `name` is not used.
        name: of the parameter that varies; `None` for an equilibrium alone.
        kernel: k, none, one or two rows of shape (N,), exact: its real and its imaginary part.
    """

    system: System
    parameters: Mapping[str, Fraction]
    name: str | None
    kernel: tuple[tuple[Fraction, ...], ...]

    @property
    def size(self) -> int:
        """N, the number of coordinates of the state."""
        return len(self.system.given_state)

    def vectors(self, unknowns: Sequence[Any]) -> list[Sequence[Any]]:
        """The real eigenvector u, or real and imaginary part u and v, among the unknowns."""
        n, first = self.size, self.size + len(self.kernel)
        return [unknowns[first + j * n : first + (j + 1) * n] for j in range(len(self.kernel))]

    def linearised(self, unknowns: Sequence[Fraction], context: mpmath.MPContext) -> Linearised:
        """What is zero, with its derivatives."""
        n, count = self.size, len(self.kernel)
        vectors = self.vectors(unknowns)
        variables = n + (count > 0)
        basis = _basis(variables, count)
        jets = field_jets(self.system, self.parameters, basis, unknowns[:n], [
            *_units(n, n), *([[Fraction(0)] * n] if count else []), *vectors
        ], None if self.name is None else (self.name, unknowns[n], n), context)  # fmt: skip

        def slope(i: int, *numbers: int) -> Any:
            return jets[i].coefficients[basis.index[tuple(int(k in numbers) for k in range(variables + count))]]

        rows, values = [], []
        for i in range(n):
            rows.append([slope(i, k) for k in range(variables)] + [context.mpf(0)] * (len(unknowns) - variables))
            values.append(jets[i].coefficients[0])
        frequency = mpf(unknowns[n + 1], context) if count == 2 else context.mpf(0)
        for j in range(count):
            # A u + omega v = 0 and A v - omega u = 0.
            sign, other = (1, 1) if j == 0 else (-1, 0)
            for i in range(n):
                row = [slope(i, variables + j, k) for k in range(variables)]
                value = slope(i, variables + j)
                if count == 2:
                    row.append(sign * mpf(vectors[other][i], context))
                    value = value + sign * frequency * mpf(vectors[other][i], context)
                for part in range(count):
                    row += [slope(i, k) if part == j else sign * frequency * int(k == i) for k in range(n)]
                rows.append(row)
                values.append(value)
        lead = [context.mpf(0)] * (n + count)
        kernel = [[mpf(value, context) for value in row] for row in self.kernel]
        apart = [
            [mpf(q - k, context) for q, k in zip(vector, row, strict=True)]
            for vector, row in zip(vectors, self.kernel, strict=True)
        ]
        if count == 1:
            rows.append([*lead, *kernel[0]])
            values.append(dot(kernel[0], apart[0]))
        if count == 2:
            rows += [[*lead, *kernel[0], *kernel[1]], [*lead, *(-k for k in kernel[1]), *kernel[0]]]
            values += [
                dot(kernel[0], apart[0]) + dot(kernel[1], apart[1]),
                dot(kernel[0], apart[1]) - dot(kernel[1], apart[0]),
            ]
        matrix = context.matrix(rows)
        spread = float(np.linalg.cond(np.array([[float(value) for value in row] for row in rows])))
        return Linearised(context.matrix(values), matrix, spread if np.isfinite(spread) else 1e15)


def _basis(variables: int, vectors: int) -> JetBasis:
    """1, all variables, and each of the first ones times each of those of vectors."""
    count = variables + vectors
    linear = JetBasis.graded((1,) * count, 1).monomials
    mixed = (tuple(int(k in (i, j)) for k in range(count)) for i in range(variables) for j in range(variables, count))
    return JetBasis.of([*linear, *mixed])


def _units(count: int, size: int) -> list[list[Fraction]]:
    return [[Fraction(int(i == j)) for i in range(size)] for j in range(count)]


def field_jets(
    system: System,
    parameters: Mapping[str, Fraction],
    basis: JetBasis,
    point: Sequence[Any],
    directions: Sequence[Sequence[Any]],
    varying: tuple[str, Any, int] | None,
    context: mpmath.MPContext,
) -> list[Jet]:
    """The field at a point plus each variable of a basis times its direction, as N jets.

    Arguments:
        point, directions: exact; for each variable a direction of shape (N,).
        varying: a parameter, its value, exact, and the number of the variable that is added to it.
    """
    n = len(system.given_state)
    start = []
    for i in range(n):
        jet = basis.constant(point[i])
        for k, direction in enumerate(directions):
            jet.coefficients[basis.variable(k)] = direction[i]
        start.append(jet)
    given: list[Any] = []
    for name in system.parameters:
        if varying is not None and name == varying[0]:
            jet = basis.constant(mpf(varying[1], context))
            jet.coefficients[basis.variable(varying[2])] = context.mpf(1)
            given.append(jet)
        else:
            given.append(mpf(parameters[name], context))
    whole = whole_jets(system, start, given, context)
    found = evaluated(system.program, [*whole, *given], context)[:n]
    return [each if isinstance(each, Jet) else basis.constant(each) for each in found]


def refined_equilibrium(
    problem: PeriodicProblem,
    name: str | None,
    guess: Sequence[float] | Vector,
    kernel: Sequence[Sequence[float] | Vector],
    digits: int,
    progress: Progress | None = None,
    farthest: float = 1e-3,
) -> tuple[EquilibriumEquations, Solution]:
    """The solution of the equations near a guess to so many digits.

    Arguments:
        guess: all unknowns but the vectors, which begin as the kernel.
        farthest: from the guess, relative where an unknown exceeds 1.

    Raises `RefinementFailure`.
    """
    rows = tuple(tuple(Fraction(float(value)) for value in row) for row in kernel)
    equations = EquilibriumEquations(problem.system, dict(problem.parameters), name, rows)
    unknowns = [Fraction(float(value)) for value in guess] + [value for row in rows for value in row]
    rule = replace(RULE, farthest=farthest)
    return equations, solved(equations.linearised, unknowns, digits, rule, progress)
