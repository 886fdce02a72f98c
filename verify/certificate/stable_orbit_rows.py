"""Orbits that are stable for ever as rows of a certificates file (section 28)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import STABLE_ORBIT, Candidate
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import with_symmetry
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import first_precision
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.twist import (
    StableOrbitEnclosures,
    StableOrbitResults,
    check_stable_orbit_exactly,
    enclose_stable_orbit,
    prove_stable_orbit,
    stable_orbit_theorem,
)


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> StableOrbitEnclosures:
    return enclose_stable_orbit(candidate, settings, ORACLE, progress)


STABLE_ORBITS = RowKind(
    names=(STABLE_ORBIT,),
    enclosures=StableOrbitEnclosures,
    results=StableOrbitResults,
    statement=partial(with_symmetry, with_distance=True),
    theorem_of=lambda candidate, form: stable_orbit_theorem(candidate),
    first_precision=first_precision,
    check_exactly=check_stable_orbit_exactly,
    enclose=_enclose,
    prove=prove_stable_orbit,
    said=lambda k, kind: "stable orbit",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
)
