"""What the certificate of a branch holds, as values: its JSON and its schema follow from their types (section 15)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, ClassVar

from orbitproof.shared.claims.fields import Id
from orbitproof.shared.stored import Unread, rules, stored
from orbitproof.verify.certificate.document import (
    Digest,
    Software,
    Stated,
    StatedFunction,
    StatedWithSymmetry,
    Verdict,
    by_verdict,
)
from orbitproof.verify.evidence import Reason


@dataclass(frozen=True, kw_only=True)
class BranchStatement(StatedWithSymmetry):
    """The statement of an atlas; see atlas.schema.json.

    Attributes:
        derived_parameters: for each parameter that follows from the others the function whose zero it is.
        stiffness_across: g, if the results are about variations w out of the plane of motion, which obey w'' = -g w.
    """

    claim: Mapping[str, Any] = stored("atlas")
    derived_parameters: Mapping[str, str] = stored(default_factory=dict)
    stiffness_across: str | None = None


@dataclass(frozen=True, kw_only=True)
class PeriodicCurveStatement(Stated):
    """The statement of an atlas that uses no symmetry; the first integral only if it is used.

    Attributes:
        functions: as in `StatedWithSymmetry`.
    """

    claim: Mapping[str, Any] = stored("atlas")
    functions: Annotated[tuple[StatedFunction, ...], rules(minItems=1, maxItems=20)] | None = None


def any_results() -> Any:
    """The type of the results of a branch of any kind, for the schema."""
    return import_module("orbitproof.verify.atlas.document_in_full").AnyResults


def any_conclusion() -> Any:
    """The type of the conclusion of a branch of any kind, for the schema."""
    return import_module("orbitproof.verify.atlas.document_in_full").AnyConclusion


@dataclass(frozen=True)
class Total:
    """Proved intervals, and the time that all tried intervals took together on one core."""

    intervals: int
    seconds: float


@dataclass(frozen=True, kw_only=True)
class BranchDocument:
    """What was claimed of a curve or surface, what is proved on each interval of each piece, and what follows.

    Attributes:
        id: of the atlas.
        reason: why the claim is not proved. Failure to verify is not a proof that the claim is false.
        statement: the claim in full, and the system it is about.
        results: what was found on intervals of pieces, in order along the curve.
        conclusion: what the results give together: hypotheses, how the pieces are glued, ends, bifurcations, the list
            of resonances if one was asked for. Null if a run was not finished.
        rests_on: the certificates of the bifurcations that were asked about, whole, each with its digest; see
            certificates.schema.json.
        computation: proved intervals, and the time that all tried intervals took together on one core.
        software: names and versions of what made this certificate, with a digest of the sources.
        digest: SHA-256 of the certificate without this key, as JSON with sorted keys and no spaces.
    """

    id: Id
    verdict: Verdict
    reason: Annotated[Any, Unread(Reason | None)]
    statement: BranchStatement | PeriodicCurveStatement
    results: Annotated[Any, Unread(any_results)]
    conclusion: Annotated[Any, Unread(any_conclusion)]
    rests_on: Annotated[
        tuple[Annotated[Mapping[str, Any], rules(required=("id", "digest"))], ...], rules(maxItems=10000)
    ]
    computation: Total
    software: Software
    digest: Digest

    stored_rules: ClassVar = by_verdict(
        {"conclusion": {"type": "object", "properties": {"verdict": {"const": "proved"}}}}, {}
    )
