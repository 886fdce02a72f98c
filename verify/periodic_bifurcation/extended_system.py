"""A point with a multiplier that is known: interval Newton for point, parameter and eigenvector (section 25.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import Checklist, dot, enclose
from orbitproof.verify.newton import enclose_zero
from orbitproof.verify.periodic_bifurcation.equations import Matrix, PointEquations, radii_of


def multiplier_of(claim: PeriodicBifurcation) -> int:
    """sigma: the multiplier of the map at a fold is 1, at a doubling and a pitchfork -1."""
    return 1 if claim.is_fold else -1


@dataclass(frozen=True)
class BifurcationPoint:
    """Where a bifurcation is.

    Attributes:
        where: enclosures of p and s, n + 1 balls.
        kernel: those of the eigenvector w, n balls.
    """

    where: tuple[arb, ...]
    kernel: tuple[arb, ...]


def check_extended(checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations) -> BifurcationPoint:
    """One point of the box at which the map has the multiplier, with an eigenvector in the box of eigenvectors."""
    sigma, size = multiplier_of(claim), equations.size
    (kernel,) = claim.kernel
    middle = [enclose(value) for value in kernel]
    zero = [arb(0)] * (size + 1)

    def matrix_over(balls: Sequence[arb]) -> Matrix:
        vector = [value + ball for value, ball in zip(middle, balls[size + 1 :], strict=True)]
        return extended_matrix(equations, balls[: size + 1], vector, sigma, middle)

    statement = (
        f"interval Newton: the point returns and {sigma} is a multiplier for exactly one point of the box and one "
        "value of the interval; there the derivative of the equations that say so is regular"
    )
    remedy = "move the centre to the bifurcation, improve the kernel, or choose smaller radii"
    with checklist.hypothesis("bifurcation", "25.3", statement, remedy) as evidence:
        singular = equations.minus(sigma, equations.slopes(zero))
        residual = [*equations.values(zero), *(dot(row, middle) for row in singular), arb(0)]
        names = [*(f"p_{i}" for i in range(size)), "s", *(f"w_{i}" for i in range(size))]
        radii = [*radii_of(claim), *(claim.kernel_radius for _ in kernel)]
        eigenvector = range(size + 1, 2 * size + 1)
        found = enclose_zero(evidence, matrix_over, residual, radii, names, eigenvector)
    vector = [value + ball for value, ball in zip(middle, found[size + 1 :], strict=True)]
    return BifurcationPoint(tuple(found[: size + 1]), tuple(vector))


def extended_matrix(
    equations: PointEquations, where: Sequence[arb], vector: Sequence[arb], sigma: int, normal: Sequence[arb]
) -> Matrix:
    """The derivative of E - J p, (D_p E - sigma J) w and normal . w in p, s and w."""
    size = equations.size
    slopes = equations.slopes(where)
    bent = equations.curvatures(where, [*vector, arb(0)])
    none = [arb(0)] * size
    points = [
        [*row, by_s[-1], *none] for row, by_s in zip(equations.minus(1, slopes), slopes, strict=True)
    ]  # fmt: skip
    vectors = [[*row, *other] for row, other in zip(bent, equations.minus(sigma, slopes), strict=True)]
    return [*points, *vectors, [*none, arb(0), *normal]]
