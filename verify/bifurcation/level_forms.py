"""A candidate in the coordinates of Fix(R), rewritten with the level of H as parameter (section 12).

The result is a claim of its own, checked like any other; that its box contains the old one is proved here.
Let a_0, a_1, a_2 be the columns of the frame and c_i = dH a_i. With h the level, p = (p_0, p_1, p_2)
satisfies h - h_c = c_0 p_0 + c_1 p_1 + c_2 p_2 to first order, and p_1, p_2 are kept.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.claim import determinant, inverse, quadratic_coefficient
from orbitproof.verify.evidence import (
    GUARD_BITS,
    Checklist,
    DerivativeTable,
    Evidence,
    IntegrationFailure,
    dot,
    enclose,
    exact_value,
    guarded,
    is_inside,
    is_outside,
    show,
    symmetric,
)
from orbitproof.verify.poincare import BOX_RATIO, box_of, derivative_table

_MOST_BITS = 1 << 17
"""Boxes that would need more are too small for any proof."""
_MARGIN = Fraction(33, 32)
_RADIUS_BITS = 12


def level_form(candidate: Candidate) -> Candidate | None:
    """The bifurcation with the level of the first integral as parameter, in a box that contains the old one.

    `None` if there is no level coordinate, if the frame is singular, if the family does not cross the levels
    at the centre, or if the new box was not shown to contain the old one.
    """
    system = candidate.system
    if candidate.is_family_of_maps or system.level_coordinate is None or not quadratic_coefficient(system):
        return None
    if not determinant(candidate.frame):
        return None
    kept = [i for i, name in enumerate(candidate.coordinates) if name != system.level_coordinate]
    dropped = candidate.coordinates.index(system.level_coordinate)
    bits, table = _first_integral(candidate)
    if table is None or not candidate.centre[dropped]:
        return None
    size = len(candidate.radii)
    # Only bits far above the errors, so that checking again, where something rounds otherwise, finds the same form.
    unit = Fraction(1, 2 ** (bits // 2))
    slopes = [round(_derivative(table, size, i) / unit) * unit for i in range(size)]
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
    unsheared = inverse(tuple(zip(*across, strict=True)))
    if unsheared is None:
        return None
    tilt = [sum((a * b for a, b in zip(row, along, strict=True)), Fraction(0)) for row in unsheared]
    level = round_dyadic(_derivative(table, size), 3 * bits // 4)
    form = replace(
        candidate,
        centre=(level, *(candidate.centre[i] for i in kept)),
        frame=frame,
        radii=_radii(candidate.radii, slopes, table, tilt),
        level_sign=1 if candidate.centre[dropped] > 0 else -1,
    )
    return form if _is_own_box(Evidence(""), candidate, form, bits, table) else None


def check_own_box(checklist: Checklist, candidate: Candidate, form: Candidate, point: Mapping[str, arb]) -> None:
    """What is proved of the box of a level form holds for the candidate's own box, `point` being the bifurcation's."""
    statement = "the box of the level form contains the candidate's own box, on which the level coordinate has one sign"
    with checklist.hypothesis("level-box", "12.3", statement, "choose smaller radii") as evidence:
        bits, table = _first_integral(candidate)
        evidence.require(table is not None, "the first integral was not enclosed on the candidate's box")
        if table is not None:
            _is_own_box(evidence, candidate, form, bits, table)
    statement = "the bifurcation point lies in the candidate's own box"
    with checklist.hypothesis(
        "candidate-box", "12.3", statement, "move the centre to the bifurcation point"
    ) as evidence:
        for j, (ball, radius) in enumerate(zip(coordinates_in_box(candidate, point), candidate.radii, strict=True)):
            evidence.record(f"p_{j}", ball)
            evidence.require(ball.is_finite(), f"p_{j} is not enclosed", needs_precision=True)
            outside = is_outside(ball, radius)
            where = "is not shown to be inside it"
            if outside:
                where = f"lies outside [-R, R], R = {float(radius):.3g}, and there is no other in the larger box"
            evidence.require(is_inside(ball, radius), f"p_{j} in {show(ball)} {where}", excluded=outside)


def _first_integral(candidate: Candidate) -> tuple[int, DerivativeTable | None]:
    """Bits that are enough for the box, and finite enclosures of the derivatives of H on it, or `None`."""
    bits = GUARD_BITS + 2 * max(_bits_below_one(radius) for radius in candidate.radii)
    if bits > _MOST_BITS:
        return bits, None
    try:
        table = enclose_first_integral(candidate, bits)
    except (IntegrationFailure, ArithmeticError, ValueError):
        return bits, None
    return bits, table if table is not None and _is_finite(table) else None


def enclose_first_integral(candidate: Candidate, precision: int) -> DerivativeTable | None:
    """Derivatives of the first integral on the candidate's box in Fix(R), without integrating."""
    with guarded(precision):
        box = box_of(candidate, precision, 1)
        return None if box.level is None else derivative_table(box.level, box.scales, BOX_RATIO)


