"""Single orbits as rows of a certificates file (section 19)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import ORBIT, Candidate
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import with_symmetry
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import first_precision
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults, OrbitTheorem, enclose_orbit, prove_orbit
from orbitproof.verify.poincare import IntegratorSettings


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> OrbitEnclosures:
    return enclose_orbit(candidate, settings, ORACLE, progress)


ORBITS = RowKind(
    names=(ORBIT,),
    enclosures=OrbitEnclosures,
    results=OrbitResults,
    statement=partial(with_symmetry, with_distance=True),
    theorem_of=lambda candidate, form: OrbitTheorem(candidate),
    first_precision=first_precision,
    check_exactly=check_exactly,
    enclose=_enclose,
    prove=prove_orbit,
    said=lambda k, kind: kind,
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
)
