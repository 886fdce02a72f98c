"""The theorem about a proved curve in words (sections 15.9, 16.4 and 16.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import HILL_VARIED, LIFTED, ReversibleSystem, shown
from orbitproof.shared.wording import itemised
from orbitproof.verify.claim import atlas_in_words, keyed_in_words, names_in_words, sheet_in_words, signs_on
from orbitproof.verify.curve import (
    Bifurcation,
    Birth,
    CurveTheorem,
    Ends,
    ProvedCurve,
    is_at_birth,
    point_name,
    vertical_point,
)
from orbitproof.verify.evidence import decimal_interval, exact_text, interval_text, range_text

_DIGITS = 18


def curve_in_words(theorem: CurveTheorem, curve: ProvedCurve) -> str:
    """What is proved of the curve, without the bifurcations on it."""
    ends = {key: keyed_in_words(theorem.atlas.system, point) for key, point in curve.ends.items()}
    atlas, half_period = atlas_in_words(theorem.atlas), curve.half_period
    paragraphs = [f"{_setting(atlas)}{_libration_units(atlas, curve.x_l)}", _curve(atlas, ends)]
    claim = atlas.claim
    if claim.increasing:
        paragraphs.append(_increasing(atlas, ends))
    if claim.covers is not None:
        covers = claim.covers
        paragraphs.append(
            f"Along it {covers.coordinate} takes all values from {exact_text(covers.start)} to "
            f"{exact_text(covers.end)}."
        )
    further = meaning(atlas)
    if further:
        paragraphs.append(further)
    if half_period.is_finite():
        said = "All these T" if times_are_of_quarters(atlas.system) else "All half periods"
        paragraphs.append(f"{said} lie in {range_text(half_period, 4)}.")
    # What is said of all half periods is about the points of the curve alone.
    if curve.birth is not None:
        paragraphs.append(_birth(atlas, curve.birth))
    return "\n".join(paragraphs)


def times_are_of_quarters(system: ReversibleSystem) -> bool:
    """Whether half orbits are quarters of the system's periodic orbits: of their times T it is said what they are."""
    return system.arrival is not None or vertical_point(system) is not None


def bifurcations_in_words(atlas: Atlas, bifurcations: Sequence[Bifurcation]) -> str:
    """Which of the certified bifurcations and orbits lie on the curve, and which are not shown to."""
    placed = [entry for entry in bifurcations if entry.place is not None]
    on, orbits = ([entry for entry in placed if entry.is_of_orbit is orbit] for orbit in (False, True))
    off = [entry for entry in bifurcations if entry.place is None and not entry.is_foreign]
    foreign = sum(entry.is_foreign for entry in bifurcations)
    lines = [
        *itemised("Of the certified bifurcations these lie on it:", (_bifurcation(atlas, entry) for entry in on)),
        *itemised("Of the certified orbits these lie on it:", (_bifurcation(atlas, entry) for entry in orbits)),
        *itemised(
            "Of these it is not shown that they lie on it:",
            (f"{shown(entry.id)} (k = {entry.k}): {entry.reason}" for entry in off),
        ),
    ]
    if foreign:
        were = "certificate is" if foreign == 1 else "certificates are"
        lines.append(
            f"{foreign} further {were} about another system, section, reversing symmetry or level, about other "
            "parameters, or not readable here."
        )
    return "\n".join(lines)


def _setting(atlas: Atlas) -> str:
    system = atlas.system
    values = ", ".join(f"{name} = {exact_text(value)}" for name, value in atlas.parameters.items())
    with_values = f" with {values}" if values else ""
    m = atlas.claim.crossings
    power = "the map P" if m == 1 else f"P = Q^{m}, Q the map"
    return (
        f"Consider the {system.title}{with_values}, and {power} to the next crossing of the section "
        f"{{{system.section} = 0}}.{_level(system)}"
    )


def _level(system: ReversibleSystem) -> str:
    """On which level of the first integral the curve lies, if it is a fixed one."""
    fixed = system.fixed_level
    if fixed is None:
        return ""
    level = f"{system.first_integral_name or 'H'} = {exact_text(fixed.value)}"
    return f" All orbits are on the level {level}, and the points of the curve have {sheet_in_words(system)}."


def _curve(atlas: Atlas, ends: Ends) -> str:
    claim = atlas.claim
    coordinates = ", ".join(atlas.system.centre_coordinates)
    orbits = "each of its points is the initial condition of an R-symmetric periodic orbit, P^2(x) = x"
    if atlas.system.arrival is not None:
        turn = atlas.system.arrival
        orbits = f"P leads each of its points x to the fixed set of R {turn}, so that P^2(x) = {turn} x and P^4(x) = x"
    if claim.crossings > 1:
        orbits += f", and the half orbits from Fix(R) to Fix(R) meet the section {claim.crossings} times"
    where = f"in the coordinates ({coordinates}) of Fix(R)"
    first, last = _point(ends["start"]), _point(ends["end"])
    fixed = f"Fix({claim.symmetry})"
    if claim.is_arc:
        simple = " without self-intersections" if claim.increasing else ""
        return f"There is a smooth curve{simple} {where} from {first} to {last}; {orbits}."
    if claim.goes_round:
        return f"There is a smooth closed curve without self-intersections {where}, through {first}; {orbits}."
    if not claim.is_closed:
        return (
            f"There is a smooth curve without self-intersections {where}, mapped to itself by {claim.symmetry}; "
            f"{orbits}. It meets {fixed} in exactly one point, {first}, and leads from there to {last} and to the "
            f"mirror image of this point."
        )
    return (
        f"There is a smooth closed curve without self-intersections {where}, mapped to itself by {claim.symmetry}; "
        f"{orbits}. It meets {fixed} in exactly two points, {first} and {last}."
    )


