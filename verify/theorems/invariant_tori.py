"""Orbits at which invariant tori accumulate (section 30)."""

from __future__ import annotations

from functools import partial

from orbitproof.shared.claims import INVARIANT_TORI, Candidate
from orbitproof.verify.attempt.precision import first_precision, missing_of_orbit
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import with_reversor
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.tori import ToriEnclosures, ToriResults, enclose_tori, prove_tori, theorem_of_tori
from orbitproof.verify.words.row_in_full import symmetric_in_full
from orbitproof.verify.words.tori import tori_found, tori_in_words


def _enclose(candidate: Candidate, settings: IntegratorSettings, progress: Progress | None) -> ToriEnclosures:
    return enclose_tori(candidate, settings, ORACLE, progress)


KIND = BoxKind(
    names=(INVARIANT_TORI,),
    found_as="orbit",
    enclosures=ToriEnclosures,
    results=ToriResults,
    statement=partial(with_reversor, with_distance=True),
    theorem_of=lambda candidate, form: theorem_of_tori(candidate),
    first_precision=first_precision,
    check_exactly=check_exactly,
    enclose=_enclose,
    prove=prove_tori,
    titles={"invariant_tori": "Invariant tori near a symmetric periodic orbit"},
    said=lambda k, kind: "tori",
    legend=lambda k, kind: "one orbit, tori near it",
    picture="orbit",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    missing=missing_of_orbit,
    in_words=tori_in_words,
    in_full=lambda candidate, theorem, found: symmetric_in_full(
        candidate, tori_in_words(theorem), tori_found(candidate, found)
    ),
)
