"""A point with a pair of multipliers on the unit circle: interval Newton for all that describes it (section 25.9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb, arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import Checklist, dot, enclose
from orbitproof.verify.newton import enclose_zero
from orbitproof.verify.periodic_bifurcation.equations import Matrix, PointEquations, radii_of

_REMEDY = "move the centre to the bifurcation, or choose smaller radii"


@dataclass(frozen=True)
class TorusPoint:
    """Where a pair of multipliers is on the unit circle.

    Attributes:
        where: enclosures of p and s, n + 1 balls.
        eigenvector: of w = u + i v, n balls.
        multiplier: of lambda.
    """

    where: tuple[arb, ...]
    eigenvector: tuple[acb, ...]
    multiplier: acb


def check_torus_point(checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations) -> TorusPoint:
    """One point of the box that returns with a multiplier of absolute value 1 near that of the claim."""
    size, (u0, v0), (c0, s0) = equations.size, *_middle(claim)
    zero = [arb(0)] * (size + 1)

    def matrix_over(balls: Sequence[arb]) -> Matrix:
        u, v, (c, s) = _parts(claim, balls)
        return torus_matrix(equations, balls[: size + 1], u, v, acb(c, s), (u0, v0))

    statement = (
        "interval Newton: the point returns and a number of absolute value 1 in its box is a multiplier for exactly "
        "one point of the box and one value of the interval; there the derivative of the equations is regular"
    )
    with checklist.hypothesis("bifurcation", "25.9", statement, _REMEDY) as evidence:
        real, imaginary = _eigenvector_defect(equations, zero, u0, v0, acb(c0, s0))
        residual = [*equations.values(zero), *real, *imaginary, c0 * c0 + s0 * s0 - 1, arb(0), arb(0)]
        numbers = range(size)
        names = [f"p_{i}" for i in numbers] + ["s"] + [f"u_{i}" for i in numbers] + [f"v_{i}" for i in numbers]
        radii = [*radii_of(claim), *(claim.kernel_radius for _ in range(2 * size + 2))]
        eigenvector = range(size + 1, 3 * size + 1)
        found = enclose_zero(evidence, matrix_over, residual, radii, [*names, "cos", "sin"], eigenvector)
    u, v, (c, s) = _parts(claim, found)
    return TorusPoint(tuple(found[: size + 1]), tuple(map(acb, u, v)), acb(c, s))


def torus_matrix(
    equations: PointEquations,
    where: Sequence[arb],
    u: Sequence[arb],
    v: Sequence[arb],
    multiplier: acb,
    normal: tuple[Sequence[arb], Sequence[arb]],
) -> Matrix:
    """The derivative of the equations (25.4) in p, s, u, v, cos and sin: 3 n + 3 rows."""
    size = equations.size
    c, s = multiplier.real, multiplier.imag
    slopes = equations.slopes(where)
    shifted = equations.minus(c, slopes)
    by_u, by_v = (equations.curvatures(where, [*vector, arb(0)]) for vector in (u, v))
    zero, none = [arb(0)] * size, [arb(0)] * (size + 1)

    def unit(row: int, entry: arb) -> list[arb]:
        return [entry if row == column else arb(0) for column in range(size)]

    points = [
        [*row, by_s[-1], *zero, *zero, arb(0), arb(0)]
        for row, by_s in zip(equations.minus(1, slopes), slopes, strict=True)
    ]
    real = [[*by_u[i], *shifted[i], *unit(i, s), -u[i], v[i]] for i in range(size)]
    imaginary = [[*by_v[i], *unit(i, -s), *shifted[i], -v[i], -u[i]] for i in range(size)]
    u0, v0 = normal
    circle = [*none, *zero, *zero, 2 * c, 2 * s]
    length = [*none, *u0, *v0, arb(0), arb(0)]
    angle = [*none, *(-entry for entry in v0), *u0, arb(0), arb(0)]
    return [*points, *real, *imaginary, circle, length, angle]


def _middle(claim: PeriodicBifurcation) -> tuple[tuple[list[arb], list[arb]], tuple[arb, arb]]:
    """u_0 and v_0, and cos and sin."""
    assert claim.multiplier is not None
    real, imaginary = ([enclose(value) for value in part] for part in claim.kernel)
    cosine, sine = map(enclose, claim.multiplier)
    return (real, imaginary), (cosine, sine)


def _parts(claim: PeriodicBifurcation, offsets: Sequence[arb]) -> tuple[list[arb], list[arb], tuple[arb, arb]]:
    """u, v, and cos and sin, from how far all unknowns are from the centre."""
    (u0, v0), (c0, s0) = _middle(claim)
    size = len(u0)
    *others, c, s = offsets
    u = [value + offset for value, offset in zip(u0, others[size + 1 : 2 * size + 1], strict=True)]
    v = [value + offset for value, offset in zip(v0, others[2 * size + 1 :], strict=True)]
    return u, v, (c0 + c, s0 + s)


def _eigenvector_defect(
    equations: PointEquations, where: Sequence[arb], u: Sequence[arb], v: Sequence[arb], multiplier: acb
) -> tuple[list[arb], list[arb]]:
    """Real and imaginary part of A w - lambda w."""
    c, s = multiplier.real, multiplier.imag
    shifted = equations.minus(c, equations.slopes(where))
    real = [dot(row, u) + s * y for row, y in zip(shifted, v, strict=True)]
    imaginary = [dot(row, v) - s * x for row, x in zip(shifted, u, strict=True)]
    return real, imaginary
