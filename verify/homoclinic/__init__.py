"""Transverse homoclinic orbits of a symmetric periodic orbit (section 40)."""

from orbitproof.verify.homoclinic.following import HomoclinicEnclosures, enclose_homoclinic
from orbitproof.verify.homoclinic.proved_homoclinic import (
    HomoclinicResults,
    HomoclinicTheorem,
    check_homoclinic_exactly,
    prove_homoclinic,
)
