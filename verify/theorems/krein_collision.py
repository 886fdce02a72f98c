"""Krein collisions (section 31)."""

from __future__ import annotations

from orbitproof.shared.claims import KREIN_COLLISION, Candidate
from orbitproof.verify.attempt.precision import breaking_precision, missing_of_parameter
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.krein import (
    KreinResults,
    check_krein_exactly,
    enclose_krein,
    prove_krein,
    theorem_of_krein,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import BreakingEnclosures, variables_of
from orbitproof.verify.words.krein import krein_found, krein_in_words
from orbitproof.verify.words.row_in_full import symmetric_in_full


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> BreakingEnclosures:
    return enclose_krein(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(KREIN_COLLISION,),
    enclosures=BreakingEnclosures,
    results=KreinResults,
    statement=with_reversor,
    theorem_of=lambda candidate, form: theorem_of_krein(candidate),
    first_precision=breaking_precision,
    check_exactly=check_krein_exactly,
    enclose=_enclose,
    prove=prove_krein,
    titles={"krein_collision": "A Krein collision of multipliers"},
    said=lambda k, kind: "Krein collision",
    legend=lambda k, kind: "Krein collision",
    tells_new_orbits=False,
    on_side=lambda kind: "linearly stable",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": {"a": found.unfolding, "b": found.coefficient},
    },
    variables=variables_of,
    missing=missing_of_parameter,
    in_words=krein_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, krein_in_words(theorem), krein_found(candidate, found)
    ),
)
