"""A candidate in the coordinates of Fix(R), rewritten with the level of H as parameter (docs/method-level.md).

The result is a claim of its own, checked like any other; nothing here carries proof. Let a_0, a_1, a_2 be
the columns of the frame and c_i = dH a_i. With h the level, p = (p_0, p_1, p_2) satisfies to first order
h - h_c = c_0 p_0 + c_1 p_1 + c_2 p_2, and p_1, p_2 are kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from shared.formats import Candidate
from shared.numbers import round_dyadic
from verify.ball_text import exact_value
from verify.derivatives import DerivativeTable
from verify.failure import IntegrationFailure
from verify.level import quadratic_coefficient
from verify.poincare import enclose_first_integral

_SPARE_BITS = 64


def level_form(candidate: Candidate) -> Candidate | None:
    """The same bifurcation, claimed with the level of the first integral as parameter.

    `None` if the system has no level coordinate, or if the family does not cross the levels at the centre.
    """
    system = candidate.system
    if candidate.is_family_of_maps or system.level_coordinate is None or not quadratic_coefficient(system):
        return None
    kept = [i for i, name in enumerate(candidate.coordinates) if name != system.level_coordinate]
    dropped = candidate.coordinates.index(system.level_coordinate)
    bits = _SPARE_BITS + 2 * max(_bits_below_one(radius) for radius in candidate.radii)
    try:
        table = enclose_first_integral(candidate, bits)
    except (IntegrationFailure, ArithmeticError, ValueError):
        return None
    if table is None or not all(ball.is_finite() for ball in table.centre.values()) or not candidate.centre[dropped]:
        return None
    size = len(candidate.radii)
    slopes = [_derivative(table, size, i) for i in range(size)]
    if not slopes[0] or not any(candidate.frame[i][0] for i in kept):
        return None

    along = [candidate.frame[i][0] / slopes[0] for i in kept]
    across = [[candidate.frame[i][j] - slopes[j] * a for i, a in zip(kept, along, strict=True)] for j in range(1, size)]
    columns = [[Fraction(1), *along], *([Fraction(0), *column] for column in across)]
    frame = tuple(tuple(round_dyadic(columns[j][i], bits) for j in range(size)) for i in range(size))
    if candidate.symmetry is not None:
        signs = system.symmetries[candidate.symmetry]
        odd = [False, *(signs[system.state.index(candidate.coordinates[i])] == -1 for i in kept)]
        frame = tuple(
            tuple(value if (j == 1) == is_odd else Fraction(0) for j, value in enumerate(row))
            for row, is_odd in zip(frame, odd, strict=True)
        )
    radii = _radii(candidate.radii, slopes, table, _solve(across, along))
    if radii is None:
        return None
    level = round_dyadic(exact_value(table.centre[(0,) * size].mid()), 2 * bits)
    return replace(
        candidate,
        centre=(level, *(candidate.centre[i] for i in kept)),
        frame=frame,
        radii=radii,
        level_sign=1 if candidate.centre[dropped] > 0 else -1,
    )


def level_spread(candidate: Candidate, form: Candidate) -> Fraction:
    """How many times longer P_0 is in the level form than the old P_0, measured along the family.

    Large where the family is nearly tangent to the levels of H compared with the box.
    """
    # Column 0 of the new frame is column 0 of the old one divided by dH a_0.
    kept = [i for i, name in enumerate(candidate.coordinates) if name in form.coordinates]
    old = sum((abs(candidate.frame[i][0]) for i in kept), Fraction(0)) * candidate.radii[0]
    new = sum((abs(row[0]) for row in form.frame[1:]), Fraction(0)) * form.radii[0]
    return new / old


def _bits_below_one(value: Fraction) -> int:
    return max(0, value.denominator.bit_length() - value.numerator.bit_length())


def _derivative(table: DerivativeTable, size: int, *positions: int) -> Fraction:
    index = tuple(positions.count(i) for i in range(size))
    return exact_value(table.centre[index].mid())


def _radii(
    radii: Sequence[Fraction], slopes: Sequence[Fraction], table: DerivativeTable, tilt: Sequence[Fraction] | None
) -> tuple[Fraction, ...] | None:
    """Half-widths for the levels and across, up to the next power of two; to second order they contain the old box.

    p_2 changes by its part of `tilt` times what h differs from its linear part; so does p_1, which is wide.
    """
    if tilt is None:
        return None
    size = len(radii)
    curved = sum(
        (abs(_derivative(table, size, i, j)) * radii[i] * radii[j] / 2 for i in range(size) for j in range(size)),
        Fraction(0),
    )
    linear = sum((abs(slope) * radius for slope, radius in zip(slopes, radii, strict=True)), Fraction(0))
    across = [radius + abs(t) * curved for radius, t in zip(radii[2:], tilt[1:], strict=True)]
    return (_power_of_two_above(linear + curved), radii[1], *(_power_of_two_above(width) for width in across))


def _power_of_two_above(value: Fraction) -> Fraction:
    exponent = value.numerator.bit_length() - value.denominator.bit_length()
    while Fraction(2) ** exponent < value:
        exponent += 1
    while Fraction(2) ** (exponent - 1) >= value:
        exponent -= 1
    return Fraction(2) ** exponent


def _solve(columns: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction] | None:
    """x with sum_j x_j columns[j] = right; `None` if the columns are dependent."""
    size = len(right)
    rows = [[columns[j][i] for j in range(size)] + [right[i]] for i in range(size)]
    for column in range(size):
        pivot = next((i for i in range(column, size) if rows[i][column]), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for i in range(size):
            if i != column and rows[i][column]:
                factor = rows[i][column]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[column], strict=True)]
    return [row[size] for row in rows]
