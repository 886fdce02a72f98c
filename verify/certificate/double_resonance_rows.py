"""Parameters at which two resonances meet as rows of a certificates file (section 34)."""

from __future__ import annotations

from orbitproof.shared.claims import DOUBLE_RESONANCE, Candidate
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import with_symmetry
from orbitproof.verify.double_resonance import (
    ResonanceEnclosures,
    ResonanceResults,
    check_resonance_exactly,
    enclose_resonance,
    prove_resonance,
    theorem_of_resonance,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import resonance_precision
from orbitproof.verify.poincare import IntegratorSettings


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> ResonanceEnclosures:
    return enclose_resonance(candidate, settings, ORACLE, progress)


DOUBLE_RESONANCES = RowKind(
    names=(DOUBLE_RESONANCE,),
    enclosures=ResonanceEnclosures,
    results=ResonanceResults,
    statement=with_symmetry,
    theorem_of=lambda candidate, form: theorem_of_resonance(candidate),
    first_precision=resonance_precision,
    check_exactly=check_resonance_exactly,
    enclose=_enclose,
    prove=prove_resonance,
    said=lambda k, kind: f"k = {k} double resonance",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": {"slope": found.slope, "curvature": found.curvature, "kappa": found.opening},
    },
)
