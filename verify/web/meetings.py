"""When an arc meets a vertex, and how (section 33.2)."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.shared.claims.web import BRANCHES, ENDS, LIBRATION_POINTS, PASSES, How, Meeting
from orbitproof.shared.systems import LIFTED
from orbitproof.verify.curve import PlaceOnCurve, is_at_birth, is_inside_curve
from orbitproof.verify.web.arc import Arc, libration_vertex


@dataclass(frozen=True)
class Incidence:
    """An arc meets a vertex.

    Attributes:
        arc, vertex: their ids.
        how: as in the claim.
        place: of the vertex's orbit on the arc; `None` for a libration point.
    """

    arc: str
    vertex: str
    how: How
    place: PlaceOnCurve | None


def meeting_shown(arc: Arc, meeting: Meeting) -> Incidence | str:
    """The meeting of a proved arc with a vertex if it is as claimed, or why that is not shown (Lemma 33.2)."""
    if meeting.vertex in LIBRATION_POINTS or meeting.how == ENDS:
        if meeting.how != ENDS or meeting.vertex not in LIBRATION_POINTS:
            return "arcs end at libration points, and at nothing else"
        if libration_vertex(arc) != meeting.vertex:
            return f"it is not proved to be the family that shrinks to {meeting.vertex}"
        return Incidence(arc.id, meeting.vertex, meeting.how, None)
    entry = arc.placed.get(meeting.vertex)
    if entry is None or entry.place is None:
        return "its certificate was not looked for" if entry is None else entry.reason
    if arc.atlas.system is LIFTED or is_at_birth(arc.atlas, entry.place):
        if meeting.how != BRANCHES:
            return "the orbits of the arc are born there: it branches off"
        return Incidence(arc.id, meeting.vertex, meeting.how, entry.place)
    is_symmetric = _is_symmetric_point(arc, entry.place)
    if meeting.how == BRANCHES:
        if not is_symmetric:
            return (
                "it is an orbit of the arc, but no symmetric point of it, where the arc would leave the symmetric ones"
            )
    elif meeting.how != PASSES:
        return "there is no such way to meet"
    elif is_symmetric:
        return "it is the symmetric point of the arc, which branches off there"
    elif arc.curve is None or not is_inside_curve(arc.atlas, arc.curve.chain, entry.place):
        return "it is not shown to lie before the end of the arc"
    return Incidence(arc.id, meeting.vertex, meeting.how, entry.place)


def _is_symmetric_point(arc: Arc, place: PlaceOnCurve) -> bool:
    """Whether the place is a point of the curve that its symmetry fixes: s = 0 of a symmetric piece (15.8)."""
    symmetric = {piece.id for piece in arc.atlas.curve_pieces() if piece.is_symmetric}
    return place.piece in symmetric and place.s.is_zero() and not place.other_point
