"""Orbits that are stable for ever (section 28)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import STABLE_ORBIT, Candidate
from orbitproof.verify.attempt.precision import first_precision, missing_of_orbit
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.twist import (
    StableOrbitEnclosures,
    StableOrbitResults,
    check_stable_orbit_exactly,
    enclose_stable_orbit,
    prove_stable_orbit,
    stable_orbit_theorem,
)
from orbitproof.verify.words.row_in_full import symmetric_in_full
from orbitproof.verify.words.stable_orbit import stable_orbit_found, stable_orbit_in_words


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> StableOrbitEnclosures:
    return enclose_stable_orbit(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(STABLE_ORBIT,),
    found_as="orbit",
    enclosures=StableOrbitEnclosures,
    results=StableOrbitResults,
    statement=partial(with_reversor, with_distance=True),
    theorem_of=lambda candidate, form: stable_orbit_theorem(candidate),
    first_precision=first_precision,
    check_exactly=check_stable_orbit_exactly,
    enclose=_enclose,
    prove=prove_stable_orbit,
    titles={"stable_orbit": "A symmetric periodic orbit that is stable for ever"},
    said=lambda k, kind: "stable orbit",
    legend=lambda k, kind: "one orbit, stable for ever",
    picture="stable orbit",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    missing=missing_of_orbit,
    in_words=stable_orbit_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, stable_orbit_in_words(theorem), stable_orbit_found(candidate, found)
    ),
)
