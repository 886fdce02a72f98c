"""Certified bifurcations on a curve and the points of its complete list (section 18.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb

from orbitproof.shared.formats import ORBIT, Atlas
from orbitproof.verify.curve import Bifurcation
from orbitproof.verify.evidence import EmptyIntersectionError, enclose, is_below
from orbitproof.verify.stability.places import FOLD, HERE, LOSS, SYMMETRIC, THERE, Gap, Point

_KINDS = {"fold": FOLD, "symmetry_breaking": SYMMETRIC}
"""What is found where a bifurcation of a kind is certified, for k = 1."""


def about_the_list(atlas: Atlas, bifurcations: Sequence[Bifurcation], order: int) -> list[Bifurcation]:
    """The bifurcations that have to be in the list; those on a planar family lead out of the plane (section 18.9)."""
    return [entry for entry in bifurcations if entry.k <= order and entry.kind != ORBIT and not atlas.system.normalised]


def with_certificates(
    points: Sequence[Point], gaps: Sequence[Gap], bifurcations: Sequence[Bifurcation]
) -> tuple[Point, ...]:
    """The points with the certificates that are about them (section 18.5)."""
    result = list(points)
    for entry in bifurcations:
        place = entry.place
        if place is None:
            continue
        here = [
            index
            for index, point in enumerate(result)
            if point.k == entry.k and point.piece == place.piece and point.s.overlaps(place.s)
        ]
        if len(here) == 1:
            found = result[here[0]]
            if found.kind == (HERE if place.other_point else THERE):
                raise EmptyIntersectionError(f"{entry.id} is certified at one point of the orbit, found at the other")
            if found.kind in (FOLD, LOSS, SYMMETRIC) and found.kind != _KINDS.get(entry.kind):
                raise EmptyIntersectionError(f"{entry.id} is certified as a {entry.kind}, found is: {found.kind}")
            result[here[0]] = replace(found, certificates=(*found.certificates, entry.id))
        elif not here and not _in_gap(place.piece, place.s, gaps):
            raise EmptyIntersectionError(f"{entry.id} is certified on the curve, but is no zero of its characteristic")
    return tuple(result)


def _in_gap(piece: str, s: arb, gaps: Sequence[Gap]) -> bool:
    return any(
        gap.piece == piece and not is_below(s, enclose(gap.start)) and not is_below(enclose(gap.end), s) for gap in gaps
    )
