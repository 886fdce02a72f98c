"""Births of orbits that R does not map to themselves (section 27)."""

from __future__ import annotations

from orbitproof.shared.claims import REVERSOR_BREAKING, Candidate
from orbitproof.verify.attempt.precision import breaking_precision, missing_of_parameter
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import (
    BreakingEnclosures,
    BreakingResults,
    check_breaking_exactly,
    enclose_breaking,
    prove_breaking,
    theorem_of,
    variables_of,
)
from orbitproof.verify.words.breaking import breaking_found, breaking_in_words
from orbitproof.verify.words.row_in_full import symmetric_in_full


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> BreakingEnclosures:
    return enclose_breaking(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(REVERSOR_BREAKING,),
    enclosures=BreakingEnclosures,
    results=BreakingResults,
    statement=with_reversor,
    theorem_of=lambda candidate, form: theorem_of(candidate),
    first_precision=breaking_precision,
    check_exactly=check_breaking_exactly,
    enclose=_enclose,
    prove=prove_breaking,
    titles={"reversor_breaking": "A birth of periodic orbits that R does not map to themselves"},
    said=lambda k, kind: "loss of R",
    legend=lambda k, kind: "$R$ is lost",
    picture="birth",
    normal_form_section="27.5",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": {"gamma": found.gamma, "beta": found.beta, "kappa": found.opening},
    },
    variables=variables_of,
    missing=missing_of_parameter,
    in_words=breaking_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, breaking_in_words(theorem), breaking_found(candidate, found)
    ),
)