def _is_own_box(evidence: Evidence, candidate: Candidate, form: Candidate, bits: int, table: DerivativeTable) -> bool:
    """Whether the form's box contains the candidate's, on which the level coordinate keeps its sign; adds evidence."""
    names = candidate.coordinates
    dropped = names.index(str(candidate.system.level_coordinate))
    with guarded(bits):
        images = _images(form, candidate, table, [i for i in range(len(names)) if i != dropped])
        evidence.require(images is not None, "a frame is singular")
        for j, (ball, radius) in enumerate(zip(images or (), form.radii, strict=False)):
            evidence.record(f"p_{j} of the candidate's box", ball)
            evidence.require(is_inside(ball, radius), f"p_{j} in {show(ball)} on it is not inside the form's")
    evidence.require(_keeps_sign(candidate, dropped), f"{names[dropped]} may change its sign on it")
    return evidence.holds


def _keeps_sign(candidate: Candidate, dropped: int) -> bool:
    """Whether the level coordinate has the sign of its centre on the whole box."""
    widths = (abs(a) * radius for a, radius in zip(candidate.frame[dropped], candidate.radii, strict=True))
    return sum(widths, Fraction(0)) < abs(candidate.centre[dropped])


def level_spread(candidate: Candidate, form: Candidate) -> Fraction:
    """How many times longer P_0 is in the level form than the old P_0, measured along the family.

    Large where the family is nearly tangent to the levels of H compared with the box.
    """
    # Column 0 of the new frame is column 0 of the old one divided by dH a_0.
    kept = [i for i, name in enumerate(candidate.coordinates) if name in form.coordinates]
    old = sum((abs(candidate.frame[i][0]) for i in kept), Fraction(0)) * candidate.radii[0]
    new = sum((abs(row[0]) for row in form.frame[1:]), Fraction(0)) * form.radii[0]
    return new / old


def _is_finite(table: DerivativeTable) -> bool:
    return all(ball.is_finite() for part in (table.centre, table.box) for ball in part.values())


def _bits_below_one(value: Fraction) -> int:
    return max(0, value.denominator.bit_length() - value.numerator.bit_length())


def _derivative(table: DerivativeTable, size: int, *positions: int) -> Fraction:
    index = tuple(positions.count(i) for i in range(size))
    return exact_value(table.centre[index].mid())


def _radii(
    radii: Sequence[Fraction], slopes: Sequence[Fraction], table: DerivativeTable, tilt: Sequence[Fraction]
) -> tuple[Fraction, ...]:
    """Half-widths that contain the old box to second order, and a little more.

    p_1, p_2 change by `tilt` times what h differs from its linear part.
    """
    size = len(radii)
    curved = sum(
        (abs(_derivative(table, size, i, j)) * radii[i] * radii[j] / 2 for i in range(size) for j in range(size)),
        Fraction(0),
    )
    linear = sum((abs(slope) * radius for slope, radius in zip(slopes, radii, strict=True)), Fraction(0))
    wide = [linear + curved, *(radius + abs(t) * curved for radius, t in zip(radii[1:], tilt, strict=True))]
    return tuple(round_dyadic(value * _MARGIN, _RADIUS_BITS) for value in wide)


def _images(form: Candidate, candidate: Candidate, table: DerivativeTable, kept: Sequence[int]) -> list[arb] | None:
    """The coordinates p of `form` on the box of `candidate`; `table` are derivatives of H on the latter.

    With h = H(0) + sum s_j p_j + Q, Q in the second-order remainder, and T the inverse of the new frame,
    p_i' = T_i0 (H(0) - h_c + Q) + sum_j (T_i0 s_j + L_ij) p_j, where L is T times the kept rows of the old frame.
    """
    size = len(form.radii)
    rows = inverse(form.frame)
    if rows is None:
        return None
    sides = [symmetric(radius) for radius in candidate.radii]
    remainder = arb(0)
    for i in range(size):
        for j in range(size):
            index = tuple((i == n) + (j == n) for n in range(size))
            remainder = remainder + table.box[index] * sides[i] * sides[j] / 2
    offset = table.centre[(0,) * size] - enclose(form.centre[0]) + remainder
    images = []
    for first, *others in rows:
        value = enclose(first) * offset
        for j, side in enumerate(sides):
            direct = sum((t * candidate.frame[n][j] for t, n in zip(others, kept, strict=True)), Fraction(0))
            unit = tuple(int(j == n) for n in range(size))
            value = value + (enclose(first) * table.centre[unit] + enclose(direct)) * side
        images.append(value)
    return images


def coordinates_in_box(candidate: Candidate, point: Mapping[str, arb]) -> list[arb]:
    """Enclosures of the p of a point of Fix(R), given by its coordinates. Not finite if the frame is singular."""
    distance = [point[name] - enclose(c) for name, c in zip(candidate.coordinates, candidate.centre, strict=True)]
    rows = inverse(candidate.frame)
    if rows is None:
        return [arb("nan")] * len(distance)
    return [dot([enclose(value) for value in row], distance) for row in rows]


def in_box(candidate: Candidate, point: Mapping[str, arb]) -> bool:
    """Whether a point of Fix(R), given by its coordinates, certainly lies inside the candidate's box."""
    where = coordinates_in_box(candidate, point)
    return all(is_inside(ball, radius) for ball, radius in zip(where, candidate.radii, strict=True))
