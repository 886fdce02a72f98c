"""Periodic orbits without symmetry (section 24)."""

from __future__ import annotations

from orbitproof.shared.claims import PERIODIC, PeriodicOrbit
from orbitproof.verify.attempt.precision import missing_of_period, periodic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    PeriodicEnclosures,
    PeriodicResults,
    PeriodicTheorem,
    check_periodic_exactly,
    enclose_periodic,
    prove_periodic,
)
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.periodic import force_in_words, periodic_in_full, periodic_in_words
from orbitproof.verify.words.row_in_full import in_lines


def _enclose(claim: PeriodicOrbit, settings: IntegratorSettings, progress: Progress | None) -> PeriodicEnclosures:
    return enclose_periodic(claim, settings, ORACLE, progress)


KIND = BoxKind(
    names=(PERIODIC,),
    found_as="periodic",
    enclosures=PeriodicEnclosures,
    results=PeriodicResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: PeriodicTheorem(claim),
    first_precision=periodic_precision,
    check_exactly=check_periodic_exactly,
    enclose=_enclose,
    prove=prove_periodic,
    titles={"periodic": "One periodic orbit"},
    said=lambda k, kind: "periodic orbit",
    picture="periodic orbit",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    besides=lambda claim, found: force_in_words(claim, found.point, found.period),
    missing=missing_of_period,
    in_words=periodic_in_words,
    in_full=lambda claim, theorem, found: in_lines(periodic_in_full(claim, periodic_in_words(theorem), found)),
)
