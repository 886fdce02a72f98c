"""The theorem about a web: proved curves that meet in certified orbits (section 33)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from flint import arb, ctx

from orbitproof.shared.claims.parts import hanging_together
from orbitproof.shared.claims.web import BRANCHES, LIBRATION_POINTS, PASSES, Web
from orbitproof.shared.systems import shown
from orbitproof.verify.curve import CURVE_PRECISION, is_planar
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    excludes_zero,
    meet,
)
from orbitproof.verify.web.arc import Arc, level_at
from orbitproof.verify.web.indices import Indices
from orbitproof.verify.web.meetings import Incidence, meeting_shown

LIBRATION_POINT = "libration_point"
"""The kind of a vertex that is one."""


@dataclass(frozen=True)
class WebTheorem:
    """The arcs of a web are proved curves that meet its vertices as it says (Theorem 33.5)."""

    web: Web

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        connected = ("connected",) if self.web.connected else ()
        return ("arcs", "equations", "meetings", "vertices", *connected, *(("indices",) if self.web.indices else ()))


@dataclass(frozen=True)
class Vertex:
    """A vertex: a certified orbit or a libration point.

    Attributes:
        id: of its certificate, or the name of the libration point.
        kind, k: of its certificate; "libration_point", 1.
        level: of the orbit, enclosed.
    """

    id: str
    kind: str
    k: int
    level: arb


@dataclass(frozen=True)
class KnownArc:
    """What a web says of an arc besides how it meets vertices.

    Attributes:
        arc: its curve.
        level: a ball with the levels of all its orbits; not finite if they are not enclosed.
        period: a ball with the periods, from a point of the curve back to it; likewise.
        indices: what is known of the index of its orbits, if that is claimed (Lemma 33.6).
    """

    arc: Arc
    level: arb
    period: arb
    indices: Indices | None = None


@dataclass(frozen=True)
class Switch:
    """At a symmetry breaking one arc leads out of the symmetric orbits of another (Lemma 33.3); ids."""

    vertex: str
    along: str
    onto: str


@dataclass(frozen=True)
class ProvedWeb:
    """What is known of a proved web.

    Attributes:
        arcs, vertices: in the order of the claim.
        incidences: all meetings, in that order.
        switches: where it is shown that one arc branches off from another.
        parts: the ids of arcs that hang together.
    """

    arcs: tuple[KnownArc, ...]
    vertices: tuple[Vertex, ...]
    incidences: tuple[Incidence, ...]
    switches: tuple[Switch, ...]
    parts: tuple[tuple[str, ...], ...]


def conclude_web(web: Web, arcs: Sequence[Arc]) -> Outcome[ProvedWeb]:
    """The theorem about a web, or the first hypothesis that is not shown.

    `arcs` are those of the claim, in its order, with the vertices that they are claimed to meet looked for.
    """
    checklist = Checklist()
    with ctx.workprec(CURVE_PRECISION):
        try:
            _check_arcs(checklist, web, arcs)
            _check_equations(checklist, arcs)
            found = _check_meetings(checklist, web, arcs)
            vertices = _check_vertices(checklist, web, arcs, found)
            parts = parts_of(web)
            if web.connected:
                statement = "any two arcs are joined by arcs that follow one another in common vertices"
                remedy = "name the vertices in which arcs meet, or do not claim it: connected = false"
                with checklist.hypothesis("connected", "33.4", statement, remedy) as evidence:
                    names = "; ".join(", ".join(map(shown, part)) for part in parts)
                    evidence.require(len(parts) == 1, f"these hang together, and no more is shown: {names}")
            indices = _check_indices(checklist, web, arcs)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        known = tuple(
            KnownArc(arc, arc.levels(), arc.period, indices.get(arc.id)) for arc in arcs if arc.curve is not None
        )
    results = ProvedWeb(known, vertices, found, _switches(arcs, found), parts)
    return Proved(WebTheorem(web), results, tuple(checklist.hypotheses))


def _check_arcs(checklist: Checklist, web: Web, arcs: Sequence[Arc]) -> None:
    statement = "every arc is a proved curve of symmetric periodic orbits, and no two have a piece in common"
    with checklist.hypothesis("arcs", "33.1", statement, "prove the curve, and give each once") as evidence:
        names = [arc.id for arc in arcs]
        evidence.require(names == [arc.id for arc in web.arcs], "they are not those of the claim")
        evidence.require(len(set(names)) == len(names), "two arcs have the same id")
        for arc in arcs:
            ordinary = arc.atlas.system.arrival is None
            evidence.require(ordinary, f"{shown(arc.id)}: its points are orbits with a variation; leave it out")
            proved = arc.curve is not None and not arc.problem
            evidence.require(proved, f"{shown(arc.id)}: {arc.problem or 'it is not proved'}")
        own = [
            {(arc.setting, piece.centre, piece.frame, piece.polynomial) for piece in arc.atlas.curve_pieces()}
            for arc in arcs
        ]
        different = len(set().union(*own)) == sum(map(len, own))
        evidence.require(different, "two arcs have a piece in common")


def _check_equations(checklist: Checklist, arcs: Sequence[Arc]) -> None:
    statement = "all arcs are about the same equations, with the same parameters"
    with checklist.hypothesis("equations", "33.1", statement, "give arcs of one system with one mass") as evidence:
        first = arcs[0]
        evidence.require(True, "")
        for arc in arcs[1:]:
            both = f"{shown(arc.id)} and {shown(first.id)}"
            evidence.require(arc.equations == first.equations, f"{both} are about different equations")
            same = dict(arc.atlas.parameters) == dict(first.atlas.parameters)
            evidence.require(same, f"{both} have different parameters")


def _check_meetings(checklist: Checklist, web: Web, arcs: Sequence[Arc]) -> tuple[Incidence, ...]:
    statement = "every arc meets its vertices as claimed"
    found: list[Incidence] = []
    with checklist.hypothesis(
        "meetings", "33.2", statement, "correct the claim, or let the arc reach further"
    ) as evidence:
        evidence.require(True, "")
        for arc, claimed in zip(arcs, web.arcs, strict=True):
            for meeting in claimed.meets:
                incidence = meeting_shown(arc, meeting)
                pair = f"that {shown(arc.id)} {meeting.how} {shown(meeting.vertex)}"
                if isinstance(incidence, str):
                    evidence.require(False, f"it is not shown {pair}: {incidence}")
                    continue
                found.append(incidence)
                if incidence.place is not None:
                    evidence.record(f"{shown(arc.id)}, s of {shown(meeting.vertex)}", incidence.place.s)
    return tuple(found)


def _check_vertices(
    checklist: Checklist, web: Web, arcs: Sequence[Arc], found: Sequence[Incidence]
) -> tuple[Vertex, ...]:
    by_id = {arc.id: arc for arc in arcs}
    statement = "the vertices are different orbits, or libration points: their levels are different"
    vertices: dict[str, Vertex] = {}
    with checklist.hypothesis("vertices", "33.3", statement, "name each orbit once, by one certificate") as evidence:
        evidence.require(True, "")
        for incidence in found:
            vertex, arc = _vertex(incidence, by_id[incidence.arc]), by_id[incidence.arc]
            before = vertices.get(vertex.id)
            if before is not None:
                same = (before.kind, before.k) == (vertex.kind, vertex.k)
                evidence.require(same, f"{shown(arc.id)} meets another vertex called {shown(vertex.id)}")
                vertex = Vertex(vertex.id, vertex.kind, vertex.k, meet(before.level, vertex.level))
            vertices[vertex.id] = vertex
        for vertex in vertices.values():
            if vertex.level.is_finite():
                evidence.record(f"level of {shown(vertex.id)}", vertex.level)
            else:
                evidence.require(False, f"the level of {shown(vertex.id)} is not known")
        for one, other in combinations(vertices.values(), 2):
            different = excludes_zero(one.level - other.level)
            evidence.require(different, f"{shown(one.id)} and {shown(other.id)} may be the same orbit")
    return tuple(vertices[name] for name in web.vertices if name in vertices)


def _vertex(incidence: Incidence, arc: Arc) -> Vertex:
    if incidence.vertex in LIBRATION_POINTS:
        at_rest = {name: arb(0) for name in arc.atlas.system.centre_coordinates}
        return Vertex(incidence.vertex, LIBRATION_POINT, 1, level_at(arc.atlas, at_rest))
    entry = arc.placed[incidence.vertex]
    return Vertex(entry.id, entry.kind, entry.k, level_at(arc.atlas, entry.point))


def _check_indices(checklist: Checklist, web: Web, arcs: Sequence[Arc]) -> dict[str, Indices]:
    """What is known of the indices that are claimed, by arc; nothing of others."""
    found: dict[str, Indices] = {}
    if not web.indices:
        return found
    statement = "the index along these arcs is proved, of the same certificates of their curves"
    remedy = "prove the index along the curve, or do not claim it: index = false"
    with checklist.hypothesis("indices", "33.6", statement, remedy) as evidence:
        for arc, claimed in zip(arcs, web.arcs, strict=True):
            if not claimed.index:
                continue
            known = arc.indices or Indices("", problem="no certificate of its index is given")
            proved = bool(known.orbits) and not known.problem
            evidence.require(proved, f"{shown(arc.id)}: {known.problem or 'no index is proved'}")
            found[arc.id] = known
    return found


def parts_of(web: Web) -> tuple[tuple[str, ...], ...]:
    """Which arcs hang together by the vertices that they meet, in the order of the claim."""
    return hanging_together({arc.id: [meeting.vertex for meeting in arc.meets] for arc in web.arcs})


def _switches(arcs: Sequence[Arc], found: Sequence[Incidence]) -> tuple[Switch, ...]:
    """Where a planar family and an arc that branches off meet (Lemma 33.3); not at orbits where R is lost."""
    planar = {arc.id for arc in arcs if is_planar(arc.atlas.system)}
    return tuple(
        Switch(onto.vertex, along.arc, onto.arc)
        for onto in found if onto.how == BRANCHES
        for along in found
        if along.how == PASSES and along.vertex == onto.vertex and along.arc in planar and not _at_other_point(along)
    )  # fmt: skip


def _at_other_point(entry: Incidence) -> bool:
    return entry.place is not None and entry.place.other_point
