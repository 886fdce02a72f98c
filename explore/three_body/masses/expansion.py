"""The equations of symmetry breaking of planar orbits in power series of (x, vy, mu), to any precision.

The half return is expanded in jets in (x, vy, mu) and, to first order, z: one integration gives the two equations
of a symmetry breaking (Remark in Appendix B of the paper),

    F_1 = pi_vx P = 0,      F_2 = d(pi_vz P)/dz = 0,

with all their derivatives in (x, vy, mu), mu being a variable of the jets like the others. The curve F = 0 has the
tangent t = grad F_1 x grad F_2, and along it dC/dmu = grad C . t / t_mu, C the Jacobi constant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import ceil, log2
from typing import Any

import mpmath

from orbitproof.explore.numerics import mpf, working_context
from orbitproof.explore.refinement import Jet, JetBasis, operations, section_crossings
from orbitproof.shared.systems import CR3BP

VARIABLES = 3
X, VY, MU = range(VARIABLES)


@dataclass(frozen=True)
class Settings:
    """How the orbits are integrated.

    Attributes:
        bits: of the mantissas.
        order: of the Taylor expansion in time, `None`: what suits the precision.
        tolerance: what a step may leave out, relative to the largest coordinate; `None`: below the last bit.
    """

    bits: int
    order: int | None = None
    tolerance: float | None = None

    @property
    def tolerance_bits(self) -> int | None:
        """The tolerance as a number of bits."""
        return None if self.tolerance is None else ceil(-log2(self.tolerance))

    def coarser(self, bits: int) -> Settings:
        """For an iteration that needs fewer bits."""
        return self if bits >= self.bits else Settings(bits)

    def finer(self) -> Settings:
        """More of everything: what the result is checked against."""
        order = None if self.order is None else ceil(1.25 * self.order)
        tolerance = None if self.tolerance is None else max(self.tolerance * 1e-20, 1e-300)
        return Settings(self.bits + 80, order, tolerance)


@dataclass(frozen=True)
class Expansion:
    """F_1, F_2 and C as jets in (x, vy, mu) at one point.

    Attributes:
        equations: F_1 and F_2.
        level: C.
        half_period: nondimensional, to double precision.
        context: working precision.
    """

    equations: tuple[Jet, Jet]
    level: Jet
    half_period: float
    context: mpmath.MPContext

    def gradient(self, jet: Jet) -> list[Any]:
        """First derivatives of one of the jets in (x, vy, mu)."""
        return [jet.coefficients[jet.basis.variable(i)] for i in range(VARIABLES)]

    def hessian(self, jet: Jet) -> list[list[Any]]:
        """Second derivatives of one of the jets, 3 x 3; needs an expansion of degree 2."""

        def entry(i: int, j: int) -> Any:
            monomial = tuple((v == i) + (v == j) for v in range(VARIABLES))
            return jet.coefficients[jet.basis.index[monomial]] * (1 + (i == j))

        return [[entry(i, j) for j in range(VARIABLES)] for i in range(VARIABLES)]

    @property
    def values(self) -> list[Any]:
        """F_1 and F_2 at the point."""
        return [jet.coefficients[0] for jet in self.equations]

    @property
    def tangent(self) -> list[Any]:
        """grad F_1 x grad F_2."""
        return _cross(*(self.gradient(jet) for jet in self.equations))

    @property
    def determinant(self) -> Any:
        """D = grad C . (grad F_1 x grad F_2)."""
        return dot(self.gradient(self.level), self.tangent)

    def determinant_gradient(self) -> list[Any]:
        """First derivatives of D; needs an expansion of degree 2."""
        first, second = (self.gradient(jet) for jet in self.equations)
        rows = [self.hessian(jet) for jet in (self.level, *self.equations)]
        slope, tangent = self.gradient(self.level), self.tangent
        return [
            dot([row[i] for row in rows[0]], tangent)
            + dot(slope, _cross([row[i] for row in rows[1]], second))
            + dot(slope, _cross(first, [row[i] for row in rows[2]]))
            for i in range(VARIABLES)
        ]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Scalar product of two vectors."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def expand(point: Sequence[Fraction], degree: int, settings: Settings) -> Expansion:
    """F_1, F_2 and C around the point (x, vy, mu) up to `degree` (1 or 2); raises `IntegrationFailure`."""
    context = working_context(settings.bits)
    exponents = [m for m in product(range(degree + 1), repeat=VARIABLES) if sum(m) <= degree]
    basis = JetBasis.of([(*m, across) for m in exponents for across in (0, 1)])
    values = [mpf(u, context) for u in point]
    jets = [basis.constant(value) for value in values]
    for i, jet in enumerate(jets):
        jet.coefficients[basis.variable(i)] = context.mpf(1)
    across = basis.constant(0)
    across.coefficients[basis.variable(VARIABLES)] = context.mpf(1)
    start = [basis.constant(context.mpf(0)) for _ in CR3BP.state]
    names = CR3BP.state
    start[names.index("x")], start[names.index("vy")], start[names.index("z")] = jets[X], jets[VY], across
    crossing = next(
        section_crossings(
            CR3BP, {}, start, jets[MU], context, order=settings.order, tolerance_bits=settings.tolerance_bits
        )
    )
    inner = JetBasis.of(exponents)

    def part(jet: Jet, across: int) -> Jet:
        return Jet(inner, [jet.coefficients[basis.index[(*m, across)]] for m in inner.monomials])

    program = CR3BP.first_integral_program
    assert program is not None

    constant, power = operations(context)
    level = program.evaluate([*start, jets[MU]], constant, power)[0]
    equations = (part(crossing.jets[names.index("vx")], 0), part(crossing.jets[names.index("vz")], 1))
    return Expansion(equations, part(level, 0), crossing.time, context)
