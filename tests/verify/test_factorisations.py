"""Lemmas 18.1 and 18.3 without their proofs: identities of the blocks of DP, exactly, at random rational matrices.

L = DP(x) is any regular matrix with C u' = 0 and b B = 0, which is all that is known of it: with dH = (b, 0) at y,
dH = (b A, 0) at x. Nothing is asked of symplectic forms.
"""

from __future__ import annotations

import random

import pytest
from flint import fmpq, fmpq_mat, fmpq_poly

SEEDS = [(n, seed) for n in (1, 2, 3) for seed in range(12)]


def draw(source: random.Random, rows: int, columns: int) -> fmpq_mat:
    return fmpq_mat(rows, columns, [fmpq(source.randint(-9, 9), source.randint(1, 5)) for _ in range(rows * columns)])


def block(matrix: fmpq_mat, rows: range, columns: range) -> fmpq_mat:
    return fmpq_mat(len(rows), len(columns), [matrix[i, j] for i in rows for j in columns])


def beside(*blocks: fmpq_mat) -> fmpq_mat:
    return fmpq_mat([[value for part in blocks for value in part.tolist()[row]] for row in range(blocks[0].nrows())])


def identity(size: int) -> fmpq_mat:
    return fmpq_mat(size, size, [int(i == j) for i in range(size) for j in range(size)])


def scaled(matrix: fmpq_mat, factor: int) -> fmpq_mat:
    return matrix * fmpq(factor)


class HalfOrbit:
    """Blocks of a random L and of its inverse, and what they induce modulo u' and v'."""

    def __init__(self, n: int, seed: int) -> None:
        source = random.Random(seed)
        self.n, self.p, self.q = n, range(n + 1), range(n + 1, 2 * n + 1)
        while True:
            self.u, self.b = draw(source, n + 1, 1), draw(source, 1, n + 1)
            A, B, C, D = (draw(source, *shape) for shape in ((n + 1, n + 1), (n + 1, n), (n, n + 1), (n, n)))
            square, length = (self.b * self.b.transpose())[0, 0], (self.u.transpose() * self.u)[0, 0]
            if not square or not length:
                continue
            B -= self.b.transpose() * (self.b * B) * (1 / square)
            C -= (C * self.u) * self.u.transpose() * (1 / length)
            L = fmpq_mat(beside(A, B).tolist() + beside(C, D).tolist())
            self.v = A * self.u
            self.dh = self.b * A
            if L.det() and self.u[0, 0] and self.v[0, 0] and self.dh[0, 0]:
                break
        inverse = L.inv()
        self.L, self.A, self.C = L, A, C
        self.A_back, self.B_back = block(inverse, self.p, self.p), block(inverse, self.p, self.q)
        self.C_back = block(inverse, self.q, self.p)
        self.sigma = scaled(self.A_back * A, 2) - identity(n + 1)
        here, there, first = self.modulo(self.u), self.modulo(self.v), self.complement
        self.A_bar, self.A_back_bar = there * A * first, here * self.A_back * first
        self.C_bar, self.sigma_bar = C * first, here * self.sigma * first
        R = fmpq_mat(
            2 * n + 1, 2 * n + 1, [(i == j) * (1 if i <= n else -1) for i in range(2 * n + 1) for j in range(2 * n + 1)]
        )
        self.M = R * inverse * R * L

    @property
    def complement(self) -> fmpq_mat:
        """The unit vectors but the first, as columns."""
        return fmpq_mat(self.n + 1, self.n, [int(i == j + 1) for i in range(self.n + 1) for j in range(self.n)])

    def modulo(self, vector: fmpq_mat) -> fmpq_mat:
        """Coordinates modulo a vector in the basis of these unit vectors."""
        rows = [[-vector[i, 0] / vector[0, 0], *(int(i == j + 1) for j in range(self.n))] for i in range(1, self.n + 1)]
        return fmpq_mat(rows)


@pytest.mark.parametrize(("n", "seed"), SEEDS)
def test_minus_one_is_a_stability_parameter_where_a_factor_of_sigma_is_singular(n: int, seed: int) -> None:
    orbit = HalfOrbit(n, seed)
    chi = (scaled(identity(n), -1) - orbit.sigma_bar).det()
    assert chi == (-2) ** n * orbit.A_back_bar.det() * orbit.A_bar.det()


@pytest.mark.parametrize(("n", "seed"), SEEDS)
def test_one_is_a_stability_parameter_where_the_level_is_stationary_or_the_symmetry_lost(n: int, seed: int) -> None:
    orbit = HalfOrbit(n, seed)
    chi = (identity(n) - orbit.sigma_bar).det()
    assert not any((orbit.dh * orbit.B_back).entries())
    # dh's kernel has the basis e_j - (dh_j/dh_0) e_0; the vector across it is e_0/dh_0.
    kernel = fmpq_mat([[-value / orbit.dh[0, 0] for value in orbit.dh.entries()[1:]], *identity(n).tolist()])
    across = fmpq_mat(n + 1, 1, [1 / orbit.dh[0, 0], *[0] * n])
    reduced = block(orbit.B_back, range(1, n + 1), range(n))
    assert kernel * reduced == orbit.B_back
    kappa = 2**n * orbit.C_bar.det() * beside(across, kernel).det() / beside(orbit.u, orbit.complement).det()
    assert chi == kappa * (orbit.dh * orbit.u)[0, 0] * reduced.det()


@pytest.mark.parametrize(("n", "seed"), SEEDS)
def test_sigma_has_one_more_eigenvalue_one(n: int, seed: int) -> None:
    orbit = HalfOrbit(n, seed)
    assert orbit.sigma * orbit.u == orbit.u
    assert orbit.dh * orbit.sigma == orbit.dh
    whole, induced = (fmpq_poly(matrix.charpoly().coeffs()) for matrix in (orbit.sigma, orbit.sigma_bar))
    assert whole == fmpq_poly([-1, 1]) * induced


@pytest.mark.parametrize(("n", "seed"), SEEDS[::3])
def test_returns_are_polynomials_of_sigma(n: int, seed: int) -> None:
    """q o P^(2m) = -2 C'A U_(m-1)(Sigma) and q o P^(2m+1) = C (U_m + U_(m-1))(Sigma) on Fix(R)."""
    orbit = HalfOrbit(n, seed)
    older, newer = scaled(orbit.sigma, 0), identity(n + 1)
    power = identity(2 * n + 1)
    for _ in range(1, 5):
        power = power * orbit.M
        even, odd = (block(matrix, orbit.q, orbit.p) for matrix in (power, orbit.L * power))
        assert even == scaled(orbit.C_back * orbit.A * newer, -2)
        older, newer = newer, scaled(orbit.sigma * newer, 2) - older
        assert odd == orbit.C * (newer + older)
