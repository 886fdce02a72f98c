"""Certificates of webs: which proved curves meet in which certified orbits (section 33.7)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar

from flint import arb

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, PieceId, Title
from orbitproof.shared.claims.web import How, Web, WebArc
from orbitproof.shared.formats import Atlas, web_from_json
from orbitproof.shared.stored import rules
from orbitproof.verify.atlas.certificate import AtlasCertificate
from orbitproof.verify.atlas.certified import certified_point
from orbitproof.verify.atlas.conclusion import follow, partner
from orbitproof.verify.atlas.index import IndexCertificate
from orbitproof.verify.atlas.kinds import kind_of
from orbitproof.verify.atlas.listed import ListedInterval
from orbitproof.verify.atlas.rests_on import Key, Part, Resting, RestingError, called, digest_of, key_of, keys_of
from orbitproof.verify.atlas.sealed import Sealed, has_form, in_all_data, read_sealed, sealed, write_sealed
from orbitproof.verify.certificate import (
    UNCHECKED_REASON,
    CannotBeCheckedError,
    Certificate,
    Examination,
    Finding,
    Level,
    Recheck,
    climb,
    other_hypotheses,
    unknown_reason,
)
from orbitproof.verify.certificate.document import Digest, Software, Verdict
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
from orbitproof.verify.words.web import web_in_words

SCHEMA = "web-certificate"


@dataclass(frozen=True)
class RestsOn:
    """A certificate that it rests on, of an arc, of a vertex, or of the index along an arc, with the id of that."""

    id: Id
    kind: Part
    digest: Digest


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
class WebDocument:
    """A graph of proved curves of periodic orbits.

    Attributes:
        id: that of the claim.
        reason: why it is not proved. Failure to verify is not a proof that the claim is false.
        rests_on: the certificates of arcs, vertices and indices.
        arcs, vertices: what is proved of them; nothing if the claim is not proved.
        switches: where one arc branches off from another, and no other points that the same symmetry fixes are near.
        parts: the ids of arcs that hang together.
        software: names and versions of what made this certificate, with a digest of the sources.
        digest: SHA-256 of the certificate without this key, as JSON with sorted keys and no spaces.
    """

    id: Id
    verdict: Verdict
    reason: Reason | None
    statement: WebStatement
    rests_on: Annotated[tuple[RestsOn, ...], rules(minItems=1, maxItems=30000)]
    hypotheses: tuple[Hypothesis, ...]
    arcs: tuple[StoredArc, ...] = ()
    vertices: tuple[StoredVertex, ...] = ()
    switches: tuple[StoredSwitch, ...] = ()
    parts: tuple[tuple[Id, ...], ...] = ()
    software: Software
    digest: Digest

    stored_rules: ClassVar[Mapping[str, Any]] = {}


@dataclass(frozen=True, repr=False)
class WebCertificate(Sealed):
    """The certificate of a web. It says what its maker wrote; whether that follows is what checks decide.

    Attributes:
        document: fits the schema and its digest.
    """

    document: Mapping[str, Any]

    def __repr__(self) -> str:
        return f"<WebCertificate {self.id!r}: {self.verdict}, {len(self.document['arcs'])} arcs>"

    @property
    def claim(self) -> Web:
        """What was claimed."""
        return web_from_json(self.document["statement"]["claim"], f"certificate {self.id!r}: statement.claim")

    @property
    def arcs(self) -> tuple[StoredArc, ...]:
        """What it says of the arcs, in the order of the claim."""
        return from_json(tuple[StoredArc, ...], self.document["arcs"], "arcs")

    @property
    def vertices(self) -> tuple[StoredVertex, ...]:
        """What it says of the vertices."""
        return from_json(tuple[StoredVertex, ...], self.document["vertices"], "vertices")


def certified_web(web: Web, certificates: Sequence[Resting], checks: Mapping[Key, Recheck]) -> dict[str, Any]:
    """The certificate of a web, as JSON.

    Args:
        certificates: as `resting` gives them.
        checks: of each, up to the conclusion or further. Raises `ValueError` if one is that of another.
    """
    for entry in certificates:
        check = checks[key_of(entry)]
        if check.stands_without_place and check.digest != digest_of(entry):
            raise ValueError(f"checks: {entry.id!r}: is the check of another certificate")
    arcs = {entry.id: entry for entry in certificates if isinstance(entry, AtlasCertificate)}
    vertices = {entry.id: entry for entry in certificates if isinstance(entry, Certificate)}
    indices = {entry.id: entry for entry in certificates if isinstance(entry, IndexCertificate)}
    points = [
        replace(_arc(arcs[arc.id], arc, vertices, checks), indices=_indices(arcs[arc.id], indices.get(arc.id), checks))
        for arc in web.arcs
    ]
    outcome = conclude_web(web, points)
    rests_on = tuple(RestsOn(entry.id, key_of(entry)[0], digest_of(entry)) for entry in certificates)
    claim, reason = WebStatement(claim=web), None if isinstance(outcome, Proved) else outcome.reason
    known: dict[str, Any] = {}
    if isinstance(outcome, Proved):
        assert isinstance(outcome.theorem, WebTheorem)
        found = outcome.results
        words = web_in_words(
            outcome.theorem, found, {entry.id: entry.digest for entry in rests_on if entry.kind != "index"}
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


_NOT_CHECKED = "it was not checked up to its conclusion"


def _problem(certificate: AtlasCertificate | IndexCertificate, checks: Mapping[Key, Recheck], called: str) -> str:
    """Why a certificate counts for nothing; empty if it says that it is proved, and stands at its conclusion."""
    check = checks[key_of(certificate)]
    if not certificate.proved:
        return f"{called} says {certificate.verdict!r}"
    if not check.stands or check.level < Level.CONCLUSION:
        return f"{called} does not stand: {check.why or _NOT_CHECKED}"
    return ""


def _arc(
    certificate: AtlasCertificate, claimed: WebArc, vertices: Mapping[str, Certificate], checks: Mapping[Key, Recheck]
) -> Arc:
    """What a certificate proves of a curve, and where on it the vertices lie that it is claimed to meet."""
    atlas = certificate.atlas
    if not isinstance(atlas, Atlas) or not kind_of(atlas).holds_points:
        raise RestingError(key_of(certificate), "is about no curve of symmetric orbits; leave it out")
    if problem := _problem(certificate, checks, "the certificate"):
        return Arc(atlas, None, problem)
    wanted = [vertices[meeting.vertex] for meeting in claimed.meets if meeting.vertex in vertices]

    def examine(entry: Certificate) -> Recheck:
        check = checks[key_of(entry)]
        return check if check.level >= Level.CONCLUSION else replace(check, obstacle=check.obstacle or _NOT_CHECKED)

    points = [certified_point(atlas, entry, examine) for entry in wanted]
    conclusion = conclude(atlas, certificate.results, points, partner, follow)
    if not isinstance(conclusion.outcome, Proved):
        return Arc(atlas, None, conclusion.outcome.reason.message)
    return Arc(atlas, conclusion.outcome.results, "", {entry.id: entry for entry in conclusion.bifurcations})


def _indices(
    curve: AtlasCertificate, certificate: IndexCertificate | None, checks: Mapping[Key, Recheck]
) -> Indices | None:
    """What a certificate proves of the index along the curve of an arc, or why it counts for nothing (section 33.6)."""
    if certificate is None:
        return None
    problem = _problem(certificate, checks, "the certificate of its index")
    if certificate.document["rests_on"] != {"id": curve.id, "digest": digest_of(curve)}:
        problem = problem or "the certificate of its index rests on another certificate of a curve"
    if problem:
        return Indices(digest_of(certificate), problem=problem)
    orbits = tuple(
        IndexOnArc(tuple(turns.index for turns in orbit.turns), orbit.piece, orbit.s, orbit.begin, orbit.end)
        for orbit in certificate.orbits
    )
    return Indices(digest_of(certificate), orbits, certificate.small)


def _stored_arc(known: KnownArc, web: ProvedWeb, certificate: AtlasCertificate) -> StoredArc:
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


def recheck_web(document: Mapping[str, Any], certificates: Sequence[Resting], checks: Mapping[Key, Recheck]) -> Recheck:
    """Check the certificate of a web that fits the schema again, as far as those that it rests on were checked.

    `certificates`, `checks` as in `certified_web`.
    """
    own = [checks[key_of(entry)] for entry in certificates]
    levels, stands = [check.level for check in own], all(check.stands_without_place for check in own)
    steps = [partial(_form, document, certificates)]
    if min(levels) >= Level.CONCLUSION or not stands:
        steps.append(partial(_conclusion, document, certificates, checks))
    if min(levels) is Level.INTEGRATION:
        steps.append(partial(_integration, checks))
    return climb(document, steps)


def _form(document: Mapping[str, Any], certificates: Sequence[Resting], examination: Examination) -> Iterator[Finding]:
    yield from has_form(document, SCHEMA)
    web = web_from_json(document["statement"]["claim"], "statement.claim")
    if [(entry["kind"], entry["id"]) for entry in document["rests_on"]] != list(keys_of(web)):
        yield Finding("rests_on", "does not name the certificates that the claim needs, in its order")
        return
    for stored, entry in zip(document["rests_on"], certificates, strict=True):
        if stored["digest"] != digest_of(entry):
            has = digest_of(entry) or "one without digest"
            yield Finding(
                "rests_on", f"the certificate {called(key_of(entry))}: rests on {stored['digest']}; given is {has}"
            )
    expected = WebTheorem(web).hypotheses
    if document["verdict"] == "proved":
        yield from other_hypotheses([each["name"] for each in document["hypotheses"]], expected, document)
    else:
        yield from unknown_reason(document["reason"] or {"condition": ""}, expected)
        examination.notes += (UNCHECKED_REASON,)


def _conclusion(
    document: Mapping[str, Any],
    certificates: Sequence[Resting],
    checks: Mapping[Key, Recheck],
    examination: Examination,
) -> Iterator[Finding]:
    for entry in certificates:
        check = checks[key_of(entry)]
        if document["verdict"] == "proved" and not check.stands_without_place:
            raise CannotBeCheckedError(f"the certificate {called(key_of(entry))} does not stand: {check.why}")
    web = web_from_json(document["statement"]["claim"], "statement.claim")
    fresh = certified_web(web, certificates, checks)
    examination.hypotheses = len(fresh["hypotheses"])
    yield from in_all_data(document, fresh, examination)


def _integration(checks: Mapping[Key, Recheck], examination: Examination) -> Iterator[Finding]:
    """Nothing here rests on an integration but the certificates, which were integrated again."""
    examination.precision = min(check.precision for check in checks.values())
    yield from ()


def write_web_certificate(path: Path, document: Mapping[str, Any]) -> None:
    """Write a certificate, whole or not at all. Raises `InputError` if it cannot be written."""
    write_sealed(path, document, SCHEMA, (("arcs",), ("rests_on",)))


def read_web_certificate(path: Path) -> WebCertificate:
    """Read a certificate. Raises `InputError` if it is none, or was changed after it was written."""
    return WebCertificate(read_sealed(path, SCHEMA))
