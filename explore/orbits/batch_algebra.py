"""Linear algebra on stacks of small matrices: steps of Newton's method and the stability of many orbits."""

from __future__ import annotations

import numpy as np

from orbitproof.explore.flow import FlowBatch, Matrices, Matrix, Vector
from orbitproof.shared.systems import ReversibleSystem


def solve(matrices: Matrices, right: Matrix) -> Matrix:
    """Solutions of N square systems, matrices (N, c, c), right (N, c); NaN where a matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(matrices, right[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        result = np.full(right.shape, np.nan)
        for i, (matrix, vector) in enumerate(zip(matrices, right, strict=True)):
            if abs(np.linalg.det(matrix)) > 0:
                result[i] = np.linalg.solve(matrix, vector)
        return result


def least_norm(matrices: Matrices, right: Matrix) -> Matrix:
    """Shortest solutions of N systems with fewer equations than unknowns, matrices (N, r, c), right (N, r)."""
    orthonormal, triangular = np.linalg.qr(np.swapaxes(matrices, 1, 2))
    weights = solve(np.swapaxes(triangular, 1, 2), right)
    return np.asarray((orthonormal @ weights[:, :, None])[:, :, 0])


def half_returns(system: ReversibleSystem, flow: FlowBatch) -> Matrices:
    """Derivatives DP of N half returns, shape (N, m - 1, m - 1), as `explore.orbits.stability.half_return`.

    NaN for orbits that are tangent to the section at their end or could not be integrated.
    """
    section, order = system.section_index, [*system.fixed_coordinates, *system.kernel_coordinates]
    speed = np.where(flow.velocities[:, section] == 0, np.nan, flow.velocities[:, section])
    times = flow.state_transitions[:, section] / speed[:, None]
    projected = flow.state_transitions - flow.velocities[:, :, None] * times[:, None, :]
    return np.asarray(projected[:, order][:, :, order])


def stability_matrices(derivatives: Matrices, fixed: int) -> Matrices:
    """Sigma = 1 - 2 c b' of N half returns with `fixed` coordinates on Fix(R), shape (N, n, n)."""
    size = derivatives.shape[1]
    usable = np.all(np.isfinite(derivatives), axis=(1, 2))
    inverse = np.full(derivatives.shape, np.nan)
    identity = np.broadcast_to(np.eye(size), derivatives.shape)
    for column in range(size):
        inverse[usable, :, column] = solve(derivatives[usable], identity[usable, :, column])
    return np.asarray(np.eye(size - fixed) - 2 * derivatives[:, fixed:, :fixed] @ inverse[:, :fixed, fixed:])


def characteristic_coefficients(matrices: Matrices) -> Matrix:
    """Coefficients of det(s - matrix) of N matrices, highest power first, shape (N, n + 1): Faddeev and LeVerrier."""
    count, size, _ = matrices.shape
    result = np.ones((count, size + 1))
    power = np.broadcast_to(np.eye(size), matrices.shape)
    for k in range(1, size + 1):
        product = matrices @ power
        result[:, k] = -np.trace(product, axis1=1, axis2=2) / k
        power = product + result[:, k, None, None] * np.eye(size)
    return result


def stability_indices(parameters: np.ndarray) -> Vector:
    """The indices of N orbits with the stability parameters (N, n), as `explore.orbits.stability.stability_index`."""
    root = np.sqrt(parameters * parameters - 1)
    sizes = np.max(np.maximum(np.abs(parameters + root), np.abs(parameters - root)), axis=1, initial=1.0)
    return np.asarray(0.5 * (sizes + 1 / sizes))


def roots(coefficients: Matrix) -> np.ndarray:
    """Complex roots of N monic polynomials, shape (N, n), sorted by real part, then imaginary part."""
    count, size = coefficients.shape[0], coefficients.shape[1] - 1
    companion = np.zeros((count, size, size))
    companion[:, 0] = -coefficients[:, 1:]
    companion[:, range(1, size), range(size - 1)] = 1.0
    finite = np.all(np.isfinite(companion), axis=(1, 2))
    result = np.full((count, size), np.nan, dtype=complex)
    result[finite] = np.linalg.eigvals(companion[finite])
    return np.sort(result, axis=1)
