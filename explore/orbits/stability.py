"""Stability of a symmetric periodic orbit from its half return.

The half return P maps the section near x_0 in Fix(R) to the section near x_1 = P(x_0) in Fix(R); in
coordinates (p, q), p on Fix(R) and q across it, write

    DP(x_0) = [[a, b], [c, d]],      DP(x_0)^-1 = [[a', b'], [c', d']].

By reversibility the monodromy matrix of the return at x_0 is M = R DP^-1 R DP, and M^-1 = R M R.
Hence (M + M^-1)/2 is the block diagonal part of M: its q block is the stability matrix

    Sigma = M_qq = 1 - 2 c b' = 2 d' d - 1,

n x n, whose eigenvalues are the stability parameters s = (lambda + 1/lambda)/2, each once and
without the trivial pair. A 1:k resonance is s = cos(2 pi j/k) with gcd(j, k) = 1.

M^m = U_{m-1}(S) M - U_{m-2}(S) with S = (M + M^-1)/2 and Chebyshev polynomials U gives
D_p pi_q P^{2m} = 2 U_{m-1}(Sigma) d' c at x_0, and at x_1 the same with d and c' in place of d' and
c. So for even k >= 4 (and for odd k) D_p pi_q P^k drops rank at both points on Fix(R); at k = 2, where
U_0 = 1, it drops rank at x_0 if d' is singular and at x_1 if d is.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from orbitproof.explore.flow import FlowResult, Matrix, Vector
from orbitproof.shared.systems import ReversibleSystem

Side = Literal["first", "second"]

SMALLEST_VALUE = 1e-15
"""Singular values of DP below this fraction of the largest are rounding errors."""

ACCURACY = 1e-12
"""Error of the entries of DP, relative to the largest, as it comes from an integration."""

LARGEST_CONDITION = 1e11
"""Condition number of DP beyond which stability parameters have no certain digit, given the integration's accuracy."""


@dataclass(frozen=True)
class HalfReturn:
    """Derivative of the half return at x_0 on Fix(R), in the section's coordinates (p, q).

    Attributes:
        derivative: shape (m - 1, m - 1), DP(x_0); p in the order of `fixed_coordinates`, then q in
            the order of `kernel_coordinates` of the system.
        fixed_dimension: number of the coordinates p.
    """

    derivative: Matrix
    fixed_dimension: int

    @property
    def resolved(self) -> bool:
        """Whether rounding errors leave anything of the inverse."""
        return bool(np.linalg.cond(self.derivative) < LARGEST_CONDITION)

    @property
    def error(self) -> float:
        """An estimate of the error of a stability parameter, relative where its magnitude exceeds 1.

        The inverse magnifies the errors of DP by its condition number.
        """
        return ACCURACY * float(np.linalg.cond(self.derivative))

    @property
    def inverse(self) -> Matrix:
        """DP(x_0)^-1, shape (m - 1, m - 1).

        Where DP is singular to working precision, the smallest singular value that can be told from zero stands in
        for its own: finite numbers, but see `resolved`.
        """
        left, values, right = np.linalg.svd(self.derivative)
        floor = SMALLEST_VALUE * values[0]
        if values[-1] >= floor:
            return np.linalg.inv(self.derivative)
        return (right.T / np.maximum(values, floor)) @ left.T

    @property
    def kernel_block(self) -> Matrix:
        """c = D_p pi_q P(x_0), shape (n, number of p)."""
        return self.derivative[self.fixed_dimension :, : self.fixed_dimension]

    @property
    def stability_matrix(self) -> Matrix:
        """Sigma = 1 - 2 c b', shape (n, n)."""
        size = self.fixed_dimension
        product = self.kernel_block @ self.inverse[:size, size:]
        return np.eye(len(product)) - 2 * product

    def doubling_defect(self, side: Side) -> float:
        """Distance of D_p pi_q P^2 from corank 1 at a point on Fix(R), at a 1:2 resonance.

        Smallest over largest singular value of d' (first point) or d (second point); for n = 1
        the magnitude of the entry.
        """
        values = np.linalg.svd(self._doubling_block(side), compute_uv=False)
        return float(values[-1] / values[0]) if len(values) > 1 else float(values[0])

    def doubling_value(self, side: Side) -> float:
        """det d' (first point) or det d (second point), whose zeros are the 1:2 resonances there.

        det(Sigma + 1) is 2^n times their product, and does not change sign where both vanish at once.
        """
        return float(np.linalg.det(self._doubling_block(side)))

    def _doubling_block(self, side: Side) -> Matrix:
        size = self.fixed_dimension
        return (self.inverse if side == "first" else self.derivative)[size:, size:]


def half_return(system: ReversibleSystem, flow: FlowResult) -> HalfReturn:
    """Project the state transition matrix over the half period onto the section.

    Raises `ZeroDivisionError` if the orbit is tangent to the section at its end.
    """
    section = system.section_index
    speed = float(flow.velocity[section])
    if speed == 0.0:
        raise ZeroDivisionError("the orbit is tangent to the section")
    projected = flow.state_transition - np.outer(flow.velocity, flow.state_transition[section]) / speed
    order = [*system.fixed_coordinates, *system.kernel_coordinates]
    return HalfReturn(projected[np.ix_(order, order)], len(system.fixed_coordinates))


def characteristic_coefficients(matrix: Matrix) -> Vector:
    """Coefficients of det(s - matrix), highest power (which is 1) first, shape (n + 1,).

    Unlike the eigenvalues these are smooth along a family, also where two eigenvalues meet.
    """
    return np.atleast_1d(np.real(np.poly(matrix)))


def stability_parameters(coefficients: Vector) -> tuple[complex, ...]:
    """The n stability parameters s = (lambda + 1/lambda)/2, sorted by real part, then imaginary part."""
    roots = np.roots(coefficients).astype(complex)
    return tuple(complex(root) for root in sorted(roots, key=lambda root: (root.real, root.imag)))


def multipliers(parameters: Iterable[complex]) -> tuple[complex, ...]:
    """The multipliers lambda, 1/lambda of each stability parameter (lambda + 1/lambda)/2, largest magnitude first.

    The one that is not small comes from the formula without cancellation, the other is its inverse.
    """
    result: list[complex] = []
    for s in parameters:
        root = complex(np.sqrt(complex(s) * complex(s) - 1))
        large = max(s + root, s - root, key=abs)
        result += [large, 1 / large]
    return tuple(sorted(result, key=abs, reverse=True))


def stability_index(parameters: Iterable[complex]) -> float:
    """(|lambda| + 1/|lambda|)/2 of the multiplier with the largest magnitude; 1 for a linearly stable orbit.

    From the stability parameters s = (lambda + 1/lambda)/2.
    """
    size = max((abs(value) for value in multipliers(parameters)), default=1.0)
    return max(1.0, 0.5 * float(size + 1 / size))


def tupling_sides(derivative: HalfReturn, k: int) -> tuple[Side, ...]:
    """The points on Fix(R), of the two of the orbit, near which the bifurcating orbits meet Fix(R).

    `derivative` belongs to an orbit at a 1:k resonance. See the module's text for the criterion.
    """
    if k != 2:
        return ("first", "second")
    first = derivative.doubling_defect("first") <= derivative.doubling_defect("second")
    return ("first",) if first else ("second",)
