"""Transverse homoclinic orbits on all levels of an interval (section 42)."""

from orbitproof.verify.homoclinic_curve.following import HomoclinicCurveEnclosures, enclose_homoclinic_curve
from orbitproof.verify.homoclinic_curve.proved_homoclinic_curve import (
    HomoclinicCurveResults,
    HomoclinicCurveTheorem,
    check_homoclinic_curve_exactly,
    prove_homoclinic_curve,
)
