"""The certificate of a candidate as a certificates file holds it, as a value (section 10.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from orbitproof.shared.claims.fields import Id
from orbitproof.shared.stored import ToldBy, Unread, stored
from orbitproof.verify.certificate.document import (
    AnyStatement,
    Computation,
    Digest,
    Software,
    StoredPlace,
    Verdict,
    by_verdict,
)
from orbitproof.verify.certificate.kinds import any_enclosures, any_results
from orbitproof.verify.evidence import Hypothesis, Reason


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A certificate.

    Attributes:
        statement: the claim in full: the candidate as read, without provenance, and the system it is about.
        reason: why the claim is not proved. Failure to verify is not a proof that it is false.
        enclosures: what every hypothesis is evaluated from; null if there are none.
        software: names and versions of what made this certificate, with a digest of the sources.
        place: of an orbit: where it lies on a proved curve; absent if that was not asked or is not shown.
        digest: SHA-256 of the certificate without this key, as JSON with sorted keys and no spaces.
    """

    id: Id
    statement: Annotated[AnyStatement, ToldBy(("candidate", "kind"))]
    verdict: Verdict
    reason: Reason | None
    hypotheses: tuple[Hypothesis, ...]
    results: Annotated[Any, Unread(any_results)]
    enclosures: Annotated[Any, Unread(any_enclosures)] = stored(always=True, default=None)
    computation: Computation
    software: Software = stored(always=True, default_factory=dict)
    place: StoredPlace | None = None
    digest: Digest = ""

    stored_rules: ClassVar = by_verdict(
        {"hypotheses": {"minItems": 1, "items": {"properties": {"holds": {"const": True}}}},
         "results": {"type": "object"}},
        {"results": {"type": "null"}},
    )  # fmt: skip
