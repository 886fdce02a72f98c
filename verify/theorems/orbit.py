"""Single orbits (section 19)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import ORBIT, Candidate
from orbitproof.verify.attempt.precision import first_precision, missing_of_orbit
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.orbit import OrbitEnclosures, OrbitResults, OrbitTheorem, enclose_orbit, prove_orbit
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.words.orbit import orbit_found, orbit_in_words
from orbitproof.verify.words.row_in_full import symmetric_in_full


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> OrbitEnclosures:
    return enclose_orbit(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(ORBIT,),
    found_as="orbit",
    enclosures=OrbitEnclosures,
    results=OrbitResults,
    statement=partial(with_reversor, with_distance=True),
    theorem_of=lambda candidate, form: OrbitTheorem(candidate),
    first_precision=first_precision,
    check_exactly=check_exactly,
    enclose=_enclose,
    prove=prove_orbit,
    titles={"orbit": "One symmetric periodic orbit"},
    said=lambda k, kind: kind,
    legend=lambda k, kind: "one orbit",
    picture="orbit",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    missing=missing_of_orbit,
    in_words=orbit_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, orbit_in_words(theorem), orbit_found(candidate, found)
    ),
)
