"""Parameters at which two resonances meet (section 34)."""

from __future__ import annotations

from orbitproof.shared.claims import DOUBLE_RESONANCE, Candidate
from orbitproof.verify.attempt.precision import missing_of_parameter, resonance_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.double_resonance import (
    ResonanceEnclosures,
    ResonanceResults,
    check_resonance_exactly,
    enclose_resonance,
    prove_resonance,
    theorem_of_resonance,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.double_resonance import resonance_found, resonance_in_words
from orbitproof.verify.words.row_in_full import symmetric_in_full


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> ResonanceEnclosures:
    return enclose_resonance(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(DOUBLE_RESONANCE,),
    enclosures=ResonanceEnclosures,
    results=ResonanceResults,
    statement=with_reversor,
    theorem_of=lambda candidate, form: theorem_of_resonance(candidate),
    first_precision=resonance_precision,
    check_exactly=check_resonance_exactly,
    enclose=_enclose,
    prove=prove_resonance,
    titles={"double_resonance": "Two resonances that meet"},
    said=lambda k, kind: f"double resonance (k = {k})",
    legend=lambda k, kind: f"two $k={k}$ resonances",
    picture="meeting",
    tells_new_orbits=False,
    on_side=lambda kind: "two resonances",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": {"slope": found.slope, "curvature": found.curvature, "kappa": found.opening},
    },
    missing=missing_of_parameter,
    in_words=resonance_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, resonance_in_words(theorem), resonance_found(candidate, found)
    ),
)
