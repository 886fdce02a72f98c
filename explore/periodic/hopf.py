"""Hopf points: where a pair of eigenvalues of an equilibrium crosses the imaginary axis, and what is born there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import pi
from typing import Any

import mpmath
import numpy as np

from orbitproof.explore.flow import FlowFailure
from orbitproof.explore.numerics import Solution, fraction, working_context
from orbitproof.explore.periodic.correction import ClosedOrbit, PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.equilibria import Equilibrium, equilibrium_at
from orbitproof.explore.periodic.equilibrium_refinement import (
    EquilibriumEquations,
    field_jets,
    refined_equilibrium,
)
from orbitproof.explore.periodic.flow import Matrix, Vector
from orbitproof.explore.refinement import JetBasis, RefinementFailure

HOPF = "Hopf"

_DIGITS = 20
"""To which a Hopf point and its coefficients are known."""
_FARTHEST = 0.3
"""The guess is an orbit of some size, or an equilibrium some way along the curve."""
_SAME = 1e-7
"""Two Hopf points are one if they agree so far."""
_PERIODS_DIFFER = 0.2
_FITS = 0.05
"""An orbit is of the family of a Hopf point if the square of its size differs by less from that of the normal form."""
_ZERO = 1e-9


@dataclass(frozen=True)
class Hopf:
    """A Hopf point, correctly rounded but for the last digits of float64.

    Attributes:
        problem: the system with its parameters; that of `name` is not the one here.
        value: of the parameter.
        equilibrium: the state there, with its eigenvalues.
        frequency: omega > 0 of the eigenvalues +- i omega.
        vector: q, complex, shape (N,), of length 1, with A q = i omega q; its real and imaginary part are orthogonal.
        speed: the derivative of the real part of the pair in the parameter.
        lyapunov: the first Lyapunov coefficient, of q of length 1 (Kuznetsov).
    """

    problem: PeriodicProblem
    name: str
    value: float
    equilibrium: Equilibrium
    frequency: float
    vector: Vector
    speed: float
    lyapunov: float

    kind = HOPF

    @property
    def point(self) -> Vector:
        """The state, shape (N,)."""
        return self.equilibrium.point

    @property
    def period(self) -> float:
        """The limit of the periods of the orbits that are born, as they shrink to the equilibrium."""
        return 2 * pi / self.frequency

    @property
    def others(self) -> Vector:
        """The eigenvalues besides the pair."""
        found = self.equilibrium.eigenvalues
        pair = [int(np.argmin(np.abs(found - sign * 1j * self.frequency))) for sign in (1, -1)]
        return np.delete(found, pair)

    @property
    def side(self) -> str | None:
        """On which side of the value the small orbits are: "above", "below", or `None` where it is not decided."""
        product = self.speed * self.lyapunov
        return None if abs(product) < _ZERO else "above" if product < 0 else "below"

    @property
    def orbits_are_stable(self) -> bool:
        """Whether the small orbits attract."""
        return self.lyapunov < 0 and bool(np.all(self.others.real < 0))


def is_same_hopf(left: Hopf, right: Hopf, symmetries: Iterable[Matrix] = ()) -> bool:
    """Whether two Hopf points are one, or images of each other under a linear map of shape (N, N)."""
    size = 1 + float(np.max(np.abs(right.equilibrium.point)))
    matrices = [np.eye(len(left.vector)), *symmetries]
    apart = min(float(np.max(np.abs(left.equilibrium.point - each @ right.equilibrium.point))) for each in matrices)
    values = abs(left.value - right.value) / (1 + abs(right.value))
    return max(apart / size, values, abs(left.period - right.period) / right.period) < _SAME


def place_of(problem: PeriodicProblem, point: Vector) -> str:
    """A state in words."""
    return ", ".join(f"{name} = {value:.12g}" for name, value in zip(problem.system.given_state, point, strict=True))


def hopf_described(hopf: Hopf) -> list[str]:
    """A Hopf point in lines."""
    born = "it is not decided on which side small orbits are"
    if hopf.side is not None:
        born = f"{'stable' if hopf.orbits_are_stable else 'unstable'} small orbits {hopf.side} it"
    return [
        f"  Hopf: {hopf.name} = {hopf.value:.15g}, {place_of(hopf.problem, hopf.equilibrium.point)}",
        f"    frequency {hopf.frequency:.12g}, period {hopf.period:.12g}, speed {hopf.speed:.8g}, first Lyapunov "
        f"coefficient {hopf.lyapunov:.8g}: {born}",
    ]


def hopf_as_json(hopf: Hopf) -> dict[str, Any]:
    """A Hopf point for programs."""
    names = hopf.problem.system.given_state
    return {
        "kind": hopf.kind,
        "value": hopf.value,
        "point": dict(zip(names, hopf.equilibrium.point, strict=True)),
        "frequency": hopf.frequency,
        "period": hopf.period,
        "speed": hopf.speed,
        "first_lyapunov": hopf.lyapunov,
        "side": hopf.side,
        "stable_orbits": hopf.orbits_are_stable,
        "other_eigenvalues": hopf.others,
    }


def hopf_near(
    problem: PeriodicProblem, name: str, point: Vector, value: float, frequency: float, vector: Vector
) -> Hopf:
    """The Hopf point near a guess. Raises `PeriodicFailure`.

    Arguments:
        vector: near an eigenvector q of i omega, complex, shape (N,), of any length.
    """
    q = _orthogonal(vector)
    try:
        equations, found = refined_equilibrium(
            problem, name, [*point, value, frequency], [q.real, q.imag], _DIGITS, farthest=_FARTHEST
        )
        return _hopf(problem, name, equations, found)
    except (RefinementFailure, FlowFailure, ZeroDivisionError) as failure:
        raise PeriodicFailure(f"no Hopf point is found there: {failure}") from None


def hopf_of_orbit(
    problem: PeriodicProblem, name: str, value: float, orbit: ClosedOrbit, *, strict: bool = False
) -> Hopf | None:
    """The Hopf point at which a small periodic orbit is born, if there is one near it.

    Arguments:
        strict: the orbit has to be as large as the normal form says for its value of the parameter.
    """
    states, phases = orbit.loop[:-1], np.exp(-2j * pi * np.arange(len(orbit.loop) - 1) / (len(orbit.loop) - 1))
    middle, vector = states.mean(axis=0), (states * phases[:, None]).mean(axis=0)
    try:
        found = hopf_near(problem, name, middle, value, 2 * pi / orbit.period, vector)
    except PeriodicFailure:
        return None
    apart = float(np.max(np.abs(found.equilibrium.point - middle)))
    is_near = apart < orbit.size and abs(found.period - orbit.period) < _PERIODS_DIFFER * orbit.period
    # |z|^2 = -speed (a - a_0) / (omega l_1) for x = x_0 + z q + conj(z q).
    left = found.frequency * found.lyapunov * float(np.linalg.norm(vector)) ** 2
    right = -found.speed * (value - found.value)
    fits = not strict or abs(left - right) < _FITS * abs(right)
    return found if is_near and fits else None


def _orthogonal(vector: Vector) -> Vector:
    """A complex vector times a factor: of length 1, with orthogonal real and imaginary part."""
    turned = vector * np.exp(-0.5j * np.angle(np.sum(vector**2)))
    return np.asarray(turned / np.linalg.norm(turned))


def _hopf(problem: PeriodicProblem, name: str, equations: EquilibriumEquations, found: Solution) -> Hopf:
    n, unknowns = equations.size, found.unknowns
    exact = [*unknowns[: n + 2]]
    u, v = (np.array(list(map(float, row))) for row in equations.vectors(unknowns))
    point, value, frequency = np.array(list(map(float, exact[:n]))), float(exact[n]), float(exact[n + 1])
    q = u + 1j * v
    if frequency < 0:
        frequency, q, exact[n + 1] = -frequency, np.conj(q), -exact[n + 1]
    values = problem.values
    values[list(problem.system.parameters).index(name)] = value
    sign = 1 if exact[n + 1] == unknowns[n + 1] else -1
    rows = equations.vectors(unknowns)
    vectors = [list(rows[0]), [sign * each for each in rows[1]]]
    context = working_context(found.bits)
    speed, lyapunov = coefficients(equations, exact[:n], exact[n], exact[n + 1], vectors, context)
    return Hopf(
        problem, name, value, equilibrium_at(problem.system, point, values), frequency, _orthogonal(q), speed, lyapunov
    )


def coefficients(
    equations: EquilibriumEquations,
    point: Sequence[Fraction],
    value: Fraction,
    frequency: Fraction,
    vectors: Sequence[Sequence[Fraction]],
    context: mpmath.MPContext,
) -> tuple[float, float]:
    """The speed d(Re lambda)/da and the first Lyapunov coefficient, of a vector of length 1.

    With the symmetric forms B and C of second and third derivatives, A h = B(q, conj q), (2 i omega - A) g = B(q, q)
    and <p, q> = 1 for the eigenvector p of the transpose: l_1 = Re <p, C(q, q, conj q) - 2 B(q, h) + B(conj q, g)> /
    (2 omega). Along the equilibria x' = -A^-1 f_a, and the eigenvalue changes by <p, (A_a + B(x', .)) q>.
    """
    n, name = equations.size, equations.name
    assert name is not None

    def jets(basis: JetBasis, directions: Sequence[Sequence[Any]], number: int | None) -> list[Any]:
        varying = (name, value, -1) if number is None else (name, value, number)
        fixed = {**equations.parameters, name: value}
        return field_jets(
            equations.system, fixed, basis, point, directions, None if number is None else varying, context
        )

    zero = [Fraction(0)] * n
    linear = JetBasis.graded((1,) * (n + 1), 1)
    field = jets(linear, [*([Fraction(int(i == j)) for i in range(n)] for j in range(n)), zero], n)
    matrix = context.matrix([[each.coefficients[linear.variable(j)] for j in range(n)] for each in field])
    by_value = context.matrix([each.coefficients[linear.variable(n)] for each in field])
    moved = [fraction(-each) for each in context.lu_solve(matrix, by_value)]

    # In the variables u, v of q, and one that moves the equilibrium with its parameter.
    cubic = JetBasis.of(
        [*((*each, 0) for each in JetBasis.graded((1, 1), 3).monomials), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
    )
    field = jets(cubic, [*vectors, moved], 2)

    def form(*monomial: int) -> Any:
        return context.matrix([each.coefficients[cubic.index[monomial]] for each in field])

    i = context.mpc(0, 1)
    rr, rm, mm = 2 * form(2, 0, 0), form(1, 1, 0), 2 * form(0, 2, 0)
    rrr, rrm, rmm, mmm = 6 * form(3, 0, 0), 2 * form(2, 1, 0), 2 * form(1, 2, 0), 6 * form(0, 3, 0)
    cubes, changes = rrr + rmm + i * (rrm + mmm), form(1, 0, 1) + i * form(0, 1, 1)
    omega = context.mpf(frequency.numerator) / frequency.denominator
    h = context.lu_solve(matrix, rr + mm)
    g = context.lu_solve(2 * i * omega * context.eye(n) - matrix, rr - mm + 2 * i * rm)

    rows = [[fraction(each) for each in row] for row in (list(h), [each.real for each in g], [each.imag for each in g])]
    mixed = [(1, 0), (0, 1)]
    quadratic = JetBasis.of([
        *JetBasis.graded((1,) * 5, 1).monomials,
        *((*first, *(int(k == j) for k in range(3))) for first in mixed for j in range(3)),
    ])  # fmt: skip
    field = jets(quadratic, [*vectors, *rows], None)

    def product(part: int, other: int) -> Any:
        where = quadratic.index[(*mixed[part], *(int(k == other) for k in range(3)))]
        return context.matrix([each.coefficients[where] for each in field])

    with_h = product(0, 0) + i * product(1, 0)
    with_g = product(0, 1) + product(1, 2) + i * (product(0, 2) - product(1, 1))
    q = context.matrix([context.mpc(*(context.mpf(a.numerator) / a.denominator for a in pair))
                        for pair in zip(*vectors, strict=True)])  # fmt: skip
    left = _left(matrix - i * omega * context.eye(n), q, context)

    def paired(vector: Any) -> Any:
        return sum(a * b for a, b in zip(left, vector, strict=True))

    length = sum(abs(each) ** 2 for each in q)
    speed = paired(changes).real
    lyapunov = paired(cubes - 2 * with_h + with_g).real / (2 * omega) / length
    return float(speed), float(lyapunov)


def _left(matrix: Any, q: Any, context: mpmath.MPContext) -> Any:
    """The row p with p M = 0 and p q = 1."""
    n = len(q)
    bordered = context.matrix(n + 1, n + 1)
    for i in range(n):
        for j in range(n):
            bordered[j, i] = matrix[i, j]
        bordered[i, n] = context.conj(q[i])
        bordered[n, i] = q[i]
    found = context.lu_solve(bordered, context.matrix([*[0] * n, 1]))
    return found[:n]
