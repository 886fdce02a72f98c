"""A point with a multiplier that is known: interval Newton for point, parameter and eigenvector (section 25.3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat

from orbitproof.shared.formats import PERIODIC_FOLD, PeriodicBifurcation
from orbitproof.verify.evidence import (
    Checklist,
    Evidence,
    dot,
    enclose,
    hull,
    is_inside,
    is_outside,
    meet,
    show,
    symmetric,
)
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.periodic_bifurcation.equations import Matrix, PointEquations, radii_of


def multiplier_of(claim: PeriodicBifurcation) -> int:
    """sigma: the multiplier of the map at a fold is 1, at a doubling and a pitchfork -1."""
    return 1 if claim.kind == PERIODIC_FOLD else -1


@dataclass(frozen=True)
class Place:
    """Where a bifurcation is.

    Attributes:
        where: enclosures of p and s, n + 1 balls.
        kernel: those of the eigenvector w, n balls.
    """

    where: tuple[arb, ...]
    kernel: tuple[arb, ...]


def enclose_zero(
    evidence: Evidence,
    matrix_over: Callable[[Sequence[arb]], Matrix],
    residual: Sequence[arb],
    radii: Sequence[Fraction],
    names: Sequence[str],
    eigenvector: range,
) -> list[arb]:
    """Require that a function has one zero in a box about 0, and that it is regular; enclosures of it (Lemma 5).

    Args:
        matrix_over: encloses the derivative at all points with coordinates in its arguments, a part of the box.
        residual: the value at 0.
        radii: half-widths of the box.
        names: of the coordinates.
        eigenvector: places of its coordinates; where these alone are outside, nothing is excluded (section 25.3).
    """
    sides = [symmetric(radius) for radius in radii]
    matrix = matrix_over(sides)
    evidence.require(is_regular(matrix), "the derivative may be singular in the box", needs_precision=True)
    image = newton_image(matrix, residual)
    for place, (name, ball, radius) in enumerate(zip(names, image, radii, strict=True)):
        evidence.record(name, ball)
        outside = is_outside(ball, radius)
        excluded = outside and place not in eigenvector
        message = f"{name} in {show(ball)} is not inside its interval"
        evidence.require(is_inside(ball, radius), message, needs_precision=not outside, excluded=excluded)
    known = [meet(side, ball) for side, ball in zip(sides, image, strict=True)]
    sharper = newton_image(matrix_over([hull(arb(0), ball) for ball in known]), residual)
    return [meet(ball, other) for ball, other in zip(known, sharper, strict=True)]


def check_extended(checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations) -> Place:
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
    return Place(tuple(found[: size + 1]), tuple(vector))


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


def bordered(matrix: Matrix, column: int, row: Sequence[arb]) -> Matrix:
    """A matrix with a unit vector as a further column and a further row."""
    return [*([*entries, arb(int(i == column))] for i, entries in enumerate(matrix)), [*row, arb(0)]]


def bordering(matrix: Matrix, row: Sequence[arb]) -> int:
    """The unit vector that borders a nearly singular matrix best; nothing rests on the choice."""
    least, best = 0.0, 0
    for column in range(len(matrix)):
        try:
            covector = left_kernel(matrix, column, row)
        except ZeroDivisionError:
            continue
        largest = max(float(abs(ball.mid())) for ball in covector)
        if not least or largest < least:
            least, best = largest, column
    return best


def left_kernel(matrix: Matrix, column: int, row: Sequence[arb]) -> list[arb]:
    """The l with l_column = 1 and l D = 0, for each D in an interval matrix that is 0 on a vector not across `row`.

    Raises `ZeroDivisionError` unless every matrix that is bordered by the unit vector and the row is regular.
    """
    whole = arb_mat(bordered(matrix, column, row)).transpose()
    solution = whole.solve(arb_mat([[0]] * len(matrix) + [[1]]))
    return [solution[i, 0] for i in range(len(matrix))]
