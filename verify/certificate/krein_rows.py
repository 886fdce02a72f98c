"""Krein collisions as rows of a certificates file (section 31)."""

from __future__ import annotations

from orbitproof.shared.claims import KREIN_COLLISION, Candidate
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import with_symmetry
from orbitproof.verify.krein import (
    KreinResults,
    check_krein_exactly,
    enclose_krein,
    prove_krein,
    theorem_of_krein,
)
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import breaking_precision
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.reversor_breaking import BreakingEnclosures, variables_of


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> BreakingEnclosures:
    return enclose_krein(candidate, settings, ORACLE, progress)


COLLISIONS = RowKind(
    names=(KREIN_COLLISION,),
    enclosures=BreakingEnclosures,
    results=KreinResults,
    statement=with_symmetry,
    theorem_of=lambda candidate, form: theorem_of_krein(candidate),
    first_precision=breaking_precision,
    check_exactly=check_krein_exactly,
    enclose=_enclose,
    prove=prove_krein,
    said=lambda k, kind: "Krein collision",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
        "normal_form": {"a": found.unfolding, "b": found.coefficient},
    },
    variables=variables_of,
)
