"""Multipliers of a periodic orbit, enclosed and counted (section 24.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from flint import acb, acb_mat, arb

from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import all_finite, is_below, sign

Matrix = Sequence[Sequence[arb]]
Number = Annotated[int, rules("number_of_multipliers", minimum=0, maximum=32)]


@dataclass(frozen=True)
class Multipliers:
    """The multipliers of a periodic orbit other than those that are 1 for every orbit of its kind.

    Attributes:
        values: one enclosure for each, with multiplicity; empty where none is found.
        inside, on, outside: how many are certain to lie inside, on and outside the unit circle.
        undecided: how many of them are neither.
        trivial: how many further multipliers are 1: that of the direction of the flow and, with a first integral, one
            more.
    """

    values: Annotated[tuple[acb, ...], rules("complex_balls", maxItems=32)]
    inside: Number
    on: Number
    outside: Number
    undecided: Number
    trivial: Number

    @property
    def is_attracting(self) -> bool:
        """Whether all of them lie inside, and nothing but the direction of the flow is 1."""
        return self.trivial == 1 and self.on == self.outside == self.undecided == 0

    @property
    def is_hyperbolic(self) -> bool:
        """Whether none of them may lie on the circle."""
        return self.on == self.undecided == 0


def multipliers_of(derivative: Matrix, trivial: int, keeps_volume: bool) -> Multipliers:
    """The eigenvalues of the derivative of a return map, as counted by `Multipliers`.

    Arguments:
        derivative: enclosure of the derivative at the fixed point; with a first integral, on its level.
        trivial: how many multipliers are no eigenvalues of it.
        keeps_volume: whether its determinant is 1.
    """
    size = len(derivative)
    values = _eigenvalues(derivative)
    if not values:
        return Multipliers((), 0, 0, 0, size, trivial)
    values = _with_real_ones(values)
    inside = sum(is_below(abs(value), arb(1)) for value in values)
    outside = sum(is_below(arb(1), abs(value)) for value in values)
    on = 0
    if keeps_volume and size == 2 and _is_pair(values):
        inside, on, outside = 0, 2, 0
    return Multipliers(tuple(values), inside, on, outside, size - inside - on - outside, trivial)


def eigenvalues_of(matrix: Matrix) -> list[acb]:
    """Enclosures of all eigenvalues of every real matrix in an interval matrix, with multiplicity, those as real
    numbers that are certainly real; none if they are not found.
    """
    return _with_real_ones(_eigenvalues(matrix))


def _eigenvalues(matrix: Matrix) -> list[acb]:
    """Enclosures of all eigenvalues of every real matrix in an interval matrix; none if they are not found.

    Either disjoint balls, each with one eigenvalue, or clusters, a ball being repeated for each that it contains.
    """
    if not matrix:
        return []
    if not all_finite(ball for row in matrix for ball in row):
        return []
    if len(matrix) == 1:
        return [acb(matrix[0][0])]
    if len(matrix) == 2 and (pair := _of_pair(matrix)):
        return pair
    balls = acb_mat([[acb(value) for value in row] for row in matrix])
    for multiple in (False, True):
        try:
            values = list(balls.eig(multiple=multiple))
        except (ValueError, ZeroDivisionError):
            continue
        if len(values) == len(matrix) and all(value.is_finite() for value in values):
            return values
    return []


def _of_pair(matrix: Matrix) -> list[acb]:
    """The eigenvalues of a 2 x 2 matrix, if it is known whether they are real; none if it is not."""
    (a, b), (c, d) = matrix
    middle, difference = (a + d) / 2, (a - d) / 2
    discriminant = difference * difference + b * c
    known = sign(discriminant)
    if known < 0:
        root = (-discriminant).sqrt()
        return [acb(middle, -root), acb(middle, root)]
    if known == 0 or not sign(middle):
        return []
    larger = middle + sign(middle) * discriminant.sqrt()
    # Their product is the determinant: no cancellation.
    return [acb((a * d - b * c) / larger), acb(larger)]


def _with_real_ones(values: Sequence[acb]) -> list[acb]:
    """The values, those as real numbers that are certainly real.

    The eigenvalues of a real matrix come with their conjugates: if the mirror image of a ball meets no other ball,
    the conjugate of the one eigenvalue in it is in it too, so it is this eigenvalue.
    """
    found = []
    for place, value in enumerate(values):
        mirrored = value.conjugate()
        others = [other for number, other in enumerate(values) if number != place]
        alone = not any(mirrored.overlaps(other) for other in others)
        found.append(acb(value.real) if alone and mirrored.overlaps(value) else value)
    return found


def _is_pair(values: Sequence[acb]) -> bool:
    """Whether both eigenvalues of a real matrix are certain not to be real, hence conjugate."""
    return all(value.imag.is_finite() and not value.imag.contains(0) for value in values)


def on_level(derivative: Matrix, slopes: Sequence[arb], dropped: int) -> list[list[arb]]:
    """The derivative on the kernel of dH, in the coordinates but one, whose part follows from dH v = 0."""
    kept = [i for i in range(len(slopes)) if i != dropped]
    return [
        [derivative[i][k] - derivative[i][dropped] * slopes[k] / slopes[dropped] for k in kept] for i in kept
    ]  # fmt: skip
