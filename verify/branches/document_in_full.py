"""What the certificates of branches of all kinds hold of their results, for the schema (section 15)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from flint import arb

from orbitproof.shared.stored import rules
from orbitproof.verify.certificate.document import Verdict
from orbitproof.verify.equilibrium import Spectrum
from orbitproof.verify.equilibrium_curve import Fold, SidedPart
from orbitproof.verify.evidence import Hypothesis, Reason
from orbitproof.verify.lasting import CurveIntervalResult
from orbitproof.verify.periodic_curve import CountedPart, PeriodicIntervalResult, Turn
from orbitproof.verify.surface import SurfaceResult


@dataclass(frozen=True)
class AnyResult(CurveIntervalResult, SurfaceResult, PeriodicIntervalResult):
    """What was found on an interval of a piece, of a curve or of a surface, for the schema."""


@dataclass(frozen=True)
class Order:
    """What is said in any case of a list: the largest k."""

    order: Annotated[int, rules(minimum=1, maximum=99)]

    stored_rules: ClassVar = {"additionalProperties": True}


@dataclass(frozen=True, kw_only=True)
class StoredConclusion:
    """What the results give together."""

    verdict: Verdict
    reason: Reason | None
    hypotheses: tuple[Hypothesis, ...]
    statement: str
    stretches: tuple[Mapping[str, Any], ...]
    joints: tuple[Mapping[str, Any], ...]
    ends: Mapping[str, Any]
    bifurcations: tuple[Annotated[Mapping[str, Any], rules(required=("id", "on_curve"))], ...]
    period: arb | None = None
    turns: tuple[Turn, ...] = ()
    multipliers: tuple[CountedPart, ...] = ()
    folds: tuple[Fold, ...] = ()
    sides: tuple[SidedPart, ...] = ()
    frequency: arb | None = None
    eigenvalues: Spectrum | None = None
    frequency_at_end: arb | None = None
    eigenvalues_at_end: Spectrum | None = None
    complete: Order | None = None


AnyResults = Annotated[tuple[AnyResult, ...], rules(maxItems=1000000)]
AnyConclusion = StoredConclusion | None
