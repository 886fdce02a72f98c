"""Births of invariant tori at periodic orbits without symmetry (section 25)."""

from __future__ import annotations

from orbitproof.shared.claims import PERIODIC_TORUS, PeriodicBifurcation
from orbitproof.verify.attempt.precision import missing_of_either, periodic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    TorusResults,
    TorusTheorem,
    check_torus_exactly,
    enclose_periodic_bifurcation,
    prove_torus,
    variables_of,
)
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.periodic import force_in_words
from orbitproof.verify.words.periodic_torus import torus_in_full, torus_in_words
from orbitproof.verify.words.row_in_full import in_lines


def _enclose(
    claim: PeriodicBifurcation, settings: IntegratorSettings, progress: Progress | None
) -> BifurcationEnclosures:
    return enclose_periodic_bifurcation(claim, settings, ORACLE, progress)


KIND = BoxKind(
    names=(PERIODIC_TORUS,),
    enclosures=BifurcationEnclosures,
    results=TorusResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: TorusTheorem(claim),
    first_precision=periodic_precision,
    check_exactly=check_torus_exactly,
    enclose=_enclose,
    prove=prove_torus,
    titles={"periodic-torus": "A torus bifurcation of periodic orbits"},
    said=lambda k, kind: "torus at a periodic orbit",
    picture="bifurcation",
    on_side=lambda kind: "the torus",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
    },
    variables=variables_of,
    besides=lambda claim, found: force_in_words(claim, found.point, found.period, found.parameter),
    missing=missing_of_either,
    in_words=torus_in_words,
    in_full=lambda claim, theorem, found: in_lines(torus_in_full(claim, torus_in_words(theorem), found)),
)
