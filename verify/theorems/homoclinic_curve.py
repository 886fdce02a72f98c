"""Homoclinic orbits on all levels of an interval (section 42)."""

from __future__ import annotations

from orbitproof.shared.claims.homoclinic_curve import HOMOCLINIC_CURVE, HomoclinicCurve
from orbitproof.verify.attempt.precision import homoclinic_precision
from orbitproof.verify.certificate.kind import BoxKind, Progress
from orbitproof.verify.certificate.stated_system import without_reversor
from orbitproof.verify.homoclinic_curve import (
    HomoclinicCurveEnclosures,
    HomoclinicCurveResults,
    HomoclinicCurveTheorem,
    check_homoclinic_curve_exactly,
    enclose_homoclinic_curve,
    prove_homoclinic_curve,
)
from orbitproof.verify.oracle import IN_FRAMES
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.theorems import linearised  # noqa: F401 (how its functions are stored)
from orbitproof.verify.words.homoclinic_curve import (
    homoclinic_curve_found,
    homoclinic_curve_in_full,
    homoclinic_curve_in_words,
)
from orbitproof.verify.words.row_in_full import in_lines


def _enclose(
    claim: HomoclinicCurve, settings: IntegratorSettings, progress: Progress | None
) -> HomoclinicCurveEnclosures:
    return enclose_homoclinic_curve(claim, settings, IN_FRAMES, progress)


KIND = BoxKind(
    names=(HOMOCLINIC_CURVE,),
    enclosures=HomoclinicCurveEnclosures,
    results=HomoclinicCurveResults,
    statement=without_reversor,
    theorem_of=lambda claim, form: HomoclinicCurveTheorem(claim),
    first_precision=homoclinic_precision,
    check_exactly=check_homoclinic_curve_exactly,
    enclose=_enclose,
    prove=prove_homoclinic_curve,
    titles={"homoclinic_curve": "Transverse homoclinic orbits on all levels of an interval"},
    said=lambda k, kind: "homoclinic orbits on all levels of an interval",
    attributes=lambda found: {"parameter_name": "period", "parameter": found.period},
    besides=homoclinic_curve_found,
    # How well the numbers are known is decided by the levels, not by precision.
    missing=lambda found, digits: 0,
    in_words=homoclinic_curve_in_words,
    in_full=lambda claim, theorem, found: in_lines(homoclinic_curve_in_full(claim, theorem, found)),
)