def _increasing(atlas: Atlas, ends: Ends) -> str:
    claim = atlas.claim
    if claim.is_of_symmetric_curve and claim.is_closed:
        return f"From the first of these points to the second, along the half of the pieces: {_grow(claim.increasing)}."
    if not claim.is_of_symmetric_curve:
        return f"Along it {_grow(claim.increasing)}."
    names = atlas.system.centre_coordinates
    signs = dict(zip(names, signs_on(atlas.system, str(claim.symmetry), names), strict=True))
    negated = [name for name in claim.increasing if signs[name] == -1]
    fixed = [name for name in claim.increasing if signs[name] == 1]
    sentences = [f"From end to end {_grow(negated)}."] if negated else []
    if fixed:
        minima = ", ".join(f"the minimum of {name}, in {interval_text(ends['start'][name], _DIGITS)}" for name in fixed)
        sentences.append(f"From its symmetric point to either end {_grow(fixed)}; at that point is {minima}.")
    return " ".join(sentences)


def _grow(names: Sequence[str]) -> str:
    return f"{' and '.join(names)} {'increases' if len(names) == 1 else 'increase'} strictly"


def _bifurcation(atlas: Atlas, entry: Bifurcation) -> str:
    what = {
        "symmetry_breaking": "symmetry breaking",
        "period_tupling": f"period {entry.k}-tupling",
        "touch_and_go": f"touch-and-go of order {entry.k}",
        "krein_collision": "Krein collision",
        "reversor_breaking": "loss of R",
    }.get(entry.kind, entry.kind.replace("_", " "))
    assert entry.place is not None
    # Of a first integral it is a title.
    own = names_in_words(atlas.system) if entry.parameter_name == atlas.system.family_parameter else {}
    name = own.get(entry.parameter_name, entry.parameter_name)
    value = "" if entry.parameter is None else f", {name} in {interval_text(entry.parameter, _DIGITS)}"
    # On a regular piece s = 0 is a point like any other.
    symmetric = {piece.id for piece in atlas.curve_pieces() if piece.is_symmetric}
    where = "at the symmetric point of" if entry.place.s.is_zero() and entry.place.piece in symmetric else "in"
    which = "the other point of the orbit on Fix(R), " if entry.place.other_point else ""
    mirror = " (its mirror image)" if entry.place.mirrored else ""
    if atlas.system is LIFTED or is_at_birth(atlas, entry.place):
        return f"{shown(entry.id)}: {what}{value}, at which the orbits of piece {entry.place.piece} are born{mirror}"
    return f"{shown(entry.id)}: {what}{value}, {which}{where} piece {entry.place.piece}{mirror}"


def _point(coordinates: Mapping[str, arb]) -> str:
    return "(" + ", ".join(interval_text(ball, _DIGITS) for ball in coordinates.values()) + ")"


_SIDES = {
    "L1": ("between the primaries", "(1 - mu)/(X + mu)^2 - mu/(X - 1 + mu)^2"),
    "L2": ("beyond the smaller primary", "(1 - mu)/(X + mu)^2 + mu/(X - 1 + mu)^2"),
    "L3": ("beyond the larger primary", "-(1 - mu)/(X + mu)^2 - mu/(X - 1 + mu)^2"),
}
"""Where the libration point lies on the axis, and what X is there."""

_SHOWN_DIGITS = 20


def _libration_units(atlas: Atlas, x_l: arb | None) -> str:
    """A sentence on the units of a system around a libration point; empty for other systems."""
    planar, vertical = point_name(atlas.system), vertical_point(atlas.system)
    name = planar or vertical
    if atlas.system is LIFTED:
        return (
            " Its coordinates are those of the three-body problem with primaries at -mu and 1 - mu but for Z = eps z, "
            "eps^2 = eps2, R is the half turn about the x axis, and (eps2, x, vy) stands for the initial point x, y = "
            "z = 0, x' = 0, y' = vy, z' = 1."
        )
    if atlas.system is HILL_VARIED:
        return (
            " (xi, eta, zeta) is the position relative to the smaller primary in units of h = mu^(1/3), and (dxi, .., "
            "dvzeta) a solution of the equations linearised along the orbit, of which V changes the sign and which "
            "begins with dveta = 1."
        )
    if name is None or x_l is None:
        return ""
    side, force = _SIDES[name]
    if vertical is not None:
        return (
            f" In its coordinates X = x_l + eps2 x, Y = eps2 y, Z = eps z of the three-body problem with primaries at "
            f"-mu and 1 - mu, eps^2 = eps2, u = z^2, v = z z', w = z'^2, x_l is the only root X of X = {force} {side}, "
            f"in {decimal_interval(x_l, _SHOWN_DIGITS)}, and (eps2, x, vy) stands for the initial point x, y = "
            f"x' = 0, y' = vy, z = 0, z' = 1."
        )
    return (
        f" In its coordinates X = x_l + eps x, Y = eps y of the three-body problem with primaries at -mu and 1 - mu, "
        f"x_l is the only root X of X = {force} {side}, in {decimal_interval(x_l, _SHOWN_DIGITS)}, and (eps, vy) "
        f"stands for the initial point x = 1, y = 0, x' = 0, y' = vy."
    )


