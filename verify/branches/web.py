"""Certificates of webs: which proved curves meet in which certified orbits (section 33.7)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, cast

from flint import arb

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, PieceId, Title
from orbitproof.shared.claims.web import How, Web, WebArc
from orbitproof.shared.formats.web import web_from_json
from orbitproof.shared.stored import rules
from orbitproof.shared.wording import counted
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.branches.curve_conclusion import follow, partner
from orbitproof.verify.branches.joined import NOT_CHECKED, Part, RestsOn, levels_of, problem_of
from orbitproof.verify.branches.kinds import symmetric_curve
from orbitproof.verify.branches.listed import ListedInterval
from orbitproof.verify.branches.rests_on import RestingError
from orbitproof.verify.certificate import Certificate, Given, Key, Level, Recheck, sealed
from orbitproof.verify.certificate.document import Document
from orbitproof.verify.certificate.stored_balls import from_json
from orbitproof.verify.curve import conclude
from orbitproof.verify.evidence import Hypothesis, Proved, Reason, software
from orbitproof.verify.web import (
    Arc,
    Incidence,
    IndexOnArc,
    Indices,
    KnownArc,
    ProvedWeb,
    WebTheorem,
    conclude_web,
)
from orbitproof.verify.web.proved_web import LIBRATION_POINT
from orbitproof.verify.words.web import web_in_words

SCHEMA = "web-certificate"


@dataclass(frozen=True)
class StoredMeeting:
    """How an arc meets a vertex, and where on the arc the orbit is; nowhere of a libration point.

    Attributes:
        mirrored: whether its mirror image lies in the piece.
        other_point: whether its other point on Fix(R) does.
    """

    vertex: Id
    how: How
    piece: PieceId | None = None
    s: arb | None = None
    mirrored: bool = False
    other_point: bool = False


@dataclass(frozen=True, kw_only=True)
class StoredArc:
    """An arc.

    Attributes:
        id: of its certificate.
        system: of its states.
        reversor: the reversing symmetry of its orbits, if it is not R.
        kind, symmetry, crossings: of its claim.
        level, period: contain those of all its orbits; absent where they are not known.
        order: of its own list of resonances, if it has one, with the gaps that this names.
        stable: between which orbits that list says that they are linearly stable.
        index: that of its orbits, if that is claimed, as its certificate has it.
        small: the index of its small orbits around a libration point, if that is claimed and says so; of planar ones
            in the plane, then across it.
    """

    id: Id
    system: Title
    reversor: Identifier | None = None
    kind: Annotated[str, rules(enum=("arc", "symmetric-arc", "symmetric-loop", "loop"))]
    symmetry: Identifier | None = None
    crossings: Crossings = 1
    level: arb | None = None
    period: arb | None = None
    meets: tuple[StoredMeeting, ...]
    order: int | None = None
    stable: tuple[ListedInterval, ...] = ()
    index: Annotated[tuple[IndexOnArc, ...], rules(maxItems=100000)] = ()
    small: Annotated[tuple[int, ...], rules(maxItems=2)] = ()


@dataclass(frozen=True)
class StoredVertex:
    """A certified orbit or a libration point, and its level."""

    id: Id
    kind: Identifier
    k: int
    level: arb

    @property
    def is_libration_point(self) -> bool:
        """Whether it is none of the certified orbits."""
        return self.kind == LIBRATION_POINT


@dataclass(frozen=True)
class StoredSwitch:
    """Near a vertex the points with P^2(x) = x that its reversing symmetry fixes are those of both arcs (Lemma 33.3).

    `along` is planar, and `onto` branches off from it.
    """

    vertex: Id
    along: Id
    onto: Id


@dataclass(frozen=True, kw_only=True)
class WebStatement:
    """The claim, and what is proved, in words; absent if that is nothing."""

    claim: Web
    theorem: str | None = None


@dataclass(frozen=True, kw_only=True)
class WebDocument(Document):
    """A graph of proved curves of periodic orbits.

    Attributes:
        rests_on: the certificates of arcs, vertices and indices.
        arcs, vertices: what is proved of them; nothing if the claim is not proved.
        switches: where one arc branches off from another, and no other points that the same symmetry fixes are near.
        parts: the ids of arcs that hang together.
    """

    reason: Reason | None
    statement: WebStatement
    rests_on: Annotated[tuple[RestsOn, ...], rules(minItems=1, maxItems=30000)]
    hypotheses: tuple[Hypothesis, ...]
    arcs: tuple[StoredArc, ...] = ()
    vertices: tuple[StoredVertex, ...] = ()
    switches: tuple[StoredSwitch, ...] = ()
    parts: tuple[tuple[Id, ...], ...] = ()


SAID: Mapping[str, Callable[[Certificate], Any]] = {
    "claim": lambda certificate: web_from_json(
        certificate.document["statement"]["claim"], f"certificate {certificate.id!r}: statement.claim"
    ),
    "arcs": lambda certificate: from_json(tuple[StoredArc, ...], certificate.document["arcs"], "arcs"),
    "vertices": lambda certificate: from_json(tuple[StoredVertex, ...], certificate.document["vertices"], "vertices"),
    "results": lambda certificate: certificate.arcs,
}
"""What the certificate of a web says besides: its claim, its arcs in the order of that, its vertices."""


def extent_of(certificate: Certificate) -> str:
    """How large it is, in words."""
    arcs, vertices = (len(certificate.document[name]) for name in ("arcs", "vertices"))
    return f"{counted(arcs, 'arc')}, {vertices} {'vertex' if vertices == 1 else 'vertices'}"


def certified_web(web: Web, certificates: Sequence[Certificate], checks: Mapping[Key, Recheck]) -> dict[str, Any]:
    """The certificate of a web, as JSON.

    Args:
        certificates: as `resting` gives them.
        checks: of each, up to the conclusion or further. Raises `ValueError` if one is that of another.
    """
    for entry in certificates:
        Given(checks=checks).check_of(entry)
    arcs, vertices, indices = (
        {entry.id: entry for entry in certificates if entry.key[0] == part} for part in ("arc", "vertex", "index")
    )
    points = [
        replace(_arc(arcs[arc.id], arc, vertices, checks), indices=_indices(arcs[arc.id], indices.get(arc.id), checks))
        for arc in web.arcs
    ]
    outcome = conclude_web(web, points)
    rests_on = tuple(RestsOn(entry.id, cast(Part, entry.key[0]), entry.digest) for entry in certificates)
    claim, reason = WebStatement(claim=web), None if isinstance(outcome, Proved) else outcome.reason
    known: dict[str, Any] = {}
    if isinstance(outcome, Proved):
        theorem, found = cast(WebTheorem, outcome.theorem), outcome.results
        words = web_in_words(
            theorem, found, {entry.id: entry.digest for entry in certificates if entry.key[0] != "index"}
        )
        claim = WebStatement(claim=web, theorem=words)
        known = {
            "arcs": tuple(_stored_arc(each, found, arcs[each.arc.id]) for each in found.arcs),
            "vertices": tuple(StoredVertex(each.id, each.kind, each.k, each.level) for each in found.vertices),
            "switches": tuple(StoredSwitch(each.vertex, each.along, each.onto) for each in found.switches),
            "parts": found.parts,
        }
    document = WebDocument(
        id=web.id, verdict="not proved" if reason else "proved", reason=reason,
        statement=claim, rests_on=rests_on, hypotheses=outcome.hypotheses, **known, software=software(), digest="",
    )  # fmt: skip
    return sealed(document, SCHEMA, ("arcs", "vertices", "switches", "parts"))


def _arc(
    certificate: Certificate, claimed: WebArc, vertices: Mapping[str, Certificate], checks: Mapping[Key, Recheck]
) -> Arc:
    """What a certificate proves of a curve, and where on it the vertices lie that it is claimed to meet."""
    atlas = symmetric_curve(certificate.atlas)
    if atlas is None:
        raise RestingError(certificate.key, "is about no curve of symmetric orbits; leave it out")
    if problem := problem_of(certificate, checks, "the certificate"):
        return Arc(atlas, None, problem)
    wanted = [vertices[meeting.vertex] for meeting in claimed.meets if meeting.vertex in vertices]

    def examine(entry: Certificate) -> Recheck:
        check = checks[entry.key]
        return check if check.level >= Level.CONCLUSION else replace(check, obstacle=check.obstacle or NOT_CHECKED)

    points = [certified_point(atlas, entry, examine) for entry in wanted]
    conclusion = conclude(atlas, certificate.results, points, partner, follow)
    if not isinstance(conclusion.outcome, Proved):
        return Arc(atlas, None, conclusion.outcome.reason.message)
    return Arc(atlas, conclusion.outcome.results, "", {entry.id: entry for entry in conclusion.bifurcations})


def _indices(curve: Certificate, certificate: Certificate | None, checks: Mapping[Key, Recheck]) -> Indices | None:
    """What a certificate proves of the index along the curve of an arc, or why it counts for nothing (section 33.6)."""
    if certificate is None:
        return None
    problem = problem_of(certificate, checks, "the certificate of its index")
    if certificate.document["rests_on"] != {"id": curve.id, "digest": curve.digest}:
        problem = problem or "the certificate of its index rests on another certificate of a curve"
    if problem:
        return Indices(certificate.digest, problem=problem)
    orbits = tuple(
        IndexOnArc(tuple(turns.index for turns in orbit.turns), orbit.piece, orbit.s, orbit.begin, orbit.end)
        for orbit in certificate.orbits
    )
    return Indices(certificate.digest, orbits, certificate.small)


def _stored_arc(known: KnownArc, web: ProvedWeb, certificate: Certificate) -> StoredArc:
    atlas = known.arc.atlas
    listed = (certificate.document["conclusion"] or {}).get("complete")
    return StoredArc(
        id=atlas.id,
        system=known.arc.system.title,
        reversor=known.arc.system.reversor,
        kind=atlas.claim.kind,
        symmetry=atlas.claim.symmetry,
        crossings=atlas.claim.crossings,
        level=_if_finite(known.level),
        period=_if_finite(known.period),
        meets=tuple(_stored_meeting(entry) for entry in web.incidences if entry.arc == atlas.id),
        order=None if listed is None else int(listed["order"]),
        stable=certificate.stable,
        index=() if known.indices is None else known.indices.orbits,
        small=() if known.indices is None else known.indices.small,
    )


def _if_finite(ball: arb) -> arb | None:
    return ball if ball.is_finite() else None


def _stored_meeting(entry: Incidence) -> StoredMeeting:
    place = entry.place
    if place is None:
        return StoredMeeting(entry.vertex, entry.how)
    return StoredMeeting(entry.vertex, entry.how, place.piece, place.s, place.mirrored, place.other_point)


LEVELS = levels_of(web_from_json, WebTheorem, certified_web)
