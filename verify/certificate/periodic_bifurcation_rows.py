"""Bifurcations of periodic orbits without symmetry as rows of a certificates file (section 25)."""

from __future__ import annotations

from typing import Any

from orbitproof.shared.claims import (
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    PeriodicBifurcation,
)
from orbitproof.verify.certificate.row_kind import Progress, RowKind
from orbitproof.verify.certificate.stated_system import without_symmetry
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.oracle.precision import periodic_precision
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
    TorusResults,
    TorusTheorem,
    check_bifurcation_exactly,
    check_torus_exactly,
    enclose_periodic_bifurcation,
    prove_periodic_bifurcation,
    prove_torus,
    variables_of,
)
from orbitproof.verify.poincare import IntegratorSettings

_SAID = {PERIODIC_FOLD: "fold", PERIODIC_DOUBLING: "period doubling", PERIODIC_PITCHFORK: "symmetry breaking"}


def _enclose(
    claim: PeriodicBifurcation, settings: IntegratorSettings, progress: Progress | None
) -> BifurcationEnclosures:
    return enclose_periodic_bifurcation(claim, settings, ORACLE, progress)


def _attributes(found: PeriodicBifurcationResults | TorusResults) -> dict[str, Any]:
    return {"parameter_name": found.parameter_name, "parameter": found.parameter, "side": found.side}


BIFURCATIONS_OF_PERIODIC_ORBITS = RowKind(
    names=tuple(_SAID),
    enclosures=BifurcationEnclosures,
    results=PeriodicBifurcationResults,
    statement=without_symmetry,
    theorem_of=lambda claim, form: PeriodicBifurcationTheorem(claim),
    first_precision=periodic_precision,
    check_exactly=check_bifurcation_exactly,
    enclose=_enclose,
    prove=prove_periodic_bifurcation,
    said=lambda k, kind: f"{_SAID[kind]} of periodic orbits",
    attributes=_attributes,
    variables=variables_of,
)

TORI_AT_PERIODIC_ORBITS = RowKind(
    names=(PERIODIC_TORUS,),
    enclosures=BifurcationEnclosures,
    results=TorusResults,
    statement=without_symmetry,
    theorem_of=lambda claim, form: TorusTheorem(claim),
    first_precision=periodic_precision,
    check_exactly=check_torus_exactly,
    enclose=_enclose,
    prove=prove_torus,
    said=lambda k, kind: "torus at a periodic orbit",
    attributes=_attributes,
    variables=variables_of,
)
