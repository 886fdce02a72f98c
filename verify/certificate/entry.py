"""The certificate of a candidate as a certificates file holds it, as a value (section 10.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from orbitproof.shared.codec import Definitions, Schema, form_of
from orbitproof.shared.stored import ToldBy, Unread, stored
from orbitproof.verify.certificate.document import (
    AnyStatement,
    Computation,
    Digest,
    Document,
    Software,
    StoredPlace,
    by_verdict,
)
from orbitproof.verify.certificate.kinds import MODULES, box_kind
from orbitproof.verify.evidence import Hypothesis, Reason

_KIND = ("candidate", "kind")
"""Where a statement says which kind of theorem it is about."""


@dataclass(frozen=True, kw_only=True)
class StoredCertificate(Document):
    """A certificate.

    Attributes:
        statement: the claim in full: the candidate as read, without provenance, and the system it is about.
        enclosures: what every hypothesis is evaluated from; null if there are none.
        place: of an orbit: where it lies on a proved curve; absent if that was not asked or is not shown.
    """

    statement: Annotated[Any, Unread(AnyStatement), ToldBy(_KIND)]
    reason: Reason | None
    hypotheses: tuple[Hypothesis, ...]
    results: Any
    enclosures: Any = stored(always=True, default=None)
    computation: Computation
    software: Software = stored(always=True, default_factory=dict)
    place: StoredPlace | None = None
    digest: Digest = ""

    @staticmethod
    def stored_rules(definitions: Definitions) -> Schema:
        """What results and enclosures there are, by verdict and kind."""
        holds = {"minItems": 1, "items": {"properties": {"holds": {"const": True}}}}
        told = by_verdict({"hypotheses": holds, "results": {"type": "object"}}, {"results": {"type": "null"}})
        modules = {MODULES[name]: [other for other in MODULES if MODULES[other] == MODULES[name]] for name in MODULES}
        return told | {"allOf": [_of_kind(names, definitions) for names in modules.values()]}


def _of_kind(names: Sequence[str], definitions: Definitions) -> Schema:
    kind = box_kind(names[0])
    held: dict[str, Any] = {"results": kind.results | None, "enclosures": kind.enclosures | None}
    condition: Schema = {"enum": list(names)}
    for key in reversed(("statement", *_KIND)):
        condition = {"required": [key], "properties": {key: condition}}
    return {
        "if": condition,
        "then": {"properties": {key: form_of(inner).schema(definitions) for key, inner in held.items()}},
    }
