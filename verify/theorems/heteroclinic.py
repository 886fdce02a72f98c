"""Heteroclinic orbits between two symmetric periodic orbits (section 41)."""

from __future__ import annotations

from orbitproof.shared.claims.heteroclinic import HETEROCLINIC, HeteroclinicOrbit
from orbitproof.verify.attempt.precision import homoclinic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.heteroclinic import (
    HeteroclinicEnclosures,
    HeteroclinicResults,
    HeteroclinicTheorem,
    check_heteroclinic_exactly,
    enclose_heteroclinic,
    prove_heteroclinic,
)
from orbitproof.verify.oracle import IN_FRAMES
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.heteroclinic import heteroclinic_found, heteroclinic_in_full, heteroclinic_in_words
from orbitproof.verify.words.row_in_full import in_lines


def _enclose(
    claim: HeteroclinicOrbit, settings: IntegratorSettings, progress: Progress | None
) -> HeteroclinicEnclosures:
    return enclose_heteroclinic(claim, settings, IN_FRAMES, progress)


KIND = BoxKind(
    names=(HETEROCLINIC,),
    enclosures=HeteroclinicEnclosures,
    results=HeteroclinicResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: HeteroclinicTheorem(claim),
    first_precision=lambda claim, digits: max(homoclinic_precision(end, digits) for end in claim.ends),
    check_exactly=check_heteroclinic_exactly,
    enclose=_enclose,
    prove=prove_heteroclinic,
    titles={"heteroclinic": "A transverse heteroclinic orbit"},
    said=lambda k, kind: "heteroclinic orbit between periodic orbits",
    attributes=lambda found: {},
    besides=heteroclinic_found,
    # As of a homoclinic orbit.
    missing=lambda found, digits: 0,
    in_words=heteroclinic_in_words,
    in_full=lambda claim, theorem, found: in_lines(heteroclinic_in_full(claim, heteroclinic_in_words(theorem), found)),
)
