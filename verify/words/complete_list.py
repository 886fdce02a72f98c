"""The complete list and the intervals of linear stability in words (section 18.7)."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import shown
from orbitproof.shared.wording import itemised
from orbitproof.verify.claim import atlas_in_words
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
from orbitproof.verify.distances import Ranges, Where
from orbitproof.verify.evidence import decimal_interval, exact_interval_text, exact_text, interval_text
from orbitproof.verify.stability import (
    BAND,
    Bound,
    CompleteList,
    CurveEnd,
    Extremum,
    Found,
    Gap,
    Kind,
    ListAcross,
    ListTheorem,
    Matter,
    Point,
    ProvedList,
    Resonance,
    StableInterval,
    What,
    level_name,
)
from orbitproof.verify.stability.units import is_of_vertical_orbits

_DIGITS, _MOST_DIGITS = 14, 24
_IN_PLANE, _ACROSS = "a stability parameter", "(lambda + 1/lambda)/2"
"""What has the value cos(2 pi j/k)."""

_POINTS = {
    Kind.RESONANCE: "1:{k}, {parameter} is {value}",
    Kind.FOLD: "extremum of {level} along the curve, where a stability parameter is 1",
    Kind.LOSS: "1:1, a stability parameter is 1 and {level} is not stationary: the symmetry R may be lost here",
    Kind.SYMMETRIC: "symmetric point of the curve, where a stability parameter is 1",
    Kind.IN_PLANE: "eps2 is 0, the planar orbit from which those of the curve are born: a stability parameter is 1",
    Kind.HERE: "1:2, a stability parameter is -1, A singular at this point of the orbit on Fix(R)",
    Kind.THERE: "1:2, a stability parameter is -1, A singular at the other point of the orbit on Fix(R)",
    Kind.COLLISION: "Krein collision: two stability parameters are equal",
    Kind.TWO_TO_ONE: "2 omega is omega' or -omega'",
    Kind.THREE_TO_ONE: "3 omega is omega' or -omega'",
    Kind.OPPOSITE: "omega + omega' is pi",
    Kind.UNDECIDED: "1:{k}, {parameter} is {value}, kind not decided",
    Kind.ACROSS_SYMMETRIC: "1:1, a curve of orbits out of the plane, symmetric under R, begins here",
    Kind.ACROSS_AXIAL: ("1:1, a curve of orbits out of the plane, symmetric under R followed by z -> -z, begins here"),
    Kind.ACROSS_DOUBLING: "1:2, {parameter} is -1",
    Kind.TWISTLESS: "no twist",
}
_ENDS = {CurveEnd.BEGINNING: "the beginning of {part}", CurveEnd.END: "the end of {part}"}
_MATTERS = {
    Matter.EVERYTHING: "everything",
    Matter.COLLISION: "equal stability parameters",
    Matter.EXTREMA: "stationary stability parameters",
    Matter.COMBINATIONS: "combination resonances",
    Matter.TWIST: "the twist",
}
_PLACES = {Where.HERE: "this point", Where.THERE: "the other point"}

_A = (
    "A at a point of Fix(R) is the derivative on Fix(R) of the coordinates of P that R fixes, modulo the directions of "
    "the curve and of its image under P."
)
_SCALED = " P is meant here up to the scaling of section {section} that makes {unit} 1 at the other end."
_BLOCK = (
    "At each of these Sigma is one Jordan block. On one side of it along the curve, near it, the two parameters are "
    "real and different, on the other they are not real: there the four multipliers are neither real nor on the unit "
    "circle."
)
_BIRTH = (
    "Where a curve begins, the orbits near this one that are symmetric in that way, start on the fixed points of the "
    "symmetry and meet them again at the corresponding crossing of the section are those in the plane and the orbits "
    "of one smooth curve, which leaves the plane."
)


def list_in_words(theorem: ListTheorem, known: ProvedList) -> str:
    """What is proved of resonances and stability along the curve, and of variations out of its plane."""
    atlas = theorem.curve.atlas
    words = statement(atlas, known.found, known.stable, known.unknown)
    return words if known.across is None else f"{words}\n{statement_across(atlas, known.across)}"


def statement(
    atlas: Atlas, found: CompleteList, stable: Sequence[StableInterval], unknown: Sequence[StableInterval]
) -> str:
    """What is proved of resonances and stability along the curve, or along the half of it that the pieces follow."""
    atlas = atlas_in_words(atlas)
    but = ", but for the places named below," if found.gaps else ""
    where = f"{half(atlas) or 'Along the curve'}{but}"
    listed = [point for point in found.points if point.k]
    value = f"an eigenvalue cos(2 pi j/k), k at most {found.order}"
    if listed:
        result = f"the points with {value}, are exactly these:"
    else:
        result = f"no point has {value}."
    u = "x" if "u" in (*atlas.system.state, *atlas.system.parameters) else "u"
    lines = [f"Hypothesis {hypothesis.name} of the list: {hypothesis.statement}." for hypothesis in found.hypotheses]
    lines.append(
        f"Let Sigma({u}) be the stability matrix of the orbit of {u} on the section, {_held(atlas)}: its eigenvalues "
        f"are the stability parameters (lambda + 1/lambda)/2 of the multipliers lambda. {where} {result}"
    )
    lines += [f"- {point_in_words(atlas, point)}" for point in listed]
    lines += _of_vertical_orbits(atlas, found)
    lines += _of_axial_orbits(atlas)
    if any(point.kind in (Kind.HERE, Kind.THERE) for point in listed):
        lines.append(_A + _scaled(atlas))
    if found.has_few_parameters:
        collisions = [point_in_words(atlas, point) for point in found.points if not point.k]
        lines += itemised(f"{where} two stability parameters are equal at exactly these points:", collisions)
        lines += [_BLOCK] if collisions else []
        lines += _combinations(atlas, found)
        lines += _extrema(atlas, found)
        lines += _stability(atlas, stable, unknown)
    else:
        lines.append(
            f"Nothing is said of where two of the {found.parameters} stability parameters are equal, of their extrema, "
            "and of linear stability."
        )
    lines += itemised("Not covered, so that nothing is said of it:", map(gap_in_words, found.gaps))
    if half(atlas):
        lines.append(
            f"The mirror image of this half under {atlas.claim.symmetry} has the mirror images of these points and "
            "places, with the same values, and its orbits are linearly stable where those of this half are."
            if found.has_few_parameters
            else f"The mirror image of this half under {atlas.claim.symmetry} has the mirror images of these points "
            "and places, with the same values."
        )
    return "\n".join(lines)


def statement_across(atlas: Atlas, across: ListAcross) -> str:
    """What is proved of variations out of the plane."""
    atlas, found = atlas_in_words(atlas), across.found
    but = ", but for the places named below," if found.gaps else ""
    where = half(atlas) or "Along the curve"
    lines = [
        f"Variations of the orbits out of the plane have one more pair of multipliers lambda, 1/lambda. {where}{but} "
        f"(lambda + 1/lambda)/2 is cos(2 pi j/k), k at most {found.order}, "
        + ("exactly here:" if found.points else "nowhere.")
    ]
    for point, value in zip(found.points, across.jacobi_constants, strict=True):
        known = "" if value is None else f"; Jacobi constant in {interval_text(value, _DIGITS)}"
        lines.append(f"- {point_in_words(atlas, point, _ACROSS)}{known}")
    if any(point.kind.is_birth for point in found.points):
        lines.append(_BIRTH)
    stable, unknown = (
        [interval_in_words(atlas, entry, _ACROSS) for entry in entries] for entries in (across.stable, across.unknown)
    )
    lines += itemised(
        f"Between the following points, themselves not included{_ends(across.stable)}, variations out of the plane "
        "are linearly stable (these multipliers are on the unit circle, not 1 or -1), "
        f"{_rest(atlas, across.unknown)}:",
        stable,
    )
    if not (stable or unknown):
        lines.append(f"For no orbit of {part(atlas)} are they linearly stable.")
    lines += itemised("It is not decided whether they are linearly stable at and between these places:", unknown)
    lines += itemised("Not covered, out of the plane:", map(gap_in_words, found.gaps))
    return "\n".join(lines)


def _of_vertical_orbits(atlas: Atlas, found: CompleteList) -> list[str]:
    """What the list of vertical orbits says of their whole period (section 18.14)."""
    if not is_of_vertical_orbits(atlas.system):
        return []
    but = ", but for the places named below," if found.gaps else ""
    return [
        "The multipliers of the whole period 4 T are the lambda^2, its stability parameters 2 c^2 - 1 for the "
        "eigenvalues c of Sigma. So the points at which one of these is cos(2 pi i/m), gcd(i, m) = 1, m at most "
        f"{found.order // 2}, are{but} exactly those of the list with k = 2 m and, if m is odd, those with k = m. In "
        "what follows multipliers are the lambda, and stability parameters the c; of orbits that are called linearly "
        "stable the four lambda^2 are on the unit circle too, without Jordan blocks.",
        "Points with eps2 < 0 stand for no orbit of the three-body problem.",
    ]


def _of_axial_orbits(atlas: Atlas) -> list[str]:
    """What the list of axial orbits is not about (section 18.15)."""
    if not is_of_axial_orbits(atlas.system):
        return []
    births = [
        f" Of the orbits of piece {piece.id}, beyond the end of the curve, nothing is said here."
        for piece in atlas.birth_pieces()
    ]
    return ["Points with eps2 < 0 stand for no orbit of the three-body problem." + "".join(births)]


def _scaled(atlas: Atlas) -> str:
    """Up to what P is meant."""
    if is_of_vertical_orbits(atlas.system):
        return _SCALED.format(section="18.14", unit="u")
    return _SCALED.format(section="18.15", unit="z'") if is_of_axial_orbits(atlas.system) else ""


def half(atlas: Atlas) -> str:
    """Along which half of a curve with a symmetry the list goes; empty for other curves."""
    return {
        "symmetric-arc": "Along the half of the curve from its symmetric point to its last point, both included",
        "symmetric-loop": "Along the half of the curve from its first symmetric point to the second, both included",
    }.get(atlas.claim.kind, "")


def part(atlas: Atlas) -> str:
    """What the list is about."""
    return "this half of the curve" if half(atlas) else "the curve"


def _rest(atlas: Atlas, unknown: Sequence[StableInterval]) -> str:
    """The words that no other orbits are stable."""
    of = " of this half" if half(atlas) else ""
    return f"and of the others{of}, but for the places named below, none are" if unknown else f"and no others{of} are"


def _ends(stable: Sequence[StableInterval]) -> str:
    """The words for ends of the curve that belong to an interval: nothing changes there."""
    bounds = [bound for entry in stable for bound in (entry.begin, entry.end)]
    return " unless they are ends of the curve" if any(map(_is_end, bounds)) else ""


def _is_end(bound: Bound) -> bool:
    """Whether it is an end of the curve and nothing else."""
    return len(bound.what) == 1 and isinstance(bound.what[0], CurveEnd)


def _combinations(atlas: Atlas, found: CompleteList) -> list[str]:
    """Resonances of the two angles of an orbit together."""
    known = found.combinations
    if known is None:
        return ["Combination resonances of two pairs of multipliers are not listed."] if found.parameters == 2 else []
    but = ", but for the places named below," if found.gaps or known.open else ""
    about = (
        f"Let exp(+-i omega) and exp(+-i omega') be the multipliers of a linearly stable orbit of {part(atlas)}{but} "
        "in either order. Modulo 2 pi omega and omega' are in a combination resonance of order 3 or 4 at "
    )
    if not known.points:
        lines = [f"{about}no such orbit."]
    else:
        lines = itemised(f"{about}exactly these:", [point_in_words(atlas, point) for point in known.points])
    return lines + itemised("Whether there are more of these is not decided:", map(gap_in_words, known.open))


def _extrema(atlas: Atlas, found: CompleteList) -> list[str]:
    """The extrema of the stability parameters; symmetric points are extrema by their symmetry."""
    inside, beside = (
        [_extremum(atlas, entry) for entry in found.extrema if entry.in_band is in_band] for in_band in (True, False)
    )
    but = ", but for the places named below" if found.gaps or found.open_extrema or beside else ""
    band = f"with a value between -{exact_text(BAND)} and {exact_text(BAND)}"
    lines = itemised(
        f"Apart from symmetric points a stability parameter is stationary {band} exactly here{but}:", inside
    )
    if not inside:
        lines = [f"Apart from symmetric points no stability parameter is stationary {band}{but}."]
    undecided = "One is stationary here, and it is not decided whether its value is between these or beyond:"
    lines += itemised(undecided, beside)
    return lines + itemised("Whether one is stationary there is not decided:", map(gap_in_words, found.open_extrema))


def _extremum(atlas: Atlas, entry: Extremum) -> str:
    place = f"{level_name(atlas)} in {interval_text(entry.level, _DIGITS)}, in piece {entry.piece}"
    known = f"; shown by the certified orbits {', '.join(map(shown, entry.certificates))}" if entry.certificates else ""
    return f"(lambda + 1/lambda)/2 in {interval_text(entry.value, _MOST_DIGITS)}: {place}{known}"


def _stability(atlas: Atlas, stable: Sequence[StableInterval], unknown: Sequence[StableInterval]) -> list[str]:
    if not (stable or unknown):
        return [f"No orbit of {part(atlas)} is linearly stable with distinct multipliers."]
    between = (
        f"The orbits between the following points, themselves not included{_ends(stable)}, are linearly stable "
        f"(these multipliers are on the unit circle, distinct and not 1 or -1), {_rest(atlas, unknown)}:"
    )
    undecided = "It is not decided whether the orbits are linearly stable at and between these places:"
    return [
        *itemised(between, (interval_in_words(atlas, entry) for entry in stable)),
        *itemised(undecided, (interval_in_words(atlas, entry) for entry in unknown)),
    ]


def _held(atlas: Atlas) -> str:
    if is_of_vertical_orbits(atlas.system):
        return (
            "on its level of the Jacobi constant, after half its period, 2 T, followed by z -> -z (at eps2 = 0 the "
            "limit of that)"
        )
    if is_of_axial_orbits(atlas.system):
        return "on its level of the Jacobi constant, after its period, 2 T (at eps2 = 0 the limit of that)"
    if atlas.system.normalised:
        return f"in the plane and on its level of the Jacobi constant (at {level_name(atlas)} = 0 the limit of that)"
    if atlas.system.fixed_level is not None:
        return f"{level_name(atlas)} and the level held fixed"
    if atlas.system.family_parameter is not None:
        return f"{level_name(atlas)} held fixed"
    return f"on its level of the {level_name(atlas)}"


def _words(atlas: Atlas, what: What, parameter: str) -> str:
    """What is at a point, or not known at a place."""
    match what:
        case Found():
            value = _value(what.k, what.j)
            return _POINTS[what.kind].format(level=level_name(atlas), k=what.k, parameter=parameter, value=value)
        case Resonance():
            return f"where {parameter} is {_value(what.k, what.j)}"
        case CurveEnd():
            return _ENDS[what].format(part=part(atlas))
    return _MATTERS[what]


def _value(k: int, j: int) -> str:
    """cos(2 pi j/k)."""
    return {1: "1", 2: "-1"}.get(k, f"cos(2 pi {j}/{k})")


def point_in_words(atlas: Atlas, point: Point, parameter: str = _IN_PLANE) -> str:
    place = (
        f"{level_name(atlas)} in {interval_text(point.level, _DIGITS)}, {_time(atlas)} in "
        f"{decimal_interval(point.half_period, 10)}"
    )
    known = f"; certified: {', '.join(map(shown, point.certificates))}" if point.certificates else ""
    return f"{_words(atlas, point.found, parameter)}: {place}, in piece {point.piece}{known}"


def interval_in_words(atlas: Atlas, entry: StableInterval, parameter: str = _IN_PLANE) -> str:
    begin, end = (_bound(atlas, entry, which, parameter) for which in (0, 1))
    return f"from {begin} to {end}{_ranges(atlas, entry.ranges, 'in between ')}"


def _time(atlas: Atlas) -> str:
    """What the time of the return is."""
    return "quarter T of the period" if is_of_vertical_orbits(atlas.system) else "half period"


def _ranges(atlas: Atlas, ranges: Ranges | None, where: str) -> str:
    """Half periods and distances in words."""
    if ranges is None:
        return ""
    words = [f"{_time(atlas)} in {interval_text(ranges.half_period, _DIGITS)}"]
    for name, (distance, place) in ranges.distances.items():
        at = f" (at {_PLACES[place]} of the orbit on Fix(R))" if place in _PLACES else ""
        words.append(f"{name} distance from {atlas.system.distance_name} in {interval_text(distance, _DIGITS)}{at}")
    return f"; {where}{', '.join(words)}"


def _bound(atlas: Atlas, entry: StableInterval, which: int, parameter: str) -> str:
    bound: Bound = (entry.begin, entry.end)[which]
    words = ", ".join(
        f"{'not covered: ' if isinstance(what, (Resonance, Matter)) else ''}{_words(atlas, what, parameter)}"
        for what in bound.what
    )
    if _is_end(bound):
        return f"{words} (piece {entry.pieces[which]})"
    if bound.point is None:
        return f"s in {exact_interval_text(bound.lower, bound.upper)} (piece {entry.pieces[which]}: {words})"
    level = f"{level_name(atlas)} in {interval_text(bound.point.level, _DIGITS)}"
    return f"{level} (piece {entry.pieces[which]}: {words}{_ranges(atlas, bound.ranges, '')})"


def gap_in_words(gap: Gap) -> str:
    subject = gap.subject
    what = f"k = {subject.k}, j = {subject.j}" if isinstance(subject, Resonance) else _MATTERS[subject]
    return f"piece {gap.piece}, s in {exact_interval_text(gap.start, gap.end)}, {what}: {gap.reason}"
