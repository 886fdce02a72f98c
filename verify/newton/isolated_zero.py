"""One zero of a function in a box, required and enclosed (section 7.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from flint import arb

from orbitproof.verify.evidence import Evidence, hull, is_below, is_inside, is_outside, meet, show, symmetric
from orbitproof.verify.newton.interval_newton import is_regular, newton_image

Matrix = list[list[arb]]

_FINE = arb(2) ** -64
"""An entry of a derivative that is known so well does not make it singular."""


def enclose_zero(
    evidence: Evidence,
    matrix_over: Callable[[Sequence[arb]], Matrix],
    residual: Sequence[arb],
    radii: Sequence[Fraction],
    names: Sequence[str],
    eigenvector: range = range(0),
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
    regular = is_regular(matrix)
    if not regular:
        # If more bits do not make these narrower, still more would not help either.
        for row, entries in enumerate(matrix):
            for column, ball in enumerate(entries):
                if is_below(_FINE, ball.rad()):
                    evidence.record(f"derivative {row}, {column}", ball)
    evidence.require(regular, "the derivative may be singular in the box", needs_precision=True)
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
