"""How many eigenvalues lie left and right of the imaginary axis, along a whole curve of equilibria (section 37.5)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Annotated

from flint import arb, arb_mat

from orbitproof.shared.claims import EquilibriumAtlas
from orbitproof.shared.stored import rules
from orbitproof.verify.curve import Chain, Stretch
from orbitproof.verify.equilibrium.expansions import expand
from orbitproof.verify.equilibrium.spectrum import spectrum_of
from orbitproof.verify.equilibrium_curve.piece import parameters_at
from orbitproof.verify.evidence import hull, sign

_HALVINGS, _MOST_PARTS = 30, 16
"""A proved interval is halved so often, as long as no more parts than these are undecided."""

Number = Annotated[int, rules("number_of_eigenvalues", minimum=0, maximum=32)]


@dataclass(frozen=True)
class Sides:
    """How many eigenvalues have negative and positive real parts; none has real part 0."""

    left: Number
    right: Number


@dataclass(frozen=True)
class SidedPart:
    """A part of a curve on which the eigenvalues of all equilibria are counted alike, or are not counted.

    Attributes:
        pieces: ids of the pieces on which it begins and ends.
        between: s of both places.
        values: enclosures of the parameter at both.
        all_values: contains its values at all points of the part.
        sides: `None` if they are not decided.
    """

    pieces: tuple[str, str]
    between: tuple[Fraction, Fraction]
    values: tuple[arb, arb]
    all_values: arb
    sides: Sides | None


def sides_along(atlas: EquilibriumAtlas, chain: Chain) -> tuple[SidedPart, ...]:
    """The parts of the curve in order, neighbours with other counts."""
    found: list[SidedPart] = []
    for stretch in chain.stretches:
        for part in _parts_of(atlas, stretch):
            if found and found[-1].sides == part.sides:
                found[-1] = _joined(found[-1], part)
            else:
                found.append(part)
    return tuple(found)


def _joined(first: SidedPart, last: SidedPart) -> SidedPart:
    return replace(
        first,
        pieces=(first.pieces[0], last.pieces[1]),
        between=(first.between[0], last.between[1]),
        values=(first.values[0], last.values[1]),
        all_values=hull(first.all_values, last.all_values),
    )


def _parts_of(atlas: EquilibriumAtlas, stretch: Stretch) -> Iterator[SidedPart]:
    """The parts of what the curve runs along of a piece: where it may enter, then each on one proved interval."""
    tube, run = stretch.tube, stretch.run
    name, reached = tube.piece.id, stretch.entered

    def part(low: Fraction, high: Fraction, everywhere: arb, sides: Sides | None) -> SidedPart:
        at = tube.point(run, low)[0], tube.point(run, high)[0]
        return SidedPart((name, name), (low, high), at, everywhere, sides)

    if stretch.enters < stretch.entered:
        # Counts of a part of it may be those of points before the place at which the piece before is left.
        entering = run.between(stretch.enters, stretch.entered)
        points = [tube.points(proved.deviation, low, high) for proved, low, high in entering]
        counts = [_sides(atlas, point) for point in points]
        everywhere = hull(points[0][0], *(point[0] for point in points[1:]))
        same = all(sides == counts[0] for sides in counts)
        yield part(stretch.enters, stretch.entered, everywhere, counts[0] if same else None)
    for proved, start, end in run.between(stretch.entered, stretch.leaves):
        first = max(start, reached)
        if first >= end:
            continue
        decided: list[tuple[Fraction, Fraction, Sides | None]] = []
        pending = [(first, end)]
        for halving in range(_HALVINGS + 1):
            open_parts = []
            for low, high in pending:
                sides = _sides(atlas, tube.points(proved.deviation, low, high))
                if sides is None:
                    open_parts.append((low, high))
                else:
                    decided.append((low, high, sides))
            if halving == _HALVINGS or len(open_parts) > _MOST_PARTS:
                decided += [(low, high, None) for low, high in open_parts]
                break
            pending = [
                half for low, high in open_parts for half in ((low, (low + high) / 2), ((low + high) / 2, high))
            ]  # fmt: skip
        for low, high, sides in sorted(decided, key=lambda part: part[:2]):
            yield part(low, high, tube.points(proved.deviation, low, high)[0], sides)
        reached = end


def _sides(atlas: EquilibriumAtlas, point: list[arb]) -> Sides | None:
    """The counts at all points of balls, if they are decided."""
    size = len(atlas.system.given_state)
    units = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
    rates = expand(atlas.system, point[1:], parameters_at(atlas, point[0]), units, 1)
    matrix = [[f.slope(j) for j in range(size)] for f in rates]
    if (known := sides_of(matrix)) is not None:
        return known
    # The scheme may break off where no eigenvalue is near the axis.
    found = spectrum_of(matrix)
    return Sides(found.left, found.right) if found.is_hyperbolic else None


def sides_of(matrix: Sequence[Sequence[arb]]) -> Sides | None:
    """How many eigenvalues lie left and right of the axis, none on it, for every matrix in an interval matrix, by the
    signs of Routh's scheme; `None` if one is not certain.
    """
    size = len(matrix)
    coefficients = arb_mat([list(row) for row in matrix]).charpoly()
    upper, lower = ([coefficients[k] for k in range(size - first, -1, -2)] for first in (0, 1))
    signs = []
    for _ in range(size + 1):
        if not (known := sign(upper[0])):
            return None
        signs.append(known)
        upper, lower = lower, _next_row(upper, lower)
        if not upper:
            break
    if len(signs) != size + 1:
        return None
    right = sum(a != b for a, b in pairwise(signs))
    return Sides(size - right, right)


def _next_row(upper: Sequence[arb], lower: Sequence[arb]) -> list[arb]:
    """The row of Routh's scheme after two of them."""
    if not lower:
        return []
    padded = [*lower, arb(0)]
    return [upper[i + 1] - upper[0] * padded[i + 1] / lower[0] for i in range(len(upper) - 1)]
