"""Orbits at which invariant tori accumulate as rows of a certificates file (section 30)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import INVARIANT_TORI, Candidate
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import with_symmetry
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import first_precision
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.tori import ToriEnclosures, ToriResults, enclose_tori, prove_tori, theorem_of_tori


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> ToriEnclosures:
    return enclose_tori(candidate, settings, ORACLE, progress)


TORI_AT_ORBITS = RowKind(
    names=(INVARIANT_TORI,),
    enclosures=ToriEnclosures,
    results=ToriResults,
    statement=partial(with_symmetry, with_distance=True),
    theorem_of=lambda candidate, form: theorem_of_tori(candidate),
    first_precision=first_precision,
    check_exactly=check_exactly,
    enclose=_enclose,
    prove=prove_tori,
    said=lambda k, kind: "tori",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
)
