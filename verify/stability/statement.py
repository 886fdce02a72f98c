"""The complete list and the intervals of linear stability in words (section 18.7)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import Atlas
from orbitproof.verify.evidence import decimal_interval, interval_text
from orbitproof.verify.stability.across_list import ListAcross
from orbitproof.verify.stability.distances import ALONG
from orbitproof.verify.stability.extrema import BAND
from orbitproof.verify.stability.linear_stability import Bound, StableInterval
from orbitproof.verify.stability.places import (
    ACROSS_AXIAL,
    ACROSS_DOUBLING,
    ACROSS_SYMMETRIC,
    COLLISION,
    FOLD,
    HERE,
    LOSS,
    RESONANCE,
    SYMMETRIC,
    THERE,
    CompleteList,
    Gap,
    Point,
)
from orbitproof.verify.stability.ranges import Ranges

_DIGITS, _MOST_DIGITS = 14, 24

_WORDS = {
    FOLD: "extremum of {level} along the curve",
    LOSS: "1:1, branches of orbits without the symmetry R may be born here",
    HERE: "1:2, orbits of twice the period at this point of the orbit on Fix(R)",
    THERE: "1:2, orbits of twice the period at the other point of the orbit on Fix(R)",
    COLLISION: "Krein collision: two stability parameters are equal",
    SYMMETRIC: "symmetric point of the curve, 1:1",
    ACROSS_SYMMETRIC: "1:1, a curve of orbits out of the plane, symmetric under R, begins here",
    ACROSS_AXIAL: "1:1, a curve of orbits out of the plane, symmetric under R followed by z -> -z, begins here",
    ACROSS_DOUBLING: "1:2",
}


def statement(
    atlas: Atlas, found: CompleteList, stable: Sequence[StableInterval], unknown: Sequence[StableInterval]
) -> str:
    """What is proved of resonances and stability along the curve."""
    everywhere = not found.gaps
    where = "Along the curve" if everywhere else "Along the curve, but for the places named below,"
    listed = [point for point in found.points if point.k]
    value = f"an eigenvalue cos(2 pi j/k), k at most {found.order}"
    if listed:
        result = f"the points with {value}, are exactly these, in order along the curve:"
    else:
        result = f"no point has {value}."
    lines = [
        f"Let Sigma(u) be the stability matrix of the orbit of u on the section, {_held(atlas)}: its eigenvalues are "
        f"the stability parameters (lambda + 1/lambda)/2 of the multipliers lambda. {where} {result}"
    ]
    lines += [f"- {_point(atlas, point)}" for point in listed]
    collisions = [point for point in found.points if not point.k]
    if collisions:
        lines.append(f"{where} two stability parameters are equal at exactly these points:")
        lines += [f"- {_point(atlas, point)}" for point in collisions]
    lines += _extrema(atlas, found)
    lines += _stability(atlas, stable, unknown)
    if found.gaps:
        lines.append("Not covered, so that nothing is said of it:")
        lines += [f"- {_gap(gap)}" for gap in found.gaps]
    return "\n".join(lines)


def statement_across(atlas: Atlas, across: ListAcross) -> str:
    """What is proved of variations out of the plane."""
    found = across.found
    but = ", but for the places named below," if found.gaps else ""
    lines = [
        "Variations of the orbits out of the plane have one more pair of multipliers lambda, 1/lambda. Along the curve"
        f"{but} (lambda + 1/lambda)/2 is cos(2 pi j/k), k at most {found.order}, "
        + ("exactly here:" if found.points else "nowhere.")
    ]
    for point, value in zip(found.points, across.jacobi_constants, strict=True):
        known = "" if value is None else f"; Jacobi constant in {interval_text(value, _DIGITS)}"
        lines.append(f"- {_point(atlas, point)}{known}")
    if any(point.kind in (ACROSS_SYMMETRIC, ACROSS_AXIAL) for point in found.points):
        lines.append(
            "Where a curve begins, the orbits near this one that are symmetric in that way, start on the fixed points "
            "of the symmetry and meet them again at the corresponding crossing of the section are those in the plane "
            "and the orbits of one smooth curve, which leaves the plane."
        )
    rest = "and of the others, but for the places named below, none are" if across.unknown else "and no others are"
    if across.stable:
        lines.append(
            "Between the following points, themselves not included, variations out of the plane are linearly stable "
            f"(these multipliers are on the unit circle, not 1 or -1), {rest}:"
        )
        lines += [f"- {_interval(atlas, entry)}" for entry in across.stable]
    elif not across.unknown:
        lines.append("For no orbit of the curve they are linearly stable.")
    if across.unknown:
        lines.append("It is not decided whether they are linearly stable at and between these places:")
        lines += [f"- {_interval(atlas, entry)}" for entry in across.unknown]
    if found.gaps:
        lines.append("Not covered, out of the plane:")
        lines += [f"- {_gap(gap)}" for gap in found.gaps]
    return "\n".join(lines)


def _extrema(atlas: Atlas, found: CompleteList) -> list[str]:
    """The extrema of the stability parameters; symmetric points are extrema by their symmetry."""
    but = ", but for the places named below" if found.gaps or found.open_extrema else ""
    band = f"with a value from -{BAND} to {BAND}"
    level = level_name(atlas)
    if not found.extrema:
        lines = [f"Apart from symmetric points no stability parameter is stationary {band}{but}."]
    else:
        lines = [f"Apart from symmetric points a stability parameter is stationary {band} exactly here{but}:"]
    for entry in found.extrema:
        place = f"{level} in {interval_text(entry.level, _DIGITS)}, in piece {entry.piece}"
        known = f"; shown by the certified orbits {', '.join(entry.certificates)}" if entry.certificates else ""
        lines.append(f"- (lambda + 1/lambda)/2 in {interval_text(entry.value, _MOST_DIGITS)}: {place}{known}")
    if found.open_extrema:
        lines.append("Whether one is stationary there is not decided:")
        lines += [f"- {_gap(gap)}" for gap in found.open_extrema]
    return lines


def _stability(atlas: Atlas, stable: Sequence[StableInterval], unknown: Sequence[StableInterval]) -> list[str]:
    lines = []
    rest = "and of the others, but for the places named below, none is" if unknown else "and no others are"
    if stable:
        lines.append(
            "The orbits between the following points, themselves not included, are linearly stable (these multipliers "
            f"are on the unit circle, distinct and not 1 or -1), {rest}:"
        )
        lines += [f"- {_interval(atlas, entry)}" for entry in stable]
    elif not unknown:
        lines.append("No orbit of the curve is linearly stable with distinct multipliers.")
    if unknown:
        lines.append("It is not decided whether the orbits are linearly stable at and between these places:")
        lines += [f"- {_interval(atlas, entry)}" for entry in unknown]
    return lines


def _held(atlas: Atlas) -> str:
    if atlas.system.normalised:
        return f"in the plane and on its level of the Jacobi constant (at {level_name(atlas)} = 0 the limit of that)"
    if atlas.system.family_parameter is not None:
        return f"{level_name(atlas)} held fixed"
    return f"on its level of the {level_name(atlas)}"


def level_name(atlas: Atlas) -> str:
    """What the level along the curve is called."""
    return str(atlas.system.family_parameter or atlas.system.first_integral_name or "first integral")


def _point(atlas: Atlas, point: Point) -> str:
    level = level_name(atlas)
    what = f"1:{point.k}" if point.kind == RESONANCE else _WORDS.get(point.kind, f"1:{point.k}, kind not decided")
    turns = f" (j = {point.j})" if point.j > 1 else ""
    place = (
        f"{level} in {interval_text(point.level, _DIGITS)}, half period in {decimal_interval(point.half_period, 10)}"
    )
    known = f"; certified: {', '.join(point.certificates)}" if point.certificates else ""
    return f"{what.format(level=level)}{turns}: {place}, in piece {point.piece}{known}"


def _interval(atlas: Atlas, entry: StableInterval) -> str:
    return f"from {_bound(atlas, entry, 0)} to {_bound(atlas, entry, 1)}{_ranges(atlas, entry.ranges, 'in between ')}"


def _ranges(atlas: Atlas, ranges: Ranges | None, where: str) -> str:
    """Half periods and distances in words."""
    if ranges is None:
        return ""
    words = [f"half period in {interval_text(ranges.half_period, _DIGITS)}"]
    for name, (distance, place) in ranges.distances.items():
        at = f" (at {place} of the orbit on Fix(R))" if place != ALONG else ""
        words.append(f"{name} distance from {atlas.system.distance_name} in {interval_text(distance, _DIGITS)}{at}")
    return f"; {where}{', '.join(words)}"


def _bound(atlas: Atlas, entry: StableInterval, which: int) -> str:
    bound: Bound = (entry.begin, entry.end)[which]
    if bound.point is None:
        return f"{bound.what} (piece {entry.pieces[which]})"
    words = _WORDS.get(bound.what, bound.what).format(level=level_name(atlas))
    level = f"{level_name(atlas)} in {interval_text(bound.point.level, _DIGITS)}"
    return f"{level} (piece {entry.pieces[which]}: {words}{_ranges(atlas, bound.ranges, '')})"


def _gap(gap: Gap) -> str:
    return f"piece {gap.piece}, s in [{float(gap.start):.9g}, {float(gap.end):.9g}], {gap.about}: {gap.reason}"
