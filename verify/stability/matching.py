"""Certified bifurcations on a curve and the points of its complete list (section 18.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from orbitproof.shared.formats import FOLD, KREIN_COLLISION, REVERSOR_BREAKING, Atlas
from orbitproof.shared.systems import CR3BP_PLANAR, shown
from orbitproof.verify.curve import Bifurcation
from orbitproof.verify.curve.piece_claim import is_of_axial_orbits
from orbitproof.verify.evidence import EmptyIntersectionError, enclose, is_below
from orbitproof.verify.stability.kinds import Kind, Matter, Resonance, name_of
from orbitproof.verify.stability.list_entries import Gap, Point
from orbitproof.verify.stability.units import is_of_vertical_orbits

_KINDS = {
    FOLD: (Kind.FOLD,), "symmetry_breaking": (Kind.SYMMETRIC, Kind.IN_PLANE), REVERSOR_BREAKING: (Kind.LOSS,),
}  # fmt: skip
"""What is found where a bifurcation of a kind is certified, for k = 1, and a stability parameter is 1."""


def about_the_list(atlas: Atlas, bifurcations: Sequence[Bifurcation], order: int) -> list[Bifurcation]:
    """The bifurcations that have to be in the list; births on a planar family lead out of the plane (18.11).

    In units of the orbit these are the certified losses of R on vertical families alone (18.14), and births of axial
    orbits in the plane (18.15).
    """
    if is_of_axial_orbits(atlas.system):
        return [entry for entry in bifurcations if entry.breaks_symmetry]
    if is_of_vertical_orbits(atlas.system):
        return [entry for entry in bifurcations if entry.loses_reversor]
    return [
        entry
        for entry in bifurcations
        if entry.k <= order
        and not entry.is_of_orbit
        and not atlas.system.normalised
        and not (atlas.system is CR3BP_PLANAR and entry.breaks_symmetry)
    ]


def with_certificates(
    points: Sequence[Point], gaps: Sequence[Gap], bifurcations: Sequence[Bifurcation], halved: bool = False
) -> tuple[Point, ...]:
    """The points with the certificates that are about them (section 18.5).

    `halved` says that multipliers of the list are square roots of those over the whole period (18.14).
    """
    result = list(points)
    for entry in bifurcations:
        place = entry.place
        if place is None:
            continue
        here = [
            index
            for index, point in enumerate(result)
            if _is_of(entry, point.kind, point.k, halved) and point.piece == place.piece and point.s.overlaps(place.s)
        ]
        is_open = any(_may_hide(gap, entry, place.piece, place.s, halved) for gap in gaps)
        if len(here) == 1 and not is_open:
            found = result[here[0]]
            if not halved and found.kind is (Kind.HERE if place.other_point else Kind.THERE):
                names = "certified at one point of the orbit, found at the other"
                raise EmptyIntersectionError(f"{shown(entry.id)} is {names}")
            known = found.kind in (Kind.FOLD, Kind.LOSS, Kind.SYMMETRIC, Kind.IN_PLANE)
            if known and found.kind not in _KINDS.get(entry.kind, ()):
                names = f"certified as a {entry.kind}, found is: {name_of(found.kind)}"
                raise EmptyIntersectionError(f"{shown(entry.id)} is {names}")
            result[here[0]] = replace(found, certificates=(*found.certificates, entry.id))
        elif not here and not is_open:
            names = "certified on the curve, but is no zero of its characteristic"
            raise EmptyIntersectionError(f"{shown(entry.id)} is {names}")
    return tuple(result)


def _is_of(entry: Bifurcation, kind: Kind, k: int, halved: bool) -> bool:
    """Whether a point of the list is a zero of the function that vanishes at a certified one."""
    if entry.kind == KREIN_COLLISION:
        return kind is Kind.COLLISION
    # A square root of 1 is 1 or -1.
    return k in ((1, 2) if halved else (entry.k,))


def _may_hide(gap: Gap, entry: Bifurcation, piece: str, s: arb, halved: bool) -> bool:
    """Whether the certified point at s may be one that is not listed."""
    if entry.kind == KREIN_COLLISION:
        is_about = gap.subject in (Matter.EVERYTHING, Matter.COLLISION)
    else:
        is_resonance = isinstance(gap.subject, Resonance) and gap.subject.k in ((1, 2) if halved else (entry.k,))
        is_about = gap.subject is Matter.EVERYTHING or is_resonance
    beside = is_below(s, enclose(gap.start)) or is_below(enclose(gap.end), s)
    return is_about and gap.piece == piece and not beside
