"""What certificates of graphs of curves have in common: they rest on those of their arcs (sections 33.7 and 39.6)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from orbitproof.shared.claims.fields import Id
from orbitproof.verify.certificate import (
    UNCHECKED_REASON,
    Certificate,
    Examination,
    Finding,
    Given,
    Key,
    Level,
    Recheck,
    in_all_data,
    other_hypotheses,
    unknown_reason,
)
from orbitproof.verify.certificate.document import Digest
from orbitproof.verify.certificate.kind import Step
from orbitproof.verify.evidence import Theorem

Part = Literal["arc", "vertex", "index"]
"""What a certificate is for a graph."""
NOT_CHECKED = "it was not checked up to its conclusion"


@dataclass(frozen=True)
class RestsOn:
    """A certificate that it rests on, of an arc, of a vertex, or of the index along an arc, with the id of that."""

    id: Id
    kind: Part
    digest: Digest


def problem_of(certificate: Certificate, checks: Mapping[Key, Recheck], called: str) -> str:
    """Why a certificate counts for nothing; empty if it says that it is proved, and stands at its conclusion."""
    check = checks[certificate.key]
    if not certificate.proved:
        return f"{called} says {certificate.verdict!r}"
    if not check.stands or check.level < Level.CONCLUSION:
        return f"{called} does not stand: {check.why or NOT_CHECKED}"
    return ""


def levels_of(
    read: Callable[[Mapping[str, Any], str], Any],
    theorem: Callable[[Any], Theorem],
    certified: Callable[[Any, Sequence[Certificate], Mapping[Key, Recheck]], dict[str, Any]],
) -> tuple[Step, Step, Step]:
    """The levels of a check: how the claim is read, its theorem, and the certificate that follows from others."""

    def form(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
        """Whether it names the certificates that it needs, which are those that are given."""
        document, certificates = certificate.document, given.certificates
        claim = read(document["statement"]["claim"], "statement.claim")
        if [(entry["kind"], entry["id"]) for entry in document["rests_on"]] != list(claim.keys):
            yield Finding("rests_on", "does not name the certificates that the claim needs, in its order")
            return
        for stored, entry in zip(document["rests_on"], certificates, strict=True):
            if stored["digest"] != entry.digest:
                has = entry.digest or "one without digest"
                words = f"the certificate {entry.called}: rests on {stored['digest']}; given is {has}"
                yield Finding("rests_on", words)
        expected = theorem(claim).hypotheses
        if document["verdict"] == "proved":
            yield from other_hypotheses([each["name"] for each in document["hypotheses"]], expected, document)
        else:
            yield from unknown_reason(document["reason"] or {"condition": ""}, expected)
            examination.notes += (UNCHECKED_REASON,)

    def conclusion(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
        """Whether it follows from these."""
        document = certificate.document
        if document["verdict"] == "proved":
            given.all_stand()
        fresh = certified(
            read(document["statement"]["claim"], "statement.claim"), given.certificates, given.checks
        )  # fmt: skip
        examination.hypotheses = len(fresh["hypotheses"])
        yield from in_all_data(document, fresh, examination)

    def integration(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
        """Nothing here rests on an integration but the certificates, which were integrated again."""
        yield from ()

    return form, conclusion, integration