def meaning(atlas: Atlas) -> str:
    """What a proved curve around a libration point says about the CR3BP; empty if it says nothing more.

    Theorem 16.3: eps increases along the curve and takes values on an interval that contains 0. Of vertical orbits:
    Theorem 16.6.
    """
    if vertical_point(atlas.system) is not None:
        return _vertical_meaning(str(vertical_point(atlas.system)))
    if atlas.system is LIFTED:
        return (
            "For eps2 > 0 the orbit of the circular restricted three-body problem through (x, 0, 0) with the velocity "
            "(0, vy, eps) is periodic and symmetric under the half turn about the x axis; after half its period it is "
            "on the axis again, and in the plane Z = 0 for the first time. At eps2 = 0 the orbit is planar, twice the "
            "time T after which it is on the axis again is a period, and the variation out of the plane that is 0 at "
            "the beginning is 0 at T again, for the first time."
        )
    if atlas.system is HILL_VARIED:
        covers = atlas.claim.covers
        with_hill = covers is not None and covers.coordinate == "h" and covers.start <= 0 <= covers.end
        return (
            "For h > 0 let mu = h^3, and T the time of the first return. The orbit of the circular restricted "
            "three-body problem with primaries at -mu and 1 - mu through (1 - mu + h xi, 0, h zeta) with the velocity "
            "(0, h veta, 0) is symmetric under R, does not lie in the plane of the primaries, and has the least period "
            "2 T and the multiplier -1: along this period the variation (dxi, dzeta, dveta) becomes its opposite. At "
            "this mass the points of Fix(R) near its own whose first return is in Fix(R) are a smooth curve, and the "
            "others whose second return is there are on a second smooth curve through it, in the direction of the "
            "variation: there R-symmetric periodic orbits of about twice the period branch off from that family."
            + (" At h = 0 all this holds of Hill's problem." if with_hill else "")
        )
    name, covers = point_name(atlas.system), atlas.claim.covers
    if name is None or covers is None or "eps" not in atlas.claim.increasing:
        return ""
    text = (
        "For eps other than 0 the orbit of (eps, vy) is the planar R-symmetric orbit of the circular restricted "
        "three-body problem through X = x_l + eps, Y' = eps vy on the axis, with the same half period."
    )
    if covers.coordinate != "eps" or not covers.start <= 0 <= covers.end:
        return text
    return (
        f"{text} At eps = 0 it is the orbit of the linear centre, so the curve is the planar Lyapunov family that "
        f"emanates from {name}."
    )


def _birth(atlas: Atlas, birth: Birth) -> str:
    """How the curve goes on to where its orbits are born (Theorems 16.12 and 16.16)."""
    piece = birth.tube.piece
    if atlas.system is not LIFTED:
        return (
            f"From one of its orbits the curve of orbits goes on, in piece {piece.id}, to an R-symmetric periodic "
            "orbit whose half orbits meet the section once, and which has the multiplier -1: each orbit on the way is "
            "periodic and symmetric under R, and its half orbits meet the section twice, first off Fix(R). The least "
            "periods of these tend to twice that of the last orbit."
        )
    return (
        f"From its end the curve of orbits goes on, in piece {piece.id}, to a periodic orbit that z -> -z maps to "
        "itself, shifted by half its period, and that is symmetric under R and under the half turn about the x axis: "
        "each orbit on the way is periodic and symmetric under the half turn, and z -> -z maps it to another one."
    )


def _vertical_meaning(name: str) -> str:
    return (
        "For eps2 > 0 let T be the time of the first return. The orbit of the circular restricted three-body problem "
        "through X = x_l + eps2 x, Y' = eps2 vy, Z' = eps on the axis, at right angles to it, is periodic with the "
        "least period 4 T and symmetric under R and under the half turn about the x axis: after the time T it meets "
        "the plane Y = 0 at right angles, for the first time, off the axis, and z -> -z shifts it by the time 2 T. For "
        "eps2 -> 0 "
        f"it shrinks to {name}, and 4 T tends to the period of the linear oscillation across the plane there, "
        "2 pi/((1 - mu)/|x_l + mu|^3 + mu/|x_l - 1 + mu|^3)^(1/2): "
        f"it belongs to the vertical family that emanates from {name}."
    )
