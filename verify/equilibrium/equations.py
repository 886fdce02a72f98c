"""The equations of a Hopf point, and derivatives of the field there (sections 36.6 and 36.7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, acb_mat, arb

from orbitproof.shared.claims import HopfPoint
from orbitproof.verify.equilibrium.enclosures import HopfEnclosures, pairs
from orbitproof.verify.evidence import dot, enclose, symmetric

Vector = Sequence[Any]
"""A vector of balls, real or complex."""


@dataclass(frozen=True)
class Derivatives:
    """The derivatives of the field at all points of the box.

    Attributes:
        matrix: A, shape (N, N).
        rate: f_a, N numbers.
        second: for each component by places of (x, a), in one order of each pair.
        third: C(q, q, conj q).
    """

    matrix: list[list[arb]]
    rate: list[arb]
    second: list[dict[tuple[int, int], arb]]
    third: list[acb]

    def quadratic(self, u: Vector, v: Vector) -> list[Any]:
        """B(u, v): the sums of the second derivatives in x, times the components of both."""
        size = len(self.rate)
        return [
            _sum(self._at(i, j, k) * (u[j] * v[k]) for j in range(size) for k in range(size)) for i in range(size)
        ]  # fmt: skip

    def mixed(self, u: Vector) -> list[Any]:
        """A_a u, A_a the derivative of A in a."""
        size = len(self.rate)
        return [_sum(self._at(i, j, size) * u[j] for j in range(size)) for i in range(size)]

    def of_product(self, u: Vector) -> list[list[arb]]:
        """The derivatives of A u in x and in a, u fixed; rows by component."""
        size = len(self.rate)
        return [
            [_sum(self._at(i, j, k) * u[j] for j in range(size)) for k in range(size + 1)] for i in range(size)
        ]  # fmt: skip

    def _at(self, component: int, j: int, k: int) -> arb:
        return self.second[component][min(j, k), max(j, k)]


def derivatives_of(found: HopfEnclosures) -> Derivatives:
    """The derivatives that are enclosed, in matrices."""
    size = len(found.field)
    return Derivatives(
        [list(f.slopes[:size]) for f in found.field],
        [f.slopes[size] for f in found.field],
        [dict(zip(pairs(size), row, strict=True)) for row in found.second],
        list(found.third),
    )


def names_of(size: int) -> list[str]:
    """What the unknowns are called, less their values at the centre of the box: x, a, omega, q = u + i v."""
    return [*(f"x_{i}" for i in range(size)), "a", "omega", *(f"{part}_{i}" for part in "uv" for i in range(size))]


def radii_of(claim: HopfPoint) -> list[Fraction]:
    """The half-widths of the box, in the order of the unknowns."""
    size = len(claim.radii)
    return [*claim.radii, claim.parameter_radius, claim.frequency_radius, *[claim.kernel_radius] * (2 * size)]


def equations_of(claim: HopfPoint, found: HopfEnclosures) -> tuple[list[list[arb]], list[arb]]:
    """The derivative of the equations over the box, and their values at its centre (36.6)."""
    size, known = len(claim.centre), derivatives_of(found)
    real, imaginary = ([enclose(value) for value in row] for row in claim.kernel)
    side = symmetric(claim.kernel_radius)
    u, v = ([value + side for value in row] for row in (real, imaginary))
    omega = enclose(claim.frequency) + symmetric(claim.frequency_radius)
    zero = [arb(0)] * size

    def unit(place: int, value: arb) -> list[arb]:
        return [value if i == place else arb(0) for i in range(size)]

    matrix = [[*known.matrix[i], known.rate[i], arb(0), *zero, *zero] for i in range(size)]
    # A u + omega v
    matrix += [[*row, v[i], *known.matrix[i], *unit(i, omega)] for i, row in enumerate(known.of_product(u))]
    # A v - omega u
    matrix += [[*row, -u[i], *unit(i, -omega), *known.matrix[i]] for i, row in enumerate(known.of_product(v))]
    nothing = [*zero, arb(0), arb(0)]
    minus = [-value for value in imaginary]
    matrix += [[*nothing, *real, *imaginary], [*nothing, *minus, *real]]
    middle = enclose(claim.frequency)
    residual = [f.centre for f in found.field]
    residual += [dot(row, real) + middle * value for row, value in zip(found.linear, imaginary, strict=True)]
    residual += [dot(row, imaginary) - middle * value for row, value in zip(found.linear, real, strict=True)]
    return matrix, [*residual, arb(0), arb(0)]


def left_eigenvector(matrix: Sequence[Sequence[arb]], omega: arb, q: Sequence[acb]) -> list[acb]:
    """The row l with l A = i omega l and l q = 1, at points where A q = i omega q (36.7).

    Raises `ZeroDivisionError` if i omega may be a multiple eigenvalue.
    """
    size = len(q)
    rows = [
        [acb(matrix[k][i]) - (acb(0, omega) if i == k else 0) for k in range(size)] + [q[i].conjugate()]
        for i in range(size)
    ]
    system = acb_mat([*rows, [*q, acb(0)]])
    solution = system.solve(acb_mat([[0]] * size + [[1]]))
    return [solution[i, 0] for i in range(size)]


def solved(matrix: Sequence[Sequence[Any]], right: Vector) -> list[acb]:
    """The solution of a linear equation. Raises `ZeroDivisionError` if the matrix may be singular."""
    solution = acb_mat([[acb(value) for value in row] for row in matrix]).solve(acb_mat([[value] for value in right]))
    return [solution[i, 0] for i in range(len(right))]


def product(left: Vector, right: Vector) -> acb:
    """The sum of the products of the components, none conjugated."""
    return acb(_sum(a * b for a, b in zip(left, right, strict=True)))


def _sum(terms: Any) -> Any:
    return sum(terms, arb(0))
