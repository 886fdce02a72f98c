"""Where a curve of equilibria turns back in its parameter: exactly one fold, which is not degenerate (section 37.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat

from orbitproof.shared.claims import EquilibriumAtlas
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Chain, Stretch
from orbitproof.verify.equilibrium.expansions import expand
from orbitproof.verify.equilibrium_curve.piece import parameters_at
from orbitproof.verify.evidence import dot, enclose, hull, sign, symmetric, total

_PLACES, _HALVINGS = 16, 24
"""On each stretch of a piece the direction is looked at in so many places; what has a fold is halved so often."""


@dataclass(frozen=True)
class Fold:
    """An extremum of the parameter along a curve of equilibria.

    Attributes:
        is_maximum: whether the parameter increases before and decreases after it.
        is_regular: whether it is the only one between the two places, and the second derivative of the parameter along
            the curve is not 0 there; if not, this is not decided.
        pieces: ids of the pieces of both places.
        between: their s.
        values: enclosures of the parameter at both.
        all_values: contains its values at all points of the curve between both, where these are on one piece.
    """

    is_maximum: bool
    is_regular: bool
    pieces: tuple[str, str]
    between: tuple[Fraction, Fraction]
    values: tuple[arb, arb]
    all_values: arb | None


def folds_of(atlas: EquilibriumAtlas, chain: Chain) -> tuple[Fold, ...]:
    """The extrema of the parameter that follow from its direction at finitely many places, in order."""
    found: list[Fold] = []
    before: tuple[int, Stretch, Fraction] | None = None
    for stretch in chain.stretches:
        for number in range(_PLACES + 1):
            s = stretch.entered + (stretch.leaves - stretch.entered) * Fraction(number, _PLACES)
            direction = _direction(stretch, s)
            if not direction:
                continue
            if before is not None and before[0] != direction:
                _, earlier, place = before
                found.append(_fold(atlas, direction < 0, (earlier, place), (stretch, s)))
            before = direction, stretch, s
    return tuple(found)


def _direction(stretch: Stretch, s: Fraction) -> int:
    """The certain sign of the derivative of the parameter by s, or 0."""
    slopes = stretch.tube.local_slope(stretch.run, s)
    return sign(dot([enclose(value) for value in stretch.tube.piece.frame[0]], slopes))


def _fold(
    atlas: EquilibriumAtlas, is_maximum: bool, first: tuple[Stretch, Fraction], last: tuple[Stretch, Fraction]
) -> Fold:
    (before, start), (after, end) = first, last
    if before is not after:
        values = before.tube.point(before.run, start)[0], after.tube.point(after.run, end)[0]
        pieces = before.tube.piece.id, after.tube.piece.id
        return Fold(is_maximum, False, pieces, (start, end), values, None)
    wanted = 1 if is_maximum else -1
    for _ in range(_HALVINGS):
        # The place at which the direction is another one stays between.
        middle = (start + end) / 2
        direction = _direction(before, middle)
        if not direction:
            break
        start, end = (middle, end) if direction == wanted else (start, middle)
    parts = before.run.between(start, end)
    points = [before.tube.points(proved.deviation, low, high) for proved, low, high in parts]
    slopes = [
        _slope_of_determinant(atlas, point, _tangent(before, proved.slope_deviation, low, high))
        for point, (proved, low, high) in zip(points, parts, strict=True)
    ]
    signs = {sign(slope) for slope in slopes}
    values = before.tube.point(before.run, start)[0], before.tube.point(before.run, end)[0]
    name = before.tube.piece.id
    everywhere = hull(points[0][0], *(point[0] for point in points[1:]))
    return Fold(is_maximum, signs in ({1}, {-1}), (name, name), (start, end), values, everywhere)


def _tangent(stretch: Stretch, bounds: Sequence[Fraction], low: Fraction, high: Fraction) -> list[arb]:
    """The derivatives of the coordinates by s, at all s of a part of a proved interval."""
    piece = stretch.tube.piece
    s = enclose((low + high) / 2) + symmetric((high - low) / 2)
    across = [
        ball_polynomial(row).derivative()(s) + symmetric(bound)
        for row, bound in zip(piece.polynomial, bounds, strict=True)
    ]
    along = [enclose(piece.half_width), *across]
    return [dot([enclose(value) for value in row], along) for row in piece.frame]


def _slope_of_determinant(atlas: EquilibriumAtlas, point: Sequence[arb], tangent: Sequence[arb]) -> arb:
    """The derivative of det A by s, A the derivative of the field in the state, at points with such tangents."""
    size = len(atlas.system.given_state)
    varying = list(atlas.system.parameters).index(atlas.claim.parameter)
    count = size + len(atlas.system.parameters)
    places = [*range(size), size + varying]
    units = [[arb(int(i == place)) for i in range(count)] for place in places]
    rates = expand(atlas.system, point[1:], parameters_at(atlas, point[0]), units, 2)
    along = [*tangent[1:], tangent[0]]
    matrix = [[f.slope(j) for j in range(size)] for f in rates]
    moved = [[dot([f.second(j, k) for k in range(size + 1)], along) for j in range(size)] for f in rates]
    return total(arb_mat([moved[i] if i == row else matrix[i] for i in range(size)]).det() for row in range(size))
