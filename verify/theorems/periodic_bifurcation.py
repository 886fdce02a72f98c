"""Bifurcations of periodic orbits without symmetry (section 25)."""

from __future__ import annotations

from orbitproof.shared.claims import (
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PeriodicBifurcation,
)
from orbitproof.verify.attempt.precision import missing_of_either, periodic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic_bifurcation import (
    BifurcationEnclosures,
    PeriodicBifurcationResults,
    PeriodicBifurcationTheorem,
    check_bifurcation_exactly,
    enclose_periodic_bifurcation,
    prove_periodic_bifurcation,
    variables_of,
)
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.periodic import force_in_words
from orbitproof.verify.words.periodic_bifurcation import periodic_bifurcation_in_full, periodic_bifurcation_in_words
from orbitproof.verify.words.row_in_full import in_lines

_SAID = {PERIODIC_FOLD: "fold", PERIODIC_DOUBLING: "period doubling", PERIODIC_PITCHFORK: "symmetry breaking"}


def _enclose(
    claim: PeriodicBifurcation, settings: IntegratorSettings, progress: Progress | None
) -> BifurcationEnclosures:
    return enclose_periodic_bifurcation(claim, settings, ORACLE, progress)


KIND = BoxKind(
    names=tuple(_SAID),
    enclosures=BifurcationEnclosures,
    results=PeriodicBifurcationResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: PeriodicBifurcationTheorem(claim),
    first_precision=periodic_precision,
    check_exactly=check_bifurcation_exactly,
    enclose=_enclose,
    prove=prove_periodic_bifurcation,
    titles={
        "periodic-fold": "A fold of periodic orbits",
        "periodic-doubling": "A period doubling of periodic orbits",
        "periodic-pitchfork": "A symmetry breaking of periodic orbits",
    },
    said=lambda k, kind: f"{_SAID[kind]} of periodic orbits",
    picture="bifurcation",
    on_side=lambda kind: "two orbits" if kind == PERIODIC_FOLD else "new orbits",
    attributes=lambda found: {
        "parameter_name": found.parameter_name,
        "parameter": found.parameter,
        "side": found.side,
    },
    variables=variables_of,
    besides=lambda claim, found: force_in_words(claim, found.point, found.period, found.parameter),
    missing=missing_of_either,
    in_words=periodic_bifurcation_in_words,
    in_full=lambda claim, theorem, found: in_lines(
        periodic_bifurcation_in_full(claim, periodic_bifurcation_in_words(theorem), found)
    ),
)
