"""Homoclinic orbits of a symmetric periodic orbit (section 40)."""

from __future__ import annotations

from orbitproof.shared.claims.homoclinic import HOMOCLINIC, HomoclinicOrbit
from orbitproof.verify.attempt.precision import homoclinic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.homoclinic import (
    HomoclinicEnclosures,
    HomoclinicResults,
    HomoclinicTheorem,
    check_homoclinic_exactly,
    enclose_homoclinic,
    prove_homoclinic,
)
from orbitproof.verify.oracle import IN_FRAMES
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.homoclinic import homoclinic_found, homoclinic_in_full, homoclinic_in_words
from orbitproof.verify.words.row_in_full import in_lines


def _enclose(claim: HomoclinicOrbit, settings: IntegratorSettings, progress: Progress | None) -> HomoclinicEnclosures:
    return enclose_homoclinic(claim, settings, IN_FRAMES, progress)


KIND = BoxKind(
    names=(HOMOCLINIC,),
    enclosures=HomoclinicEnclosures,
    results=HomoclinicResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: HomoclinicTheorem(claim),
    first_precision=homoclinic_precision,
    check_exactly=check_homoclinic_exactly,
    enclose=_enclose,
    prove=prove_homoclinic,
    titles={"homoclinic": "A transverse homoclinic orbit"},
    said=lambda k, kind: "homoclinic orbit to a periodic orbit",
    picture="connection",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    besides=homoclinic_found,
    # How well the numbers are known is decided by the box and the interval, not by precision.
    missing=lambda found, digits: 0,
    in_words=homoclinic_in_words,
    in_full=lambda claim, theorem, found: in_lines(homoclinic_in_full(claim, homoclinic_in_words(theorem), found)),
)
