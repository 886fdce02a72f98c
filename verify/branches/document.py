"""What the certificate of a branch holds, as values: its JSON and its schema follow from their types (section 15)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, ClassVar

from orbitproof.shared.claims import ATLASES_WITHOUT_REVERSOR, CLAIMS, SURFACE
from orbitproof.shared.stored import Rules, ToldBy, Unread, rules, stored
from orbitproof.verify.certificate.document import (
    Document,
    Stated,
    StatedFunction,
    StatedWithReversor,
    by_verdict,
)
from orbitproof.verify.evidence import Reason


def _kinds(*names: str) -> Rules:
    """The rule that an atlas claims one of these."""
    claim = {"type": "object", "required": ["kind"], "properties": {"kind": {"enum": names}}}
    return rules(required=("claim",), properties={"claim": claim})


@dataclass(frozen=True, kw_only=True)
class BranchStatement(StatedWithReversor):
    """The statement of an atlas; see atlas.schema.json.

    Attributes:
        derived_parameters: for each parameter that follows from the others the function whose zero it is.
        stiffness_across: g, if the results are about variations w out of the plane of motion, which obey w'' = -g w.
    """

    claim: Annotated[Mapping[str, Any], _kinds(*CLAIMS, SURFACE)] = stored("atlas")
    derived_parameters: Mapping[str, str] = stored(default_factory=dict)
    stiffness_across: str | None = None


@dataclass(frozen=True, kw_only=True)
class PeriodicCurveStatement(Stated):
    """The statement of an atlas that uses no symmetry; the first integral only if it is used.

    Attributes:
        functions: as in `StatedWithReversor`.
    """

    claim: Annotated[Mapping[str, Any], _kinds(*ATLASES_WITHOUT_REVERSOR)] = stored("atlas")
    functions: Annotated[tuple[StatedFunction, ...], rules(minItems=1, maxItems=20)] | None = None


def any_results() -> Any:
    """The type of the results of a branch of any kind, for the schema."""
    return import_module("orbitproof.verify.branches.document_in_full").AnyResults


def any_conclusion() -> Any:
    """The type of the conclusion of a branch of any kind, for the schema."""
    return import_module("orbitproof.verify.branches.document_in_full").AnyConclusion


@dataclass(frozen=True)
class Total:
    """Proved intervals, and the time that all tried intervals took together on one core."""

    intervals: int
    seconds: float


@dataclass(frozen=True, kw_only=True)
class BranchDocument(Document):
    """What was claimed of a curve or surface, what is proved on each interval of each piece, and what follows.

    Attributes:
        statement: the claim in full, and the system it is about.
        results: what was found on intervals of pieces, in order along the curve.
        conclusion: what the results give together: hypotheses, how the pieces are glued, ends, bifurcations, the list
            of resonances if one was asked for. Null if a run was not finished.
        rests_on: the certificates of the bifurcations that were asked about, whole, each with its digest; see
            certificates.schema.json.
        computation: proved intervals, and the time that all tried intervals took together on one core.
    """

    reason: Annotated[Any, Unread(Reason | None)]
    statement: Annotated[BranchStatement | PeriodicCurveStatement, ToldBy(("atlas", "claim", "kind"))]
    results: Annotated[Any, Unread(any_results)]
    conclusion: Annotated[Any, Unread(any_conclusion)]
    rests_on: Annotated[
        tuple[Annotated[Mapping[str, Any], rules(required=("id", "digest"))], ...], rules(maxItems=10000)
    ]
    computation: Total

    stored_rules: ClassVar = by_verdict(
        {"conclusion": {"type": "object", "properties": {"verdict": {"const": "proved"}}}}, {}
    )
